//! Triangle lists from lists, strips and fans, with or without indices.

use super::meshes::Mode;

/// Corners of all triangles, three by three, in the winding that glTF gives them.
///
/// Ends that do not make up a triangle are dropped, as GPUs do.
pub(crate) fn triangles(mode: Mode, indices: Option<Vec<u32>>, vertex_count: usize) -> Vec<u32> {
    let mut corners = indices.unwrap_or_else(|| (0..vertex_count as u32).collect());
    match mode {
        Mode::Triangles => {
            corners.truncate(corners.len() / 3 * 3);
            corners
        }
        // Every second triangle of a strip is turned to keep the winding.
        Mode::Strip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| [w[0], w[1 + i % 2], w[2 - i % 2]])
            .collect(),
        Mode::Fan => match corners.split_first() {
            Some((&hub, rim)) => rim.windows(2).flat_map(|w| [w[0], w[1], hub]).collect(),
            None => Vec::new(),
        },
        Mode::NoTriangles => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_unroll_with_the_winding_of_the_specification() {
        let of = |mode, n| triangles(mode, None, n);
        assert_eq!(of(Mode::Triangles, 7), [0, 1, 2, 3, 4, 5]);
        assert_eq!(of(Mode::Strip, 5), [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        assert_eq!(of(Mode::Fan, 5), [1, 2, 0, 2, 3, 0, 3, 4, 0]);
        for mode in [Mode::Triangles, Mode::Strip, Mode::Fan, Mode::NoTriangles] {
            for n in 0..3 {
                assert!(of(mode, n).is_empty());
            }
        }
        let indexed = triangles(Mode::Strip, Some(vec![9, 8, 7, 6]), 10);
        assert_eq!(indexed, [9, 8, 7, 8, 6, 7]);
    }
}
