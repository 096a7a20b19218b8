//! Tables in textures, held to tables in buffers.

use foveal_generate as generate;

use super::is_reduced;
use crate::testing::{gpu, gpu_with_buffers, picture, rendered_on, small};
use crate::{Antialiasing, Geometry, LightAssignment, Settings, Shading, Shadows, Stereo};

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
