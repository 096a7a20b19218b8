//! Occlusion culling on the CPU for Bevy.
//!
//! Walls and other *occluders* are rasterized into a small occlusion buffer by [`foveal_cull`], and
//! the meshes that Bevy has found in a camera's frustum are tested against it. Hidden ones leave
//! [`VisibleEntities`](bevy_camera::visibility::VisibleEntities) before anything is extracted for
//! drawing. The same is done for the shadow casters of lights. No GPU feature is needed, results are
//! those of the same frame, and what is removed is hidden: the picture stays the same.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_foveal_cull::{CpuOcclusionCulling, CpuOcclusionPlugin, Occluder};
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, CpuOcclusionPlugin))
//!         .add_systems(Startup, setup)
//!         .run();
//! }
//!
//! fn setup(
//!     mut commands: Commands,
//!     mut meshes: ResMut<Assets<Mesh>>,
//!     mut materials: ResMut<Assets<StandardMaterial>>,
//! ) {
//!     let gray = materials.add(Color::srgb(0.6, 0.6, 0.6));
//!     // A wall hides what is behind it.
//!     commands.spawn((
//!         Mesh3d(meshes.add(Cuboid::new(8.0, 4.0, 0.2))),
//!         MeshMaterial3d(gray.clone()),
//!         Occluder::default(),
//!     ));
//!     // A ball behind the wall: every mesh is tested, nothing need be added to it.
//!     commands.spawn((
//!         Mesh3d(meshes.add(Sphere::new(1.0))),
//!         MeshMaterial3d(gray),
//!         Transform::from_xyz(0.0, 0.0, -5.0),
//!     ));
//!     commands.spawn((
//!         Camera3d::default(),
//!         Transform::from_xyz(0.0, 0.0, 6.0),
//!         CpuOcclusionCulling::default(),
//!     ));
//!     commands.spawn((
//!         PointLight { shadow_maps_enabled: true, ..default() },
//!         Transform::from_xyz(0.0, 1.5, 3.0),
//!         CpuOcclusionCulling::default(),
//!     ));
//! }
//! ```
//!
//! # What is never hidden
//! - Entities with [`NoOcclusionCulling`], and with Bevy's `NoFrustumCulling` or `NoCpuCulling`.
//! - Entities without an `Aabb`, morphing ones, and skinned ones without `DynamicSkinnedMeshBounds`
//!   or while their joints or bind poses are missing: nothing is known of where they are.
//! - Forward decals, wireframes, and materials with a depth bias above 0: they are drawn in front of
//!   what is nearer. Of materials of your own this is known with an `OccluderMaterialPlugin`.
//! - What shaders move, draw outside the `Aabb` or draw in front of what is nearer is not known: give
//!   such entities [`NoOcclusionCulling`].
//!
//! # What occludes
//! Entities with [`Occluder`] that are visible, in the list of the view, neither skinned nor
//! morphing, without `NoCpuCulling`, and, where the feature `bevy_pbr` is on, of an opaque material
//! whose textures are loaded. Materials of your own need an `OccluderMaterialPlugin`. Occluders may
//! move, come and go. Where a light looks, they must be shadow casters. A box or a proxy on an
//! entity with a mesh hides nothing from a view that is inside the mesh's `Aabb`, or whose near
//! plane may cut the mesh. Materials that discard pixels in a shader of their own must not be given
//! to occluders. With the feature `bevy_pbr`, `AutomaticOccluders` finds occluders by itself.
//!
//! # What is not drawn yet
//! Bevy draws a mesh only when its pipeline is compiled, and compiles pipelines only for what a view
//! lists. So an entity hides others, and is hidden, from the fourth frame on in which a view lists it
//! with its mesh and material; and while pipelines are being compiled, nothing is hidden
//! ([`CpuOcclusionStats::waiting_views`]). Assets that `RenderAssetBytesPerFrame` holds back from
//! the GPU are not known: such an entity may hide others before it is drawn. A material of your own
//! that is exchanged while its entity is hidden may be drawn some frames late.
//!
//! # Exactness
//! By [`OcclusionBufferSize::Exact`], the default, occlusion is sampled at the very sample positions
//! of the picture, multisampled or not, and of the shadow map. Where the buffer would need more than
//! 4,096 pixels on a side it gets half of them or less ([`CpuOcclusionStats::coarse_views`]), and
//! slits narrower than a pixel may lose what is behind them. So may they with a temporal jitter
//! (`TemporalAntiAliasing`) or an upscaler, whose samples are not those of the viewport.
//!
//! A view whose transform or projection mirrors without `Camera::invert_culling` is not culled by
//! occluders; [`CpuOcclusionStats::refused_views`] counts them. Where the near plane is oblique (a
//! mirror's clip plane), occluders that reach before it are left out.
//!
//! # Shadows that nobody sees
//! Casters whose shadow can fall on nothing that a camera lists are left out of the shadow maps of
//! lights with [`CpuOcclusionCulling`]. A point or spot light is not drawn where all that a camera
//! lists within its range is in the shadow of occluders, or where there is nothing: its
//! `ViewVisibility` is then hidden. Lights stay whose entity has a mesh too, or near which something
//! is seen that is lit without shadows; all stay where clusters of lights are filled by the CPU, and
//! where more are visible than Bevy draws shadow maps for.
//! [`CpuOcclusionCulling::keep_unseen_shadows`] turns both off.
//!
//! # Features
//! - `bevy_pbr` (default): materials decide who may occlude, and `AutomaticOccluders`. Includes
//!   `bevy_light`.
//! - `bevy_light`: shadow casters of lights.
//! - `overlay` (default): `CpuOcclusionOverlay`, which shows what the culler does.

#[cfg(feature = "bevy_pbr")]
mod automatic;
mod cameras;
mod components;
mod cull;
#[cfg(feature = "bevy_light")]
mod left_out;
#[cfg(feature = "bevy_light")]
mod lights;
#[cfg(feature = "bevy_light")]
mod map_sizes;
#[cfg(feature = "bevy_light")]
mod mask;
mod materials;
mod occluders;
#[cfg(feature = "overlay")]
mod overlay;
mod plugin;
#[cfg(feature = "bevy_light")]
mod reach;
mod ready;
#[cfg(feature = "bevy_light")]
mod receivers;
#[cfg(feature = "bevy_light")]
mod shadow_map;
mod stats;
mod tasks;
mod view;

#[cfg(feature = "bevy_pbr")]
pub use automatic::{AutomaticOccluder, AutomaticOccluders};
pub use components::{
    CpuOcclusionCulling, NoOcclusionCulling, Occluder, OccluderShape, OcclusionBufferSize,
};
#[cfg(feature = "bevy_pbr")]
pub use materials::OccluderMaterialPlugin;
#[cfg(feature = "overlay")]
pub use overlay::{CpuOcclusionGizmos, CpuOcclusionOverlay, CpuOcclusionOverlayCamera};
pub use plugin::{CpuOcclusionPlugin, CpuOcclusionSystems};
pub use stats::CpuOcclusionStats;
