//! Patches of a tile: what is drawn again where something has moved in it.

use foveal_scene::Aabb;
use glam::Vec2;

use super::footprint::Footprint;
use super::volume::Volume;

/// Texels around a footprint that rounding may reach.
const MARGIN: f32 = 1.0;

/// A rectangle of a tile's texels, from the tile's upper left corner, rows downwards; the greater
/// ends are not in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Patch {
    pub(super) low: [u32; 2],
    pub(super) high: [u32; 2],
}

impl Patch {
    /// All of a tile.
    pub(super) fn whole(side: u32) -> Self {
        Self {
            low: [0; 2],
            high: [side; 2],
        }
    }

    /// The texels of a tile of `side` texels that what lies in a footprint may cover; `None` where
    /// there are none.
    fn of(footprint: Footprint, side: u32) -> Option<Self> {
        let around = footprint.grown(MARGIN);
        let down = |at: Vec2| Vec2::new(at.x, side as f32 - at.y);
        let (a, b) = (down(around.low), down(around.high));
        let texel = |at: Vec2| at.clamp(Vec2::ZERO, Vec2::splat(side as f32)).as_uvec2();
        let (low, high) = (texel(a.min(b).floor()), texel(a.max(b).ceil()));
        low.cmplt(high).all().then(|| Self {
            low: low.to_array(),
            high: high.to_array(),
        })
    }

    /// The texels of a tile of `side` texels that what lies in a box may cover; `None` where there
    /// are none.
    pub(super) fn of_box(volume: &Volume, b: &Aabb, side: u32) -> Option<Self> {
        Self::of(Footprint::new(volume, b, side as f32)?, side)
    }

    pub(super) fn union(self, other: Self) -> Self {
        let each =
            |of: fn(u32, u32) -> u32, a: [u32; 2], b: [u32; 2]| [of(a[0], b[0]), of(a[1], b[1])];
        Self {
            low: each(u32::min, self.low, other.low),
            high: each(u32::max, self.high, other.high),
        }
    }

    pub(super) fn meets(self, other: Self) -> bool {
        (0..2).all(|i| self.low[i] < other.high[i] && other.low[i] < self.high[i])
    }

    /// Whether little is left of a tile of `side` texels beside it.
    pub(super) fn is_most_of(self, side: u32) -> bool {
        let [width, height] = [0, 1].map(|i| u64::from(self.high[i] - self.low[i]));
        4 * width * height >= 3 * u64::from(side).pow(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footprint(low: [f32; 2], high: [f32; 2]) -> Footprint {
        Footprint {
            low: low.into(),
            high: high.into(),
            nearest: 1.0,
            farthest: 2.0,
        }
    }

    fn patch(low: [u32; 2], high: [u32; 2]) -> Patch {
        Patch { low, high }
    }

    #[test]
    fn a_patch_holds_a_texel_more_on_each_side_and_ends_with_the_tile() {
        let of = |low, high| Patch::of(footprint(low, high), 64);
        assert_eq!(
            of([10.5, 20.0], [12.5, 30.0]),
            Some(patch([9, 33], [14, 45]))
        );
        assert_eq!(of([-50.0, 60.5], [0.5, 99.0]), Some(patch([0, 0], [2, 5])));
        assert_eq!(of([-1e30; 2], [f32::INFINITY; 2]), Some(Patch::whole(64)));
        assert_eq!(of([-9.0, 0.0], [-1.0, 64.0]), None, "beside the tile");
        assert_eq!(of([65.5, 0.0], [70.0, 64.0]), None);
    }

    #[test]
    fn patches_meet_where_they_share_a_texel() {
        let a = patch([4, 4], [8, 8]);
        assert!(a.meets(patch([7, 0], [9, 5])));
        assert!(!a.meets(patch([8, 4], [9, 8])));
        assert_eq!(a.union(patch([8, 2], [9, 5])), patch([4, 2], [9, 8]));
        assert!(!a.is_most_of(16) && a.is_most_of(4));
        assert!(Patch::whole(16).is_most_of(16));
    }
}
