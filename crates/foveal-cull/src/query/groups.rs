//! Boxes around the children of a node.

use crate::bounds::Aabb;
use crate::projection::boxes::Boxes8;
use crate::simd::{F8, Lanes};

/// The box around eight boxes, each a volume or [`Aabb::EMPTY`].
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn around<L: Lanes>(l: L, boxes: &[Aabb; 8]) -> Aabb {
    let first = row(l, &boxes[0]);
    let (mut low, mut high) = (first, first);
    for b in &boxes[1..] {
        let row = row(l, b);
        (low, high) = (row.min(low), row.max(high));
    }
    let (mut lows, mut highs) = ([0.0; 8], [0.0; 8]);
    low.store(&mut lows);
    high.store(&mut highs);
    Aabb::new([lows[0], lows[1], lows[2]], [highs[3], highs[6], highs[7]])
}

/// A box in a register: its first four numbers and its last four, which compilers load as they lie.
#[cfg_attr(not(unoptimized), inline(always))]
fn row<L: Lanes>(l: L, Aabb { min, max }: &Aabb) -> F8<L> {
    l.load(&[
        min[0], min[1], min[2], max[0], min[2], max[0], max[1], max[2],
    ])
}

/// The sum of half the surfaces of the boxes whose bit is set. A box counts nothing whose surface is
/// not a number or too large for one.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn half_areas<L: Lanes>(l: L, boxes: &Boxes8, lanes: u8) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| l.load(&boxes.half[k]));
    let area = x * y + y * z + z * x;
    let mut areas = [0.0; 8];
    area.is_finite()
        .select(area, l.splat(0.0))
        .store(&mut areas);
    (0..8)
        .filter(|lane| lanes >> lane & 1 != 0)
        .map(|lane| f64::from(areas[lane]))
        .sum()
}
