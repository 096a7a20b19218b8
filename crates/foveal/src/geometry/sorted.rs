//! The instances that a frame draws, in their order: solid ones front to back, so that what is
//! hidden is not shaded, blended ones back to front.

use foveal_scene::{Aabb, AlphaMode, Camera, Projection};
use glam::Vec3;

use super::{Faces, PipelineKey, Shape};
use crate::scene::{DrawnInstance, LobeClass, SceneOnGpu};

/// One instance in a draw. Ordered so that those of one draw follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Item {
    pub(super) key: PipelineKey,
    pub(super) material: u32,
    pub(super) mesh: u32,
    pub(super) instance: u32,
}

/// The visible instances in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorted {
    pub(super) solid: Vec<(Nearness, Item)>,
    pub(super) strokes: Vec<Item>,
    pub(super) blended: Vec<Blended>,
}

/// A blended instance's surface, or its points and lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blended {
    farness: f32,
    pub(super) instance: u32,
    pub(super) shape: Shape,
}

impl Sorted {
    /// Finds them anew.
    pub(super) fn find(
        &mut self,
        scene: &SceneOnGpu,
        camera: &Camera,
        is_visible: impl Fn(u32) -> bool,
    ) {
        self.solid.clear();
        self.strokes.clear();
        self.blended.clear();
        let all = (0..).zip(&scene.instances);
        for (number, instance) in all.filter(|(_, instance)| instance.visible) {
            let mesh = scene.geometry.mesh(instance.mesh);
            // They reach beyond their boxes by half their width, so culling does not judge them.
            if mesh.stroke_index_count > 0 {
                let key = key_of_strokes(instance, mesh.lights_strokes);
                self.add(number, instance, key, camera);
            }
            if mesh.index_count > 0 && is_visible(instance.object) {
                self.add(number, instance, key_of_triangles(instance), camera);
            }
        }
        self.solid.sort_unstable();
        self.strokes.sort_unstable();
        (self.blended).sort_unstable_by(|a, b| {
            let by_farness = b.farness.total_cmp(&a.farness);
            by_farness.then((a.instance, a.shape).cmp(&(b.instance, b.shape)))
        });
    }

    fn add(&mut self, number: u32, instance: &DrawnInstance, key: PipelineKey, camera: &Camera) {
        let item = Item {
            key,
            material: instance.material,
            mesh: instance.mesh,
            instance: number,
        };
        match (instance.alpha_mode, key.shape) {
            (AlphaMode::Blend, shape) => self.blended.push(Blended {
                farness: farness(&instance.bounds, camera),
                instance: number,
                shape,
            }),
            (_, Shape::Triangles) => {
                let nearness = Nearness::of(&instance.bounds, camera.eye());
                self.solid.push((nearness, item));
            }
            (_, Shape::LitStrokes | Shape::UnlitStrokes) => self.strokes.push(item),
        }
    }
}

/// The pipeline's key for an instance's triangles in the G-buffer.
pub(super) fn key_of_triangles(instance: &DrawnInstance) -> PipelineKey {
    PipelineKey {
        class: instance.material_class,
        masked: matches!(instance.alpha_mode, AlphaMode::Mask { .. }),
        mirrored: instance.mirrored,
        faces: if instance.double_sided {
            Faces::Both
        } else {
            Faces::Front
        },
        lobes: LobeClass::default(),
        shape: Shape::Triangles,
    }
}

/// The pipeline's key for an instance's points and lines. They have no lobes, which need a
/// surface's tangents.
pub(super) fn key_of_strokes(instance: &DrawnInstance, lit: bool) -> PipelineKey {
    PipelineKey {
        class: instance.material_class,
        masked: matches!(instance.alpha_mode, AlphaMode::Mask { .. }),
        mirrored: false,
        faces: Faces::Both,
        lobes: LobeClass::default(),
        shape: if lit {
            Shape::LitStrokes
        } else {
            Shape::UnlitStrokes
        },
    }
}

/// How far from the eye an instance's box ends, in steps of a factor of 2. What is drawn from small
/// to large hides what is behind before that is shaded: what ends near is near, whereas what begins
/// near may be the ground. By an instance alone, so that what else is drawn does not change the
/// order of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Nearness(u32);

impl Nearness {
    fn of(bounds: &Aabb, eye: Vec3) -> Self {
        let farthest = (eye - bounds.min).abs().max((eye - bounds.max).abs());
        // The exponent of a square, which is not negative: two of its steps are a factor of 2.
        Self(farthest.length_squared().to_bits() >> 24)
    }
}

/// What blended things are sorted by, from large to small: the depth of a box's centre in a
/// parallel projection, its squared distance from the eye in a perspective.
fn farness(bounds: &Aabb, camera: &Camera) -> f32 {
    let away = bounds.center() - camera.eye();
    match camera.projection {
        Projection::Perspective { .. } => away.length_squared(),
        Projection::Orthographic { .. } => -away.dot(camera.world_from_view.z_axis.truncate()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_near_is_nearer_than_the_ground_below_the_eye() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        let around = |half: Vec3, away: Vec3| Aabb {
            min: eye + away - half,
            max: eye + away + half,
        };
        let nearness = |half, away| Nearness::of(&around(half, away), eye);
        let small = nearness(Vec3::splat(0.5), Vec3::X * 2.0);
        let ground = nearness(Vec3::new(50.0, 0.1, 50.0), -2.0 * Vec3::Y);
        assert!(small < ground);
        // Within a factor of 2 state changes decide.
        let farther = |by: f32| nearness(Vec3::ZERO, Vec3::Z * by);
        assert_eq!(farther(2.9), farther(5.5));
        assert!(farther(2.7) < farther(2.9) && farther(5.5) < farther(5.8));
    }
}
