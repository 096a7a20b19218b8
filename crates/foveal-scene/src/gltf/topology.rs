//! Lists of triangles, lines and points from lists, strips, loops and fans, with or without indices.

use super::meshes::Mode;

/// Corners of all triangles, three by three in the winding that glTF gives them, of all lines, two by
/// two, or of all points.
///
/// Ends that do not make up a whole one are dropped, as GPUs do.
pub(crate) fn lists(mode: Mode, indices: Option<Vec<u32>>, vertex_count: usize) -> Vec<u32> {
    let mut corners = indices.unwrap_or_else(|| (0..vertex_count as u32).collect());
    match mode {
        Mode::Points | Mode::Lines | Mode::Triangles => {
            corners.truncate(corners.len() / mode.corners() * mode.corners());
            corners
        }
        Mode::LineStrip => corners.windows(2).flatten().copied().collect(),
        Mode::LineLoop => match corners[..] {
            [first, .., last] => {
                let open = corners.windows(2).flatten().copied();
                open.chain([last, first]).collect()
            }
            _ => Vec::new(),
        },
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_loops_and_fans_unroll_as_the_specification_says() {
        let of = |mode, n| lists(mode, None, n);
        assert_eq!(of(Mode::Triangles, 7), [0, 1, 2, 3, 4, 5]);
        assert_eq!(of(Mode::Strip, 5), [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        assert_eq!(of(Mode::Fan, 5), [1, 2, 0, 2, 3, 0, 3, 4, 0]);
        for mode in [Mode::Triangles, Mode::Strip, Mode::Fan] {
            for n in 0..3 {
                assert!(of(mode, n).is_empty());
            }
        }
        let indexed = lists(Mode::Strip, Some(vec![9, 8, 7, 6]), 10);
        assert_eq!(indexed, [9, 8, 7, 8, 6, 7]);
        assert_eq!(of(Mode::Points, 3), [0, 1, 2]);
        assert_eq!(of(Mode::Lines, 5), [0, 1, 2, 3]);
        assert_eq!(of(Mode::LineStrip, 4), [0, 1, 1, 2, 2, 3]);
        assert_eq!(of(Mode::LineLoop, 4), [0, 1, 1, 2, 2, 3, 3, 0]);
        for mode in [Mode::Lines, Mode::LineStrip, Mode::LineLoop] {
            for n in 0..2 {
                assert!(of(mode, n).is_empty());
            }
        }
    }

    #[test]
    fn lists_have_no_more_corners_than_announced() {
        let all = [Mode::Points, Mode::Lines, Mode::LineLoop, Mode::LineStrip];
        for mode in all
            .into_iter()
            .chain([Mode::Triangles, Mode::Strip, Mode::Fan])
        {
            for n in 0..9 {
                let corners = lists(mode, None, n).len();
                assert!(
                    corners as u64 <= mode.corners_in_lists(n as u64),
                    "{mode:?}"
                );
                assert_eq!(corners % mode.corners(), 0, "{mode:?}");
            }
        }
    }
}
