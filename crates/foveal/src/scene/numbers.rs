//! A scene's numbers, which may come from a program's own code: those that must be finite. One light
//! that is no number would take the light of all others with it, one box without an end the sun's
//! shadows. Vertices are not looked at: a wrong one spoils its triangles alone.

use foveal_scene::{Aabb, AlphaMode, ImageLight, Light, LightKind, Material, Scene};

use crate::Error;

/// Refuses numbers that are not finite where they must be, and an environment that is turned by no
/// rotation.
///
/// # Errors
/// [`Error::Scene`] for the first of them.
pub(super) fn check_numbers(scene: &Scene) -> Result<(), Error> {
    let refused = |cause| Err(Error::Scene { cause });
    let in_list = |list: &str, number: usize, name: &str| {
        refused(format!("{list}[{number}].{name} is not finite"))
    };
    for (number, instance) in scene.instances.iter().enumerate() {
        if !instance.world_from_object.is_finite() {
            return in_list("instances", number, "world_from_object");
        }
        if !has_end(instance.bounds) {
            return in_list("instances", number, "bounds");
        }
    }
    if let Some(number) = scene.objects.iter().position(|o| !has_end(o.bounds)) {
        return in_list("objects", number, "bounds");
    }
    for (number, light) in scene.lights.iter().enumerate() {
        if let Some(name) = wrong_in_light(light) {
            return in_list("lights", number, name);
        }
    }
    for (number, material) in scene.materials.iter().enumerate() {
        if let Some(name) = wrong_in_material(material) {
            return in_list("materials", number, name);
        }
    }
    let sky = &scene.environment;
    if ![sky.zenith, sky.horizon, sky.nadir]
        .iter()
        .all(|c| c.is_finite())
    {
        return refused("environment is not finite".to_owned());
    }
    let wrong = scene.image_light.as_ref().and_then(wrong_in_image_light);
    wrong.map_or(Ok(()), |what| refused(format!("image_light.{what}")))
}

/// A box that is empty is around nothing.
fn has_end(b: Aabb) -> bool {
    b.is_empty() || b.is_valid()
}

/// The first that is wrong.
fn first<const N: usize>(fields: [(&'static str, bool); N]) -> Option<&'static str> {
    let wrong = fields.into_iter().find(|(_, is_sound)| !is_sound);
    wrong.map(|(name, _)| name)
}

fn wrong_in_light(light: &Light) -> Option<&'static str> {
    let angles = match light.kind {
        LightKind::Spot {
            inner_rad,
            outer_rad,
        } => inner_rad.is_finite() && outer_rad.is_finite(),
        LightKind::Directional | LightKind::Point => true,
    };
    first([
        ("color", light.color.is_finite()),
        ("intensity", light.intensity.is_finite()),
        ("position", light.position.is_finite()),
        ("direction", light.direction.is_finite()),
        // Infinite is as good as none.
        ("range_m", !light.range_m.is_some_and(f32::is_nan)),
        ("kind", angles),
    ])
}

fn wrong_in_material(material: &Material) -> Option<&'static str> {
    let cutoff = match material.alpha_mode {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.0,
    };
    first([
        ("base_color", material.base_color.is_finite()),
        ("metallic", material.metallic.is_finite()),
        ("roughness", material.roughness.is_finite()),
        ("ior", material.ior.is_finite()),
        ("specular", material.specular.is_finite()),
        ("specular_color", material.specular_color.is_finite()),
        ("normal_scale", material.normal_scale.is_finite()),
        (
            "occlusion_strength",
            material.occlusion_strength.is_finite(),
        ),
        ("emissive", material.emissive.is_finite()),
        ("alpha_mode", cutoff.is_finite()),
    ])
}

/// Its radiance is brought into range where it is filtered.
fn wrong_in_image_light(light: &ImageLight) -> Option<&'static str> {
    let irradiance = light.irradiance.as_flattened();
    let length = light.rotation.length();
    first([
        (
            "rotation is no rotation",
            length.is_finite() && length > 1e-6,
        ),
        ("intensity is not finite", light.intensity.is_finite()),
        (
            "irradiance is not finite",
            irradiance.iter().all(|v| v.is_finite()),
        ),
    ])
}

#[cfg(test)]
mod tests {
    use foveal_generate as generate;
    use glam::{Quat, Vec3};
    use pollster::block_on;

    use super::*;
    use crate::testing::{Film, picture, small};
    use crate::{Culling, Shadows};

    type Change = fn(&mut Scene);

    fn endless() -> Aabb {
        Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY)
    }

    fn surroundings() -> ImageLight {
        ImageLight {
            name: String::new(),
            rotation: Quat::IDENTITY,
            intensity: 1.0,
            side: 1,
            radiance: vec![[f32::NAN; 3]; 6].into(),
            irradiance: [[0.0; 3]; 9],
        }
    }

    const CHANGES: [(Change, &str); 14] = [
        (
            |s| s.instances[1].world_from_object.x_axis.y = f32::NAN,
            "instances[1].world_from_object",
        ),
        (|s| s.instances[2].bounds = endless(), "instances[2].bounds"),
        (|s| s.objects[3].bounds = endless(), "objects[3].bounds"),
        (|s| s.lights[2].color.y = f32::NAN, "lights[2].color"),
        (
            |s| s.lights[0].intensity = f32::INFINITY,
            "lights[0].intensity",
        ),
        (|s| s.lights[1].position.x = f32::NAN, "lights[1].position"),
        (|s| s.lights[5].direction = Vec3::NAN, "lights[5].direction"),
        (
            |s| s.lights[1].range_m = Some(f32::NAN),
            "lights[1].range_m",
        ),
        (
            |s| {
                s.lights[0].kind = LightKind::Spot {
                    inner_rad: 0.0,
                    outer_rad: f32::NAN,
                }
            },
            "lights[0].kind",
        ),
        (
            |s| s.materials[1].emissive = Vec3::INFINITY,
            "materials[1].emissive",
        ),
        (
            |s| s.materials[0].alpha_mode = AlphaMode::Mask { cutoff: f32::NAN },
            "materials[0].alpha_mode",
        ),
        (|s| s.environment.zenith = Vec3::NAN, "environment"),
        (
            |s| {
                s.image_light = Some(ImageLight {
                    rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
                    ..surroundings()
                })
            },
            "image_light.rotation is no rotation",
        ),
        (
            |s| {
                s.image_light = Some(ImageLight {
                    intensity: f32::NAN,
                    ..surroundings()
                })
            },
            "image_light.intensity",
        ),
    ];

    /// Scenes and poses: the old ones are drawn then.
    #[test]
    fn numbers_that_are_not_finite_are_refused_by_place() {
        let room = generate::cornell();
        let settings = small(48, 32).with(|s| {
            s.culling.mode = Culling::Occlusion;
            s.lighting.shadows = Shadows::Hard;
            s.lighting.shadow_atlas = 256;
        });
        let mut film = Film::new(&room, &settings);
        film.draw(&room.cameras[0]);
        let before = picture(&film.renderer);
        for (change, place) in CHANGES {
            let mut broken = room.clone();
            change(&mut broken);
            let set = block_on(film.renderer.set_scene(&broken)).expect_err(place);
            let posed = block_on(film.renderer.update_pose(&broken)).expect_err(place);
            for error in [set, posed] {
                assert!(matches!(error, Error::Scene { .. }), "{error}");
                assert!(error.to_string().contains(place), "{error}");
            }
            film.draw(&room.cameras[0]);
            assert!(picture(&film.renderer) == before, "{place}");
        }
    }

    #[test]
    fn lights_without_end_and_empty_boxes_are_sound() {
        let mut room = generate::cornell();
        room.lights[0].range_m = Some(f32::INFINITY);
        room.instances[0].bounds = Aabb::EMPTY;
        room.objects[0].bounds = Aabb::EMPTY;
        room.image_light = Some(surroundings());
        check_numbers(&room).expect("all is sound");
    }
}
