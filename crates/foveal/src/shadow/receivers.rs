//! What the camera sees in a frame, and since when it has seen it without a break.

use foveal_scene::Aabb;

/// What a frame's shadows may fall on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Receivers {
    /// Instances, by number: shadows are drawn with all casters.
    Instances(Vec<u32>),
    /// Cells of the scene ([`crate::culling::CullingScene`]), by number, ascending: casters whose
    /// shadows fall on none of them are left out.
    Cells(Vec<u32>),
}

impl Receivers {
    pub(super) fn numbers(&self) -> &[u32] {
        match self {
            Self::Instances(numbers) | Self::Cells(numbers) => numbers,
        }
    }
}

/// Since which frame each cell has been seen, without a break and at the same place.
#[derive(Debug, Default)]
pub(super) struct SeenSince {
    cells: Vec<Since>,
}

#[derive(Clone, Copy, Debug)]
struct Since {
    first: u64,
    last: u64,
    at: Aabb,
}

impl SeenSince {
    /// These cells are seen in a frame; frames count from 1 without gaps.
    pub(super) fn see(&mut self, frame: u64, seen: &[u32], boxes: &[Aabb]) {
        const NEVER: Since = Since {
            first: 0,
            last: 0,
            at: Aabb::EMPTY,
        };
        self.cells.resize(boxes.len(), NEVER);
        for &cell in seen {
            let (since, at) = (&mut self.cells[cell as usize], boxes[cell as usize]);
            if since.last + 1 != frame || since.at != at {
                since.first = frame;
            }
            *since = Since {
                last: frame,
                at,
                ..*since
            };
        }
    }

    /// Whether a cell that is seen now was seen in that earlier frame, at the same place.
    pub(super) fn was_seen(&self, cell: u32, frame: u64) -> bool {
        self.cells[cell as usize].first <= frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_cell_that_was_away_or_has_moved_is_new() {
        let at = |x: f32| Aabb::new(Vec3::splat(x), Vec3::splat(x + 1.0));
        let mut seen = SeenSince::default();
        seen.see(1, &[0, 1], &[at(0.0), at(1.0), at(2.0)]);
        seen.see(2, &[0, 2], &[at(0.0), at(1.0), at(2.0)]);
        seen.see(3, &[0, 1, 2], &[at(0.5), at(1.0), at(2.0)]);
        assert!(!seen.was_seen(0, 2), "it has moved");
        assert!(!seen.was_seen(1, 1), "it was away");
        assert!(seen.was_seen(2, 2) && !seen.was_seen(2, 1));
    }
}
