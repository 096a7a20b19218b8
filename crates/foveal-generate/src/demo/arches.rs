//! Arches and columns: the arcades, bridges, gates and court walls are made from these.

use glam::{Vec2, Vec3};

use crate::build::MeshBuilder;
use crate::trig::sin_cos_turns;

/// A wall with an arched opening; its front is at z = 0, x is centred.
pub(super) struct ArchWall {
    /// Half the width of the opening.
    pub(super) opening: f32,
    /// Half the width of the wall.
    pub(super) half: f32,
    /// Height where the arch springs.
    pub(super) spring: f32,
    /// Height of the arch above its springing.
    pub(super) rise: f32,
    /// Top of the wall.
    pub(super) top: f32,
    /// Thickness.
    pub(super) depth: f32,
}

impl ArchWall {
    /// The arcades' bays.
    pub(super) const ARCADE: Self = Self {
        opening: 1.75,
        half: 2.0,
        spring: 2.6,
        rise: 1.75,
        top: 4.8,
        depth: 0.45,
    };
    /// Over a lane, from wall to wall.
    pub(super) const BRIDGE: Self = Self {
        opening: 4.5,
        half: 4.5,
        spring: 4.9,
        rise: 1.5,
        top: 7.0,
        depth: 0.85,
    };
    /// Closes a court.
    pub(super) const COURT: Self = Self {
        opening: 1.2,
        half: 3.5,
        spring: 2.2,
        rise: 1.2,
        top: 4.0,
        depth: 0.4,
    };
}

const ARC_STEPS: u8 = 14;

/// The part of the wall above the springing, piers excluded below it.
pub(super) fn arch_wall(b: &mut MeshBuilder, w: &ArchWall) {
    let arc = |i: u8| {
        let (sin, cos) = sin_cos_turns(0.5 - 0.5 * f32::from(i) / f32::from(ARC_STEPS));
        Vec2::new(cos * w.opening, w.spring + sin * w.rise)
    };
    for (z, front) in [(0.0, true), (-w.depth, false)] {
        let mut flat = |points: &[Vec2]| {
            let mut corners: Vec<Vec3> = points.iter().map(|p| p.extend(z)).collect();
            if !front {
                corners.reverse();
            }
            b.face(&corners);
        };
        for i in 0..ARC_STEPS {
            let (l, r) = (arc(i), arc(i + 1));
            flat(&[l, r, Vec2::new(r.x, w.top), Vec2::new(l.x, w.top)]);
        }
        if w.half > w.opening {
            for (l, r) in [(-w.half, -w.opening), (w.opening, w.half)] {
                flat(&[(l, w.spring), (r, w.spring), (r, w.top), (l, w.top)].map(Vec2::from));
            }
        }
    }
    let (opening, spring, rise, depth) = (w.opening, w.spring, w.rise, w.depth);
    b.sheet(
        u32::from(ARC_STEPS),
        1,
        |s, t| {
            let (sin, cos) = sin_cos_turns(0.5 * s);
            Vec3::new(cos * opening, spring + sin * rise, -t * depth)
        },
        |s, t| Vec2::new(s * opening * 3.0, t * depth),
    );
    if w.half > w.opening {
        for (l, r) in [(-w.half, -w.opening), (w.opening, w.half)] {
            let (y, z) = (w.spring, -w.depth);
            b.face(&[
                Vec3::new(l, y, z),
                Vec3::new(r, y, z),
                Vec3::new(r, y, 0.0),
                Vec3::new(l, y, 0.0),
            ]);
        }
    }
}

/// The raised band around an arch of radius `r` springing at `y`.
pub(super) fn archivolt(b: &mut MeshBuilder, r: f32, y: f32, width: f32) {
    const OUT: f32 = 0.05;
    let steps = u32::from(ARC_STEPS);
    let at = |s: f32, r: f32, z: f32| {
        let (sin, cos) = sin_cos_turns(0.5 * s);
        Vec3::new(cos * r, y + sin * r, z)
    };
    let around = move |s: f32, t: f32| Vec2::new(s * r * 3.3, t * width);
    b.sheet(
        1,
        steps,
        |t, s| at(s, r + t * width, OUT),
        |t, s| around(s, t),
    );
    b.sheet(
        1,
        steps,
        |t, s| at(s, r, t * OUT),
        |t, s| around(s, t * 0.2),
    );
    b.sheet(
        1,
        steps,
        |t, s| at(s, r + width, OUT - t * OUT),
        |t, s| around(s, t * 0.2),
    );
}

/// A Tuscan column 2.6 m high on a square plinth.
pub(super) fn column(b: &mut MeshBuilder) {
    b.bevel_box(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 0.18, 0.3), 0.02);
    let shaft = [
        (0.27, 0.18),
        (0.29, 0.23),
        (0.27, 0.28),
        (0.225, 0.32),
        (0.225, 0.36),
        (0.22, 1.0),
        (0.205, 1.7),
        (0.185, 2.2),
        (0.215, 2.22),
        (0.215, 2.26),
        (0.19, 2.27),
        (0.20, 2.33),
        (0.27, 2.42),
    ];
    b.lathe(&shaft, 16);
    b.bevel_box(Vec3::new(-0.3, 2.42, -0.3), Vec3::new(0.3, 2.6, 0.3), 0.02);
}
