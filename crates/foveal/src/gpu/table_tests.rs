//! Tables in textures, held to tables in buffers.

use foveal_generate as generate;

use super::{Gpu, is_reduced};
use crate::testing::{gpu, picture, rendered_on, small};
use crate::{Antialiasing, Geometry, LightAssignment, Settings, Shading, Shadows, Stereo};

/// A device that differs from the tests' own in the number of textures that a stage may read: tables
/// lie in buffers.
fn gpu_with_buffers() -> Gpu {
    pollster::block_on(async {
        let adapter = super::adapter::choose(None).await.unwrap();
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                required_features: gpu().device.features(),
                required_limits: wgpu::Limits {
                    max_sampled_textures_per_shader_stage: Gpu::required_limits()
                        .max_sampled_textures_per_shader_stage,
                    ..gpu().device.limits()
                },
                ..Default::default()
            })
            .await
            .unwrap();
        Gpu::from_device(device, queue)
    })
}

/// A scene, and how it is drawn.
type Way = (&'static str, fn(&mut Settings));

#[test]
fn pictures_do_not_depend_on_where_tables_lie() {
    let buffers = gpu_with_buffers();
    assert!(!is_reduced(&buffers.device.limits()) && !buffers.has_texture_tables());
    assert_eq!(gpu().has_texture_tables(), gpu().is_lavapipe());
    let ways: [Way; 8] = [
        ("alpha", |_| {}),
        ("demo:1000", |s| s.lighting.shadows = Shadows::Soft),
        ("demo:1000", |s| s.shading.mode = Shading::Coarse),
        ("demo:1000", |s| {
            s.geometry.path = Geometry::Visibility;
            s.shading.mode = Shading::Variable;
        }),
        ("demo:1000", |s| s.antialiasing.mode = Antialiasing::Msaa),
        ("lobes", |_| {}),
        ("cornell", |s| {
            s.lighting.shadows = Shadows::Contact;
            s.lighting.assignment = LightAssignment::Brute;
        }),
        ("demo:1000", |s| s.stereo.mode = Stereo::Instanced),
    ];
    for (name, change) in ways {
        let scene = generate::by_name(name).unwrap();
        let settings = small(64, 40).with(change);
        let [in_textures, in_buffers] = [gpu(), &buffers]
            .map(|gpu| picture(&rendered_on(gpu, &scene, &scene.cameras[0], &settings)));
        assert!(in_textures == in_buffers, "{name} {settings:?}");
        assert!(in_textures.iter().any(|&b| b != in_textures[0]));
    }
}
