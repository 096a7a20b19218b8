//! Finds a way through a level: a grid of columns, the floors in each, and the longest of the shortest
//! ways from floor to floor.

use bevy::prelude::*;
use std::collections::{HashMap, VecDeque};

/// Room that a walker needs above a floor, metres.
const HEADROOM: f32 = 1.9;
/// Height of the eye.
const EYE: f32 = 1.65;
/// The highest step.
const STEP: f32 = 0.45;
/// Least side of a column, and most columns along each side of the level.
const CELL: f32 = 0.4;
const MOST: f32 = 500.0;

/// A floor in a column: its number there and its height.
type Floor = (usize, f32);

/// Eye positions from one end of the level to the other, in steps of about a column.
pub fn longest_walk(triangles: &[[Vec3; 3]]) -> Vec<Vec3> {
    let corners = || triangles.iter().flatten();
    let low = corners().fold(Vec3::INFINITY, |a, b| a.min(*b));
    let high = corners().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
    let side = ((high - low).xz().max_element() / MOST).max(CELL);
    let columns = Columns::new(triangles, low, high, side);
    let clear = columns.clear();
    let Some(start) = columns.start(&clear) else {
        return Vec::new();
    };
    let (end, _) = columns.farthest(&clear, start);
    let (other, came_from) = columns.farthest(&clear, end);
    let mut way = vec![other];
    while let Some(before) = way.last().and_then(|node| came_from.get(node)) {
        way.push(*before);
    }
    let feet: Vec<Vec3> = way.iter().map(|node| columns.place(*node)).collect();
    // Without the corners of the grid.
    (0..feet.len())
        .map(|i| {
            let near = &feet[i.saturating_sub(2)..(i + 3).min(feet.len())];
            near.iter().sum::<Vec3>() / near.len() as f32 + Vec3::Y * EYE
        })
        .collect()
}

/// A column and a floor in it.
type Node = (usize, usize);

struct Columns {
    low: Vec3,
    side: f32,
    size: [usize; 2],
    /// Floors with headroom, and whether there is something above.
    floors: Vec<Vec<(f32, bool)>>,
}

impl Columns {
    fn new(triangles: &[[Vec3; 3]], low: Vec3, high: Vec3, side: f32) -> Self {
        let size = [high.x - low.x, high.z - low.z].map(|s| (s / side).ceil().max(1.0) as usize);
        let mut solid: Vec<Vec<[f32; 2]>> = vec![Vec::new(); size[0] * size[1]];
        for triangle in triangles {
            let least = triangle.iter().fold(Vec3::INFINITY, |a, b| a.min(*b)) - low;
            let most = triangle.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b)) - low;
            let cell = |at: f32, size: usize| ((at / side) as usize).min(size - 1);
            for x in cell(least.x, size[0])..=cell(most.x, size[0]) {
                for z in cell(least.z, size[1])..=cell(most.z, size[1]) {
                    let corner = low.xz() + Vec2::new(x as f32, z as f32) * side;
                    if let Some(span) = heights(triangle, corner, side) {
                        solid[z * size[0] + x].push(span);
                    }
                }
            }
        }
        let floors = solid.into_iter().map(floors).collect();
        Self {
            low,
            side,
            size,
            floors,
        }
    }

    fn place(&self, (column, floor): Node) -> Vec3 {
        let (x, z) = (column % self.size[0], column / self.size[0]);
        let middle = self.low + Vec3::new(x as f32 + 0.5, 0.0, z as f32 + 0.5) * self.side;
        middle.with_y(self.floors[column][floor].0)
    }

    /// The floor beside one that a step leads to.
    fn beside(&self, (column, floor): Node, dx: isize, dz: isize) -> Option<Node> {
        let (x, z) = (column % self.size[0], column / self.size[0]);
        let x = x.checked_add_signed(dx).filter(|x| *x < self.size[0])?;
        let z = z.checked_add_signed(dz).filter(|z| *z < self.size[1])?;
        let height = self.floors[column][floor].0;
        let other = z * self.size[0] + x;
        let step = |f: &Floor| (f.1 - height).abs();
        (self.floors[other].iter().map(|f| f.0).enumerate())
            .min_by(|a, b| step(a).total_cmp(&step(b)))
            .filter(|f| step(f) <= STEP)
            .map(|(i, _)| (other, i))
    }

    fn nodes(&self) -> impl Iterator<Item = Node> + '_ {
        let of_column = |(i, f): (usize, &Vec<_>)| (0..f.len()).map(move |j| (i, j));
        self.floors.iter().enumerate().flat_map(of_column)
    }

    /// Floors with floors all around: no wall is near.
    fn clear(&self) -> HashMap<Node, bool> {
        let around = |node: &Node| {
            let mut sides = [-1, 0, 1]
                .into_iter()
                .flat_map(|x| [-1, 0, 1].map(|z| (x, z)));
            sides.all(|(x, z)| self.beside(*node, x, z).is_some())
        };
        self.nodes()
            .filter(around)
            .map(|node| (node, self.floors[node.0][node.1].1))
            .collect()
    }

    /// A floor of the connected part with the most floors that have something above.
    fn start(&self, clear: &HashMap<Node, bool>) -> Option<Node> {
        let mut known = HashMap::new();
        let mut best = (0, None);
        for node in self.nodes().filter(|node| clear.contains_key(node)) {
            if known.contains_key(&node) {
                continue;
            }
            let part = self.reached(clear, node).0;
            let roofed = part.iter().filter(|node| clear[node]).count();
            let weight = part.len() + 1000 * roofed;
            known.extend(part.into_iter().map(|node| (node, ())));
            if weight > best.0 {
                best = (weight, Some(node));
            }
        }
        best.1
    }

    /// All that can be reached, nearest first, and from where.
    fn reached(
        &self,
        clear: &HashMap<Node, bool>,
        start: Node,
    ) -> (Vec<Node>, HashMap<Node, Node>) {
        let mut came_from = HashMap::new();
        let mut order = vec![start];
        let mut open = VecDeque::from([start]);
        while let Some(node) = open.pop_front() {
            for (dx, dz) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let Some(next) = self.beside(node, dx, dz) else {
                    continue;
                };
                if next != start && clear.contains_key(&next) && !came_from.contains_key(&next) {
                    came_from.insert(next, node);
                    order.push(next);
                    open.push_back(next);
                }
            }
        }
        (order, came_from)
    }

    fn farthest(&self, clear: &HashMap<Node, bool>, start: Node) -> (Node, HashMap<Node, Node>) {
        let (order, came_from) = self.reached(clear, start);
        (order.last().copied().unwrap_or(start), came_from)
    }
}

/// The heights between which a triangle lies in a column.
fn heights(triangle: &[Vec3; 3], corner: Vec2, side: f32) -> Option<[f32; 2]> {
    let mut polygon = triangle.to_vec();
    for (axis, sign, edge) in [
        (0, 1.0, corner.x),
        (0, -1.0, corner.x + side),
        (2, 1.0, corner.y),
        (2, -1.0, corner.y + side),
    ] {
        let inside = |p: Vec3| sign * (p[axis] - edge);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            let (from, to) = (inside(a), inside(b));
            if from >= 0.0 {
                kept.push(a);
            }
            if (from < 0.0) != (to < 0.0) {
                kept.push(a.lerp(b, from / (from - to)));
            }
        }
        polygon = kept;
    }
    let low = polygon.iter().map(|p| p.y).reduce(f32::min)?;
    let high = polygon.iter().map(|p| p.y).reduce(f32::max)?;
    Some([low, high])
}

/// The floors of a column, from what is solid in it.
fn floors(mut solid: Vec<[f32; 2]>) -> Vec<(f32, bool)> {
    solid.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut floors: Vec<(f32, bool)> = Vec::new();
    let mut top = f32::NEG_INFINITY;
    for [low, high] in solid {
        if top.is_finite() && low - top >= HEADROOM {
            floors.push((top, true));
        }
        top = top.max(high);
    }
    if top.is_finite() {
        floors.push((top, false));
    }
    floors
}
