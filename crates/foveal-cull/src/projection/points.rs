//! Single points of boxes on the screen: a box with a point in front of the buffer is visible.
//!
//! Most visible boxes are visible at their centre, and most of the others at a corner. Pixel
//! indices are found for many boxes at once; the look-ups are scalar, since gathers take longer.

/// Index of a pixel (right, down; on the screen) for
/// [`OcclusionBuffer::code_at`](crate::depth::buffer::OcclusionBuffer::code_at), one per lane of
/// `$l`. A macro, which lanes of eight and of sixteen share.
macro_rules! pixel_index {
    ($l:ident, $buffer:expr, $x:expr, $y:expr) => {{
        use crate::format::{BLOCK, BLOCK_PIXELS};
        let (x, y) = ($x, $y);
        let bits = $l.int(BLOCK.trailing_zeros() as i32);
        let (column, row) = (x >> bits, y >> bits);
        // A step to the next block, less the steps within a block.
        let right = $l.int((BLOCK_PIXELS - BLOCK) as i32);
        let down = $l.int(((($buffer).blocks_x - 1) * BLOCK_PIXELS) as i32);
        let within = x + y * BLOCK as i32;
        let across = column * right + row * down;
        within + across
    }};
}
pub(crate) use pixel_index;

/// The corners of eight boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Corners8 {
    /// By corner: the index of its pixel.
    pub(crate) at: [[i32; 8]; 8],
    /// By corner: its depth code; a very low one beside the screen.
    pub(crate) code: [[i32; 8]; 8],
}

impl Corners8 {
    pub(crate) const NONE: Self = Self {
        at: [[0; 8]; 8],
        code: [[0; 8]; 8],
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use crate::depth::block::BlockState;
    use crate::depth::buffer::OcclusionBuffer;
    use crate::depth::hiz::Hiz;
    use crate::format::{EMPTY, encode};
    use crate::projection::boxes::Boxes8;
    use crate::projection::project::outline;
    use crate::projection::screen::Screen;
    use crate::simd::{Kernel, Lanes};
    use glam::Vec3;

    struct Project<'a>(&'a Screen<'a>, &'a Boxes8);

    impl Kernel for Project<'_> {
        type Output = Corners8;

        #[cfg_attr(not(unoptimized), inline(always))]
        fn run<L: Lanes>(self, l: L) -> Corners8 {
            let mut corners = Corners8::NONE;
            outline(l, self.0, self.1, Some(&mut corners));
            corners
        }
    }

    #[test]
    fn corners_lie_in_their_pixels() {
        let (width, height) = (72, 40);
        let mut buffer = OcclusionBuffer::new(width, height);
        // Each pixel has a code that names it.
        buffer.states.fill(BlockState::DEPTH);
        for (b, block) in (0u32..).zip(&mut buffer.depth) {
            for (i, code) in (0u32..).zip(&mut block.0) {
                let (x, y) = (
                    b % buffer.blocks_x * 8 + i % 8,
                    b / buffer.blocks_x * 8 + i / 8,
                );
                *code = (y * width + x) as i16;
            }
        }
        // The eye looks along -z, with 45 degrees to either side.
        let (w, h) = (4.0 * width as f32, 4.0 * height as f32);
        let screen = Screen {
            rows: [
                [0.5 * w, 0.0, -0.5 * w, 0.0],
                [0.0, -0.5 * w, -0.5 * h, 0.0],
                [0.0, 0.0, 0.0, 0.1],
                [0.0, 0.0, -1.0, 0.0],
            ],
            width: w,
            height: h,
            far_depth: 0.0,
            dilate: 0.5,
            grow: 0.0,
            hiz: Hiz::new(&buffer),
        };
        let mut boxes = Boxes8::NONE;
        let at = |i: usize| {
            let v = i as f32;
            (
                Vec3::new(v - 3.5, 0.4 * v - 1.3, -3.0 - v),
                Vec3::new(0.7, 0.2 + 0.1 * v, 0.5),
            )
        };
        for i in 0..8 {
            let (center, half) = at(i);
            boxes.set(i, center, half);
        }
        let corners = InstructionSet::detect().run(Project(&screen, &boxes));
        let portable = InstructionSet::Portable.run(Project(&screen, &boxes));
        let (mut on, mut off) = (0, 0);
        for i in 0..8 {
            let (center, half) = at(i);
            let mut expected: Vec<_> = (0..8)
                .map(|k| {
                    let side = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
                    let p = center + half * Vec3::new(side(1), side(2), side(4));
                    let x = (0.5 * w * (p.x / -p.z + 1.0) / 4.0).floor();
                    let y = ((-0.5 * w * p.y / -p.z + 0.5 * h) / 4.0).floor();
                    let inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
                    let code = encode(0.1 / -p.z);
                    inside.then_some((y as i32 * width as i32 + x as i32, i32::from(code)))
                })
                .collect();
            let mut found: Vec<_> = (0..8)
                .map(|k| {
                    let (at, code) = (corners.at[k][i], corners.code[k][i]);
                    assert_eq!((at, code), (portable.at[k][i], portable.code[k][i]));
                    (code > i32::from(EMPTY))
                        .then(|| (i32::from(buffer.code_at(at as usize)), code))
                })
                .collect();
            expected.sort_unstable();
            found.sort_unstable();
            for (e, f) in expected.iter().zip(&found) {
                assert_eq!(e.map(|e| e.0), f.map(|f| f.0), "box {i}");
                let apart = e.zip(*f).map_or(0, |(e, f)| e.1 - f.1);
                assert!(apart.abs() <= 1, "box {i}");
            }
            on += expected.iter().flatten().count();
            off += 8 - expected.iter().flatten().count();
        }
        assert!(on > 20 && off > 5, "{on} {off}");
    }
}
