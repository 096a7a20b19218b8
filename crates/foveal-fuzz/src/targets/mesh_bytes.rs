//! Baked meshes as bytes: refused, or a mesh that draws the same by every instruction set.

use std::sync::Arc;

use foveal_cull::testing::seal_mesh_bytes;
use foveal_cull::{
    Aabb, Affine, BakeOptions, Culler, FrameOptions, InstructionSet, OccluderMesh, OccluderSet,
    SingleThread, View,
};

use super::scenes::{Random, scene};

/// Reads the bytes as they are, and with a length and a checksum that fit.
pub fn mesh_bytes(input: &[u8]) {
    let mut sealed = input.to_vec();
    seal_mesh_bytes(&mut sealed);
    for bytes in [input, &sealed] {
        if let Ok(mesh) = OccluderMesh::from_bytes(bytes) {
            draw(mesh);
        }
    }
}

fn draw(mesh: OccluderMesh) {
    let bounds = mesh.bounds();
    let again = OccluderMesh::from_bytes(&mesh.to_bytes());
    assert!(again.is_ok_and(|m| m.bounds() == bounds), "bytes of a mesh");
    let mut set = OccluderSet::new();
    if set.add(Arc::new(mesh), Affine::IDENTITY).is_err() {
        return;
    }
    let [eye, target, up] = [[0.3, 0.2, 6.0], [0.0; 3], [0.0, 1.0, 0.0]];
    let view = View::perspective(eye, target, up, 1.0, 1.25, 0.1);
    // With a radius the mesh's adjacency is read too.
    for view in [view, view.with_validity_radius(0.05)] {
        draw_from(&view, &set);
    }
}

fn draw_from(view: &View, set: &OccluderSet) {
    let Ok(mut culler) = Culler::new(40, 32) else {
        panic!("a culler of 40 x 32 pixels");
    };
    let mut first: Option<Vec<u32>> = None;
    for instruction_set in InstructionSet::available() {
        culler.set_instruction_set(instruction_set);
        // Numbers may be too large for this view.
        let drawn = culler.rasterize(view, set, &FrameOptions::default(), &SingleThread);
        let mut depth = [0.0; 40 * 32];
        assert_eq!(culler.read_depth(&mut depth), Ok(()));
        let bits: Vec<u32> = depth
            .iter()
            .map(|d| d.to_bits())
            .chain([u32::from(drawn.is_ok())])
            .collect();
        match &first {
            Some(first) => assert!(*first == bits, "{instruction_set:?} draws something else"),
            None => first = Some(bits),
        }
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    let unit = Aabb::new([-1.0; 3], [1.0; 3]);
    seeds.extend(OccluderMesh::from_box(unit).map(|mesh| mesh.to_bytes()));
    let scene = scene(&mut Random::new(3), 6, 0, glam::DVec3::ZERO);
    for (i, object) in scene.objects.iter().enumerate() {
        let options = BakeOptions::default()
            .with_two_sided(object.two_sided)
            .with_adjacency(i % 2 == 0);
        let baked = OccluderMesh::bake(&object.positions, &object.indices, options);
        seeds.extend(baked.map(|mesh| mesh.to_bytes()));
    }
    seeds
}
