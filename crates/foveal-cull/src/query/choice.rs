//! Whether a hierarchy or a list takes less time.
//!
//! A list classifies a box in a few nanoseconds. A walk leaves out groups at once, but what it opens
//! takes longer than in a list. So the upper levels are looked at first.

use super::classify::Query;
use super::tree::OccludeeTree;
use crate::simd::{Kernel, Lanes};

/// A tree takes less time than a list where the objects that it has to open, and `MORE`, are at most
/// this part of all. Read in a town from ten cameras, with 2,000 to 100,000 boxes
/// (docs/decisions/0121-tree-or-list.md). One rule for all instruction sets, so that their results are
/// the same.
const PART: f64 = 0.58;
const MORE: usize = 2000;

/// Whether a tree takes less time than a list if so many of all objects are open.
pub(super) fn tree_pays(open: usize, all: usize) -> bool {
    (open + MORE) as f64 <= PART * all as f64
}

/// The kernel that looks at a tree's upper levels and says how many objects lie where the coarse test
/// culls nothing: about what a walk has to open. None without a coarse test.
pub(crate) struct OpenObjects<'a> {
    pub(crate) query: &'a Query<'a>,
    pub(crate) tree: &'a OccludeeTree,
}

/// Most nodes of a level that are looked at, and objects per node.
const LEVEL: usize = 64;
const OBJECTS_PER_NODE: usize = 256;

impl Kernel for OpenObjects<'_> {
    type Output = Option<usize>;

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, l: L) -> Option<usize> {
        let (coarse, w) = (self.query.coarse_test()?, l.wide());
        let nodes = self.tree.nodes();
        let most = (self.tree.len() / OBJECTS_PER_NODE).clamp(8, LEVEL);
        let (mut level, mut below) = ([0; 8 * LEVEL], [0; 8 * LEVEL]);
        let mut count = usize::from(!nodes.is_empty());
        // Objects that are nodes' children, and those in the groups of the last level.
        let (mut objects, mut in_groups) = (0, 0);
        while (1..=most).contains(&count) {
            let mut groups = 0;
            in_groups = 0;
            for pair in level[..count].chunks(2) {
                let two = [pair[0], pair[pair.len() - 1]].map(|n: u32| &nodes[n as usize]);
                let mut nodes16 = coarse.classify_nodes(w, two.map(|n| &n.boxes), 0.0);
                nodes16.coarse.fetch(coarse.hiz);
                let culled = nodes16.coarse.outside | nodes16.coarse.hidden(w);
                for (k, node) in two.iter().enumerate().take(pair.len()) {
                    let open = node.lanes & !(culled >> (8 * k)) as u8;
                    objects += (open & node.objects).count_ones() as usize;
                    for lane in node
                        .children()
                        .filter(|lane| (open & !node.objects) >> lane & 1 != 0)
                    {
                        in_groups += node.run(lane).len();
                        below[groups] = node.child(lane);
                        groups += 1;
                    }
                }
            }
            (level, count) = (below, groups);
        }
        Some(objects + if count > 0 { in_groups } else { 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Culler, Eye, FrameOptions, OccluderMesh, OccluderSet, Projection};
    use crate::{SingleThread, View, Visibility};
    use glam::{DAffine3, DVec3};
    use std::sync::Arc;

    /// Two blocks of 20 x 20 x 10 boxes, one of them behind a wall, as an eye between them sees them
    /// that looks along `axis`.
    fn open_objects(axis: DVec3) -> [usize; 2] {
        let boxes: Vec<Aabb> = (0..8000)
            .map(|i| {
                let side = if i % 2 == 0 { 20.0 } else { -20.0 };
                let n = i / 2;
                let at = [n % 20, n / 20 % 20, n / 400].map(|v| v as f32 - 10.0);
                let at = [at[0] * 0.5, at[1] * 0.5, side + at[2] * 0.5];
                Aabb::new(at, at.map(|v| v + 0.3))
            })
            .collect();
        let wall = OccluderMesh::from_box(Aabb::new([-60.0, -60.0, 9.0], [60.0, 60.0, 10.0]));
        let mut occluders = OccluderSet::new();
        occluders
            .add(Arc::new(wall.unwrap()), DAffine3::IDENTITY)
            .unwrap();
        let projection = Projection::perspective(1.2, 1.0, 0.1, f64::INFINITY);
        let eye = Eye::look_at(DVec3::ZERO, axis, DVec3::Y, projection);
        let mut culler = Culler::new(128, 128).unwrap();
        let options = FrameOptions::default();
        culler
            .rasterize(&View::mono(eye), &occluders, &options, &SingleThread)
            .unwrap();
        let tree = OccludeeTree::build(&boxes, DVec3::ZERO);
        let open = culler.open_objects_of(&tree);
        let mut results = vec![Visibility::Occluded; boxes.len()];
        culler.query(&boxes, DVec3::ZERO, &mut results).unwrap();
        let visible = results.iter().filter(|r| r.is_visible()).count();
        [open, visible]
    }

    #[test]
    fn what_is_visible_is_open_and_what_is_hidden_or_outside_is_not() {
        let [open, visible] = open_objects(DVec3::NEG_Z);
        assert!(visible > 400 && open >= visible, "{open} {visible}");
        assert!(open <= 4000, "one block is behind the eye");
        assert_eq!(open_objects(DVec3::Z), [0, 0], "behind the wall");
        assert_eq!(open_objects(DVec3::NEG_X), [0, 0], "beside the screen");
    }

    #[test]
    fn few_objects_and_open_ones_are_a_list() {
        assert!(!tree_pays(0, 3000) && tree_pays(0, 4000));
        assert!(tree_pays(9000, 25_000) && !tree_pays(20_000, 25_000));
    }
}
