//! Scenes by name, and from dropped files.

use std::collections::BTreeMap;

use foveal_generate as generate;
use foveal_scene::{Aabb, Camera, LoadOptions, Scene, load_bytes};
use glam::Vec3;
use js_sys::Uint8Array;
use serde::Serialize;

use crate::camera::Place;

/// What the page is told of a scene.
#[derive(Serialize)]
pub(crate) struct Shown {
    name: String,
    camera: Place,
    /// Half the length of its box's diagonal, for the pace of the camera.
    radius_m: f32,
    triangles: u64,
    objects: usize,
    lights: usize,
    warnings: Vec<String>,
}

impl Shown {
    pub(crate) fn of(scene: &Scene) -> Self {
        let bounds = match scene.bounds() {
            // As the overview camera takes it.
            empty if empty.is_empty() => Aabb::new(-Vec3::ONE, Vec3::ONE),
            bounds => bounds,
        };
        let radius_m = bounds.half_extent().length();
        let camera: Camera = match scene.cameras.first() {
            Some(camera) => camera.clone(),
            None => scene.overview_camera(),
        };
        Self {
            name: scene.name.clone(),
            camera: Place::of(&camera, camera.eye().distance(bounds.center()).max(1e-3)),
            radius_m,
            triangles: scene.triangle_count(),
            objects: scene.objects.len(),
            lights: scene.lights.len(),
            warnings: scene.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

/// A generated scene (`demo`, `cornell`, …).
pub(crate) fn generated(name: &str) -> Result<Scene, String> {
    let mut scene = generate::by_name(name).map_err(|cause| cause.to_string())?;
    scene.light_by_default();
    Ok(scene)
}

/// Files that a visitor gave together with a scene, by the way to them from its folder: a map of
/// `ArrayBuffer`s.
pub(crate) struct Beside(BTreeMap<String, Vec<u8>>);

impl Beside {
    pub(crate) fn new(files: &js_sys::Map) -> Self {
        let mut found = BTreeMap::new();
        files.for_each(&mut |bytes, name| {
            if let Some(name) = name.as_string() {
                found.insert(name, Uint8Array::new(&bytes).to_vec());
            }
        });
        Self(found)
    }

    /// The file of a URI. Of files that came without folders a page knows their names alone.
    fn get(&self, uri: &str) -> Option<&Vec<u8>> {
        let path = uri.strip_prefix("./").unwrap_or(uri);
        let name = uri.rsplit(['/', '\\']).next().unwrap_or(uri);
        self.0.get(path).or_else(|| self.0.get(name))
    }
}

/// A `.glb` or a `.gltf`, with what lies beside it as far as that was given too: a page cannot look
/// there.
pub(crate) fn from_bytes(name: &str, bytes: &[u8], beside: &Beside) -> Result<Scene, String> {
    let options = LoadOptions {
        parallel: false,
        max_file_bytes: 512 << 20,
        max_texture_size: 2048,
        max_texture_bytes: 1 << 30,
        ..LoadOptions::default()
    };
    let outside = |uri: &str| {
        beside.get(uri).cloned().ok_or_else(|| {
            format!(
                "\"{uri}\" lies beside the file, where a page cannot look; give both at once, \
                 or a .glb that holds everything"
            )
        })
    };
    let mut scene = load_bytes(bytes, name, &options, &outside).map_err(|e| e.to_string())?;
    // One thread filters it.
    if let Some(light) = &mut scene.image_light {
        light.halve_to(256);
    }
    scene.light_by_default();
    Ok(scene)
}
