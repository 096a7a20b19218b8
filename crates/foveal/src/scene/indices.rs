//! A scene's indices, which may come from a program's own code: each must name what the scene has,
//! because all stages take its parts by them without asking again. So are the texels of its own
//! environment counted.

use std::fmt::Display;

use foveal_scene::{Material, Mesh, Scene};

use super::material_uniform::slots;
use crate::Error;

/// Refuses instances, materials and meshes that name what `scene` does not have, and an environment
/// that lacks texels.
///
/// # Errors
/// [`Error::Scene`] for the first of them.
pub(super) fn check_indices(scene: &Scene) -> Result<(), Error> {
    for (number, instance) in scene.instances.iter().enumerate() {
        for (what, index, kind, count) in [
            ("mesh", instance.mesh, "meshes", scene.meshes.len()),
            (
                "material",
                instance.material,
                "materials",
                scene.materials.len(),
            ),
            ("object", instance.object, "objects", scene.objects.len()),
        ] {
            if index as usize >= count {
                let place = format!("instances[{number}].{what}");
                return Err(missing(place, index, "the scene", count, kind));
            }
        }
    }
    for (number, material) in scene.materials.iter().enumerate() {
        let count = scene.textures.len();
        if let Some(index) = textures(material).find(|&index| index as usize >= count) {
            let place = format!("a texture of materials[{number}]");
            return Err(missing(place, index, "the scene", count, "textures"));
        }
    }
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let count = mesh.vertices.len();
        if let Some((place, index)) = beyond_vertices(mesh) {
            let place = format!("meshes[{number}].{place}");
            return Err(missing(place, index, "the mesh", count, "vertices"));
        }
    }
    check_image_light(scene)
}

/// Refuses an environment that has not the texels of six sides.
fn check_image_light(scene: &Scene) -> Result<(), Error> {
    let Some(light) = &scene.image_light else {
        return Ok(());
    };
    let (side, texels) = (light.side, light.radiance.len());
    let of_side = u64::from(side) * u64::from(side);
    if side > 0 && texels.is_multiple_of(6) && texels as u64 / 6 == of_side {
        return Ok(());
    }
    Err(Error::Scene {
        cause: format!(
            "image_light.radiance has {texels} texels; it must be six sides of {side} x {side}, and these not empty"
        ),
    })
}

fn missing(place: impl Display, index: u32, owner: &str, count: usize, kind: &str) -> Error {
    Error::Scene {
        cause: format!("{place} is {index}, and {owner} has {count} {kind}"),
    }
}

/// All that a material reads, its lobes' included.
fn textures(material: &Material) -> impl Iterator<Item = u32> {
    let own = slots(material).into_iter();
    let slots = own.chain(material.lobe_textures()).flatten();
    slots.map(|slot| slot.texture)
}

/// The first index of a mesh that is no vertex's, and where it stands.
fn beyond_vertices(mesh: &Mesh) -> Option<(String, u32)> {
    let lists = [
        ("indices", mesh.indices.as_slice()),
        ("lines", mesh.lines.as_flattened()),
        ("points", mesh.points.as_slice()),
    ];
    let is_beyond = |&index: &u32| index as usize >= mesh.vertices.len();
    lists.into_iter().find_map(|(name, list)| {
        // The largest is found many at a time; only a wrong list is looked through one by one.
        list.iter().copied().max().filter(is_beyond)?;
        let at = list.iter().position(is_beyond)?;
        let place = match name {
            "lines" => format!("{name}[{}][{}]", at / 2, at % 2),
            _ => format!("{name}[{at}]"),
        };
        Some((place, list[at]))
    })
}

#[cfg(test)]
mod tests {
    use foveal_scene::{ImageLight, Sheen};
    use glam::{Quat, Vec3};
    use pollster::block_on;

    use super::*;
    use crate::testing::{Film, picture, slot, small};
    use crate::{Culling, Frame};

    type Change = fn(&mut Scene);

    /// A way to break a scene with two meshes and more, and the place that the error names.
    const CHANGES: [(Change, &str); 9] = [
        (
            |s| s.instances[1].mesh = s.meshes.len() as u32,
            "instances[1].mesh is",
        ),
        (|s| s.instances[0].mesh = u32::MAX, "instances[0].mesh is"),
        (
            |s| s.instances[1].material = s.materials.len() as u32,
            "instances[1].material is",
        ),
        (
            |s| s.instances[1].object = s.objects.len() as u32,
            "instances[1].object is",
        ),
        (
            |s| s.materials[1].specular_color_texture = slot(s.textures.len() as u32),
            "a texture of materials[1] is",
        ),
        (
            |s| {
                s.materials[0].sheen = Some(Sheen {
                    color: Vec3::ONE,
                    color_texture: None,
                    roughness: 0.5,
                    roughness_texture: slot(7),
                });
            },
            "a texture of materials[0] is 7, and the scene has 0 textures",
        ),
        (
            |s| s.meshes[1].indices[4] = s.meshes[1].vertices.len() as u32,
            "meshes[1].indices[4] is",
        ),
        (
            |s| s.meshes[0].lines = vec![[0, 1], [0, u32::MAX]],
            "meshes[0].lines[1][1] is 4294967295, and the mesh has",
        ),
        (
            |s| s.meshes[0].points = vec![0, 1, 70_000],
            "meshes[0].points[2] is 70000",
        ),
    ];

    /// The renderer draws its old scene then, whichever stages would have read the new one.
    #[test]
    fn a_scene_that_names_what_it_does_not_have_is_refused() {
        let room = foveal_generate::cornell();
        assert!(check_indices(&room).is_ok());
        let settings = small(64, 48).with(|s| s.culling.mode = Culling::Occlusion);
        let mut film = Film::new(&room, &settings);
        film.draw(&room.cameras[0]);
        let before = picture(&film.renderer);
        for (change, place) in CHANGES {
            let mut broken = room.clone();
            broken.lights.clear();
            change(&mut broken);
            let error = block_on(film.renderer.set_scene(&broken)).expect_err(place);
            assert!(matches!(error, Error::Scene { .. }), "{error}");
            assert!(error.to_string().contains(place), "{error}");
            block_on(film.renderer.render(&Frame::new(&room.cameras[0]))).expect("drawn");
            assert!(picture(&film.renderer) == before, "{place}");
        }
    }

    /// Whatever environment is in force: settings may choose the scene's later.
    #[test]
    fn an_environment_that_lacks_texels_is_refused() {
        let mut room = foveal_generate::cornell();
        let mut film = Film::new(&room, &small(48, 32));
        for (side, texels) in [(4, 95), (4, 97), (4, 0), (0, 0), (0, 6), (1 << 31, 6)] {
            room.image_light = Some(ImageLight {
                name: String::new(),
                rotation: Quat::IDENTITY,
                intensity: 1.0,
                side,
                radiance: vec![[1.0; 3]; texels].into(),
                irradiance: [[0.0; 3]; 9],
            });
            let error = block_on(film.renderer.set_scene(&room)).expect_err("texels are missing");
            assert!(matches!(error, Error::Scene { .. }), "{error}");
            let named = format!("image_light.radiance has {texels} texels");
            assert!(error.to_string().contains(&named), "{error}");
        }
        film.draw(&room.cameras[0]);
    }

    #[test]
    fn an_empty_scene_names_nothing() {
        assert!(check_indices(&Scene::default()).is_ok());
    }
}
