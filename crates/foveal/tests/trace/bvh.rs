//! A hierarchy of boxes around a scene's triangles, and rays through it.

use foveal_scene::Scene;
use glam::Vec3;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// A triangle in world space.
#[derive(Clone, Copy)]
pub(crate) struct Triangle {
    corners: [Vec3; 3],
    normals: [Vec3; 3],
    pub(crate) instance: u32,
}

/// Where a ray meets a triangle first.
#[derive(Clone, Copy)]
pub(crate) struct Hit {
    pub(crate) distance: f32,
    pub(crate) triangle: usize,
    /// Weights of the second and the third corner.
    at: [f32; 2],
}

struct Node {
    low: Vec3,
    high: Vec3,
    /// First triangle of a leaf, or the second child; the first one follows its parent.
    first: usize,
    /// Of a leaf, else 0.
    count: usize,
}

pub(crate) struct Bvh {
    pub(crate) triangles: Vec<Triangle>,
    nodes: Vec<Node>,
}

impl Bvh {
    /// Of all instances.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut triangles = Vec::new();
        for (number, instance) in (0..).zip(&scene.instances) {
            let mesh = &scene.meshes[instance.mesh as usize];
            let to_world = instance.world_from_object;
            let normals = to_world.inverse().transpose();
            for corners in mesh.indices.as_chunks::<3>().0 {
                let vertices = corners.map(|i| &mesh.vertices[i as usize]);
                triangles.push(Triangle {
                    corners: vertices.map(|v| to_world.transform_point3(v.position.into())),
                    normals: vertices
                        .map(|v| normals.transform_vector3(v.normal.into()).normalize()),
                    instance: number,
                });
            }
        }
        let mut nodes = Vec::new();
        let count = triangles.len();
        split(&mut triangles, 0, count, &mut nodes);
        Self { triangles, nodes }
    }

    /// The nearest triangle along a unit direction, nearer than `end`, of an instance that `counts`.
    pub(crate) fn first_hit(
        &self,
        (from, along): (Vec3, Vec3),
        end: f32,
        counts: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let per = along.recip();
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index];
            let end = best.map_or(end, |hit| hit.distance);
            let (a, b) = ((node.low - from) * per, (node.high - from) * per);
            let enter = a.min(b).max_element().max(0.0);
            if enter > a.max(b).min_element().min(end) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, index + 1]);
                continue;
            }
            for triangle in node.first..node.first + node.count {
                if !counts(self.triangles[triangle].instance) {
                    continue;
                }
                let end = best.map_or(end, |hit| hit.distance);
                let hit = self.triangles[triangle].hit(from, along, end);
                best = hit
                    .map(|(distance, at)| Hit {
                        distance,
                        triangle,
                        at,
                    })
                    .or(best);
            }
        }
        best
    }

    /// The shading normal and the face's own at a hit, both turned to where the ray comes from.
    pub(crate) fn normals(&self, hit: &Hit, along: Vec3) -> (Vec3, Vec3) {
        let t = &self.triangles[hit.triangle];
        let [u, v] = hit.at;
        let n = t.normals[0] * (1.0 - u - v) + t.normals[1] * u + t.normals[2] * v;
        let face = t.face();
        if face.dot(along) > 0.0 {
            (-n.normalize(), -face)
        } else {
            (n.normalize(), face)
        }
    }
}

impl Triangle {
    fn face(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize()
    }

    /// Distance and place (Möller and Trumbore 1997).
    fn hit(&self, from: Vec3, along: Vec3, end: f32) -> Option<(f32, [f32; 2])> {
        let [a, b, c] = self.corners;
        let (e, f) = (b - a, c - a);
        let p = along.cross(f);
        let determinant = e.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let t = (from - a) / determinant;
        let u = t.dot(p);
        let q = t.cross(e);
        let v = along.dot(q);
        let distance = f.dot(q);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (inside && distance > 0.0 && distance < end).then_some((distance, [u, v]))
    }
}

/// Orders the triangles of a range by halves along the longest side of their box.
fn split(triangles: &mut [Triangle], first: usize, count: usize, nodes: &mut Vec<Node>) {
    let own = &mut triangles[first..first + count];
    let corners = || own.iter().flat_map(|t| t.corners);
    let node = nodes.len();
    let (low, high) = (
        corners().fold(Vec3::INFINITY, Vec3::min),
        corners().fold(Vec3::NEG_INFINITY, Vec3::max),
    );
    nodes.push(Node {
        low,
        high,
        first,
        count,
    });
    if count <= LEAF {
        return;
    }
    let axis = (high - low).max_position();
    let center = |t: &Triangle| t.corners.iter().map(|c| c[axis]).sum::<f32>();
    let half = count / 2;
    own.select_nth_unstable_by(half, |a, b| center(a).total_cmp(&center(b)));
    split(triangles, first, half, nodes);
    let second = nodes.len();
    split(triangles, first + half, count - half, nodes);
    nodes[node].first = second;
    nodes[node].count = 0;
}
