//! The shapes of which everything is made: faces, bevelled boxes, turned bodies, tubes, sheets.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::MeshBuilder;
use crate::trig::sin_cos_turns;

/// UV in metres on the plane that the normal faces most; v runs down, u to the viewer's right.
fn box_uv(p: Vec3, n: Vec3) -> Vec2 {
    let a = n.abs();
    if a.y >= a.x && a.y >= a.z {
        Vec2::new(p.x, p.z * n.y.signum())
    } else if a.x >= a.z {
        Vec2::new(-p.z * n.x.signum(), -p.y)
    } else {
        Vec2::new(p.x * n.z.signum(), -p.y)
    }
}

impl MeshBuilder {
    /// A flat convex polygon, counter-clockwise from the front, box-mapped.
    pub(crate) fn face(&mut self, corners: &[Vec3]) -> &mut Self {
        let n = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize_or(Vec3::Y);
        let first = corners
            .iter()
            .map(|&p| self.vertex(p, n, box_uv(p, n)))
            .min()
            .unwrap_or(0);
        for i in 2..corners.len() as u32 {
            self.triangle(first, first + i - 1, first + i);
        }
        self
    }

    /// A flat quad from a corner and two edges; the front is where `right` x `up` points.
    /// UV (0, 0) is the upper left corner, in metres.
    pub(crate) fn panel(&mut self, corner: Vec3, right: Vec3, up: Vec3) -> &mut Self {
        self.panel_uv(
            corner,
            right,
            up,
            Vec2::ZERO,
            Vec2::new(right.length(), up.length()),
        )
    }

    /// A flat quad as [`panel`](Self::panel) with the UVs of its upper left and lower right
    /// corners.
    pub(crate) fn panel_uv(
        &mut self,
        corner: Vec3,
        right: Vec3,
        up: Vec3,
        upper_left: Vec2,
        lower_right: Vec2,
    ) -> &mut Self {
        let n = right.cross(up);
        let (l, r) = (upper_left, lower_right);
        let a = self.vertex(corner, n, Vec2::new(l.x, r.y));
        let b = self.vertex(corner + right, n, r);
        let c = self.vertex(corner + right + up, n, Vec2::new(r.x, l.y));
        let d = self.vertex(corner + up, n, l);
        self.quad(a, b, c, d);
        self
    }

    /// A plain box.
    pub(crate) fn block(&mut self, min: Vec3, max: Vec3) -> &mut Self {
        self.bevel_box(min, max, 0.0)
    }

    /// A box whose edges are cut by `bevel` metres and shaded round; 44 triangles (12 without
    /// bevel).
    pub(crate) fn bevel_box(&mut self, min: Vec3, max: Vec3, bevel: f32) -> &mut Self {
        let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let size = max - min;
        let longest =
            usize::from(size.y > size.x.max(size.z)) + 2 * usize::from(size.z > size.x.max(size.y));
        let grain = self.grain;
        let uv = move |p: Vec3, n: Vec3| {
            let uv = box_uv(p, n);
            // Box mapping runs v along y on walls and along z on floors.
            let v_axis = if n.y.abs() > 0.5 { 2 } else { 1 };
            let u_axis = if n.x.abs() > 0.5 { 2 } else { 0 };
            if grain && v_axis == longest && u_axis != longest {
                Vec2::new(uv.y, -uv.x)
            } else {
                uv
            }
        };
        let axis = |i: usize| Vec3::AXES[i];
        let inner = (half - Vec3::splat(bevel)).max(Vec3::ZERO);
        // The corner of the face with normal `n` in the octant of `s`.
        let corner = |n: Vec3, s: Vec3| center + s * inner + n * (half - inner);
        let signs = |n: Vec3, a: f32, u: Vec3, b: f32, v: Vec3, c: f32| n * a + u * b + v * c;
        for i in 0..3 {
            let (u, v) = (axis((i + 1) % 3), axis((i + 2) % 3));
            for a in [-1.0f32, 1.0] {
                let n = axis(i) * a;
                let ring = [(-1.0, -1.0), (a, -a), (1.0, 1.0), (-a, a)];
                let q = ring.map(|(b, c)| {
                    let p = corner(n, signs(axis(i), a, u, b, v, c));
                    self.vertex(p, n, uv(p, n))
                });
                self.quad(q[0], q[1], q[2], q[3]);
                if bevel <= 0.0 {
                    continue;
                }
                // The strip towards the face of the next axis.
                for b in [-1.0f32, 1.0] {
                    let m = u * b;
                    let ends = [a * b, -a * b].map(|c| signs(axis(i), a, u, b, v, c));
                    let q = [(ends[1], n), (ends[1], m), (ends[0], m), (ends[0], n)].map(
                        |(s, face)| {
                            let p = corner(face, s);
                            self.vertex(p, face, uv(p, n))
                        },
                    );
                    self.quad(q[0], q[1], q[2], q[3]);
                }
            }
        }
        if bevel > 0.0 {
            for octant in 0..8u32 {
                let s = Vec3::new(
                    if octant & 1 == 0 { -1.0 } else { 1.0 },
                    if octant & 2 == 0 { -1.0 } else { 1.0 },
                    if octant & 4 == 0 { -1.0 } else { 1.0 },
                );
                let q = [0, 1, 2].map(|i| {
                    let n = axis(i) * s[i];
                    let p = corner(n, s);
                    self.vertex(p, n, uv(p, axis(0) * s.x))
                });
                if s.x * s.y * s.z > 0.0 {
                    self.triangle(q[0], q[1], q[2]);
                } else {
                    self.triangle(q[0], q[2], q[1]);
                }
            }
        }
        self
    }

    /// A body of revolution about y. `profile` holds (radius, height) upwards for an outer side
    /// (downwards turns the front inwards); corners sharper than about 40° stay sharp.
    pub(crate) fn lathe(&mut self, profile: &[(f32, f32)], segments: u32) -> &mut Self {
        let points: Vec<Vec2> = profile.iter().map(|&p| Vec2::from(p)).collect();
        let widest = points.iter().fold(0.0f32, |w, p| w.max(p.x));
        let normal = |i: usize| {
            let d = points[i + 1] - points[i];
            Vec2::new(d.y, -d.x).normalize_or(Vec2::X)
        };
        let spans = points.len() - 1;
        let mut v = 0.0;
        for i in 0..spans {
            let here = normal(i);
            let blend = |other: Option<usize>| match other {
                Some(j) if here.dot(normal(j)) > 0.77 => (here + normal(j)).normalize_or(here),
                _ => here,
            };
            let n = [
                blend(i.checked_sub(1)),
                blend((i + 1 < spans).then_some(i + 1)),
            ];
            let next_v = v - points[i].distance(points[i + 1]);
            for (k, (p, v)) in [(points[i], v), (points[i + 1], next_v)]
                .into_iter()
                .enumerate()
            {
                for s in 0..=segments {
                    let t = s as f32 / segments as f32;
                    let (sin, cos) = sin_cos_turns(if s == segments { 0.0 } else { t });
                    let position = Vec3::new(p.x * sin, p.y, p.x * cos);
                    let normal = Vec3::new(n[k].x * sin, n[k].y, n[k].x * cos);
                    self.vertex(position, normal, Vec2::new(t * TAU * widest, v));
                }
            }
            let top = self.next_index() - (segments + 1);
            let bottom = top - (segments + 1);
            for s in 0..segments {
                let (a, b, c, d) = (bottom + s, bottom + s + 1, top + s + 1, top + s);
                if points[i].x > 0.0 {
                    self.triangle(a, b, c);
                }
                if points[i + 1].x > 0.0 {
                    self.triangle(a, c, d);
                }
            }
            v = next_v;
        }
        self
    }

    /// An ellipsoid; 2 · segments · (rings − 1) triangles.
    pub(crate) fn ellipsoid(
        &mut self,
        center: Vec3,
        radii: Vec3,
        segments: u32,
        rings: u32,
    ) -> &mut Self {
        let row = segments + 1;
        let first = self.next_index();
        for r in 0..=rings {
            let (sin_lat, cos_lat) = sin_cos_turns(0.5 * r as f32 / rings as f32 - 0.25);
            // The poles are exact, whatever the last bit of the cosine.
            let cos_lat = if r == 0 || r == rings { 0.0 } else { cos_lat };
            for s in 0..=segments {
                let t = s as f32 / segments as f32;
                let (sin, cos) = sin_cos_turns(if s == segments { 0.0 } else { t });
                let unit = Vec3::new(cos_lat * sin, sin_lat, cos_lat * cos);
                let uv = Vec2::new(
                    t * TAU * radii.x,
                    (1.0 - r as f32 / rings as f32) * 0.5 * TAU * radii.y,
                );
                self.vertex(center + unit * radii, unit / radii, uv);
            }
        }
        for r in 0..rings {
            for s in 0..segments {
                let a = first + r * row + s;
                if r > 0 {
                    self.triangle(a, a + 1, a + row + 1);
                }
                if r + 1 < rings {
                    self.triangle(a, a + row + 1, a + row);
                }
            }
        }
        self
    }

    /// A round bar along `path`, without end caps; u runs around, v along.
    pub(crate) fn tube(&mut self, path: &[Vec3], radius: f32, sides: u32) -> &mut Self {
        let mut along = 0.0;
        let mut side = Vec3::ZERO;
        for (i, &p) in path.iter().enumerate() {
            let before = path[i.saturating_sub(1)];
            let after = path[(i + 1).min(path.len() - 1)];
            let axis = (after - before).normalize_or(Vec3::Y);
            // Carry the frame along, so that the bar does not twist.
            side = (side - axis * axis.dot(side))
                .try_normalize()
                .unwrap_or_else(|| axis.any_orthonormal_vector());
            let other = axis.cross(side);
            along += p.distance(before);
            for s in 0..=sides {
                let t = s as f32 / sides as f32;
                let (sin, cos) = sin_cos_turns(if s == sides { 0.0 } else { t });
                let n = side * cos + other * sin;
                self.vertex(p + n * radius, n, Vec2::new(t * TAU * radius, along));
            }
            if i > 0 {
                let top = self.next_index() - (sides + 1);
                let bottom = top - (sides + 1);
                for s in 0..sides {
                    self.quad(bottom + s, bottom + s + 1, top + s + 1, top + s);
                }
            }
        }
        self
    }

    /// A surface over (s, t) in [0, 1]²; `point` gives the position, `uv` the coordinates; the
    /// front is where dP/ds x dP/dt points. 2 · `columns` · `rows` triangles.
    pub(crate) fn sheet(
        &mut self,
        columns: u32,
        rows: u32,
        point: impl Fn(f32, f32) -> Vec3,
        uv: impl Fn(f32, f32) -> Vec2,
    ) -> &mut Self {
        const STEP: f32 = 1.0 / 512.0;
        let first = self.next_index();
        for r in 0..=rows {
            for c in 0..=columns {
                let (s, t) = (c as f32 / columns as f32, r as f32 / rows as f32);
                let ds = point(s + STEP, t) - point(s - STEP, t);
                let dt = point(s, t + STEP) - point(s, t - STEP);
                self.vertex(point(s, t), ds.cross(dt), uv(s, t));
            }
        }
        for r in 0..rows {
            for c in 0..columns {
                let a = first + r * (columns + 1) + c;
                self.quad(a, a + 1, a + columns + 2, a + columns + 1);
            }
        }
        self
    }
}
