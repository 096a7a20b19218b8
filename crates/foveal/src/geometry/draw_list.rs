//! Which draws a frame issues, and in which order.

use std::collections::BTreeMap;

use foveal_scene::{AlphaMode, Camera};

use super::sorted::{Blended, Item, Nearness, Sorted, key_of_strokes, key_of_triangles};
use super::{Faces, PipelineKey, Shape};
use crate::scene::{DrawnInstance, LobeClass, SceneOnGpu};
use crate::stereo::Drawn;

/// One draw: equal meshes with equal materials, `count` instances from `first` in
/// [`DrawList::drawn`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Batch {
    pub(crate) key: PipelineKey,
    pub(crate) material: u32,
    pub(crate) mesh: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// The draws of one frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawList {
    /// Instance numbers in draw order.
    pub(crate) drawn: Vec<u32>,
    /// Opaque and masked surfaces: front to back by [`Nearness`], within it with the fewest state
    /// changes.
    pub(crate) solid: Vec<Batch>,
    /// Those of `solid` that have lobes, which are shaded in a pass over what the G-buffer shows.
    pub(crate) lobed: Vec<Batch>,
    /// Opaque and masked points and lines, which are not in the G-buffer.
    pub(crate) strokes: Vec<Batch>,
    /// Surfaces that light passes, which are not in the G-buffer.
    pub(crate) transmissive: Vec<Batch>,
    /// Blended surfaces, points and lines, back to front.
    pub(crate) blended: Vec<Batch>,
    /// Triangles of all draws.
    pub(crate) triangles: u64,
    /// What the draws are made of, kept for its room.
    sorted: Sorted,
}

/// A scene and what a frame draws of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draws<'a> {
    pub(crate) scene: &'a SceneOnGpu,
    pub(crate) list: &'a DrawList,
}

/// Makes draws of instances that come one after the other.
struct Batcher<'a> {
    scene: &'a SceneOnGpu,
    /// Equal ones become instances of one draw.
    merge: bool,
    /// Of the list.
    drawn: &'a mut Vec<u32>,
    triangles: &'a mut u64,
}

impl Batcher<'_> {
    /// Appends an instance: to the last draw where that is alike.
    fn push(&mut self, list: &mut Vec<Batch>, item: Item) {
        let Item {
            key,
            material,
            mesh,
            instance,
        } = item;
        if key.shape == Shape::Triangles {
            *self.triangles += u64::from(self.scene.geometry.mesh(mesh).index_count / 3);
        }
        let at = self.drawn.len() as u32;
        self.drawn.push(instance);
        if let Some(last) = list.last_mut()
            && self.merge
            && last.first + last.count == at
            && (last.key, last.material, last.mesh) == (key, material, mesh)
        {
            last.count += 1;
            return;
        }
        list.push(Batch {
            key,
            material,
            mesh,
            first: at,
            count: 1,
        });
    }

    fn lobes(&self, item: &Item) -> Option<LobeClass> {
        self.scene.materials.lobes(item.material)
    }

    /// What the G-buffer shows.
    fn solid(&mut self, list: &mut Vec<Batch>, solid: &[(Nearness, Item)]) {
        for (_, item) in solid {
            if !self.lobes(item).is_some_and(LobeClass::transmits) {
                self.push(list, *item);
            }
        }
    }

    /// Those with lobes by which light passes, or does not.
    fn lobed(&mut self, list: &mut Vec<Batch>, solid: &[(Nearness, Item)], transmits: bool) {
        for &(_, item) in solid {
            if let Some(lobes) = self.lobes(&item)
                && lobes.transmits() == transmits
            {
                let key = PipelineKey { lobes, ..item.key };
                self.push(list, Item { key, ..item });
            }
        }
    }

    fn blended(&mut self, list: &mut Vec<Batch>, blended: &[Blended]) {
        for one in blended {
            let instance = &self.scene.instances[one.instance as usize];
            let of_key = |key| Item {
                key,
                material: instance.material,
                mesh: instance.mesh,
                instance: one.instance,
            };
            if one.shape != Shape::Triangles {
                let is_lit = one.shape == Shape::LitStrokes;
                self.push(list, of_key(key_of_strokes(instance, is_lit)));
                continue;
            }
            // The far side of a two-sided thing lies behind its near side.
            let sides: &[Faces] = if instance.double_sided {
                &[Faces::Back, Faces::Front]
            } else {
                &[Faces::Front]
            };
            // What is behind shows by alpha.
            let lobes = (self.scene.materials.lobes(instance.material))
                .map_or_else(LobeClass::default, LobeClass::without_transmission);
            for &faces in sides {
                self.push(
                    list,
                    of_key(PipelineKey {
                        faces,
                        lobes,
                        ..key_of_triangles(instance)
                    }),
                );
            }
        }
    }
}

impl DrawList {
    /// Lists the draws of the instances of `scene` whose object `is_visible`, seen by `camera`;
    /// where they `merge`, equal ones become instances of one draw.
    pub(crate) fn build(
        &mut self,
        scene: &SceneOnGpu,
        camera: &Camera,
        merge: bool,
        is_visible: impl Fn(u32) -> bool,
    ) {
        self.clear();
        let (sorted, triangles) = (&mut self.sorted, &mut self.triangles);
        sorted.find(scene, camera, is_visible);
        let mut batcher = Batcher {
            scene,
            merge,
            drawn: &mut self.drawn,
            triangles,
        };
        // One list after the other: a draw's instances follow each other in `drawn`.
        batcher.solid(&mut self.solid, &sorted.solid);
        batcher.lobed(&mut self.lobed, &sorted.solid, false);
        batcher.lobed(&mut self.transmissive, &sorted.solid, true);
        for item in &sorted.strokes {
            batcher.push(&mut self.strokes, *item);
        }
        batcher.blended(&mut self.blended, &sorted.blended);
    }

    fn clear(&mut self) {
        self.drawn.clear();
        for list in [
            &mut self.solid,
            &mut self.lobed,
            &mut self.strokes,
            &mut self.transmissive,
            &mut self.blended,
        ] {
            list.clear();
        }
        self.triangles = 0;
    }

    /// Whether anything is drawn forward.
    pub(crate) fn has_forward(&self) -> bool {
        !(self.strokes.is_empty() && self.lobed.is_empty() && self.blended.is_empty())
    }

    /// Lists the draws of instances of which only the depth matters; `key` is the pipeline's for a
    /// material's class, and whether alpha cuts holes.
    pub(crate) fn of_casters(
        scene: &SceneOnGpu,
        instances: impl Iterator<Item = u32>,
        key: impl Fn(u32, bool) -> PipelineKey,
    ) -> Self {
        let has_triangles = |instance: &DrawnInstance| {
            let mesh = scene.geometry.mesh(instance.mesh);
            mesh.index_count > 0
        };
        let mut casters: Vec<Item> = instances
            .map(|number| (number, &scene.instances[number as usize]))
            .filter(|(_, instance)| has_triangles(instance))
            .map(|(number, instance)| {
                let masked = matches!(instance.alpha_mode, AlphaMode::Mask { .. });
                Item {
                    key: key(instance.material_class, masked),
                    // What has no holes is drawn alike whatever its material.
                    material: if masked { instance.material } else { 0 },
                    mesh: instance.mesh,
                    instance: number,
                }
            })
            .collect();
        casters.sort_unstable();
        let mut list = Self::default();
        let mut batcher = Batcher {
            scene,
            merge: true,
            drawn: &mut list.drawn,
            triangles: &mut list.triangles,
        };
        for item in casters {
            batcher.push(&mut list.solid, item);
        }
        list
    }

    /// Issues `batches` into a pass that has bind group 0 and the geometry bound, `drawn` for one
    /// eye or both.
    pub(crate) fn issue(
        batches: &[Batch],
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneOnGpu,
        pipelines: &super::Pipelines,
        drawn: Drawn,
    ) {
        Self::issue_with(batches, pass, scene, |key| pipelines.get(key), false, drawn);
    }

    /// As [`DrawList::issue`], with the pipeline that each key gets; `pulled`: the shader fetches
    /// the vertices, by provoking indices.
    pub(crate) fn issue_with<'p>(
        batches: &[Batch],
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneOnGpu,
        pipeline: impl Fn(PipelineKey) -> &'p wgpu::RenderPipeline,
        pulled: bool,
        drawn: Drawn,
    ) {
        let (mut key, mut material) = (None, None);
        for batch in batches {
            if key != Some(batch.key) {
                key = Some(batch.key);
                pass.set_pipeline(pipeline(batch.key));
            }
            if material != Some(batch.material) {
                material = Some(batch.material);
                let materials = &scene.materials;
                let group = if batch.key.lobes == LobeClass::default() {
                    materials.group(batch.material)
                } else {
                    materials.group_with_lobes(batch.material)
                };
                pass.set_bind_group(1, group, &[]);
            }
            let mesh = scene.geometry.mesh(batch.mesh);
            let instances = drawn.range(batch.first, batch.count);
            if pulled {
                pass.draw_indexed(mesh.provoking_indices(), 0, instances);
            } else {
                let indices = mesh.indices(batch.key.shape != Shape::Triangles);
                pass.draw_indexed(indices, mesh.index_base, instances);
            }
        }
    }

    /// Materials of the solid draws with their classes, each once.
    pub(crate) fn solid_materials(&self) -> BTreeMap<u32, u32> {
        let draws = self.solid.iter();
        draws.map(|b| (b.material, b.key.class)).collect()
    }

    /// Families of the solid draws' materials with their classes, each once.
    pub(crate) fn solid_families(&self, scene: &SceneOnGpu) -> BTreeMap<u32, u32> {
        let families = scene.materials.families();
        let draws = self.solid.iter();
        draws
            .map(|b| (families.of(b.material), b.key.class))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use foveal_scene::Projection;
    use glam::Vec3;

    use super::*;

    #[test]
    fn two_draws_keep_their_order_whatever_else_is_drawn() {
        let scene = foveal_generate::by_name("demo:1000").unwrap();
        let renderer =
            crate::testing::rendered(&scene, &scene.cameras[0], &crate::testing::small(16, 16));
        let scene_on_gpu = renderer.scene();
        let mut list = DrawList::default();
        let mut order = |is_visible: &dyn Fn(u32) -> bool| {
            list.build(scene_on_gpu, &scene.cameras[0], true, is_visible);
            list.drawn.clone()
        };
        let all = order(&|_| true);
        let some = order(&|object| object % 3 == 0);
        let expected: Vec<u32> = all.iter().copied().filter(|i| some.contains(i)).collect();
        assert!(some.len() < all.len() && !some.is_empty());
        assert_eq!(some, expected);
        // A list that is built again holds nothing of the frame before.
        assert_eq!(order(&|_| true), all);
    }

    #[test]
    fn merged_draws_hold_their_own_instances_where_glass_and_coats_alternate() {
        let all = foveal_generate::lobes().materials;
        let coated = all
            .iter()
            .find(|m| m.clearcoat.is_some() && m.transmission.is_none());
        let glass = all.iter().find(|m| m.transmission.is_some());
        let plain = |of: Option<&foveal_scene::Material>| foveal_scene::Material {
            clearcoat: of.and_then(|m| m.clearcoat),
            transmission: of.and_then(|m| m.transmission),
            ..foveal_scene::Material::default()
        };
        let materials = vec![plain(coated), plain(glass)];
        let depths = [-2.0, -4.0, -8.0, -16.0, -32.0, -64.0];
        let mut scene = crate::forward::twin::quads(materials, &depths);
        for (instance, material) in scene.instances.iter_mut().zip([0, 1].into_iter().cycle()) {
            instance.material = material;
        }
        let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
        let settings = crate::testing::small(16, 16);
        let renderer = crate::testing::rendered(&scene, &camera, &settings);
        let mut list = DrawList::default();
        list.build(renderer.scene(), &camera, true, |_| true);
        for batches in [&list.lobed, &list.transmissive] {
            let mut count = 0;
            for batch in batches {
                for i in batch.first..batch.first + batch.count {
                    let instance = &scene.instances[list.drawn[i as usize] as usize];
                    assert_eq!(instance.material, batch.material);
                    count += 1;
                }
            }
            assert_eq!(count, 3);
        }
    }

    #[test]
    fn parallel_cameras_sort_what_is_blended_by_its_depth() {
        use glam::{Mat4, Vec4};
        let pane = |color| foveal_scene::Material {
            base_color: color,
            alpha_mode: AlphaMode::Blend,
            unlit: true,
            ..foveal_scene::Material::default()
        };
        let (red, green) = (Vec4::new(1.0, 0.0, 0.0, 0.5), Vec4::new(0.0, 1.0, 0.0, 0.5));
        let mut scene = crate::forward::twin::quads(vec![pane(red), pane(green)], &[0.0, -1.0]);
        // The nearer one is to the side, so that its centre is farther from the eye.
        let places = [(Vec3::X * 8.0, 4.0), (-Vec3::Z, 6.0)];
        for (instance, (at, scale)) in scene.instances.iter_mut().zip(places) {
            let scaled = Mat4::from_scale(Vec3::splat(scale));
            instance.world_from_object = Mat4::from_translation(at) * scaled;
            instance.bounds = (scene.meshes[0].bounds).transformed(instance.world_from_object);
            scene.objects[instance.object as usize].bounds = instance.bounds;
        }
        let mut camera = Camera::look_at(Vec3::Z * 10.0, Vec3::ZERO, Vec3::Y, 1.0);
        camera.projection = Projection::Orthographic {
            height_m: 20.0,
            near_m: 0.1,
            far_m: 40.0,
        };
        let settings =
            crate::testing::small(40, 40).with(|s| s.lighting.background = crate::Background::None);
        let renderer = crate::testing::rendered(&scene, &camera, &settings);
        let radiance = crate::testing::texels::<[u16; 4]>(&renderer.targets().radiance_view);
        // Both are seen at x = 5, y = 0: red over green.
        let [r, g, ..] = radiance[20 * 40 + 30].map(crate::testing::f32_of_half);
        assert_eq!([r, g], [0.5, 0.25]);
    }
}
