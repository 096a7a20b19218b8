//! Building the HiZ of a complete frame.

use super::buffer::OcclusionBuffer;
use super::hiz_layout::{MAX_JOINED, PARTS, part_len, rows};
use crate::simd::{Kernel, Lanes};

/// The kernel that clears stale blocks and fills the HiZ table.
pub(crate) struct BuildHiz<'a>(pub(crate) &'a mut OcclusionBuffer);

impl Kernel for BuildHiz<'_> {
    type Output = ();

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, _: L) {
        let buffer = self.0;
        buffer.empty_stale();
        let stride = buffer.blocks_x as usize;
        let (rows, part) = (
            rows(buffer.blocks_x, buffer.blocks_y) as usize,
            part_len(buffer.blocks_x, buffer.blocks_y),
        );
        let (mut w, mut h) = (stride, buffer.blocks_y as usize);
        let hiz = &mut buffer.hiz;
        hiz[..buffer.min.len()].copy_from_slice(&buffer.min);
        for level in 0.. {
            let first = (rows - (rows >> level)) * stride;
            // Join one more cell to the right, then one more row below. Values past the right and
            // lower edge are meaningless, and no look-up reads them.
            let n = h * stride;
            for right in 1..MAX_JOINED {
                let (done, to) = hiz.split_at_mut(right * part);
                let before = &done[(right - 1) * part + first..];
                farther(&mut to[first..][..n], before, &done[first + right..]);
            }
            for p in MAX_JOINED..PARTS {
                let (below, right) = (p / MAX_JOINED, p % MAX_JOINED);
                let (done, to) = hiz.split_at_mut(p * part);
                let before = &done[(p - MAX_JOINED) * part + first..];
                let lower = &done[right * part + first + below * stride..];
                farther(&mut to[first..][..n], before, lower);
            }
            if w == 1 && h == 1 {
                return;
            }
            let next = (w.div_ceil(2), h.div_ceil(2));
            let next_first = (rows - (rows >> (level + 1))) * stride;
            for y in 0..next.1 {
                // The last column and row may have no neighbours.
                let below = usize::from(2 * y + 1 < h) * MAX_JOINED;
                let row = first + 2 * y * stride;
                let last = (below + usize::from(w % 2 == 0)) * part + row + 2 * (next.0 - 1);
                let last = hiz[last];
                let (single, fours) = hiz.split_at_mut((below + 1) * part);
                let above = &mut single[next_first + y * stride..][..next.0];
                for (out, v) in above.iter_mut().zip(fours[row..].iter().step_by(2)) {
                    *out = *v;
                }
                above[next.0 - 1] = last;
            }
            (w, h) = next;
        }
    }
}

#[cfg_attr(not(unoptimized), inline(always))]
fn farther(out: &mut [i16], a: &[i16], b: &[i16]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = *a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;

    #[test]
    fn the_hiz_has_the_farthest_depth_of_the_blocks_below() {
        for (width, height) in [(72, 40), (8, 8), (8, 130), (300, 16)] {
            let mut buffer = OcclusionBuffer::new(width, height);
            for (i, min) in (0i16..).zip(&mut buffer.min) {
                *min = (i * 37) % 101;
            }
            InstructionSet::detect().run(BuildHiz(&mut buffer));
            let (w, h) = (buffer.blocks_x, buffer.blocks_y);
            let rows = rows(w, h);
            for level in 0..=w.max(h).next_power_of_two().trailing_zeros() {
                for y in 0..h.div_ceil(1 << level) {
                    for x in 0..w.div_ceil(1 << level) {
                        let inside = |p: &u32| {
                            let (x, y) = (x + p % MAX_JOINED as u32, y + p / MAX_JOINED as u32);
                            x << level < w && y << level < h
                        };
                        for p in (0..PARTS as u32).filter(inside) {
                            let within = |v: u32, from: u32, more: u32| {
                                (from..=from + more).contains(&(v >> level))
                            };
                            let below = (0..h)
                                .flat_map(|v| (0..w).map(move |u| (u, v)))
                                .filter(|&(u, v)| {
                                    within(u, x, p % MAX_JOINED as u32)
                                        && within(v, y, p / MAX_JOINED as u32)
                                })
                                .map(|(u, v)| buffer.min[(v * w + u) as usize])
                                .min();
                            let at = (rows - (rows >> level) + y) * w + x;
                            let at = p as usize * part_len(w, h) + at as usize;
                            assert_eq!(Some(buffer.hiz[at]), below, "{level} {x} {y} {p}");
                        }
                    }
                }
            }
        }
    }
}
