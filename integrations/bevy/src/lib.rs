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
//! - Entities without an `Aabb`, morphing ones, and skinned ones without `DynamicSkinnedMeshBounds`:
//!   nothing is known of where they are.
//! - What materials move, draw outside the `Aabb` or draw in front of what is nearer (vertex
//!   displacement, depth bias) is not known either: give such entities [`NoOcclusionCulling`].
//!
//! # What occludes
//! Entities with [`Occluder`] that are visible, on a layer of the view, neither skinned nor morphing,
//! and, where the feature `bevy_pbr` is on, of an opaque material. They may move, come and go.
//! Where a light looks, they must be shadow casters. Materials that discard pixels in a shader of
//! their own must not be given to occluders. With the feature `bevy_pbr`,
//! `AutomaticOccluders` finds occluders by itself.
//!
//! # Exactness
//! By [`OcclusionBufferSize::Exact`], the default, occlusion is sampled at the very sample positions
//! of the picture, multisampled or not, and of the shadow map. A temporal jitter
//! (`TemporalAntiAliasing`) moves the picture's samples by less than a pixel; slits narrower than
//! that may then lose what is behind them.
//!
//! A view whose near plane is oblique (a mirror's clip plane), or whose transform mirrors without
//! `Camera::invert_culling`, is not culled; [`CpuOcclusionStats::refused_views`] counts them.
//!
//! # Features
//! - `bevy_pbr` (default): materials decide who may occlude, and `AutomaticOccluders`. Includes
//!   `bevy_light`.
//! - `bevy_light`: shadow casters of lights.

#[cfg(feature = "bevy_pbr")]
mod automatic;
mod cameras;
mod components;
mod cull;
#[cfg(feature = "bevy_light")]
mod lights;
mod materials;
mod occluders;
mod plugin;
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
pub use plugin::{CpuOcclusionPlugin, CpuOcclusionSystems};
pub use stats::CpuOcclusionStats;
