//! The exact tiling on the CPU: the passes' twin, and what tests and tools ask about a tiling.

/// The minimum of the requested levels over each block of each level, and the tiling that follows
/// from it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MinPyramid {
    levels: Vec<Grid>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Grid {
    width: u32,
    height: u32,
    cells: Vec<u8>,
}

/// Bit of a cell that says that its block holds a geometric edge.
pub(crate) const EDGE: u8 = 0x80;
/// Bits of a cell that hold the level.
pub(crate) const LEVEL: u8 = 0x0f;

impl Grid {
    fn at(&self, x: u32, y: u32) -> u8 {
        self.cells[(y * self.width + x) as usize]
    }

    fn holds(&self, x: u32, y: u32) -> bool {
        x < self.width && y < self.height
    }
}

impl MinPyramid {
    /// Builds the pyramid over `requests`, rows of `width` (at least 1) pixels, top to bottom. The
    /// lowest four bits of a request are its level; one above `coarsest`, which is at most 15, counts
    /// as `coarsest`. Bit 7 marks a geometric edge, the others mean nothing. With `balance`,
    /// neighbouring blocks differ by one level at most.
    #[must_use]
    pub fn new(width: u32, requests: &[u8], coarsest: u8, balance: bool) -> Self {
        let (width, coarsest) = (width.max(1), coarsest.min(LEVEL));
        let cells = requests
            .iter()
            .map(|&w| (w & LEVEL).min(coarsest) | w & EDGE)
            .collect();
        let mut levels = vec![Grid {
            width,
            height: requests.len() as u32 / width,
            cells,
        }];
        for level in 1..=coarsest {
            let next = reduce(&levels[usize::from(level) - 1], level, balance);
            levels.push(next);
        }
        Self { levels }
    }

    /// The coarsest level.
    #[must_use]
    pub fn coarsest(&self) -> u8 {
        self.levels.len() as u8 - 1
    }

    fn level(&self, level: u8) -> Option<&Grid> {
        self.levels.get(usize::from(level))
    }

    /// Blocks across and down at a level; those at the right and the bottom may reach beyond the
    /// picture. None beyond the coarsest level.
    #[must_use]
    pub fn size(&self, level: u8) -> (u32, u32) {
        self.level(level)
            .map_or((0, 0), |grid| (grid.width, grid.height))
    }

    /// The cells of a level as the passes write them, row by row; empty beyond the coarsest level. The
    /// lowest four bits are the coarsest level that the block's pixels allow, and with balance those
    /// around it; bit 7 says that the block holds an edge.
    #[must_use]
    pub fn cells(&self, level: u8) -> &[u8] {
        self.level(level).map_or(&[], |grid| &grid.cells)
    }

    /// Whether a block is allowed at its level.
    fn allows(&self, level: u8, x: u32, y: u32) -> bool {
        self.level(level)
            .is_some_and(|grid| grid.holds(x, y) && grid.at(x, y) & LEVEL >= level)
    }

    /// Whether a block is a tile of the tiling; false where there is no such block.
    #[must_use]
    pub fn owns(&self, level: u8, x: u32, y: u32) -> bool {
        self.allows(level, x, y)
            && (level == self.coarsest() || !self.allows(level + 1, x / 2, y / 2))
    }

    /// The level of the tile that holds a pixel; 0 where none does.
    #[must_use]
    pub fn owner_level(&self, x: u32, y: u32) -> u8 {
        let mut level = 0;
        while level < self.coarsest() && self.allows(level + 1, x >> (level + 1), y >> (level + 1))
        {
            level += 1;
        }
        level
    }

    /// Tiles per level.
    #[must_use]
    pub fn tiles(&self) -> Vec<u64> {
        (0..=self.coarsest())
            .map(|level| {
                let (width, height) = self.size(level);
                (0..height)
                    .flat_map(|y| (0..width).map(move |x| (x, y)))
                    .filter(|&(x, y)| self.owns(level, x, y))
                    .count() as u64
            })
            .collect()
    }
}

/// The grid of `level` from the one below: the minimum of the four children inside the picture. For
/// a balanced tiling a block is allowed only where all blocks around its children are allowed at
/// the children's level.
fn reduce(below: &Grid, level: u8, balance: bool) -> Grid {
    let (width, height) = (below.width.div_ceil(2), below.height.div_ceil(2));
    let cell = |x: u32, y: u32| {
        let mut least = LEVEL;
        let mut edge = 0;
        let ring = u32::from(balance);
        for cy in (2 * y).saturating_sub(ring)..(2 * y + 2 + ring).min(below.height) {
            for cx in (2 * x).saturating_sub(ring)..(2 * x + 2 + ring).min(below.width) {
                let child = below.at(cx, cy);
                if cx / 2 == x && cy / 2 == y {
                    least = least.min(child & LEVEL);
                    edge |= child & EDGE;
                } else if child & LEVEL < level - 1 {
                    least = least.min(level - 1);
                }
            }
        }
        least | edge
    };
    Grid {
        width,
        height,
        cells: (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| cell(x, y))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A map whose requested levels come in patches of 2^patch pixels, so that coarse levels occur
    /// at all.
    fn patches(width: u32, height: u32, patch: u32, seed: u32) -> Vec<u8> {
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let h = ((x >> patch) ^ seed)
                    .wrapping_mul(0x9e37_79b1)
                    .wrapping_add((y >> patch).wrapping_mul(0x85eb_ca6b));
                (((h ^ h >> 15).wrapping_mul(0x2c1b_3c6d) >> 20) % 9) as u8
            })
            .collect()
    }

    /// Sizes from 1 x 1 to 4096 in one direction.
    fn maps() -> impl Strategy<Value = (u32, u32, Vec<u8>)> {
        let size = prop_oneof![
            (1..300u32, 1..300u32),
            (1..4097u32, 1..20u32),
            (1..20u32, 1..4097u32)
        ];
        (size, 0..9u32, any::<u32>())
            .prop_map(|((w, h), patch, seed)| (w, h, patches(w, h, patch, seed)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn every_pixel_has_exactly_one_owner((w, _, requests) in maps(), coarsest in 0..9u8, balance: bool) {
            let pyramid = MinPyramid::new(w, &requests, coarsest, balance);
            for (index, &request) in (0..).zip(&requests) {
                let (x, y) = (index % w, index / w);
                let owners: Vec<u8> =
                    (0..=coarsest).filter(|&l| pyramid.owns(l, x >> l, y >> l)).collect();
                prop_assert_eq!(&owners, &vec![pyramid.owner_level(x, y)]);
                prop_assert!(owners[0] <= request, "never coarser than requested");
            }
        }

        #[test]
        fn tiles_cover_the_picture_once((w, h, requests) in maps(), balance: bool) {
            let pyramid = MinPyramid::new(w, &requests, 8, balance);
            let mut area = 0;
            for level in 0..=8u8 {
                let (bw, bh) = pyramid.size(level);
                for (x, y) in (0..bh).flat_map(|y| (0..bw).map(move |x| (x, y))) {
                    if pyramid.owns(level, x, y) {
                        let across = ((x + 1) << level).min(w) - (x << level);
                        let down = ((y + 1) << level).min(h) - (y << level);
                        area += across * down;
                    }
                }
            }
            prop_assert_eq!(area, w * h);
        }

        #[test]
        fn balanced_neighbours_differ_by_one_level_at_most((w, h, requests) in maps()) {
            let pyramid = MinPyramid::new(w, &requests, 8, true);
            for y in 0..h {
                for x in 0..w {
                    let here = pyramid.owner_level(x, y);
                    for (nx, ny) in [(x + 1, y), (x, y + 1), (x + 1, y + 1), (x.wrapping_sub(1), y + 1)] {
                        if nx < w && ny < h {
                            prop_assert!(here.abs_diff(pyramid.owner_level(nx, ny)) <= 1);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn there_is_nothing_beyond_the_picture_and_the_coarsest_level() {
        let deep = MinPyramid::new(3, &[255; 6], u8::MAX, true);
        assert_eq!(deep.coarsest(), 15);
        let pyramid = MinPyramid::new(3, &[8; 6], 2, false);
        assert_eq!((pyramid.coarsest(), pyramid.owner_level(2, 1)), (2, 2));
        for level in [3, u8::MAX] {
            assert_eq!(
                (pyramid.size(level), pyramid.cells(level)),
                ((0, 0), &[][..])
            );
            assert!(!pyramid.owns(level, 0, 0));
        }
        for (x, y) in [(3, 0), (0, 2), (u32::MAX, u32::MAX)] {
            assert!(!pyramid.owns(0, x, y) && !pyramid.owns(2, x, y));
        }
        assert_eq!(pyramid.owner_level(u32::MAX, 9), 0);
        let none = MinPyramid::new(0, &[], 8, true);
        assert_eq!((none.size(8), none.owner_level(0, 0)), ((1, 0), 0));
    }

    #[test]
    fn a_picture_of_4096_x_4096_is_tiled_once() {
        for (patch, balance) in [(3, false), (6, true)] {
            let side = 4096;
            let requests = patches(side, side, patch, 77);
            let pyramid = MinPyramid::new(side, &requests, 8, balance);
            let area: u64 = (0..9).map(|l| pyramid.tiles()[l] << (2 * l)).sum();
            assert_eq!(area, u64::from(side).pow(2));
            for (index, &request) in (0..).zip(&requests).step_by(97) {
                let (x, y) = (index % side, index / side);
                let owners = (0..=8).filter(|&l| pyramid.owns(l, x >> l, y >> l)).count();
                assert_eq!(owners, 1, "{x}, {y}");
                assert!(pyramid.owner_level(x, y) <= request);
            }
        }
    }

    #[test]
    fn a_uniform_wish_is_met_even_at_odd_borders() {
        let pyramid = MinPyramid::new(513, &vec![8; 513 * 257], 8, false);
        assert_eq!(pyramid.tiles(), [0, 0, 0, 0, 0, 0, 0, 0, 6]);
    }
}
