//! What the tests of several stages share.

use std::sync::OnceLock;

use foveal_scene::{
    Aabb, Camera, ColorSpace, Encoding, Instance, Material, Mesh, Object, Sampler, Scene, Texture,
    TextureRef,
};
use glam::{Mat3, Mat4, Vec3};

use crate::gpu::{MipChain, read_level, read_texture};
use crate::{Frame, FrameStats, Gpu, Renderer, Settings};

/// One device for all tests of the process.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter")
    })
}

/// Whether the tests' device rounds alike wherever the same is computed. Hardware does not: its
/// compilers join multiplications and additions as they see fit, and its rasterizers interpolate
/// from the target's corner.
pub(crate) fn rounds_alike() -> bool {
    gpu().is_lavapipe()
}

/// A device of one's own on the tests' adapter.
pub(crate) fn gpu_with(features: wgpu::Features, limits: wgpu::Limits) -> Gpu {
    pollster::block_on(async {
        let adapter = crate::gpu::choose_adapter(None).await;
        let (device, queue) = (adapter.expect("the tests need a graphics adapter"))
            .request_device(&wgpu::DeviceDescriptor {
                required_features: features,
                required_limits: limits,
                ..Default::default()
            })
            .await
            .expect("the adapter has what was asked for");
        Gpu::from_device(device, queue)
    })
}

/// A device that differs from the tests' own in the number of textures that a stage may read: tables
/// lie in buffers, and triangles are numbered by the device.
pub(crate) fn gpu_with_buffers() -> Gpu {
    let limits = wgpu::Limits {
        max_sampled_textures_per_shader_stage: Gpu::required_limits()
            .max_sampled_textures_per_shader_stage,
        ..gpu().device.limits()
    };
    gpu_with(gpu().device.features(), limits)
}

/// A renderer that has drawn `scene` once from `camera`.
pub(crate) fn rendered(scene: &Scene, camera: &Camera, settings: &Settings) -> Renderer {
    rendered_on(gpu(), scene, camera, settings)
}

/// The same on a device of one's own.
pub(crate) fn rendered_on(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
) -> Renderer {
    pollster::block_on(async {
        let mut renderer = Renderer::new(gpu, settings, crate::RendererOptions::default())
            .await
            .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        let frame = Frame::new(camera);
        renderer.render(&frame).await.expect("frame is drawn");
        renderer
    })
}

/// The texels of a view's texture.
pub(crate) fn texels<T: bytemuck::Pod>(view: &wgpu::TextureView) -> Vec<T> {
    let bytes = pollster::block_on(read_texture(gpu(), view.texture())).expect("read-back works");
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Radiance of a frame's pixels, row by row.
pub(crate) fn radiance(renderer: &Renderer) -> Vec<Vec3> {
    texels::<[u16; 4]>(&renderer.targets().radiance_view)
        .into_iter()
        .map(|[r, g, b, _]| Vec3::from([r, g, b].map(f32_of_half)))
        .collect()
}

/// The cells of a level of a rate map, row by row, whichever kind of pass wrote them.
pub(crate) fn rate_cells(chain: &MipChain, level: u32) -> Vec<u8> {
    let read = read_level(gpu(), &chain.texture, level - 1, chain.blocks(level));
    let bytes = pollster::block_on(read).expect("read-back works");
    // The lowest byte comes first.
    let size = chain.texture.format().block_copy_size(None).unwrap_or(1);
    bytes.into_iter().step_by(size as usize).collect()
}

/// A half-precision float's value.
pub(crate) fn f32_of_half(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 31);
    let mantissa = f32::from(bits & 1023) / 1024.0;
    sign * match exponent {
        0 => mantissa * 2f32.powi(-14),
        31 => f32::INFINITY,
        _ => (1.0 + mantissa) * 2f32.powi(exponent - 15),
    }
}

/// Light from 0 to 1 for a code of sRGB from 0 to 1.
pub(crate) fn linear_of_srgb(code: f32) -> f32 {
    if code <= 0.04045 {
        code / 12.92
    } else {
        ((code + 0.055) / 1.055).powf(2.4)
    }
}

/// The code of sRGB from 0 to 1 for light from 0 to 1.
pub(crate) fn srgb_of_linear(linear: f32) -> f32 {
    if linear <= 0.0031308 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The picture of a frame.
pub(crate) fn picture(renderer: &Renderer) -> Vec<u8> {
    pollster::block_on(renderer.read_picture()).expect("read-back works")
}

/// Numbers from 0 up to 1, the same for the same seed.
pub(crate) fn random(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

/// Settings for a small target.
pub(crate) fn small(width: u32, height: u32) -> Settings {
    Settings::default().with(|s| {
        s.picture.width = width;
        s.picture.height = height;
        // Tests of light that is kept turn it on.
        s.coarse.history = false;
        // Twins count one bounce; tests of further ones turn them on.
        s.lighting.multiple_scattering = false;
        // What tests look at does not hang on times.
        s.rate.force = true;
    })
}

/// A renderer with a scene, and the camera of its last frame.
pub(crate) struct Film {
    pub(crate) renderer: Renderer,
    /// What the next frame follows.
    pub(crate) last: Option<Camera>,
}

impl Film {
    pub(crate) fn new(scene: &Scene, settings: &Settings) -> Self {
        pollster::block_on(async {
            let mut renderer = Renderer::new(gpu(), settings, crate::RendererOptions::default())
                .await
                .unwrap();
            renderer.set_scene(scene).await.unwrap();
            Self {
                renderer,
                last: None,
            }
        })
    }

    pub(crate) fn draw(&mut self, camera: &Camera) -> FrameStats {
        let frame = Frame::new(camera).with_previous(self.last.as_ref());
        let stats = pollster::block_on(self.renderer.render(&frame)).unwrap();
        self.last = Some(camera.clone());
        stats
    }

    pub(crate) fn radiance(&self) -> Vec<[u16; 4]> {
        texels(&self.renderer.targets().radiance_view)
    }
}

/// The camera moved to the right, in metres of the world's x.
pub(crate) fn shifted(camera: &Camera, x: f32) -> Camera {
    let mut camera = camera.clone();
    camera.world_from_view.w_axis.x += x;
    camera
}

/// A texture in the first texture coordinates as they are.
pub(crate) fn slot(texture: u32) -> Option<TextureRef> {
    Some(TextureRef {
        texture,
        uv_set: 0,
        uv_transform: Mat3::IDENTITY,
    })
}

/// A texture of one texel.
pub(crate) fn one_texel(color_space: ColorSpace, texel: [u8; 4]) -> Texture {
    Texture {
        name: "one texel".to_owned(),
        width: 1,
        height: 1,
        color_space,
        sampler: Sampler::default(),
        encoding: Encoding::Rgba8,
        levels: vec![texel.to_vec()],
    }
}

/// A mesh that an object of its own shows.
pub(crate) fn add(scene: &mut Scene, mut mesh: Mesh, material: Material, world_from_object: Mat4) {
    mesh.bounds = Aabb::of_points(mesh.vertices.iter().map(|v| v.position.into()));
    let bounds = mesh.bounds.transformed(world_from_object);
    let number = scene.instances.len() as u32;
    scene.objects.push(Object {
        name: "a mesh".to_owned(),
        node: number,
        element: 0,
        visible: true,
        occluder: None,
        set: None,
        bounds,
        instances: number..number + 1,
    });
    scene.instances.push(Instance {
        mesh: scene.meshes.len() as u32,
        material: scene.materials.len() as u32,
        object: number,
        world_from_object,
        bounds,
    });
    scene.materials.push(material);
    scene.meshes.push(mesh);
}
