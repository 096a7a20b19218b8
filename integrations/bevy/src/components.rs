//! What a user puts on entities.

use bevy_asset::Handle;
use bevy_camera::visibility::Visibility;
use bevy_ecs::component::Component;
use bevy_math::{UVec2, Vec3};
use bevy_mesh::Mesh;
use bevy_transform::components::Transform;

/// Makes an entity hide what is behind it.
///
/// Only what is drawn opaque may occlude: see the crate's documentation for when an occluder is
/// left out. It follows the entity's `GlobalTransform`, `Visibility`, `Mesh3d` and mesh asset. A
/// mesh is baked in the frame in which it first occludes, about one microsecond per triangle; large
/// detailed meshes are better given a [proxy](OccluderShape::Proxy) or a [box](OccluderShape::Box).
///
/// ```
/// use bevy_foveal_cull::Occluder;
/// use bevy_math::Vec3;
///
/// let wall = Occluder::default(); // the entity's own mesh
/// let house = Occluder::from_box(Vec3::new(-4.0, 0.0, -3.0), Vec3::new(4.0, 5.0, 3.0));
/// # let _ = (wall, house);
/// ```
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[require(Transform, Visibility)]
pub struct Occluder {
    /// What occludes; the entity's own mesh by default.
    pub shape: OccluderShape,
    /// Whether triangles occlude from behind as well; `false` by default. Only for materials without
    /// back-face culling (`cull_mode: None`); with one that culls faces, or of which that is not known,
    /// it has no effect. Boxes are closed and need it not.
    pub two_sided: bool,
}

/// What an [`Occluder`] hides with, in the space of the entity.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum OccluderShape {
    /// The mesh of the entity's `Mesh3d`. Its vertices must be in the main world: a mesh that is
    /// loaded for the render world alone never occludes.
    #[default]
    Mesh,
    /// A box that must lie wholly inside what is drawn. On an entity with a mesh it hides nothing
    /// from a camera or light whose near plane may cut that mesh, and nothing where the mesh's
    /// bounds are unknown. On an entity without a mesh nothing is known of what is drawn around it:
    /// it hides wherever the camera or the light is.
    Box {
        /// The corner with the smallest coordinates.
        min: Vec3,
        /// The corner with the largest coordinates.
        max: Vec3,
    },
    /// Another mesh, which must lie wholly inside what is drawn. Near planes and unknown bounds
    /// count as for a [box](OccluderShape::Box).
    Proxy(Handle<Mesh>),
}

impl Occluder {
    /// Occludes with the entity's mesh, from both sides.
    #[must_use]
    pub fn two_sided() -> Self {
        Self {
            two_sided: true,
            ..Self::default()
        }
    }

    /// Occludes with a box in the entity's space, which must lie wholly inside what is drawn. A `min`
    /// above `max` in some axis hides nothing, with a warning.
    #[must_use]
    pub fn from_box(min: Vec3, max: Vec3) -> Self {
        Self {
            shape: OccluderShape::Box { min, max },
            two_sided: false,
        }
    }

    /// Occludes with another mesh, which must lie wholly inside what is drawn.
    #[must_use]
    pub fn from_proxy(mesh: Handle<Mesh>) -> Self {
        Self {
            shape: OccluderShape::Proxy(mesh),
            two_sided: false,
        }
    }
}

/// Culls what is hidden from a camera, or the shadow casters that are hidden from a light.
///
/// On cameras it removes entities from `VisibleEntities`; on point, spot and directional lights
/// (feature `bevy_light`) from the lists of their shadow maps. It may be put on and taken off at any
/// time.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CpuOcclusionCulling {
    /// The size of the occlusion buffer.
    pub buffer_size: OcclusionBufferSize,
    /// For lights: whether casters are drawn whose shadow falls on nothing that a camera sees, and
    /// lights that light nothing that a camera sees; `false` by default. Set it where something reads
    /// shadow maps elsewhere than at the meshes of the camera's `VisibleEntities`: meshes that are
    /// drawn by a pipeline of your own, meshlets, or materials that look up shadows beside themselves.
    /// `VolumetricLight`s and soft shadows (`experimental_pbr_pcss`) are known, and draw all.
    pub keep_unseen_shadows: bool,
}

/// The size of a view's occlusion buffer. Every pixel of it has 4x4 samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OcclusionBufferSize {
    /// So many pixels that their samples are those of the picture: a quarter of the viewport per
    /// axis without multisampling; a half, all and twice of it with 2, 4 and 8 samples. For lights a
    /// quarter of the shadow map. The number of samples is known with the feature `bevy_pbr`, else
    /// 4 are assumed. A buffer has at most 4,096 pixels on a side: above that it is halved, and no
    /// longer exact; `coarse_views` in the stats counts such views.
    #[default]
    Exact,
    /// A quarter of the viewport per axis. Exact at pixel centres. With multisampling, samples
    /// beside an occluder's edge may lose what shows through slits narrower than a pixel.
    Quarter,
    /// This many pixels, for instance to spend less time. What shows only between their samples may
    /// be lost.
    Fixed(UVec2),
}

/// On an entity that occlusion culling must never hide.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoOcclusionCulling;
