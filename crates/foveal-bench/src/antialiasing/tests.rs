//! The reference fits the device, and pictures lack nothing.

use super::*;

#[test]
fn the_reference_has_as_many_sub_samples_as_the_device_can_draw() {
    let limits = wgpu::Limits {
        max_texture_dimension_2d: 16_384,
        ..wgpu::Limits::default()
    };
    let samples = |size: (u32, u32), wanted| {
        let base = Settings::default().with(|s| (s.picture.width, s.picture.height) = size);
        let reference = reference_of(&base, wanted, &limits)?;
        Ok::<_, foveal::Error>(reference.map(|s| s.antialiasing.samples))
    };
    assert_eq!(samples((1920, 1080), 64).unwrap(), Some(64));
    assert_eq!(samples((2560, 1440), 64).unwrap(), Some(36));
    assert_eq!(samples((2560, 1440), 16).unwrap(), Some(16));
    assert_eq!(samples((2560, 1440), 0).unwrap(), None);
    // Nothing is measured where no reference can be.
    assert!(samples((10_000, 100), 64).is_err());
    assert!(samples((1920, 1080), 50).is_err());
}

#[test]
fn a_reference_that_the_device_has_no_memory_for_is_made_smaller() {
    let base = Settings::default();
    let drawn = |wanted, most| {
        let limits = wgpu::Limits::default();
        drawn_reference(&base, wanted, &limits, |settings| {
            let samples = settings.antialiasing.samples;
            let doing = "drawing".to_owned();
            match samples {
                _ if samples <= most => Ok(samples),
                _ => Err(foveal::Error::OutOfMemory { doing }.into()),
            }
        })
    };
    assert_eq!(drawn(36, 64).unwrap(), Some((36, 36)));
    assert_eq!(drawn(36, 20).unwrap(), Some((16, 16)));
    assert_eq!(drawn(0, 64).unwrap(), None);
    assert!(drawn(36, 3).is_err());
    let fails = |_: &Settings| -> anyhow::Result<u32> { anyhow::bail!("another cause") };
    assert!(drawn_reference(&base, 36, &wgpu::Limits::default(), fails).is_err());
}

/// The scene with slivers in place of its meshes: more surfaces in a pixel than room is made
/// for before the first frame.
fn in_slivers(mut scene: Scene) -> Scene {
    let mut state = 1_u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    for mesh in &mut scene.meshes {
        let (least, size) = (mesh.bounds.min, mesh.bounds.max - mesh.bounds.min);
        let mut vertex = mesh.vertices[0];
        let scattered = (0..60_000).map(|number| {
            let extent = if number % 3 == 0 { 1.0 } else { 0.04 };
            for axis in 0..3 {
                vertex.normal[axis] = if axis == number / 3 % 3 { 1.0 } else { 0.0 };
                let place = least[axis] + random() * size[axis];
                vertex.position[axis] += extent * (place - vertex.position[axis]);
            }
            vertex
        });
        mesh.vertices = scattered.collect();
        // Seen from both sides.
        let corners = (0..20_000).map(|n| 3 * n);
        mesh.indices = corners
            .flat_map(|n| [n, n + 1, n + 2, n + 2, n + 1, n])
            .collect();
    }
    scene
}

#[test]
fn a_picture_that_is_kept_lacks_no_surface() {
    let gpu = foveal_host::gpu::open(None).unwrap();
    let mut scene = in_slivers(foveal_generate::cornell());
    scene.light_by_default();
    let settings = Settings::default().with(|s| {
        (s.picture.width, s.picture.height) = (48, 32);
        s.antialiasing.mode = Antialiasing::Msaa;
        s.antialiasing.pattern = SamplePattern::Rotated;
        s.antialiasing.samples = 8;
    });
    let mut mode = Mode::new(&gpu, &scene, &settings).unwrap();
    let camera = &scene.cameras[0];
    mode.warm_up(camera).unwrap();
    let kept = mode.picture.take().unwrap();
    mode.warm_up(camera).unwrap();
    assert!(kept.pixels == mode.picture.take().unwrap().pixels);
    // The scene is one whose first frame lacks room.
    let mut mode = Mode::new(&gpu, &scene, &settings).unwrap();
    let first = mode.draw(camera).unwrap();
    assert!(first.surfaces_left_out > 0, "{first:?}");
}
