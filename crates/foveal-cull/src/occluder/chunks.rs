//! Chunks: triangles that lie together and are baked one chunk after the other.
//!
//! A large mesh is halved at the median of its triangles' centres, along the longest side, until no
//! part has more than [`MOST_TRIANGLES`]. What baking needs besides its result is then small and
//! lies in the caches, and threads share the chunks. Chunks depend on the triangles alone.

use super::in_parts::in_parts_of;
use crate::threads::Threads;
use glam::Vec3;

/// Most triangles of a chunk.
pub(super) const MOST_TRIANGLES: usize = 16_384;

/// How a mesh is cut into chunks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunking {
    /// Most triangles of a chunk, [`MOST_TRIANGLES`] or fewer.
    pub(super) triangles: usize,
    /// Most corners of triangles that are looked at for what lies around a chunk, its own at its
    /// border included, so that vertices of very many triangles, which belong to many chunks, take
    /// no quadratic time.
    pub(super) corners_around: usize,
}

impl Chunking {
    pub(super) const USUAL: Self = Self {
        triangles: MOST_TRIANGLES,
        corners_around: 8 * MOST_TRIANGLES,
    };
}

/// Where a triangle is.
#[derive(Clone, Copy)]
struct Center {
    at: Vec3,
    triangle: u32,
}

/// The numbers of `count` triangles by chunk, at most `most` and ascending in each. `corners` gives a triangle's
/// positions, which are finite.
pub(super) fn apart(
    count: usize,
    corners: &(dyn Fn(usize) -> [Vec3; 3] + Sync),
    most: usize,
    threads: &dyn Threads,
) -> Vec<Vec<u32>> {
    if count <= most {
        return vec![(0..count as u32).collect()];
    }
    let nowhere = Center {
        at: Vec3::ZERO,
        triangle: 0,
    };
    let mut centers = vec![nowhere; count];
    let mut parts: Vec<(usize, &mut [Center])> = centers
        .chunks_mut(MOST_TRIANGLES)
        .enumerate()
        .map(|(i, part)| (i * MOST_TRIANGLES, part))
        .collect();
    in_parts_of(threads, &mut parts, &|(first, part)| {
        for (triangle, center) in (*first..).zip(part.iter_mut()) {
            // Divided before the sum, which therefore stays finite.
            let at = corners(triangle).map(|p| p / 3.0).iter().sum();
            *center = Center {
                at,
                triangle: triangle as u32,
            };
        }
    });
    drop(parts);
    let mut ranges = vec![&mut centers[..]];
    while ranges.iter().any(|r| r.len() > most) {
        in_parts_of(threads, &mut ranges, &|range| halve(range));
        let halves = |range| {
            let range: &mut [Center] = range;
            let at = middle(range.len());
            range.split_at_mut(at)
        };
        ranges = ranges
            .into_iter()
            .map(halves)
            .flat_map(<[_; 2]>::from)
            .collect();
    }
    let numbers = |range: &mut &mut [Center]| {
        let mut numbers: Vec<u32> = range.iter().map(|c| c.triangle).collect();
        numbers.sort_unstable();
        numbers
    };
    in_parts_of(threads, &mut ranges, &numbers)
}

/// Where a range is halved; all ranges of a level end up too short at once, but for one triangle.
fn middle(count: usize) -> usize {
    count.div_ceil(2)
}

/// Brings the triangles on the lower side of the median, along the longest side, to the front.
fn halve(range: &mut [Center]) {
    let corners = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (lo, hi) = range
        .iter()
        .fold(corners, |(lo, hi), c| (lo.min(c.at), hi.max(c.at)));
    let size = hi - lo;
    let axis = size.max_position();
    let at = middle(range.len()).min(range.len().saturating_sub(1));
    if range.len() > 1 {
        range.select_nth_unstable_by(at, |a, b| {
            (a.at[axis].total_cmp(&b.at[axis])).then(a.triangle.cmp(&b.triangle))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SingleThread;

    #[test]
    fn every_triangle_is_in_one_chunk_and_chunks_lie_apart() {
        // Flat, 300 x 200 triangles, numbered across the long side.
        let (wide, high) = (300usize, 200usize);
        let corners = |t: usize| {
            let p = Vec3::new((t / high) as f32, (t % high) as f32, 0.0);
            [p, p + Vec3::X * 0.5, p + Vec3::Y * 0.5]
        };
        let chunks = apart(wide * high, &corners, MOST_TRIANGLES, &SingleThread);
        assert_eq!(chunks.len(), 4);
        let mut all: Vec<u32> = chunks.concat();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..(wide * high) as u32));
        for (n, chunk) in chunks.iter().enumerate() {
            assert!(chunk.is_sorted() && chunk.len() <= MOST_TRIANGLES);
            // First halved along the long side, then both halves, 150 x 200, along the other.
            let lo = chunk
                .iter()
                .map(|&t| corners(t as usize)[0])
                .reduce(Vec3::min);
            let column = (n / 2 * wide / 2) as f32;
            let row = (n % 2 * high / 2) as f32;
            assert_eq!(lo, Some(Vec3::new(column, row, 0.0)), "chunk {n}");
        }
    }

    #[test]
    fn triangles_in_one_place_or_far_apart_are_halved_all_the_same() {
        for place in [0.0, 1e-45, 3e38] {
            let corners =
                |t: usize| [Vec3::splat(if t.is_multiple_of(2) { place } else { -place }); 3];
            let chunks = apart(100_000, &corners, MOST_TRIANGLES, &SingleThread);
            assert_eq!(chunks.iter().map(Vec::len).sum::<usize>(), 100_000);
            assert_eq!(chunks.len(), 8, "{place}");
        }
    }
}
