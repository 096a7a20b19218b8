//! What has been placed, and which of it stays when the number of instances is limited.

use std::cmp::Reverse;

use glam::{Mat4, Vec3};

use super::kit::Thing;
use crate::lights::point;
use foveal_scene::Light;

/// How early something is left out when there are too many instances: later variants first,
/// within a variant by chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// Stays always.
    Needed,
    /// Windows, chimneys: the houses look plain without.
    Detail(u32),
    /// Stalls.
    Stall(u32),
    /// What stands on stalls or beside them, lanterns without light.
    Goods(u32),
}

/// One placed thing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item<'a> {
    pub(super) thing: &'a Thing,
    pub(super) place: Mat4,
    pub(super) rank: Rank,
}

/// How a lantern shines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shine {
    pub(super) color: [f32; 3],
    pub(super) intensity: f32,
    pub(super) range_m: f32,
}

/// A lantern that may get one of the lights.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    /// Its item, and the item that carries it.
    items: [usize; 2],
    position: Vec3,
    shine: Shine,
    /// Those with the smallest order are lit.
    order: f32,
}

/// Collects what is placed.
#[derive(Debug, Default)]
pub(super) struct Market<'a> {
    items: Vec<Item<'a>>,
    lamps: Vec<Lamp>,
}

impl<'a> Market<'a> {
    /// Places a thing and returns its number.
    pub(super) fn put(&mut self, thing: &'a Thing, place: Mat4, rank: Rank) -> usize {
        self.items.push(Item { thing, place, rank });
        self.items.len() - 1
    }

    /// Places a lantern whose flame is `flame` in its own space. `carrier` must not be left out
    /// while the lantern shines; `order` says how important its light is (small = important).
    pub(super) fn put_lamp(
        &mut self,
        (thing, flame): (&'a Thing, Vec3),
        place: Mat4,
        rank: Rank,
        carrier: Option<usize>,
        shine: Shine,
        order: f32,
    ) {
        let item = self.put(thing, place, rank);
        self.lamps.push(Lamp {
            items: [item, carrier.unwrap_or(item)],
            position: place.transform_point3(flame),
            shine,
            order,
        });
    }

    /// Number of lanterns so far.
    pub(super) const fn lamp_count(&self) -> usize {
        self.lamps.len()
    }

    /// Number of instances if nothing is left out.
    pub(super) fn instance_count(&self) -> usize {
        self.items.iter().map(|i| i.thing.parts.len()).sum()
    }

    /// The `count` most important lights; their lanterns will stay.
    pub(super) fn light(&mut self, count: usize) -> Vec<Light> {
        // Equal orders keep the order of placing.
        self.lamps.sort_by(|a, b| a.order.total_cmp(&b.order));
        self.lamps
            .iter()
            .take(count)
            .map(|lamp| {
                for item in lamp.items {
                    self.items[item].rank = Rank::Needed;
                }
                let Shine {
                    color,
                    intensity,
                    range_m,
                } = lamp.shine;
                point(lamp.position, color.into(), intensity, range_m)
            })
            .collect()
    }

    /// What stays within `limit` instances, in the order of placing.
    pub(super) fn keep(self, limit: usize) -> Vec<Item<'a>> {
        let mut items = self.items;
        let mut excess = items
            .iter()
            .map(|i| i.thing.parts.len())
            .sum::<usize>()
            .saturating_sub(limit);
        let mut order: Vec<usize> = (0..items.len()).collect();
        order.sort_by_key(|&i| (Reverse(items[i].rank), i));
        let mut stays = vec![true; items.len()];
        for i in order {
            if excess == 0 || items[i].rank == Rank::Needed {
                break;
            }
            excess = excess.saturating_sub(items[i].thing.parts.len());
            stays[i] = false;
        }
        let mut stays = stays.into_iter();
        items.retain(|_| stays.next().unwrap_or(true));
        items
    }
}
