//! Single kernels for the crate's own benches. Not part of the interface: it may change at any
//! time.

use crate::bounds::Aabb;
use crate::depth::block::BlockState;
use crate::depth::buffer::OcclusionBuffer;
use crate::depth::hiz_build::BuildHiz;
use crate::format::{BLOCK, BLOCK_SAMPLES, encode};
use crate::raster::block::DepthPlane;
use crate::raster::edges::Edges;
use crate::raster::polygon::{self, Polygon};
use crate::simd::{F16, InstructionSet, Kernel, Lanes, Sixteen};

/// A single block that overlapping polygons update one after the other.
#[derive(Debug)]
pub struct BlockUpdates {
    buffer: OcclusionBuffer,
    /// Corners by coordinate, samples, and depth.
    quads: Vec<([f64; 4], [f64; 4], f32)>,
}

impl BlockUpdates {
    /// A block, and `count` quads that each cover a part of it, farthest first.
    #[must_use]
    pub fn new(count: u32) -> Self {
        let center = f64::from(BLOCK_SAMPLES) * 0.5;
        let quad = |i: u32| {
            let turn = f64::from(i) * 2.4;
            let (at, reach) = (center + 9.0 * (3.0 * turn).sin(), center * 0.9);
            // Counter-clockwise on the screen, whose y points down.
            let corner = |k: u32| turn - f64::from(k) * core::f64::consts::FRAC_PI_2;
            (
                core::array::from_fn(|k| at + reach * corner(k as u32).cos()),
                core::array::from_fn(|k| center + reach * corner(k as u32).sin()),
                0.1 + 0.8 * i as f32 / count as f32,
            )
        };
        Self {
            buffer: OcclusionBuffer::new(BLOCK, BLOCK),
            quads: (0..count).map(quad).collect(),
        }
    }

    /// Clears the block and draws all quads; returns the work that was counted.
    pub fn run(&mut self, set: InstructionSet) -> u32 {
        self.buffer.clear();
        set.run(self)
    }
}

impl Kernel for &mut BlockUpdates {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> u32 {
        let mut band = self.buffer.band();
        for (x, y, depth) in &self.quads {
            let Some((edges, rows)) = Edges::of(l, l.load_doubles(x), l.load_doubles(y)) else {
                continue;
            };
            let plane = DepthPlane {
                x: x[0] as f32,
                y: y[0] as f32,
                depth: *depth,
                dx: 1e-4,
                dy: 2e-4,
                min: depth * 0.99,
                min_code: encode(depth * 0.99),
                max_code: encode(depth * 1.01),
            };
            let polygon = Polygon {
                edges,
                rows,
                plane,
                blocks: [0; 4],
            };
            polygon::draw(l, &mut band, &polygon);
        }
        band.work[0]
    }
}

/// A buffer that is full of depth.
#[derive(Debug)]
pub struct FullBuffer(OcclusionBuffer);

impl FullBuffer {
    /// A buffer of this size, pixels.
    #[must_use]
    pub fn new(width_px: u32, height_px: u32) -> Self {
        let mut buffer = OcclusionBuffer::new(width_px, height_px);
        buffer.states.fill(BlockState::DEPTH);
        for (i, (min, depth)) in (0u32..).zip(buffer.min.iter_mut().zip(&mut buffer.depth)) {
            *min = (i.wrapping_mul(2_654_435_761) >> 17) as i16;
            depth.0.fill(*min);
        }
        Self(buffer)
    }

    /// Builds the HiZ; returns its farthest code.
    pub fn build_hiz(&mut self, set: InstructionSet) -> i16 {
        set.run(BuildHiz(&mut self.0));
        self.0.hiz.iter().copied().min().unwrap_or(0)
    }
}

/// Transposes boxes, sixteen at a time, from rows to lanes; returns the sum of the last lanes.
#[must_use]
pub fn transpose(boxes: &[Aabb], set: InstructionSet) -> f32 {
    set.run(Transpose(boxes))
}

struct Transpose<'a>(&'a [Aabb]);

impl Kernel for Transpose<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> f32 {
        let sum = sum(l.wide(), self.0);
        let mut lanes = [0.0; 16];
        sum.store(&mut lanes);
        lanes[15]
    }
}

#[inline(always)]
fn sum<W: Sixteen>(w: W, boxes: &[Aabb]) -> F16<W> {
    let mut sum = w.splat(0.0);
    for boxes in boxes.as_chunks::<16>().0 {
        for v in w.transpose(boxes) {
            sum = sum + v;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::block::{KIND_DEPTH, KIND_EMPTY};

    #[test]
    fn quads_of_a_block_cover_parts_of_it_and_together_more() {
        for set in InstructionSet::available() {
            let covered = |count| {
                let mut block = BlockUpdates::new(count);
                block.run(set);
                assert!(block.buffer.states[0].kind() > KIND_DEPTH, "partly covered");
                let pixels = (0..64).filter(|&p| block.buffer.code_at(p) > i16::MIN);
                pixels.count()
            };
            let (one, all) = (covered(1), covered(64));
            assert!(10 < one && one < all && all < 64, "{one} {all}");
        }
    }

    #[test]
    fn a_full_buffer_has_depth_everywhere() {
        let mut buffer = FullBuffer::new(72, 40);
        buffer.build_hiz(InstructionSet::detect());
        let states = &buffer.0.states;
        assert!(states.iter().all(|s| s.kind() != KIND_EMPTY));
        assert_eq!(buffer.0.hiz[..states.len()], buffer.0.min);
    }
}
