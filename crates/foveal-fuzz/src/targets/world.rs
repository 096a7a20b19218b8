//! A host's world: objects and occluders that come, move and go have the answers of a plain list.

use std::sync::Arc;

use foveal_cull::{
    Aabb, Affine, CullError, Culler, FrameOptions, OccludeeId, OccludeeSet, OccluderId,
    OccluderMesh, OccluderSet, SingleThread, View, testing,
};
use glam::{DVec3, Vec3};

use super::scenes::{Random, assert_as_a_list, eye};
use crate::random::{Choices, random_bytes};

/// Makes up to some hundred random calls, and compares after each frame.
pub fn world(input: &[u8]) {
    let mut choices = Choices::new(input);
    let mut r = Random::new(choices.bits());
    let mut world = World::new();
    for _ in 0..20 + choices.below(60) {
        match choices.below(12) {
            0..3 => world.insert(&mut choices, &mut r),
            3..6 => world.move_some(&mut choices, &mut r),
            6 | 7 => world.remove_some(&mut choices),
            8 | 9 => world.change_occluders(&mut choices, &mut r),
            10 => world.rebuild(&mut choices),
            _ => world.frame(&mut choices, &mut r),
        }
    }
    world.frame(&mut choices, &mut r);
    world.gone_stays_gone();
}

struct World {
    objects: OccludeeSet,
    ids: Vec<OccludeeId>,
    gone: Vec<OccludeeId>,
    waiting: Option<foveal_cull::OccludeeSnapshot>,
    occluders: OccluderSet,
    placed: Vec<OccluderId>,
    displaced: Vec<OccluderId>,
    culler: Culler,
}

/// Corners of boxes that are no volumes, or hardly any.
const ODD: [f32; 8] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    3e38,
    -3e38,
    0.0,
    1e-45,
    1e20,
];

fn bounds(choices: &mut Choices<'_>, r: &mut Random) -> Aabb {
    let center = (r.vec(1.0) * DVec3::new(9.0, 5.0, 12.0)).as_vec3();
    let half = Vec3::splat(r.range(0.0, 1.5) as f32);
    let mut bounds = Aabb::new(center - half, center + half);
    if choices.one_in(40) {
        let corner = if choices.one_in(2) {
            &mut bounds.min
        } else {
            &mut bounds.max
        };
        corner[choices.below(3)] = choices.pick(&ODD);
    }
    bounds
}

impl World {
    fn new() -> Self {
        let Ok(culler) = Culler::new(64, 48) else {
            panic!("a culler of 64 x 48 pixels");
        };
        let mut objects = OccludeeSet::new(DVec3::ZERO);
        // Few objects would be a list otherwise.
        testing::prefer_tree(&mut objects);
        Self {
            objects,
            ids: Vec::new(),
            gone: Vec::new(),
            waiting: None,
            occluders: OccluderSet::new(),
            placed: Vec::new(),
            displaced: Vec::new(),
            culler,
        }
    }

    fn insert(&mut self, choices: &mut Choices<'_>, r: &mut Random) {
        let count = if choices.one_in(8) { 1100 } else { 20 };
        for _ in 0..choices.below(count) {
            self.ids.push(self.objects.insert(bounds(choices, r)));
        }
    }

    fn move_some(&mut self, choices: &mut Choices<'_>, r: &mut Random) {
        for _ in 0..choices.below(30).min(self.ids.len()) {
            let id = self.ids[choices.bits() as usize % self.ids.len()];
            let moved = self.objects.set_bounds(id, bounds(choices, r));
            assert_eq!(moved, Ok(()));
        }
        if choices.one_in(2) {
            self.objects.refit();
        }
    }

    fn remove_some(&mut self, choices: &mut Choices<'_>) {
        for _ in 0..choices.below(20).min(self.ids.len()) {
            let at = choices.bits() as usize % self.ids.len();
            let id = self.ids.swap_remove(at);
            assert_eq!(self.objects.remove(id), Ok(()));
            self.gone.push(id);
        }
        assert_eq!(self.objects.len(), self.ids.len());
    }

    fn rebuild(&mut self, choices: &mut Choices<'_>) {
        match choices.below(3) {
            0 => self.objects.rebuild(),
            1 => self.waiting = Some(self.objects.snapshot()),
            _ => {
                if let Some(snapshot) = self.waiting.take() {
                    self.objects.adopt(snapshot.build());
                }
            }
        }
    }

    fn change_occluders(&mut self, choices: &mut Choices<'_>, r: &mut Random) {
        let mut place = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].map(f64::from);
        if choices.one_in(3) {
            place = core::array::from_fn(|_| r.range(-1.5, 1.5));
        }
        let at = r.vec(1.0) * DVec3::new(6.0, 3.0, 8.0);
        let columns = glam::DMat3::from_cols_array(&place);
        let place: Affine = glam::DAffine3::from_mat3_translation(columns, at).into();
        if self.placed.len() < 12 && choices.one_in(2) {
            let half = [0, 1, 2].map(|_| r.range(0.0, 2.0) as f32);
            if let Ok(mesh) = OccluderMesh::from_box(Aabb::new(half.map(|v| -v), half))
                && let Ok(id) = self.occluders.add(Arc::new(mesh), place)
            {
                self.placed.push(id);
            }
            return;
        }
        if self.placed.is_empty() {
            return;
        }
        let at = choices.below(self.placed.len());
        let id = self.placed[at];
        let done = match choices.below(4) {
            0 => {
                self.displaced.push(self.placed.swap_remove(at));
                self.occluders.remove(id)
            }
            1 => self.occluders.set_enabled(id, choices.one_in(2)),
            _ => self.occluders.set_transform(id, place),
        };
        assert_eq!(done, Ok(()));
        assert_eq!(self.occluders.len(), self.placed.len());
    }

    fn frame(&mut self, choices: &mut Choices<'_>, r: &mut Random) {
        let mut view = View::mono(eye(r, DVec3::ZERO, choices.one_in(4)));
        if choices.one_in(4) {
            view = view.with_validity_radius(0.02);
        }
        let options = FrameOptions::default();
        let drawn = self
            .culler
            .rasterize(&view, &self.occluders, &options, &SingleThread);
        assert_eq!(drawn, Ok(()));
        assert_as_a_list(&self.culler, &self.objects, &self.ids);
    }

    fn gone_stays_gone(&mut self) {
        let unknown = Err(CullError::UnknownOccludee);
        for id in &self.gone {
            assert_eq!(self.objects.set_bounds(*id, Aabb::EMPTY), unknown);
        }
        for id in &self.displaced {
            assert!(!self.occluders.contains(*id));
        }
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    random_bytes(200)
}
