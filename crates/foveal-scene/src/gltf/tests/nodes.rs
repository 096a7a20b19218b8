//! Nodes, instancing, cameras, lights, bounds.

use glam::{Mat4, Vec3};
use serde_json::json;

use super::{File, Loads, warnings};
use crate::{Aabb, LightKind, Projection};

#[test]
fn transforms_add_up_along_the_hierarchy() {
    let mut file = File::with_triangle();
    *file.node() = json!({ "name": "top", "translation": [1, 0, 0], "children": [1] });
    let half = std::f32::consts::FRAC_1_SQRT_2;
    file.push(
        "nodes",
        json!({ "rotation": [0, 0, half, half], "scale": [2, 2, 2], "children": [2] }),
    );
    let matrix = Mat4::from_translation(Vec3::new(0., 3., 0.)).to_cols_array();
    file.push(
        "nodes",
        json!({ "mesh": 0, "matrix": matrix, "name": "leaf", "extras": { "occluder": true, "set": "castle" } }),
    );
    let scene = file.load();
    let o = &scene.objects[0];
    assert_eq!(
        (o.name.as_str(), o.node, o.occluder),
        ("leaf", 2, Some(true))
    );
    assert_eq!(o.set.as_deref(), Some("castle"));
    // y = 3 is scaled to 6, turned to x = −6, moved to −5.
    let place = scene.instances[0].world_from_object.w_axis.truncate();
    assert!(place.abs_diff_eq(Vec3::new(-5., 0., 0.), 1e-5), "{place}");
}

#[test]
fn bounds_are_those_of_the_vertices_under_rotation_and_mirroring() {
    let mut file = File::with_triangle();
    let turn = Mat4::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let matrix = turn * Mat4::from_scale(Vec3::new(-2., 1., 1.));
    file.node()["matrix"] = json!(matrix.to_cols_array());
    let scene = file.load();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let Aabb { min, max } = scene.instances[0].bounds;
    assert!(
        min.abs_diff_eq(Vec3::new(-2. * half, -2. * half, 0.), 1e-6),
        "{min}"
    );
    assert!(max.abs_diff_eq(Vec3::new(0., half, 0.), 1e-6), "{max}");
    assert!(scene.instances[0].world_from_object.determinant() < 0.);
}

#[test]
fn gpu_instancing_makes_one_object_per_element() {
    let mut file = File::with_triangle();
    let t = file.floats(&[0., 0., 0., 10., 0., 0.], "VEC3");
    let s = file.floats(&[1., 1., 1., 3., 3., 3.], "VEC3");
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let r = file.floats(&[0., 0., 0., 1., 0., 0., half, half], "VEC4");
    file.node()["translation"] = json!([0, 5, 0]);
    file.node()["extensions"] = json!({ "EXT_mesh_gpu_instancing": {
        "attributes": { "TRANSLATION": t, "SCALE": s, "ROTATION": r },
    } });
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = file.load();
    assert_eq!(scene.objects.len(), 2);
    assert_eq!(scene.objects[1].element, 1);
    assert_eq!(scene.triangle_count(), 2);
    let b = scene.objects[1].bounds;
    assert!(b.min.abs_diff_eq(Vec3::new(7., 5., 0.), 1e-5), "{b:?}");
    assert!(b.max.abs_diff_eq(Vec3::new(10., 8., 0.), 1e-5), "{b:?}");
}

#[test]
fn instancing_attributes_of_different_lengths_make_the_fewest_elements_and_a_warning() {
    let mut file = File::with_triangle();
    let three = file.floats(&[0., 0., 0., 10., 0., 0., 20., 0., 0.], "VEC3");
    let two = file.floats(&[1.; 6], "VEC3");
    let one = file.floats(&[7.], "SCALAR");
    for (attributes, elements, warning) in [
        (
            json!({ "TRANSLATION": three, "SCALE": two }),
            2,
            "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes: have 2 to 3 elements; \
             2 instances are made",
        ),
        // What says nothing of places is left alone.
        (json!({ "TRANSLATION": three, "_ID": one }), 3, ""),
        (json!({ "_ID": two }), 2, ""),
    ] {
        let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        file.node()["extensions"] = extension;
        let scene = file.load();
        assert_eq!(scene.objects.len(), elements, "{attributes}");
        assert_eq!(warnings(&scene), warning);
    }
}

#[test]
fn cameras_lose_far_plane_and_scale() {
    let mut file = File::with_triangle();
    file.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 1, "znear": 0.5, "zfar": 9 } },
        { "type": "orthographic", "orthographic": { "xmag": 4, "ymag": 3, "znear": 0, "zfar": 10 } },
        { "type": "perspective", "perspective": { "yfov": 0, "znear": 0.5 } },
    ]);
    file.push(
        "nodes",
        json!({ "camera": 0, "name": "front", "scale": [3, 3, 3], "translation": [0, 0, 7] }),
    );
    file.push("nodes", json!({ "camera": 1 }));
    file.push("nodes", json!({ "camera": 2 }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = file.load();
    let [front, plan] = &scene.cameras[..] else {
        panic!("{:?}", scene.cameras)
    };
    assert_eq!(front.name, "front");
    assert_eq!(
        front.projection,
        Projection::Perspective {
            fov_y_rad: 1.,
            near_m: 0.5
        }
    );
    assert_eq!(
        front.world_from_view,
        Mat4::from_translation(Vec3::new(0., 0., 7.))
    );
    assert_eq!(plan.name, "camera 1");
    let slab = Projection::Orthographic {
        height_m: 6.,
        near_m: 0.,
        far_m: 10.,
    };
    assert_eq!(plan.projection, slab);
    assert!(warnings(&scene).contains("cameras[2].perspective.yfov: is 0, not above 0"));
}

#[test]
fn lights_shine_along_their_nodes_minus_z() {
    let mut file = File::with_triangle();
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "color": [1, 0.5, 0], "intensity": 40, "range": 12,
          "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.4 } },
        { "type": "directional" },
        { "type": "area" },
    ] } });
    for light in 0..3 {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        file.push(
            "nodes",
            json!({
                "translation": [light, 2, 3], "rotation": [-half, 0, 0, half], "scale": [5, 5, 5],
                "extensions": { "KHR_lights_punctual": { "light": light } },
            }),
        );
    }
    file.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = file.load();
    assert_eq!(scene.lights.len(), 2);
    let spot = &scene.lights[0];
    assert_eq!(
        spot.kind,
        LightKind::Spot {
            inner_rad: 0.2,
            outer_rad: 0.4
        }
    );
    assert_eq!(
        (spot.intensity, spot.range_m, spot.node),
        (40., Some(12.), Some(1))
    );
    assert_eq!(spot.position, Vec3::new(0., 2., 3.));
    assert!(
        spot.direction.abs_diff_eq(Vec3::NEG_Y, 1e-6),
        "{}",
        spot.direction
    );
    assert_eq!(scene.lights[1].kind, LightKind::Directional);
    assert!(warnings(&scene).contains("lights[2].type: \"area\" is not a light type"));
}

#[test]
fn only_the_default_scene_is_shown_and_hidden_nodes_are_not() {
    let mut file = File::with_triangle();
    file.push("nodes", json!({ "mesh": 0, "name": "other" }));
    file.push("nodes", json!({
        "mesh": 0, "children": [3], "extensions": { "KHR_node_visibility": { "visible": false } },
    }));
    file.push("nodes", json!({ "mesh": 0 }));
    file.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1, 2] }]);
    file.json["scene"] = json!(1);
    let scene = file.load();
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["other"]);
}

#[test]
fn cameras_of_hidden_nodes_can_be_used() {
    let mut file = File::with_triangle();
    file.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 1, "znear": 0.5 } },
    ]);
    let hidden = json!({ "KHR_node_visibility": { "visible": false } });
    file.push(
        "nodes",
        json!({ "mesh": 0, "children": [2], "extensions": hidden }),
    );
    file.push("nodes", json!({ "camera": 0, "name": "shot" }));
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = file.load();
    assert_eq!(scene.objects.len(), 1);
    let names: Vec<_> = scene.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["shot"]);
}

#[test]
fn what_lies_beyond_the_numbers_is_left_out() {
    let mut file = File::with_triangle();
    file.node()["scale"] = json!([3e38, 1, 1]);
    file.push(
        "nodes",
        json!({ "scale": [3e38, 3e38, 1], "children": [2] }),
    );
    file.push("nodes", json!({ "mesh": 0, "scale": [10, 10, 1] }));
    file.push("nodes", json!({ "mesh": 0, "scale": [0, 0, 0] }));
    file.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    let scene = file.load();
    assert_eq!(scene.objects.len(), 2);
    assert!(warnings(&scene).contains("nodes[2]: lies beyond the range"));
    assert_eq!(
        scene.objects[1].bounds,
        Aabb {
            min: Vec3::ZERO,
            max: Vec3::ZERO
        }
    );
}

#[test]
fn a_light_beyond_the_numbers_is_at_their_end() {
    let mut file = File::with_triangle();
    let lights = json!({ "lights": [{ "type": "point" }] });
    file.json["extensions"] = json!({ "KHR_lights_punctual": lights });
    let lamp = json!({ "KHR_lights_punctual": { "light": 0 } });
    file.node()["scale"] = json!([3e38, 3e38, 1]);
    file.node()["children"] = json!([1]);
    file.push(
        "nodes",
        json!({ "translation": [10, -10, 2], "extensions": lamp }),
    );
    let position = file.load().lights[0].position;
    assert_eq!(position, Vec3::new(f32::MAX, f32::MIN, 2.0));
}
