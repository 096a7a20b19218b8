//! Places for square tiles in the square atlas: a quadtree of free squares.

use std::collections::BTreeSet;

/// Side of the smallest tile in texels, as a power of two.
pub(super) const LEAST_LEVEL: u32 = 4;

/// A square of the atlas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Tile {
    /// Its side is `2^level` texels.
    pub(crate) level: u32,
    /// Upper left corner in texels, a multiple of the side.
    pub(crate) x: u32,
    pub(crate) y: u32,
}

impl Tile {
    /// Side in texels.
    pub(crate) fn side(self) -> u32 {
        1 << self.level
    }

    /// As `shadow_tile` in `shadow/lookup.wgsl` reads it.
    pub(super) fn word(self) -> u32 {
        let unit = 1 << LEAST_LEVEL;
        1 << 31 | self.level << 20 | (self.y / unit) << 10 | (self.x / unit)
    }
}

/// Which squares of the atlas are free.
#[derive(Debug)]
pub(super) struct Atlas {
    level: u32,
    /// Corners (y, x) of free squares, per level from [`LEAST_LEVEL`] on. Squares that four of a
    /// kind make up are listed as one.
    free: Vec<BTreeSet<(u32, u32)>>,
}

impl Atlas {
    /// An empty atlas of `2^level` texels a side.
    pub(super) fn new(level: u32) -> Self {
        let mut free = vec![BTreeSet::new(); (level - LEAST_LEVEL + 1) as usize];
        free[(level - LEAST_LEVEL) as usize].insert((0, 0));
        Self { level, free }
    }

    fn free_at(&mut self, level: u32) -> &mut BTreeSet<(u32, u32)> {
        &mut self.free[(level - LEAST_LEVEL) as usize]
    }

    /// Takes a free square of `2^level` texels a side: the first of the smallest that are large
    /// enough. Tiles that are asked for from the largest to the smallest leave no gaps: they all
    /// fit if their areas do.
    pub(super) fn take(&mut self, level: u32) -> Option<Tile> {
        let (from, (y, x)) =
            (level..=self.level).find_map(|from| Some((from, self.free_at(from).pop_first()?)))?;
        // Of each quartered square the first quarter is taken further.
        for quarter in (level..from).rev() {
            let side = 1 << quarter;
            self.free_at(quarter)
                .extend([(y, x + side), (y + side, x), (y + side, x + side)]);
        }
        Some(Tile { level, x, y })
    }

    /// Gives a square back.
    pub(super) fn give(&mut self, tile: Tile) {
        let Tile {
            mut level,
            mut x,
            mut y,
        } = tile;
        while level < self.level {
            let side = 1 << level;
            let (left, top) = (x & !side, y & !side);
            let quarters = [
                (top, left),
                (top, left + side),
                (top + side, left),
                (top + side, left + side),
            ];
            let own = (y, x);
            let free = self.free_at(level);
            let others = quarters.iter().filter(|&&q| q != own);
            if !others.clone().all(|q| free.contains(q)) {
                break;
            }
            for quarter in quarters {
                free.remove(&quarter);
            }
            (x, y, level) = (left, top, level + 1);
        }
        self.free_at(level).insert((y, x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlap(a: Tile, b: Tile) -> bool {
        let apart = |a: u32, a_side: u32, b: u32, b_side: u32| a + a_side <= b || b + b_side <= a;
        !apart(a.x, a.side(), b.x, b.side()) && !apart(a.y, a.side(), b.y, b.side())
    }

    #[test]
    fn tiles_from_large_to_small_fill_the_atlas_without_gap_or_overlap() {
        let mut atlas = Atlas::new(8);
        let levels = [
            7, 7, 6, 6, 6, 6, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 4, 4, 4, 4,
        ];
        let area = |levels: &[u32]| levels.iter().map(|l| 1u32 << (2 * l)).sum::<u32>();
        let mut levels = levels.to_vec();
        while area(&levels) < 1 << 16 {
            levels.push(4);
        }
        assert_eq!(area(&levels), 1 << 16);
        let tiles: Vec<Tile> = levels
            .iter()
            .map(|&l| atlas.take(l).expect("fits"))
            .collect();
        for (i, &a) in tiles.iter().enumerate() {
            assert!(a.x + a.side() <= 256 && a.y + a.side() <= 256);
            assert!(tiles[..i].iter().all(|&b| !overlap(a, b)), "{a:?}");
        }
        assert_eq!(atlas.take(4), None);
    }

    #[test]
    fn squares_given_back_become_large_ones_again() {
        let mut atlas = Atlas::new(7);
        let tiles: Vec<Tile> = std::iter::from_fn(|| atlas.take(4)).collect();
        assert_eq!(tiles.len(), 64);
        for &tile in tiles.iter().rev() {
            atlas.give(tile);
        }
        assert_eq!(atlas.take(7).map(Tile::side), Some(128));
    }

    #[test]
    fn a_place_is_the_same_for_the_same_requests() {
        let places = || {
            let mut atlas = Atlas::new(9);
            [6, 4, 7, 5, 4].map(|level| atlas.take(level))
        };
        assert_eq!(places(), places());
    }
}
