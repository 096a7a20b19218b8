//! Shows what the culler does: boxes of occluders and of what is hidden, and the occlusion buffer.

use crate::cameras::CameraCullers;
use crate::components::CpuOcclusionCulling;
use crate::cull::ViewCuller;
use crate::occluders::Occluders;
use crate::plugin::CpuOcclusionSystems;
use bevy_app::{App, PostUpdate};
use bevy_asset::{Assets, Handle, RenderAssetUsages};
use bevy_camera::visibility::RenderLayers;
use bevy_camera::{
    Camera, Camera3d, ClearColorConfig, Hdr, OrthographicProjection, Projection, RenderTarget,
    ScalingMode, Viewport,
};
use bevy_color::Color;
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::component::Component;
use bevy_ecs::entity::{Entity, EntityHashMap};
use bevy_ecs::query::Has;
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::schedule::common_conditions::resource_exists;
use bevy_ecs::system::{Commands, Local, Query};
use bevy_gizmos::config::{GizmoConfig, GizmoConfigGroup};
use bevy_gizmos::gizmos::Gizmos;
use bevy_gizmos::{AppGizmoBuilder, GizmoAsset};
use bevy_image::Image;
use bevy_light::{NotShadowCaster, NotShadowReceiver};
use bevy_math::{UVec2, Vec3};
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_reflect::Reflect;
use bevy_render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_render::view::Msaa;
use bevy_transform::components::{GlobalTransform, Transform};

/// Shows what the culler does in the pictures of culled cameras, for as long as this resource exists.
///
/// Boxes are gizmos of the group [`CpuOcclusionGizmos`] and need Bevy's feature
/// `bevy_gizmos_render`. The depth is drawn by a camera of its own, which sees nothing but `layer`
/// and has the component [`CpuOcclusionOverlayCamera`]. It draws last, so Bevy's UI goes to it
/// unless a camera of yours has `IsDefaultUiCamera`, or the UI's roots name theirs by
/// `UiTargetCamera`.
///
/// ```
/// # use bevy_app::App;
/// # use bevy_foveal_cull::CpuOcclusionOverlay;
/// # let mut app = App::new();
/// app.insert_resource(CpuOcclusionOverlay {
///     depth_share: 0.5,
///     ..Default::default()
/// });
/// ```
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct CpuOcclusionOverlay {
    /// Whether the boxes of occluders are shown, in green.
    pub occluders: bool,
    /// Whether the boxes of hidden meshes are shown, in red.
    pub hidden: bool,
    /// Width of the occlusion buffer's depth in the lower left corner, as a share of the picture's;
    /// 0 for none. What is near is bright, and what no occluder covers is black.
    pub depth_share: f32,
    /// The render layer of the depth, which nothing else may have.
    pub layer: usize,
}

impl Default for CpuOcclusionOverlay {
    fn default() -> Self {
        Self {
            occluders: true,
            hidden: true,
            depth_share: 0.3,
            layer: 31,
        }
    }
}

/// The gizmos of [`CpuOcclusionOverlay`]: by default they are drawn in front of everything.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct CpuOcclusionGizmos;

/// On the cameras with which [`CpuOcclusionOverlay`] draws depth. Systems that look for a camera of
/// yours leave them out by it.
///
/// ```
/// # use bevy_camera::Camera3d;
/// # use bevy_ecs::query::{With, Without};
/// # use bevy_ecs::system::Single;
/// # use bevy_foveal_cull::CpuOcclusionOverlayCamera;
/// # use bevy_transform::components::Transform;
/// fn walk(camera: Single<&mut Transform, (With<Camera3d>, Without<CpuOcclusionOverlayCamera>)>) {
/// #   let _ = camera;
///     // ...
/// }
/// # bevy_ecs::system::assert_is_system(walk);
/// ```
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CpuOcclusionOverlayCamera;

const OCCLUDER: Color = Color::srgba(0.1, 0.9, 0.3, 0.6);
const HIDDEN: Color = Color::srgba(1.0, 0.25, 0.15, 0.6);

/// Where the depth is in the world, far from everything: metres below the origin.
const BELOW: f32 = 20_000.0;

/// Adds what shows the overlay, as far as Bevy's plugins are there.
pub(crate) fn add(app: &mut App) {
    let world = app.world();
    let has_gizmos = world.contains_resource::<Assets<GizmoAsset>>();
    let has_pictures = world.contains_resource::<Assets<Image>>()
        && world.contains_resource::<Assets<StandardMaterial>>();
    if has_gizmos {
        let config = GizmoConfig {
            depth_bias: -1.0,
            ..Default::default()
        };
        app.insert_gizmo_config(CpuOcclusionGizmos, config)
            .add_systems(
                PostUpdate,
                draw_boxes
                    .after(CpuOcclusionSystems::CullCameras)
                    .run_if(resource_exists::<CpuOcclusionOverlay>),
            );
    }
    if has_pictures {
        app.add_systems(
            PostUpdate,
            show_depth.after(CpuOcclusionSystems::CullLights),
        );
    }
}

fn draw_boxes(
    overlay: Res<CpuOcclusionOverlay>,
    occluders: Res<Occluders>,
    cullers: Res<CameraCullers>,
    transforms: Query<&GlobalTransform>,
    mut gizmos: Gizmos<CpuOcclusionGizmos>,
) {
    let cube = |min: [f32; 3], max: [f32; 3]| {
        let (min, max) = (Vec3::from(min), Vec3::from(max));
        Transform::from_translation((min + max) * 0.5).with_scale(max - min)
    };
    if overlay.occluders {
        for (entity, bounds) in occluders.shapes() {
            if let Ok(transform) = transforms.get(entity) {
                gizmos.cube(*transform * cube(bounds.min, bounds.max), OCCLUDER);
            }
        }
    }
    if overlay.hidden {
        for bounds in cullers.all().flat_map(|(_, culler)| culler.hidden()) {
            gizmos.cube(cube(bounds.min, bounds.max), HIDDEN);
        }
    }
}

/// What shows the depth of one camera.
struct Shown {
    /// A camera that draws into the corner, and the square that it sees.
    camera: Entity,
    square: Entity,
    image: Handle<Image>,
    material: Handle<StandardMaterial>,
    layer: usize,
}

fn show_depth(
    mut commands: Commands,
    overlay: Option<Res<CpuOcclusionOverlay>>,
    cullers: Res<CameraCullers>,
    mut shown: Local<EntityHashMap<Shown>>,
    mut square: Local<Option<Handle<Mesh>>>,
    mut texels: Local<Vec<f32>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    cameras: Query<(
        &Camera,
        Option<&RenderTarget>,
        Option<&Msaa>,
        Has<Hdr>,
        Has<CpuOcclusionCulling>,
    )>,
) {
    let overlay = overlay.filter(|overlay| overlay.depth_share > 0.0);
    shown.retain(|camera, shown| {
        let kept = overlay.as_ref().is_some_and(|o| o.layer == shown.layer)
            && cullers.all().any(|(culled, _)| culled == *camera)
            && cameras
                .get(*camera)
                .is_ok_and(|(camera, ..)| camera.is_active);
        if !kept {
            commands.entity(shown.camera).try_despawn();
            commands.entity(shown.square).try_despawn();
        }
        kept
    });
    let Some(overlay) = overlay else { return };
    for (entity, culler) in cullers.all() {
        let Ok((camera, target, msaa, hdr, true)) = cameras.get(entity) else {
            continue;
        };
        let Some(viewport) = camera
            .physical_viewport_rect()
            .filter(|_| camera.is_active)
            .and_then(|picture| corner(picture.min, picture.size(), overlay.depth_share))
        else {
            continue;
        };
        let of_overlay = Camera {
            viewport: Some(viewport),
            order: camera.order.saturating_add(1000),
            clear_color: ClearColorConfig::None,
            ..Default::default()
        };
        let image = depth_image(culler, &mut texels);
        let count = shown.len();
        let shown = shown.entry(entity).or_insert_with(|| {
            let image = images.add(image.clone());
            let material = materials.add(StandardMaterial {
                base_color_texture: Some(image.clone()),
                unlit: true,
                fog_enabled: false,
                ..Default::default()
            });
            let square = square.get_or_insert_with(|| {
                let plane = bevy_math::primitives::Rectangle::new(1.0, 1.0);
                meshes.add(Mesh::from(plane))
            });
            let place = Vec3::new(4.0 * count as f32, -BELOW, 0.0);
            let layers = RenderLayers::layer(overlay.layer);
            let square = commands.spawn((
                Mesh3d(square.clone()),
                MeshMaterial3d(material.clone()),
                Transform::from_translation(place),
                layers.clone(),
                NotShadowCaster,
                NotShadowReceiver,
            ));
            let square = square.id();
            let projection = OrthographicProjection {
                scaling_mode: ScalingMode::Fixed {
                    width: 1.0,
                    height: 1.0,
                },
                near: 0.0,
                far: 2.0,
                ..OrthographicProjection::default_3d()
            };
            let mut overlay_camera = commands.spawn((
                Camera3d::default(),
                CpuOcclusionOverlayCamera,
                of_overlay.clone(),
                Projection::Orthographic(projection),
                Tonemapping::None,
                msaa.copied().unwrap_or_default(),
                Transform::from_translation(place + Vec3::Z),
                layers,
            ));
            if hdr {
                overlay_camera.insert(Hdr);
            }
            Shown {
                camera: overlay_camera.id(),
                square,
                image,
                material,
                layer: overlay.layer,
            }
        });
        let mut overlay_camera = commands.entity(shown.camera);
        overlay_camera
            .entry::<Camera>()
            .and_modify(move |mut camera| {
                camera.viewport = of_overlay.viewport;
                camera.order = of_overlay.order;
            });
        if let Some(target) = target {
            overlay_camera.insert(target.clone());
        }
        let _ = images.insert(&shown.image, image);
        // The material takes the image anew.
        if let Some(material) = materials.get_mut(&shown.material) {
            material.into_inner();
        }
    }
}

/// The lower left corner of a picture; `None` where it has no pixels.
fn corner(from: UVec2, size: UVec2, share: f32) -> Option<Viewport> {
    let part = (size.as_vec2() * share.min(1.0)).as_uvec2();
    (part.min_element() > 0).then(|| Viewport {
        physical_position: UVec2::new(from.x, from.y + size.y - part.y),
        physical_size: part,
        ..Default::default()
    })
}

/// The buffer of a culler as a picture.
fn depth_image(culler: &ViewCuller, texels: &mut Vec<f32>) -> Image {
    let (width, height) = culler.size();
    texels.clear();
    texels.resize((width * height) as usize, 0.0);
    culler.read_depth(texels);
    let extent = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let pixels = texels.iter().flat_map(|&depth| {
        let gray = gray(depth);
        [gray, gray, gray, 255]
    });
    Image::new(
        extent,
        TextureDimension::D2,
        pixels.collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::default(),
    )
}

/// White at the near plane, darker with each tenfold of the distance, and black where nothing is.
fn gray(depth: f32) -> u8 {
    if depth > 0.0 {
        (255.0 * (1.0 + depth.log10() / 5.0)).clamp(30.0, 255.0) as u8
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_lies_in_the_lower_left_corner() {
        let viewport = corner(UVec2::new(10, 20), UVec2::new(400, 200), 0.25).unwrap();
        assert_eq!(viewport.physical_position, UVec2::new(10, 170));
        assert_eq!(viewport.physical_size, UVec2::new(100, 50));
        assert!(corner(UVec2::ZERO, UVec2::new(2, 2), 0.25).is_none());
    }

    #[test]
    fn what_is_nearer_is_brighter_and_nothing_is_black() {
        assert_eq!((gray(1.0), gray(0.0)), (255, 0));
        assert!(gray(0.1) > gray(0.01) && gray(0.01) > gray(1e-3));
        assert_eq!(gray(1e-9), 30);
    }
}
