//! Indices by which a vertex knows its triangle, for devices that do not number triangles in the
//! fragment shader, or that take long to.
//!
//! A triangle's first vertex provokes it: values that are not interpolated are taken from there. So
//! that each triangle has a first vertex of its own, indices name either a triangle's first corner or
//! a vertex: `2 t` is the first corner of triangle t, `2 v + 1` is vertex v. A corner that is the
//! first of some triangle is always named as one of those, and not computed once more as a vertex.
//! Shader: `geometry/visibility/pulled.wgsl`.

/// What draws of a mesh's triangles take in place of its `indices`. `first_triangle`: the number of
/// its first triangle among all of the scene; `base_vertex`: that of its first vertex of
/// `vertex_count`. Indices beyond these give what is not there, as they do on the device.
pub(super) fn provoking_indices(
    indices: &[u32],
    first_triangle: u32,
    (base_vertex, vertex_count): (u32, usize),
) -> impl Iterator<Item = u32> + '_ {
    let mut provoked = vec![None; vertex_count];
    for (triangle, corners) in (first_triangle..).zip(indices.chunks_exact(3)) {
        if let Some(slot) = provoked.get_mut(corners[0] as usize) {
            *slot = Some(triangle);
        }
    }
    (0..).zip(indices).map(move |(i, &vertex)| {
        let triangle = if i % 3 == 0 {
            Some(first_triangle + i / 3)
        } else {
            provoked.get(vertex as usize).copied().flatten()
        };
        match triangle {
            Some(triangle) => 2 * triangle,
            None => base_vertex.wrapping_add(vertex).wrapping_mul(2) | 1,
        }
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    /// What the shader makes of an index: a vertex, and the triangle that it provokes.
    fn decoded(index: u32, indices: &[u32], first: u32, base: u32) -> (u32, Option<u32>) {
        if index & 1 == 0 {
            let triangle = index / 2 - first;
            (indices[3 * triangle as usize], Some(triangle))
        } else {
            (index / 2 - base, None)
        }
    }

    proptest! {
        #[test]
        fn corners_are_those_of_the_mesh_and_the_first_one_names_its_triangle(
            triangles in prop::collection::vec([0..40_u32, 0..40, 0..40], 0..60),
            first in 0..1000_u32,
            base in 0..1000_u32,
        ) {
            let indices = triangles.as_flattened();
            let provoking: Vec<_> = provoking_indices(indices, first, (base, 40)).collect();
            prop_assert_eq!(provoking.len(), indices.len());
            for (i, (&index, &vertex)) in provoking.iter().zip(indices).enumerate() {
                let (named, triangle) = decoded(index, indices, first, base);
                prop_assert_eq!(named, vertex);
                if i % 3 == 0 {
                    prop_assert_eq!(triangle, Some(i as u32 / 3));
                }
            }
            // A vertex of its own for each triangle, and one for each that is the first of none.
            let own: BTreeSet<_> = triangles.iter().map(|t| t[0]).collect();
            let other: BTreeSet<_> = indices.iter().filter(|v| !own.contains(v)).collect();
            let computed: BTreeSet<_> = provoking.iter().collect();
            prop_assert_eq!(computed.len(), triangles.len() + other.len());
        }
    }

    #[test]
    fn an_index_beyond_the_vertices_is_no_panic() {
        for wrong in [3, u32::MAX / 2, u32::MAX] {
            let indices = [wrong, 1, 2, 0, wrong, 1];
            let found: Vec<_> = provoking_indices(&indices, 7, (5, 3)).collect();
            assert_eq!([found[0], found[3]], [14, 16]);
            assert_eq!(found[4] & 1, 1);
        }
    }
}
