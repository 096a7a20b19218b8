//! The occluders of the world, kept up to date from frame to frame.
//!
//! Every entity with an `Occluder` is looked at in every frame, and an entry is compared with what
//! it is now: nothing depends on removal events being seen. The culler's set is touched only where
//! something has changed.

use crate::components::{Occluder, OccluderShape};
use crate::cull::{Skins, world_box};
use crate::materials::{MaterialVerdicts, Verdict};
use crate::ready::SETTLED;
use crate::stats::CpuOcclusionStats;
use crate::view::NearSpace;
use bevy_asset::{AssetEvent, AssetId, Assets};
use bevy_camera::primitives::Aabb as MeshBounds;
use bevy_camera::visibility::{
    DynamicSkinnedMeshBounds, InheritedVisibility, NoCpuCulling, NoFrustumCulling, RenderLayers,
    VisibilityRange,
};
use bevy_ecs::change_detection::{DetectChanges, Ref, Res, ResMut};
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::message::MessageReader;
use bevy_ecs::query::Has;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::Query;
use bevy_math::{Affine3A, Vec3, Vec3A};
use bevy_mesh::morph::MeshMorphWeights;
use bevy_mesh::skinning::SkinnedMesh;
use bevy_mesh::{Indices, Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use bevy_platform::collections::{HashMap, HashSet};
use bevy_platform::time::Instant;
use bevy_transform::components::GlobalTransform;
use foveal_cull::{Aabb, BakeOptions, OccluderId, OccluderMesh, OccluderSet};
use std::sync::{Arc, Once};
use tracing::warn;

/// The culler's set of occluders, and what is known of each.
#[derive(Resource, Default)]
pub(crate) struct Occluders {
    pub(crate) set: OccluderSet,
    entries: EntityHashMap<Entry>,
    /// `None` for meshes that cannot be baked.
    baked: HashMap<(AssetId<Mesh>, Sides), Option<Arc<OccluderMesh>>>,
    /// Meshes of which it was said that they cannot be baked.
    refused: HashSet<AssetId<Mesh>>,
    frame: u64,
}

/// An occluder, as a view's conditions need it.
pub(crate) struct Entry {
    /// `None` where there is nothing to place: the mesh is not loaded, or cannot be baked.
    id: Option<OccluderId>,
    shape: Shape,
    /// The box in the world of what is drawn of it; `EMPTY` where that is not known.
    pub(crate) bounds: Aabb,
    /// Whether it is a box or a proxy inside a mesh that is drawn.
    inside: bool,
    /// Whether it is switched on in the set.
    enabled: bool,
    /// Whether it is drawn, for what does not depend on the view.
    drawn: bool,
    pub(crate) layers: RenderLayers,
    pub(crate) range: Range,
    /// Whether its material draws into shadow maps.
    pub(crate) shadows: bool,
    /// Whether a view draws its entity only if it lists it.
    pub(crate) listed: bool,
    /// Whether its material draws the same side of faces where a camera inverts culling.
    pub(crate) not_inverted: bool,
    /// The mesh that is drawn, and the look of its material.
    look: (Option<AssetId<Mesh>>, u64),
    /// The frame in which these changed last.
    since: u64,
    /// The last frame in which its entity was seen.
    frame: u64,
}

/// A `VisibilityRange`, as far as occlusion is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Range {
    None,
    /// Drawn wholly or not at all.
    Abrupt,
    /// Fades: what is drawn has holes.
    Fading,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Sides {
    Front,
    Both,
}

/// What occludes; a change makes the occluder anew.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Mesh(AssetId<Mesh>, Sides),
    Box(Vec3, Vec3),
    Nothing,
}

impl Entry {
    /// Whether the mesh around a box or a proxy is closed for a view with this space before its
    /// near plane. A mesh that the plane cuts, or that the eye is in, does not cover what is inside
    /// it.
    pub(crate) fn is_closed(&self, near: &NearSpace) -> bool {
        !self.inside || near.spares(&self.bounds)
    }
}

impl Occluders {
    /// Switches on the occluders that are drawn and fulfil a view's condition, and the others off.
    /// Returns how many are on.
    pub(crate) fn enable(&mut self, condition: impl Fn(Entity, &Entry) -> bool) -> usize {
        let mut on = 0;
        for (&entity, entry) in &mut self.entries {
            let Some(id) = entry.id else { continue };
            let enabled = entry.drawn && condition(entity, entry);
            on += usize::from(enabled);
            if enabled != entry.enabled && self.set.set_enabled(id, enabled).is_ok() {
                entry.enabled = enabled;
            }
        }
        on
    }

    /// The occluders that are drawn, and their boxes in their own space.
    #[cfg(feature = "overlay")]
    pub(crate) fn shapes(&self) -> impl Iterator<Item = (Entity, Aabb)> {
        self.entries.iter().filter_map(|(&entity, entry)| {
            let id = entry.id.filter(|_| entry.drawn)?;
            Some((entity, self.set.mesh(id).ok()?.bounds()))
        })
    }

    /// Whether an entity is an occluder that is switched on.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn is_on(&self, entity: Entity) -> bool {
        let entry = self.entries.get(&entity);
        entry.is_some_and(|entry| entry.id.is_some() && entry.enabled)
    }

    /// Whether all occluders that are switched on stand in a view's list.
    #[cfg(feature = "bevy_light")]
    pub(crate) fn are_all_listed(&self) -> bool {
        let mut on = self
            .entries
            .values()
            .filter(|e| e.id.is_some() && e.enabled);
        on.all(|entry| entry.listed)
    }

    /// Forgets what was made of meshes that have changed or are gone.
    fn forget_meshes(&mut self, changed: &HashSet<AssetId<Mesh>>, meshes: &Assets<Mesh>) {
        if !changed.is_empty() {
            self.baked.retain(|(mesh, _), _| !changed.contains(mesh));
            self.refused.retain(|mesh| meshes.contains(*mesh));
        }
    }

    fn sweep(&mut self, reshaped: bool) {
        let (set, frame, before) = (&mut self.set, self.frame, self.entries.len());
        self.entries.retain(|_, entry| {
            let kept = entry.frame == frame;
            if !kept && let Some(id) = entry.id {
                // An error means that it is gone already.
                let _ = set.remove(id);
            }
            kept
        });
        if self.entries.len() < before || reshaped {
            self.baked
                .retain(|_, mesh| mesh.as_ref().is_none_or(|m| Arc::strong_count(m) > 1));
        }
    }
}

pub(crate) fn update(
    mut occluders: ResMut<Occluders>,
    mut stats: ResMut<CpuOcclusionStats>,
    meshes: Res<Assets<Mesh>>,
    mut events: MessageReader<AssetEvent<Mesh>>,
    verdicts: Res<MaterialVerdicts>,
    entities: Query<(
        Entity,
        &Occluder,
        Ref<GlobalTransform>,
        Option<&Mesh3d>,
        Option<&MeshBounds>,
        &InheritedVisibility,
        Option<&RenderLayers>,
        Option<&VisibilityRange>,
        (
            Option<&SkinnedMesh>,
            Has<DynamicSkinnedMeshBounds>,
            Has<MeshMorphWeights>,
        ),
        (Has<NoCpuCulling>, Has<NoFrustumCulling>),
    )>,
    skins: Skins,
) {
    let begin = Instant::now();
    let occluders = &mut *occluders;
    occluders.frame += 1;
    let changed: HashSet<AssetId<Mesh>> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Added { id }
            | AssetEvent::Modified { id }
            | AssetEvent::Removed { id }
            | AssetEvent::LoadedWithDependencies { id } => Some(*id),
            AssetEvent::Unused { .. } => None,
        })
        .collect();
    occluders.forget_meshes(&changed, &meshes);

    let frame = occluders.frame;
    let mut drawn_ones = 0;
    let mut reshaped = false;
    for (
        entity,
        occluder,
        transform,
        mesh,
        drawn_bounds,
        visibility,
        layers,
        range,
        (skinned, follows_joints, morphing),
        (unlisted, not_bounded),
    ) in &entities
    {
        let judgment = verdicts.of(entity);
        // Without a material Bevy draws no mesh, and of an unknown one nothing is known.
        let unknown = cfg!(feature = "bevy_pbr") && mesh.is_some() && judgment.is_none();
        let judgment = judgment.unwrap_or_default();
        let verdict = judgment.verdict;
        let sides = match occluder.two_sided && !verdict.contains(Verdict::ONE_SIDED) {
            true => Sides::Both,
            false => Sides::Front,
        };
        let own_mesh = occluder.shape == OccluderShape::Mesh;
        let shape = match &occluder.shape {
            OccluderShape::Mesh => mesh.map_or(Shape::Nothing, |m| Shape::Mesh(m.id(), sides)),
            OccluderShape::Proxy(proxy) => Shape::Mesh(proxy.id(), sides),
            OccluderShape::Box { min, max } => Shape::Box(*min, *max),
        };
        // Bevy does not turn faces around where a scale mirrors: a material must draw the other side.
        // Without a mesh there is no material to ask.
        let mirrored = transform.affine().matrix3.determinant() < 0.0;
        let outside_drawn = mesh.is_none()
            || sides == Sides::Both
            || mirrored == verdict.contains(Verdict::FRONT_CULLED);
        // A mesh with `NoCpuCulling` is in no view's list: whether a view draws it is not known.
        let drawn = visibility.get()
            && outside_drawn
            && !unknown
            && !verdict.contains(Verdict::NEVER)
            && !(mesh.is_some() && unlisted)
            && !(own_mesh && (skinned.is_some() || morphing));
        let look = (mesh.map(|m| m.id()), judgment.look);

        let entry = occluders.entries.entry(entity).or_insert_with(|| Entry {
            id: None,
            shape: Shape::Nothing,
            bounds: Aabb::EMPTY,
            inside: false,
            enabled: true,
            drawn,
            layers: RenderLayers::default(),
            range: Range::None,
            shadows: true,
            listed: false,
            not_inverted: false,
            look,
            since: frame,
            frame,
        });
        if entry.look != look || look.0.is_some_and(|mesh| changed.contains(&mesh)) {
            entry.look = look;
            entry.since = frame;
        }
        let age = frame - entry.since;
        if unknown && age == u64::from(SETTLED) {
            static SAID: Once = Once::new();
            SAID.call_once(|| {
                warn!(
                    "{entity} and perhaps others do not occlude: they have neither a \
                     `StandardMaterial` nor one with an `OccluderMaterialPlugin`"
                );
            });
        }
        // What has changed may not be drawn at once: pipelines are compiled and assets uploaded.
        let drawn = drawn && (mesh.is_none() || age >= u64::from(SETTLED));
        drawn_ones += usize::from(drawn);
        entry.frame = frame;
        entry.drawn = drawn;
        entry.listed = mesh.is_some();
        entry.inside = mesh.is_some() && !own_mesh;
        entry.not_inverted = verdict.contains(Verdict::NOT_INVERTED);
        entry.shadows = !verdict.contains(Verdict::NO_SHADOW);
        entry.range = match range {
            None => Range::None,
            Some(range) if range.is_abrupt() => Range::Abrupt,
            Some(_) => Range::Fading,
        };
        let layers = layers.unwrap_or_default();
        if entry.layers != *layers {
            entry.layers = layers.clone();
        }

        let changed_mesh = matches!(shape, Shape::Mesh(mesh, _) if changed.contains(&mesh));
        let place = affine(&transform.affine());
        let moved = transform.is_changed();
        if let Some(id) = entry.id {
            let anew = entry.shape != shape || changed_mesh;
            if anew || (moved && occluders.set.set_transform(id, place).is_err()) {
                let _ = occluders.set.remove(id);
                entry.id = None;
            }
        }
        let was_placed = entry.id.is_some();
        reshaped |= entry.shape != shape;
        entry.shape = shape;
        // What is not drawn is not baked. What could not be placed is tried again.
        if entry.id.is_none() && drawn {
            let baked = match shape {
                Shape::Nothing => None,
                Shape::Box(min, max) => match OccluderMesh::from_box(Aabb::new(min, max)) {
                    Ok(mesh) => Some(Arc::new(mesh)),
                    Err(error) => {
                        static SAID: Once = Once::new();
                        SAID.call_once(|| {
                            warn!("{entity} and perhaps others do not occlude: {error}");
                        });
                        None
                    }
                },
                Shape::Mesh(id, sides) => meshes.get(id).and_then(|mesh| {
                    let refused = &mut occluders.refused;
                    occluders
                        .baked
                        .entry((id, sides))
                        .or_insert_with(|| match bake(mesh, sides) {
                            Ok(mesh) => Some(Arc::new(mesh)),
                            Err(reason) => {
                                // Once for each mesh, however often it changes.
                                if refused.insert(id) {
                                    warn!("the mesh {id} cannot occlude: {reason}");
                                }
                                None
                            }
                        })
                        .clone()
                }),
            };
            entry.id = baked.and_then(|mesh| occluders.set.add(mesh, place).ok());
            entry.enabled = true;
        }
        if !own_mesh {
            // What is drawn around a box or a proxy. With `NoFrustumCulling` Bevy keeps no bounds.
            entry.bounds = match (mesh, drawn_bounds) {
                (Some(mesh), Some(bounds))
                    if !(not_bounded || morphing)
                        && skinned.is_none_or(|skinned| {
                            skins.bound(skinned, mesh, follows_joints, &transform)
                        }) =>
                {
                    world_box(bounds, &transform)
                }
                _ => Aabb::EMPTY,
            };
        } else if let Some(id) = entry.id.filter(|_| moved || !was_placed)
            && let Ok(mesh) = occluders.set.mesh(id)
        {
            entry.bounds = placed(mesh.bounds(), &transform);
        }
    }
    occluders.sweep(reshaped);
    *stats = CpuOcclusionStats {
        occluders: drawn_ones,
        update_time: begin.elapsed(),
        ..CpuOcclusionStats::default()
    };
}

/// The box in the world of an occluder's box.
fn placed(bounds: Aabb, transform: &GlobalTransform) -> Aabb {
    let (min, max) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
    let bounds = MeshBounds {
        center: (min + max) * 0.5,
        half_extents: (max - min) * 0.5,
    };
    world_box(&bounds, transform)
}

fn affine(map: &Affine3A) -> foveal_cull::Affine {
    map.to_cols_array_2d().map(|c| c.map(f64::from)).into()
}

/// Bakes a mesh, or says why it cannot.
fn bake(mesh: &Mesh, sides: Sides) -> Result<OccluderMesh, String> {
    triangles(mesh).and_then(|(positions, indices)| {
        // Cameras and lights are single eyes, which need no adjacency.
        let options = BakeOptions::default()
            .with_two_sided(sides == Sides::Both)
            .with_adjacency(false);
        OccluderMesh::bake(positions, &indices, options).map_err(|error| error.to_string())
    })
}

/// The positions of a mesh and its triangles.
fn triangles(mesh: &Mesh) -> Result<(&[[f32; 3]], Vec<u32>), String> {
    let positions = mesh
        .try_attribute(Mesh::ATTRIBUTE_POSITION)
        .map_err(|error| error.to_string())?;
    let VertexAttributeValues::Float32x3(positions) = positions else {
        return Err("its positions are not Float32x3".into());
    };
    let list: Vec<u32> = match mesh.try_indices_option().map_err(|e| e.to_string())? {
        Some(Indices::U16(list)) => list.iter().map(|&i| u32::from(i)).collect(),
        Some(Indices::U32(list)) => list.clone(),
        None => (0..positions.len() as u32).collect(),
    };
    let indices = match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => {
            let whole = list.len() - list.len() % 3;
            list[..whole].to_vec()
        }
        PrimitiveTopology::TriangleStrip => list
            .windows(3)
            .enumerate()
            .flat_map(|(i, corners)| match i % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[1], corners[0], corners[2]],
            })
            .collect(),
        other => return Err(format!("its topology is {other:?}")),
    };
    Ok((positions, indices))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_asset::RenderAssetUsages;

    fn quad(topology: PrimitiveTopology) -> Mesh {
        let corners = vec![
            [0.0, 0.0, 0.0_f32],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        Mesh::new(topology, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
    }

    #[test]
    fn strips_alternate_and_lists_may_lack_indices() {
        let strip = quad(PrimitiveTopology::TriangleStrip);
        let (positions, indices) = triangles(&strip).unwrap();
        assert_eq!(positions.len(), 4);
        assert_eq!(indices, [0, 1, 2, 2, 1, 3]);
        let list = quad(PrimitiveTopology::TriangleList);
        assert_eq!(triangles(&list).unwrap().1, [0, 1, 2]);
        let u16s = quad(PrimitiveTopology::TriangleList)
            .with_inserted_indices(Indices::U16(vec![0, 1, 2, 3, 2, 1, 0]));
        assert_eq!(triangles(&u16s).unwrap().1, [0, 1, 2, 3, 2, 1]);
        assert!(triangles(&quad(PrimitiveTopology::LineList)).is_err());
    }

    #[test]
    fn meshes_that_have_left_the_main_world_are_refused_with_a_reason() {
        let mut mesh = quad(PrimitiveTopology::TriangleStrip);
        mesh.take_gpu_data().unwrap();
        assert!(triangles(&mesh).unwrap_err().contains("RenderWorld"));
        assert!(bake(&mesh, Sides::Front).is_err());
    }
}
