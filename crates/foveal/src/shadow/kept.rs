//! Tiles that are kept from frame to frame: where they lie, and whether what they hold is right.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use foveal_scene::Aabb;

use super::atlas::{Atlas, Tile};
use super::footprint::texel_at;
use super::mask::Mask;
use super::patch::Patch;
use super::plan::Wanted;
use super::volume::Volume;

/// A tile with its place in the atlas.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    pub(super) tile: Tile,
    pub(super) volume: Volume,
    /// Whether its texels are right for the current pose, but for the casters in `left_out`.
    pub(super) is_drawn: bool,
    /// Where `is_drawn` is false: the patch of wrong texels; `None` where all are wrong.
    pub(super) wrong: Option<Patch>,
    /// The volume that its texels were drawn for; `None` before they are.
    held: Option<Volume>,
    /// Casters that are not drawn, because their shadows fall on nothing seen so far: instances,
    /// ascending.
    pub(super) left_out: Vec<u32>,
    /// The receivers that it was drawn for, on which no caster in `left_out` casts a shadow.
    pub(super) received: Option<Box<Received>>,
    /// The frame in which it was looked at last, if its volume held no seen receiver then.
    pub(super) sees_nothing_in: Option<u64>,
    /// The last frame that wanted it.
    wanted_in: u64,
    /// The last frame after which it had to be drawn again.
    disturbed_in: Option<u64>,
    /// Whether it had to be drawn again after two frames in a row.
    pub(super) is_restless: bool,
    /// Whether it is restless and its light has moved since it was drawn.
    pub(super) light_moves: bool,
}

impl Kept {
    /// What it holds is wrong from the frame after this one on, all of it or in a patch.
    fn disturb(&mut self, frame: u64, patch: Option<Patch>) {
        self.is_drawn = false;
        self.wrong = patch;
        self.is_restless = self.disturbed_in.is_some_and(|before| before + 1 >= frame);
        self.light_moves = false;
        self.disturbed_in = Some(frame);
    }

    /// What it holds is wrong in a patch too, from the frame after this one on.
    fn disturb_patch(&mut self, frame: u64, patch: Patch) {
        let all = if self.is_drawn {
            Some(patch)
        } else {
            self.wrong.map(|wrong| wrong.union(patch))
        };
        let wrong = all.filter(|all| !all.is_most_of(self.tile.side()));
        if self.is_drawn {
            self.disturb(frame, wrong);
        } else {
            self.wrong = wrong;
        }
    }

    /// A patch around what the tile sees of boxes, or around most of the tile; `None` where it sees
    /// nothing of them.
    fn patch_around(&self, boxes: &[Aabb]) -> Option<Patch> {
        let side = self.tile.side();
        let met = boxes.iter().filter(|b| self.volume.meets(b, side as f32));
        let mut all: Option<Patch> = None;
        for patch in met.filter_map(|b| Patch::of_box(&self.volume, b, side)) {
            let both = all.map_or(patch, |all| all.union(patch));
            all = Some(both);
            if both.is_most_of(side) {
                break;
            }
        }
        all
    }
}

/// Receivers that a tile has been drawn for.
#[derive(Clone, Debug)]
pub(super) struct Received {
    pub(super) mask: Mask,
    /// The frames whose receivers are in the mask, first and last.
    pub(super) first: u64,
    pub(super) last: u64,
}

impl Received {
    /// A tile's of `side` texels, of which nothing has been seen.
    pub(super) fn new(side: f32, frame: u64) -> Self {
        Self {
            mask: Mask::new(side),
            first: frame,
            last: 0,
        }
    }
}

/// The tiles in the atlas.
#[derive(Debug)]
pub(super) struct KeptTiles {
    atlas_level: u32,
    atlas: Atlas,
    /// By slot and level.
    tiles: BTreeMap<(u32, u32), Kept>,
    frame: u64,
    /// Nothing has been drawn since all was forgotten.
    is_new: bool,
    /// By slot: tiles that a frame's budget has left for a later one, and that are not drawn yet.
    waits: BTreeMap<u32, Wait>,
}

/// Frames that had to wait for a slot's tile, of whatever size: the first without a break, and the
/// last.
#[derive(Clone, Copy, Debug)]
struct Wait {
    first: u64,
    last: u64,
}

/// How urgently a tile is to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Urgency {
    /// It may wait, and has for so many frames; more where nothing stands in for it.
    Waits(u64),
    /// What it holds is wrong everywhere.
    Now,
}

/// Frames that a tile which holds nothing is ahead of one that holds something.
const AHEAD: u64 = 8;

fn key(want: &Wanted) -> (u32, u32) {
    (want.slot, want.level)
}

impl KeptTiles {
    pub(super) fn new(atlas_level: u32) -> Self {
        Self {
            atlas_level,
            atlas: Atlas::new(atlas_level),
            tiles: BTreeMap::new(),
            frame: 0,
            is_new: true,
            waits: BTreeMap::new(),
        }
    }

    /// Nothing is known any more.
    pub(super) fn forget(&mut self) {
        *self = Self {
            frame: self.frame,
            ..Self::new(self.atlas_level)
        };
    }

    pub(super) fn get(&self, want: &Wanted) -> Option<&Kept> {
        self.tiles.get(&key(want))
    }

    pub(super) fn get_mut(&mut self, want: &Wanted) -> Option<&mut Kept> {
        self.tiles.get_mut(&key(want))
    }

    /// Metres that the widest texel of these slots' tiles spans; `None` without tiles.
    pub(super) fn widest_texel(&self, slots: std::ops::Range<u32>) -> Option<f32> {
        let tiles = self.tiles.range((slots.start, 0)..(slots.end, 0));
        let texel = |kept: &Kept| {
            let reach = match kept.volume {
                Volume::Pyramid { range, .. } => range,
                Volume::Column { .. } => 0.0,
            };
            texel_at(&kept.volume, kept.tile.side() as f32, reach)
        };
        tiles.map(|(_, kept)| texel(kept)).reduce(f32::max)
    }

    /// The tile has been drawn, without some casters. Whether a frame had to wait for it.
    pub(super) fn drawn(&mut self, want: &Wanted, left_out: Vec<u32>) -> bool {
        if let Some(kept) = self.tiles.get_mut(&key(want)) {
            kept.is_drawn = true;
            kept.wrong = None;
            kept.held = Some(kept.volume);
            kept.left_out = left_out;
        }
        self.waits.remove(&want.slot).is_some()
    }

    /// Whether all has been forgotten since this was asked last.
    pub(super) fn take_is_new(&mut self) -> bool {
        std::mem::take(&mut self.is_new)
    }

    /// A tile has to wait in this frame.
    pub(super) fn wait(&mut self, want: &Wanted) {
        let frame = self.frame;
        let first = frame - self.waited(want);
        (self.waits).insert(want.slot, Wait { first, last: frame });
        // What is looked into meanwhile keeps its place.
        if let Some((level, _)) = self.stand_in(want)
            && let Some(kept) = self.tiles.get_mut(&(want.slot, level))
        {
            kept.wanted_in = frame;
        }
    }

    /// Frames before this one that had to wait for a tile without a break.
    pub(super) fn waited(&self, want: &Wanted) -> u64 {
        let wait = self.waits.get(&want.slot);
        let wait = wait.filter(|wait| wait.last + 1 >= self.frame);
        wait.map_or(0, |wait| self.frame - wait.first)
    }

    /// How urgently a tile that is not drawn is to be drawn.
    pub(super) fn urgency(&self, want: &Wanted) -> Urgency {
        let waited = self.waited(want);
        if self.stand_in(want).is_some() {
            return Urgency::Waits(waited);
        }
        let mut sizes = self.sizes_of(want.slot);
        if sizes.any(|(_, kept)| kept.held.is_some()) {
            return Urgency::Now;
        }
        Urgency::Waits(waited + AHEAD)
    }

    /// Where shaders look for a wanted tile, and what is there: the tile, or in a frame in which it
    /// has to wait what it held before or what one of another size holds.
    pub(super) fn shown(&self, want: &Wanted) -> Option<(Tile, Volume)> {
        let kept = self.get(want)?;
        if kept.is_drawn {
            return Some((kept.tile, kept.volume));
        }
        let wait = self.waits.get(&want.slot);
        wait.filter(|wait| wait.last == self.frame)?;
        self.stand_in(want).map(|(_, shown)| shown)
    }

    /// A slot's tiles by their levels.
    fn sizes_of(&self, slot: u32) -> impl Iterator<Item = (u32, &Kept)> {
        let sizes = self.tiles.range((slot, 0)..(slot + 1, 0));
        sizes.map(|(&(_, level), kept)| (level, kept))
    }

    /// What can be looked into in place of a tile that is not drawn: one of the current shadows
    /// sooner than one of earlier ones, and of these the one of the nearest size.
    fn stand_in(&self, want: &Wanted) -> Option<(u32, (Tile, Volume))> {
        let usable = self.sizes_of(want.slot).filter_map(|(level, kept)| {
            let held = kept.held.filter(|held| want.volume.can_look_into(held))?;
            let is_old = !kept.is_drawn;
            Some((
                (is_old, level.abs_diff(want.level), level),
                (kept.tile, held),
            ))
        });
        let best = usable.min_by_key(|&(order, _)| order);
        best.map(|((_, _, level), shown)| (level, shown))
    }

    /// A frame needs what the one before needed.
    pub(super) fn rest(&mut self) {
        self.frame += 1;
    }

    /// Tiles that were drawn without some casters must be drawn again: nobody says any more what is
    /// seen.
    pub(super) fn draw_in_full(&mut self) {
        for kept in self.tiles.values_mut().filter(|k| !k.left_out.is_empty()) {
            kept.left_out.clear();
            kept.is_drawn = false;
            kept.wrong = None;
        }
    }

    /// Tiles that see any of these boxes must be drawn again where they see them, for what they
    /// were drawn for at least.
    pub(super) fn disturb(&mut self, boxes: &[Aabb]) {
        let tiles = self.tiles.values_mut();
        for kept in tiles.filter(|kept| kept.is_drawn || kept.wrong.is_some()) {
            if let Some(patch) = kept.patch_around(boxes) {
                kept.disturb_patch(self.frame, patch);
            }
        }
    }

    /// All of the tiles in which something is wrong is wrong, or of every tile.
    #[cfg(test)]
    pub(super) fn spoil(&mut self, every: bool) {
        for kept in self.tiles.values_mut() {
            kept.is_drawn &= !every;
            kept.wrong = None;
        }
    }

    /// Gives each wanted tile a place. A tile stays where it is while its size is right; tiles that
    /// no frame has wanted for the longest time make room; where squares are scattered so that one
    /// does not fit, smaller ones move out of its way. All find a place where they fit by their area.
    ///
    /// `keeps_sizes`: a tile of another size stays too until its place is needed, for a frame that
    /// wants that size again, or for one that looks into it while the tile of the right size waits.
    pub(super) fn place(&mut self, wanted: &[Wanted], keeps_sizes: bool) {
        self.frame += 1;
        // From the largest to the smallest: `None` for those that have to move.
        let mut missing = BTreeMap::new();
        let order = |(slot, level): (u32, u32)| (Reverse(level), slot);
        for want in wanted {
            if !keeps_sizes {
                self.give_other_sizes(want);
            }
            match self.tiles.get_mut(&key(want)) {
                Some(kept) => {
                    kept.wanted_in = self.frame;
                    if kept.volume != want.volume {
                        kept.volume = want.volume;
                        kept.received = None;
                        kept.sees_nothing_in = None;
                        kept.disturb(self.frame - 1, None);
                        kept.light_moves = kept.is_restless;
                    }
                }
                None => _ = missing.insert(order(key(want)), *want),
            }
        }
        while let Some((_, want)) = missing.pop_first() {
            if !self.fit(&want) {
                let moved = self.take_out_smaller(want.level);
                self.fit(&want);
                let moved = wanted.iter().filter(|want| moved.contains(&key(want)));
                missing.extend(moved.map(|want| (order(key(want)), *want)));
            }
        }
    }

    /// Takes the tiles out of a square of `2^level` texels a side that holds smaller ones alone: of
    /// these squares the one with the fewest. There is one where all wanted tiles fit by their area,
    /// since tiles as large as the square or larger fill whole ones.
    fn take_out_smaller(&mut self, level: u32) -> Vec<(u32, u32)> {
        let mut squares: BTreeMap<(u32, u32), Vec<(u32, u32)>> = BTreeMap::new();
        for (&key, kept) in self.tiles.iter().filter(|(_, k)| k.tile.level < level) {
            let corner = (kept.tile.y >> level, kept.tile.x >> level);
            squares.entry(corner).or_default().push(key);
        }
        let fewest = squares.into_values().min_by_key(Vec::len);
        let keys = fewest.unwrap_or_default();
        for kept in keys.iter().filter_map(|key| self.tiles.remove(key)) {
            self.atlas.give(kept.tile);
        }
        keys
    }

    fn give_other_sizes(&mut self, want: &Wanted) {
        let slot = (want.slot, 0)..(want.slot + 1, 0);
        let others = self.tiles.range(slot).map(|(&key, _)| key);
        let others: Vec<_> = others.filter(|&other| other != key(want)).collect();
        for other in others {
            if let Some(kept) = self.tiles.remove(&other) {
                self.atlas.give(kept.tile);
            }
        }
    }

    /// Finds room for one tile, where tiles that this frame does not want may give way.
    fn fit(&mut self, want: &Wanted) -> bool {
        loop {
            if let Some(tile) = self.atlas.take(want.level) {
                self.insert(want, tile);
                return true;
            }
            let unwanted = self.tiles.iter().filter(|(_, k)| k.wanted_in < self.frame);
            let oldest = unwanted
                .min_by_key(|(_, k)| k.wanted_in)
                .map(|(&key, _)| key);
            let Some(kept) = oldest.and_then(|key| self.tiles.remove(&key)) else {
                return false;
            };
            self.atlas.give(kept.tile);
        }
    }

    fn insert(&mut self, want: &Wanted, tile: Tile) {
        let kept = Kept {
            tile,
            volume: want.volume,
            is_drawn: false,
            wrong: None,
            held: None,
            left_out: Vec::new(),
            received: None,
            sees_nothing_in: None,
            wanted_in: self.frame,
            disturbed_in: None,
            is_restless: false,
            light_moves: false,
        };
        self.tiles.insert(key(want), kept);
    }
}

#[cfg(test)]
mod tests;
