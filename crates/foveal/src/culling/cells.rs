//! What may receive shadows: the instances' boxes, large ones cut into cells, so that of a large
//! thing only the part that is seen counts.

use foveal_cull::OccludeeTree;
use foveal_scene::{Aabb, Scene};
use glam::{DVec3, UVec3, Vec3};

/// A cell's longest side is at most this part of the diagonal of the scene.
const CELLS_ALONG: f32 = 64.0;
/// Most cells of an instance along an axis, and of all instances together.
const MOST_ALONG: f32 = 64.0;
const MOST: usize = 1 << 17;

/// The cells of all instances, in the instances' order.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    /// Cells of each instance along the axes; the same in every pose.
    grids: Vec<UVec3>,
    /// World space.
    boxes: Vec<Aabb>,
    /// The object that each cell belongs to.
    pub(super) objects: Vec<u32>,
    /// Over the boxes.
    pub(super) tree: OccludeeTree,
}

impl Cells {
    pub(super) fn new(scene: &Scene) -> Self {
        let largest = scene.bounds().size().length() / CELLS_ALONG;
        let grid = |b: &Aabb| {
            let along = (b.size() / largest)
                .ceil()
                .clamp(Vec3::ONE, Vec3::splat(MOST_ALONG));
            let is_cut = b.is_valid() && along.is_finite();
            if is_cut { along.as_uvec3() } else { UVec3::ONE }
        };
        let mut grids: Vec<UVec3> = scene.instances.iter().map(|i| grid(&i.bounds)).collect();
        if grids
            .iter()
            .map(|g| g.element_product() as usize)
            .sum::<usize>()
            > MOST
        {
            grids.fill(UVec3::ONE);
        }
        let counts = grids.iter().map(|g| g.element_product() as usize);
        let objects = scene.instances.iter().zip(counts);
        let objects = objects.flat_map(|(i, count)| std::iter::repeat_n(i.object, count));
        let mut this = Self {
            objects: objects.collect(),
            grids,
            ..Self::default()
        };
        this.take_boxes(scene);
        this.tree = OccludeeTree::build(&this.plain_boxes(), DVec3::ZERO);
        this
    }

    /// Takes over a new pose.
    pub(super) fn update_pose(&mut self, scene: &Scene) {
        self.take_boxes(scene);
        let boxes = self.plain_boxes();
        if self.tree.refit(&boxes).is_err() {
            self.tree = OccludeeTree::build(&boxes, DVec3::ZERO);
        }
    }

    fn take_boxes(&mut self, scene: &Scene) {
        self.boxes.clear();
        for (grid, instance) in self.grids.iter().zip(&scene.instances) {
            let (b, size) = (&instance.bounds, instance.bounds.size());
            // Neighbours share a border to the bit.
            let border = |at: UVec3| {
                let inner = b.min + size * (at.as_vec3() / grid.as_vec3());
                Vec3::select(at.cmpeq(*grid), b.max, inner)
            };
            for i in 0..grid.element_product() {
                let at = UVec3::new(i % grid.x, i / grid.x % grid.y, i / (grid.x * grid.y));
                self.boxes.push(Aabb::new(border(at), border(at + 1)));
            }
        }
    }

    fn plain_boxes(&self) -> Vec<foveal_cull::Aabb> {
        let boxes = self.boxes.iter();
        boxes
            .map(|b| foveal_cull::Aabb::new(b.min, b.max))
            .collect()
    }

    /// World space.
    pub(crate) fn boxes(&self) -> &[Aabb] {
        &self.boxes
    }
}
