//! What the camera sees in a frame, and since when it has seen it without a break.

use std::borrow::Cow;
use std::cell::OnceCell;

use foveal_scene::Aabb;
use glam::Vec3;

use super::kept::{Kept, Received};
use super::plan::Wanted;
use super::volume::Volume;

/// What a frame's shadows may fall on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Receivers<'a> {
    /// Instances, by number: shadows are drawn with all casters.
    Instances(Cow<'a, [u32]>),
    /// Cells of the scene ([`crate::culling::CullingScene`]), by number, ascending: casters whose
    /// shadows fall on none of them are left out.
    Cells(Cow<'a, [u32]>),
}

impl Receivers<'_> {
    /// The same, to be kept beyond the frame.
    pub(super) fn into_owned(self) -> Receivers<'static> {
        match self {
            Self::Instances(numbers) => Receivers::Instances(numbers.into_owned().into()),
            Self::Cells(numbers) => Receivers::Cells(numbers.into_owned().into()),
        }
    }
}

/// Since which frame each cell has been seen, without a break and at the same place.
#[derive(Debug, Default)]
pub(super) struct SeenSince {
    cells: Vec<Since>,
}

#[derive(Clone, Copy, Debug)]
struct Since {
    first: u64,
    last: u64,
    at: Aabb,
}

impl SeenSince {
    /// These cells are seen in a frame; frames count from 1 without gaps.
    pub(super) fn see(&mut self, frame: u64, seen: &[u32], boxes: &[Aabb]) {
        const NEVER: Since = Since {
            first: 0,
            last: 0,
            at: Aabb::EMPTY,
        };
        self.cells.resize(boxes.len(), NEVER);
        for &cell in seen {
            let (since, at) = (&mut self.cells[cell as usize], boxes[cell as usize]);
            if since.last + 1 != frame || since.at != at {
                since.first = frame;
            }
            *since = Since {
                last: frame,
                at,
                ..*since
            };
        }
    }

    /// Whether a cell that is seen now was seen in that earlier frame, at the same place.
    pub(super) fn was_seen(&self, cell: u32, frame: u64) -> bool {
        self.cells[cell as usize].first <= frame
    }
}

/// Where a light of several tiles reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Place and range; `None` for a directional light.
    pub(super) sphere: Option<(Vec3, f32)>,
}

impl Reach {
    /// Of the light of these tiles.
    pub(super) fn of(wanted: &[Wanted]) -> Self {
        let sphere = match wanted.first().map(|w| w.volume) {
            Some(Volume::Pyramid { apex, range, .. }) => Some((apex, range)),
            _ => None,
        };
        Self { sphere }
    }

    pub(super) fn meets(&self, b: &Aabb) -> bool {
        self.sphere.is_none_or(|(apex, range)| {
            apex.clamp(b.min, b.max).distance_squared(apex) <= range * range
        })
    }
}

/// The cells that a frame sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenCells<'a> {
    /// Of all cells.
    pub(super) boxes: &'a [Aabb],
    pub(super) since: &'a SeenSince,
    pub(super) frame: u64,
    /// Those that are seen.
    pub(super) all: &'a [u32],
    /// Those of them that the frame before did not see: most tiles were looked at then.
    pub(super) new: &'a [u32],
    /// Texels by which places are moved before they are looked up, and that are read beside them.
    pub(super) reach: (f32, f32),
}

impl<'a> SeenCells<'a> {
    /// Those within a light's reach, which are looked for when they are asked for.
    pub(super) fn near(self, reach: Reach) -> NearCells<'a> {
        NearCells {
            seen: self,
            reach,
            all: OnceCell::new(),
            new: OnceCell::new(),
        }
    }
}

/// The cells that a frame sees within a light's reach.
#[derive(Debug)]
pub(super) struct NearCells<'a> {
    seen: SeenCells<'a>,
    reach: Reach,
    all: OnceCell<Vec<u32>>,
    new: OnceCell<Vec<u32>>,
}

impl NearCells<'_> {
    fn within(&self, cells: &[u32]) -> Vec<u32> {
        let is_near = |cell: &&u32| self.reach.meets(&self.seen.boxes[**cell as usize]);
        cells.iter().filter(is_near).copied().collect()
    }

    fn all(&self) -> &[u32] {
        self.all.get_or_init(|| self.within(self.seen.all))
    }

    fn come_into_sight(&self) -> &[u32] {
        self.new.get_or_init(|| self.within(self.seen.new))
    }

    /// Whether a tile sees any of them. One that saw none in the frame before sees none but those
    /// that have come into sight.
    pub(super) fn meet(&self, kept: &mut Kept) -> bool {
        let frame = self.seen.frame;
        let saw_nothing = kept.sees_nothing_in.is_some_and(|last| last + 1 == frame);
        let cells = if saw_nothing {
            self.come_into_sight()
        } else {
            self.all()
        };
        let side = kept.tile.side() as f32;
        let mut boxes = cells.iter().map(|&c| &self.seen.boxes[c as usize]);
        let sees_any = boxes.any(|b| kept.volume.meets(b, side));
        kept.sees_nothing_in = (!sees_any).then_some(frame);
        sees_any
    }

    /// Adds what has come into sight since a tile of `side` texels was looked at last; whether its
    /// mask is larger for it.
    pub(super) fn add_to(&self, received: &mut Received, volume: &Volume, side: f32) -> bool {
        let SeenCells {
            boxes,
            since,
            frame,
            reach,
            ..
        } = self.seen;
        let before = std::mem::replace(&mut received.last, frame);
        let cells = if before + 1 == frame {
            self.come_into_sight()
        } else {
            self.all()
        };
        let mut grows = false;
        for &cell in cells.iter().filter(|&&cell| !since.was_seen(cell, before)) {
            let b = &boxes[cell as usize];
            grows |= volume.meets(b, side) && received.mask.receive(volume, b, reach);
        }
        grows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_that_was_away_or_has_moved_is_new() {
        let at = |x: f32| Aabb::new(Vec3::splat(x), Vec3::splat(x + 1.0));
        let mut seen = SeenSince::default();
        seen.see(1, &[0, 1], &[at(0.0), at(1.0), at(2.0)]);
        seen.see(2, &[0, 2], &[at(0.0), at(1.0), at(2.0)]);
        seen.see(3, &[0, 1, 2], &[at(0.5), at(1.0), at(2.0)]);
        assert!(!seen.was_seen(0, 2), "it has moved");
        assert!(!seen.was_seen(1, 1), "it was away");
        assert!(seen.was_seen(2, 2) && !seen.was_seen(2, 1));
    }
}
