//! Welding: positions that are bit-equal become one vertex, so that neighbours are found however a
//! mesh was exported. In a mesh that deforms they may part, so each index stays a vertex.

use super::word_hash::{WordHash, Words3};
use glam::Vec3;
use std::collections::HashMap;

/// Points, and triangles that index them.
pub(super) struct Welded {
    /// All points that any triangle has, degenerate ones too.
    pub(super) points: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The first index of each point's position.
    pub(super) sources: Vec<u32>,
}

/// What becomes one vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum By {
    /// Equal positions. Triangles without area are left out.
    Position,
    /// Equal indices. Triangles with an index twice are left out.
    Index,
}

/// Welds triangles over `positions` finite positions, which `position` gives, and leaves out
/// degenerate triangles.
pub(super) fn weld(
    by: By,
    positions: usize,
    position: &dyn Fn(u32) -> Vec3,
    triangles: impl ExactSizeIterator<Item = [u32; 3]>,
) -> Welded {
    let corners = triangles.len().saturating_mul(3);
    let most = match by {
        By::Position => positions.min(corners),
        By::Index => 0,
    };
    let mut unique: HashMap<Words3, u32, WordHash> =
        HashMap::with_capacity_and_hasher(most, WordHash::default());
    let mut numbers = Numbers::new(positions, corners);
    let (mut points, mut sources) = (Vec::new(), Vec::new());
    let mut renumber = |i: u32| {
        numbers.get_or(i, || {
            // + 0.0 makes -0.0 and 0.0 the same point.
            let p = position(i) + Vec3::ZERO;
            let mut next = || {
                points.push(p);
                sources.push(i);
                (points.len() - 1) as u32
            };
            match by {
                By::Index => next(),
                By::Position => {
                    let key = Words3(p.to_array().map(f32::to_bits));
                    *unique.entry(key).or_insert_with(next)
                }
            }
        })
    };
    let mut triangles: Vec<[u32; 3]> = triangles.map(|t| t.map(&mut renumber)).collect();
    triangles.retain(|&[a, b, c]| {
        let [p, q, r] = [a, b, c].map(|i| points[i as usize].as_dvec3());
        match by {
            By::Index => a != b && b != c && c != a,
            By::Position => (q - p).cross(r - p).length_squared() > 0.0,
        }
    });
    Welded {
        points,
        triangles,
        sources,
    }
}

/// The numbers of indices.
enum Numbers {
    Table(Vec<u32>),
    /// For few of very many.
    Map(HashMap<u32, u32, WordHash>),
}

impl Numbers {
    /// No number yet.
    const NONE: u32 = u32::MAX;

    fn new(positions: usize, corners: usize) -> Self {
        if positions <= corners {
            Self::Table(vec![Self::NONE; positions])
        } else {
            Self::Map(HashMap::default())
        }
    }

    fn get_or(&mut self, index: u32, number: impl FnOnce() -> u32) -> u32 {
        let place = match self {
            Self::Table(numbers) => &mut numbers[index as usize],
            Self::Map(numbers) => numbers.entry(index).or_insert(Self::NONE),
        };
        if *place == Self::NONE {
            *place = number();
        }
        *place
    }
}
