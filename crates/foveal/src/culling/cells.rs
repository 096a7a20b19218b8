//! What may receive shadows: the instances, large ones in parts, so that of a large thing only what
//! is seen counts.

use std::collections::HashMap;

use foveal_cull::OccludeeTree;
use foveal_scene::{Aabb, Instance, Scene};
use glam::{DVec3, Mat4, UVec3, Vec3};

use super::surface::parts;

/// A cell's sides are about as long as this part of the diagonal of the scene.
const CELLS_ALONG: f32 = 64.0;
/// Most cells of an instance along an axis, and of all instances together: where there would be
/// more, cells are twice as large.
const MOST_ALONG: u32 = 64;
const MOST: usize = 1 << 17;
/// Most looks into cells for all meshes, beyond one for each triangle.
const MOST_LOOKS: f32 = (1 << 26) as f32;

/// What a part of an instance may be moved by as numbers are rounded, as a share of the terms that
/// make up its place.
const ROUNDING: f32 = 1e-6;

/// How an instance is cut; the same in every pose.
#[derive(Debug)]
enum Cut {
    /// Its box in world space into a grid: its shape changes.
    Box(UVec3),
    /// Boxes in object space around the parts of its surface.
    Surface(Vec<Aabb>),
}

impl Cut {
    fn count(&self) -> usize {
        match self {
            Self::Box(grid) => grid.element_product() as usize,
            Self::Surface(parts) => parts.len(),
        }
    }
}

/// An instance.
#[derive(Debug)]
struct Owner {
    /// Its number in the list of cuts.
    cut: u32,
    object: u32,
    /// It has points or lines, which are drawn whatever culling says of its box.
    has_strokes: bool,
}

/// The cells of all instances, in the instances' order.
#[derive(Debug)]
pub(crate) struct Cells {
    cuts: Vec<Cut>,
    owners: Vec<Owner>,
    /// Of which pose all below is; `None` before cells are first needed.
    pose: Option<u64>,
    /// The box and place of each instance.
    places: Vec<(Aabb, Mat4)>,
    /// World space.
    boxes: Vec<Aabb>,
    plain_boxes: Vec<foveal_cull::Aabb>,
    /// The instance that each cell belongs to.
    of: Vec<u32>,
    /// Over the boxes.
    tree: OccludeeTree,
}

impl Cells {
    /// Looks at the meshes; places no cells. `None` where there are more instances than cells may
    /// be.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        if scene.instances.len() > MOST {
            return None;
        }
        let diagonal = scene.bounds().size().length();
        let sizes = std::iter::successors(Some(CELLS_ALONG), |along| Some(0.5 * along));
        sizes
            .take_while(|along| *along >= 0.5)
            .find_map(|along| Self::of_size(scene, diagonal / along))
    }

    /// `None` where there are too many cells.
    fn of_size(scene: &Scene, side: f32) -> Option<Self> {
        let mut cuts: Vec<Cut> = Vec::new();
        let mut known = HashMap::new();
        let mut looks = MOST_LOOKS;
        let (mut owners, mut count) = (Vec::new(), 0);
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            let grid = grid(mesh.deforms, &mesh.bounds, instance, side);
            let cut = *known.entry((instance.mesh, grid)).or_insert_with(|| {
                let parts = if mesh.deforms {
                    None
                } else {
                    parts(mesh, grid, &mut looks)
                };
                cuts.push(parts.map_or(Cut::Box(grid), Cut::Surface));
                cuts.len() - 1
            });
            count += cuts[cut].count();
            if count > MOST {
                return None;
            }
            owners.push(Owner {
                cut: cut as u32,
                object: instance.object,
                has_strokes: mesh.stroke_count() > 0,
            });
        }
        Some(Self {
            owners,
            cuts,
            pose: None,
            places: Vec::new(),
            boxes: Vec::new(),
            plain_boxes: Vec::new(),
            of: Vec::new(),
            tree: OccludeeTree::default(),
        })
    }

    fn cut(&self, owner: &Owner) -> &Cut {
        &self.cuts[owner.cut as usize]
    }

    /// Brings the cells to a pose, of which `instances` gives the boxes and places.
    pub(super) fn place(&mut self, pose: u64, instances: impl Iterator<Item = (Aabb, Mat4)>) {
        let before = self.pose.replace(pose);
        if before == Some(pose) {
            return;
        }
        if before.is_none() {
            let of = (0..).zip(&self.owners);
            let of = of.map(|(i, o)| std::iter::repeat_n(i, self.cut(o).count()));
            self.of = of.flatten().collect();
            self.boxes = vec![Aabb::EMPTY; self.of.len()];
            let nowhere = foveal_cull::Aabb::new(Vec3::ZERO, Vec3::ZERO);
            self.plain_boxes = vec![nowhere; self.of.len()];
            self.places.clear();
        }
        let (mut first, mut has_moved) = (0, false);
        for (number, (owner, place)) in self.owners.iter().zip(instances).enumerate() {
            let cut = &self.cuts[owner.cut as usize];
            let cells = first..first + cut.count();
            first = cells.end;
            match self.places.get_mut(number) {
                Some(before) if *before == place => continue,
                Some(before) => *before = place,
                None => self.places.push(place),
            }
            has_moved = true;
            let (bounds, world_from_object) = place;
            let boxes = &mut self.boxes[cells.clone()];
            match cut {
                Cut::Box(grid) => cut_box(&bounds, *grid, boxes),
                Cut::Surface(parts) => {
                    for (to, part) in boxes.iter_mut().zip(parts) {
                        *to = placed(part, &bounds, world_from_object);
                    }
                }
            }
            for (to, b) in self.plain_boxes[cells].iter_mut().zip(boxes) {
                *to = foveal_cull::Aabb::new(b.min, b.max);
            }
        }
        let is_old = before.is_some() && self.tree.len() == self.plain_boxes.len();
        if is_old && (!has_moved || self.tree.refit(&self.plain_boxes).is_ok()) {
            return;
        }
        self.tree = OccludeeTree::build(&self.plain_boxes, DVec3::ZERO);
    }

    /// World space; empty before cells are first needed.
    pub(crate) fn boxes(&self) -> &[Aabb] {
        &self.boxes
    }

    pub(super) fn tree(&self) -> &OccludeeTree {
        &self.tree
    }

    /// The cells that are drawn, in ascending order: of the objects that are, those that `is_seen`;
    /// and all of points and lines, which reach beyond their boxes.
    pub(super) fn drawn(
        &self,
        is_drawn: impl Fn(u32) -> bool,
        is_seen: impl Fn(usize) -> bool,
    ) -> Vec<u32> {
        let owner = |cell: usize| &self.owners[self.of[cell] as usize];
        (0..self.boxes.len())
            .filter(|&cell| {
                let owner = owner(cell);
                owner.has_strokes || (is_drawn(owner.object) && is_seen(cell))
            })
            .map(|cell| cell as u32)
            .collect()
    }
}

/// Cells along the axes of an instance's box, powers of two: few meshes are cut in many ways.
fn grid(deforms: bool, mesh: &Aabb, instance: &Instance, side: f32) -> UVec3 {
    let size = if deforms {
        instance.bounds.size()
    } else {
        let m = &instance.world_from_object;
        let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate().length());
        mesh.size() * Vec3::from(scale)
    };
    let along = size / side;
    if !along.is_finite() {
        return UVec3::ONE;
    }
    let of = |cells: f32| 2.0_f32.powf(cells.max(1.0).log2().round()) as u32;
    UVec3::from(along.to_array().map(of)).min(UVec3::splat(MOST_ALONG))
}

fn cut_box(b: &Aabb, grid: UVec3, to: &mut [Aabb]) {
    if !b.is_valid() || !b.size().is_finite() {
        return to.fill(*b);
    }
    // Neighbours share a border to the bit.
    let border = |at: UVec3| {
        let inner = b.min + b.size() * (at.as_vec3() / grid.as_vec3());
        Vec3::select(at.cmpeq(grid), b.max, inner)
    };
    for (i, to) in (0..).zip(to) {
        let at = UVec3::new(i % grid.x, i / grid.x % grid.y, i / (grid.x * grid.y));
        *to = Aabb::new(border(at), border(at + 1));
    }
}

/// A part of an instance in world space, where the instance has these bounds.
fn placed(part: &Aabb, bounds: &Aabb, world_from_object: Mat4) -> Aabb {
    let b = part.transformed(world_from_object);
    if !bounds.is_valid() || !b.is_valid() {
        return *bounds;
    }
    let within = Aabb::new(b.min.max(bounds.min), b.max.min(bounds.max));
    let b = if within.is_valid() { within } else { b };
    let m = &world_from_object;
    let reach = part.min.abs().max(part.max.abs());
    let terms = m.x_axis.abs() * reach.x + m.y_axis.abs() * reach.y + m.z_axis.abs() * reach.z;
    let grown = ROUNDING * (terms + m.w_axis.abs()).truncate();
    Aabb::new(b.min - grown, b.max + grown)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(scene: &Scene) -> Cells {
        let mut cells = Cells::new(scene).unwrap();
        let instances = scene.instances.iter();
        cells.place(1, instances.map(|i| (i.bounds, i.world_from_object)));
        cells
    }

    /// Corners of triangles and middles between them lie in cells of their instance.
    fn assert_holds(scene: &Scene, cells: &Cells) {
        let boxes: HashMap<u32, Vec<Aabb>> = {
            let mut boxes: HashMap<u32, Vec<Aabb>> = HashMap::new();
            for (of, b) in cells.of.iter().zip(&cells.boxes) {
                boxes.entry(*of).or_default().push(*b);
            }
            boxes
        };
        for (number, instance) in (0..).zip(&scene.instances) {
            let mesh = &scene.meshes[instance.mesh as usize];
            for t in mesh.indices.chunks_exact(3).step_by(7) {
                let at = |i: u32| {
                    let p = mesh.vertices[i as usize].position.into();
                    instance.world_from_object.transform_point3(p)
                };
                let [a, b, c] = [at(t[0]), at(t[1]), at(t[2])];
                for p in [a, (a + b) * 0.5, (a + b + c) / 3.0] {
                    let holds = |b: &Aabb| p.cmpge(b.min).all() && p.cmple(b.max).all();
                    assert!(boxes[&number].iter().any(holds), "{p} of {number}");
                }
            }
        }
    }

    #[test]
    fn cells_hold_every_surface_in_every_pose() {
        let options = foveal_generate::DemoOptions {
            instances: 1_000,
            lights: 1,
            ..Default::default()
        };
        let mut scene = foveal_generate::demo(&options).unwrap();
        let mut cells = cells(&scene);
        assert_holds(&scene, &cells);
        let turn = Mat4::from_rotation_z(0.7) * Mat4::from_translation(Vec3::new(1e4, -3.0, 7.0));
        for instance in &mut scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            instance.world_from_object = turn * instance.world_from_object;
            instance.bounds = mesh.bounds.transformed(instance.world_from_object);
        }
        let instances = scene.instances.iter();
        cells.place(2, instances.map(|i| (i.bounds, i.world_from_object)));
        assert_holds(&scene, &cells);
    }

    #[test]
    fn cells_follow_one_instance_that_moves() {
        let mut scene = foveal_generate::cornell();
        let mut cells = cells(&scene);
        let moved = scene.instances.len() / 2;
        let shift = Mat4::from_translation(Vec3::new(0.0, 30.0, 0.0));
        let instance = &mut scene.instances[moved];
        instance.world_from_object = shift * instance.world_from_object;
        instance.bounds = instance.bounds.transformed(shift);
        let instances = || {
            scene
                .instances
                .iter()
                .map(|i| (i.bounds, i.world_from_object))
        };
        cells.place(2, instances());
        assert_holds(&scene, &cells);
        let anew = self::cells(&scene);
        assert_eq!(cells.boxes, anew.boxes);
        for (a, b) in cells.plain_boxes.iter().zip(&cells.boxes) {
            assert_eq!(*a, foveal_cull::Aabb::new(b.min, b.max));
        }
    }

    #[test]
    fn too_many_cells_become_larger_ones_and_stay_more_than_one() {
        let mut scene = foveal_generate::cornell();
        let few = cells(&scene).boxes.len();
        assert!(few > 10 * scene.instances.len());
        // The same room again and again.
        let instances = scene.instances.clone();
        for _ in 0..MOST / few + 1 {
            scene.instances.extend(instances.iter().cloned());
        }
        let many = cells(&scene).boxes.len();
        assert!(many <= MOST && many > 2 * scene.instances.len(), "{many}");
    }

    #[test]
    fn a_box_is_cut_without_gaps_and_one_that_makes_no_sense_stays() {
        let mut boxes = [Aabb::EMPTY; 8];
        let b = Aabb::new(Vec3::new(-1.0, 0.3, 2.0), Vec3::new(2.0, 0.3, 7.0));
        cut_box(&b, UVec3::new(4, 1, 2), &mut boxes);
        assert_eq!(boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b)), b);
        assert_eq!(boxes[0].max.x, boxes[1].min.x);
        let endless = Aabb::new(Vec3::splat(f32::NEG_INFINITY), Vec3::splat(f32::INFINITY));
        let mut boxes = [Aabb::EMPTY];
        cut_box(&endless, UVec3::ONE, &mut boxes);
        assert_eq!(boxes, [endless]);
    }
}
