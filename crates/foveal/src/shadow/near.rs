//! What a frame sees near a light, and what may cast shadows there.

use foveal_scene::{Aabb, AlphaMode};
use glam::Vec3;

use super::kept::Kept;
use super::plan::Wanted;
use super::receivers::{NearCells, Reach, SeenCells};
use crate::scene::{DrawnInstance, SceneOnGpu};

/// What a frame sees.
#[derive(Clone, Copy, Debug)]
pub(super) enum Seen<'a> {
    Instances(&'a [u32]),
    Cells(SeenCells<'a>),
}

/// What a frame sees within a light's reach.
pub(super) enum Near<'a> {
    Instances(Vec<&'a Aabb>),
    Cells(NearCells<'a>),
}

impl<'a> Seen<'a> {
    fn near(self, scene: &'a SceneOnGpu, reach: Reach) -> Near<'a> {
        match self {
            Self::Instances(instances) => {
                let boxes = instances.iter();
                let boxes = boxes.map(|&i| &scene.instances[i as usize].bounds);
                Near::Instances(boxes.filter(|b| reach.meets(b)).collect())
            }
            Self::Cells(cells) => Near::Cells(cells.near(reach)),
        }
    }
}

/// A light of which tiles are missing.
pub(super) struct NearLight<'a> {
    reach: Reach,
    pub(super) near: Near<'a>,
    /// Instances within its reach, once they are asked for.
    casters: Option<Vec<u32>>,
}

impl<'a> NearLight<'a> {
    /// The light of these tiles.
    pub(super) fn new(scene: &'a SceneOnGpu, receivers: Seen<'a>, wanted: &[Wanted]) -> Self {
        let reach = Reach::of(wanted);
        Self {
            reach,
            near: receivers.near(scene, reach),
            casters: None,
        }
    }

    /// All casters within its reach: instances, ascending.
    pub(super) fn casters(&mut self, scene: &SceneOnGpu) -> &[u32] {
        let reach = self.reach;
        self.casters.get_or_insert_with(|| {
            (0..)
                .zip(&scene.instances)
                .filter(|(_, i)| casts(scene, i, reach.sphere) && reach.meets(&i.bounds))
                .map(|(number, _)| number)
                .collect()
        })
    }
}

impl Near<'_> {
    /// Whether a tile sees any of it.
    pub(super) fn meets(&self, kept: &mut Kept) -> bool {
        match self {
            Self::Instances(boxes) => {
                let side = kept.tile.side() as f32;
                boxes.iter().any(|b| kept.volume.meets(b, side))
            }
            Self::Cells(cells) => cells.meet(kept),
        }
    }
}

/// A light's own lamp is no larger than this part of its range.
const LARGEST_LAMP: f32 = 0.5;

/// Whether an instance keeps a light, given by its place and range, from what is beyond. What
/// glows, is small, and holds the light within its box is the light's own lamp.
fn casts(scene: &SceneOnGpu, instance: &DrawnInstance, light: Option<(Vec3, f32)>) -> bool {
    let b = &instance.bounds;
    let has_triangles = scene.geometry.mesh(instance.mesh).index_count > 0;
    let is_own_lamp = instance.glows
        && light.is_some_and(|(at, range)| {
            at.cmpge(b.min).all()
                && at.cmple(b.max).all()
                && b.size().length() <= LARGEST_LAMP * range
        });
    let is_shown = has_triangles && instance.visible;
    is_shown && instance.alpha_mode != AlphaMode::Blend && b.is_valid() && !is_own_lamp
}
