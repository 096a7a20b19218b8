//! House parts: cores, arcades, windows, roofs. Front at z = 0 facing +z, 12 m wide in three bays.

use std::array::from_fn;

use glam::{Vec2, Vec3};

use super::kit::{Thing, model};
use super::materials::Materials;
use crate::generate::build::{MeshBuilder, SceneBuilder};
use crate::generate::trig::{shift, sin_cos_turns, yaw};

/// Width of a house along its lane.
pub(super) const WIDTH_M: f32 = 12.0;
/// Depth of a house, its arcade included.
pub(super) const DEPTH_M: f32 = 8.0;
/// Depth of the arcade under the upper floors.
pub(super) const ARCADE_M: f32 = 3.0;
/// Height of the arcade: where the upper floors begin.
pub(super) const ARCADE_HEIGHT_M: f32 = 4.8;
/// Height of each upper floor.
pub(super) const STOREY_M: f32 = 3.2;
/// Width of a bay.
pub(super) const BAY_M: f32 = 4.0;

/// All things that houses are made from.
#[derive(Debug)]
pub(super) struct Houses {
    /// By number of upper floors less one, then by wall.
    pub(super) cores: [[Thing; 6]; 3],
    pub(super) arch: Thing,
    pub(super) column: Thing,
    pub(super) course: Thing,
    pub(super) roof: Thing,
    /// Brightly lit, dimly lit, dark; with shutters of each colour.
    pub(super) windows: [[Thing; 3]; 3],
    pub(super) balcony: Thing,
    pub(super) chimney: Thing,
    pub(super) door: Thing,
    pub(super) bridge: Thing,
    pub(super) court_wall: Thing,
}

impl Houses {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let cores = [1u8, 2, 3].map(|floors| {
            let height = ARCADE_HEIGHT_M + STOREY_M * f32::from(floors);
            let mesh = model(scene, &format!("house of {floors} floors"), |b| {
                core(b, height)
            });
            m.walls
                .map(|wall| Thing::new("house", "houses", &[(mesh, wall)]).occluding())
        });
        let arch = model(scene, "arch", |b| {
            arch_wall(b, &ArchWall::ARCADE);
            archivolt(b, 1.75, 2.6, 0.26);
        });
        let column = model(scene, "column", column);
        let course = model(scene, "string course", |b| {
            b.bevel_box(
                Vec3::new(-6.0, -0.12, -0.05),
                Vec3::new(6.0, 0.02, 0.10),
                0.03,
            );
            b.bevel_box(
                Vec3::new(-6.0, 0.02, -0.05),
                Vec3::new(6.0, 0.12, 0.16),
                0.03,
            );
        });
        let roof = model(scene, "gable roof", gable_roof);
        let frame = model(scene, "window frame", window_frame);
        let pane = model(scene, "window pane", |b| {
            let corner = Vec3::new(-0.5, 0.0, 0.02);
            b.panel_uv(corner, Vec3::X, Vec3::Y * 1.6, Vec2::ZERO, Vec2::ONE);
        });
        let shutters = model(scene, "shutters", shutters);
        let panes = [m.lit_windows[0], m.lit_windows[1], m.dark_window];
        let slab = model(scene, "balcony slab", balcony_slab);
        let rail = model(scene, "balcony rail", balcony_rail);
        let chimney = model(scene, "chimney", |b| {
            b.bevel_box(Vec3::new(-0.4, -1.0, -0.3), Vec3::new(0.4, 1.2, 0.3), 0.02);
            b.bevel_box(Vec3::new(-0.5, 1.2, -0.4), Vec3::new(0.5, 1.34, 0.4), 0.03);
            for x in [-0.2, 0.2] {
                b.at(shift(x, 1.34, 0.0))
                    .lathe(&[(0.13, 0.0), (0.11, 0.35), (0.08, 0.35), (0.08, 0.1)], 10);
            }
        });
        let leaf = model(scene, "door leaf", door_leaf);
        let door_frame = model(scene, "door frame", door_frame);
        let bridge = model(scene, "bridge arch", |b| {
            arch_wall(b, &ArchWall::BRIDGE);
            b.block(Vec3::new(-4.5, 7.0, -0.95), Vec3::new(4.5, 7.18, 0.1));
        });
        let court_wall = model(scene, "court wall", |b| {
            arch_wall(b, &ArchWall::COURT);
            for x in [-1.0f32, 1.0] {
                let (a, c) = (x * 1.2, x * 3.5);
                b.block(
                    Vec3::new(a.min(c), 0.0, -0.4),
                    Vec3::new(a.max(c), 2.2, 0.0),
                );
            }
            b.bevel_box(Vec3::new(-3.5, 4.0, -0.5), Vec3::new(3.5, 4.14, 0.1), 0.03);
        });
        Self {
            cores,
            arch: Thing::new("arch", "arcades", &[(arch, m.pale_stone)]),
            column: Thing::new("column", "arcades", &[(column, m.pale_stone)]),
            course: Thing::new("string course", "houses", &[(course, m.pale_stone)]),
            roof: Thing::new("roof", "houses", &[(roof, m.roof)]).occluding(),
            windows: from_fn(|light| {
                from_fn(|color| {
                    let parts = [
                        (frame, m.pale_stone),
                        (pane, panes[light]),
                        (shutters, m.shutters[color]),
                    ];
                    Thing::new("window", "houses", &parts)
                })
            }),
            balcony: Thing::new("balcony", "houses", &[(slab, m.pale_stone), (rail, m.iron)]),
            chimney: Thing::new("chimney", "houses", &[(chimney, m.brick)]),
            door: Thing::new(
                "door",
                "houses",
                &[(door_frame, m.pale_stone), (leaf, m.timber)],
            ),
            bridge: Thing::new("bridge arch", "houses", &[(bridge, m.stone)]).occluding(),
            court_wall: Thing::new("court wall", "walls", &[(court_wall, m.stone)]).occluding(),
        }
    }
}

/// The house's solid: recessed ground floor, upper floors over the arcade, gables.
fn core(b: &mut MeshBuilder, height: f32) {
    let (x, h, g) = (0.5 * WIDTH_M, height, ARCADE_HEIGHT_M);
    let (back, inner, ridge) = (-DEPTH_M, -ARCADE_M, height + 2.0);
    let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    b.face(&[
        p(-x, 0.0, inner),
        p(x, 0.0, inner),
        p(x, g, inner),
        p(-x, g, inner),
    ]);
    b.face(&[p(-x, g, inner), p(x, g, inner), p(x, g, 0.0), p(-x, g, 0.0)]);
    b.face(&[p(-x, g, 0.0), p(x, g, 0.0), p(x, h, 0.0), p(-x, h, 0.0)]);
    b.face(&[
        p(x, 0.0, back),
        p(-x, 0.0, back),
        p(-x, h, back),
        p(x, h, back),
    ]);
    for s in [-1.0f32, 1.0] {
        let x = x * s;
        let mut side = |mut corners: Vec<Vec3>| {
            if s < 0.0 {
                corners.reverse();
            }
            b.face(&corners);
        };
        side(vec![
            p(x, 0.0, inner),
            p(x, 0.0, back),
            p(x, g, back),
            p(x, g, inner),
        ]);
        side(vec![
            p(x, g, 0.0),
            p(x, g, back),
            p(x, h, back),
            p(x, h, 0.0),
        ]);
        side(vec![p(x, h, 0.0), p(x, h, back), p(x, ridge, 0.5 * back)]);
    }
    // The attic floor closes the solid for whoever looks from above through a missing roof.
    b.face(&[p(-x, h, 0.0), p(x, h, 0.0), p(x, h, back), p(-x, h, back)]);
}

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
    const ARCADE: Self = Self {
        opening: 1.75,
        half: 2.0,
        spring: 2.6,
        rise: 1.75,
        top: 4.8,
        depth: 0.45,
    };
    const BRIDGE: Self = Self {
        opening: 4.5,
        half: 4.5,
        spring: 4.9,
        rise: 1.5,
        top: 7.0,
        depth: 0.85,
    };
    const COURT: Self = Self {
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
fn archivolt(b: &mut MeshBuilder, r: f32, y: f32, width: f32) {
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
fn column(b: &mut MeshBuilder) {
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

/// Two slopes with overhanging eaves and a ridge; y = 0 is the top of the walls.
fn gable_roof(b: &mut MeshBuilder) {
    const THICK: f32 = 0.14;
    let x = 0.5 * WIDTH_M;
    let ridge = Vec3::new(0.0, 2.16, -0.5 * DEPTH_M);
    for turned in [false, true] {
        // Built for the front, turned about the ridge for the back.
        let place = if turned {
            shift(0.0, 0.0, -DEPTH_M) * yaw(0.5)
        } else {
            shift(0.0, 0.0, 0.0)
        };
        b.at(place);
        let eave = Vec3::new(0.0, -0.16, 0.6);
        let up = ridge - eave;
        let drop = Vec3::NEG_Y * THICK;
        let (l, r) = (Vec3::NEG_X * x, Vec3::X * x);
        b.panel(l + eave, r * 2.0, up);
        b.panel(l + ridge + drop, r * 2.0, -up);
        b.panel(l + eave + drop, r * 2.0, -drop);
        b.face(&[l + eave + drop, l + eave, l + ridge, l + ridge + drop]);
        b.face(&[r + eave, r + eave + drop, r + ridge + drop, r + ridge]);
    }
    b.at(shift(0.0, 0.0, 0.0));
    let line: Vec<Vec3> = (0..=1)
        .map(|i| ridge + Vec3::X * x * (2.0 * i as f32 - 1.0))
        .collect();
    b.tube(&line, 0.13, 10);
}

/// Jambs, lintel and sill around an opening 1.0 by 1.6 m whose foot is at y = 0.
fn window_frame(b: &mut MeshBuilder) {
    b.bevel_box(
        Vec3::new(-0.68, -0.14, -0.05),
        Vec3::new(0.68, 0.0, 0.2),
        0.02,
    );
    for x in [-0.57f32, 0.57] {
        b.bevel_box(
            Vec3::new(x - 0.07, 0.0, -0.05),
            Vec3::new(x + 0.07, 1.6, 0.1),
            0.015,
        );
    }
    b.bevel_box(
        Vec3::new(-0.68, 1.6, -0.05),
        Vec3::new(0.68, 1.78, 0.13),
        0.02,
    );
}

/// Two open leaves beside the window, a hand's breadth off the wall at their outer edges.
fn shutters(b: &mut MeshBuilder) {
    for (s, open) in [(-1.0f32, -0.030f32), (1.0, 0.045)] {
        b.at(shift(s * 0.66, 0.0, 0.10) * yaw(-s * open.abs()));
        let (a, c) = (0.0, s * 0.54);
        b.bevel_box(
            Vec3::new(f32::min(a, c), -0.02, -0.02),
            Vec3::new(f32::max(a, c), 1.62, 0.02),
            0.008,
        );
        for y in [0.12, 0.78, 1.40] {
            b.block(
                Vec3::new(f32::min(a, c) + 0.03, y, 0.02),
                Vec3::new(f32::max(a, c) - 0.03, y + 0.09, 0.04),
            );
        }
    }
}

/// A slab on two brackets in front of a window; y = 0 is its top.
fn balcony_slab(b: &mut MeshBuilder) {
    b.bevel_box(
        Vec3::new(-1.15, -0.14, -0.05),
        Vec3::new(1.15, 0.0, 0.9),
        0.03,
    );
    for x in [-0.85, 0.85] {
        b.bevel_box(
            Vec3::new(x - 0.1, -0.42, -0.05),
            Vec3::new(x + 0.1, -0.14, 0.45),
            0.03,
        );
    }
}

/// The iron rail of a balcony.
fn balcony_rail(b: &mut MeshBuilder) {
    let (x, z) = (1.1, 0.85);
    let corners = [(-x, 0.0), (-x, z), (x, z), (x, 0.0)];
    for y in [0.08, 0.95] {
        let rail: Vec<Vec3> = corners.iter().map(|&(x, z)| Vec3::new(x, y, z)).collect();
        for pair in rail.windows(2) {
            b.tube(pair, if y > 0.5 { 0.025 } else { 0.014 }, 6);
        }
    }
    for i in 0..=14u8 {
        let x = 1.1 * (f32::from(i) / 7.0 - 1.0);
        b.tube(&[Vec3::new(x, 0.0, z), Vec3::new(x, 0.95, z)], 0.011, 4);
    }
    for s in [-x, x] {
        for z in [0.2, 0.42, 0.64] {
            b.tube(&[Vec3::new(s, 0.0, z), Vec3::new(s, 0.95, z)], 0.011, 4);
        }
    }
}

/// Planked double door 1.5 m wide, on the wall z = 0.
fn door_leaf(b: &mut MeshBuilder) {
    b.along_grain();
    for i in 0..8u8 {
        let x = -0.72 + 0.18 * f32::from(i);
        b.bevel_box(
            Vec3::new(x, 0.02, 0.0),
            Vec3::new(x + 0.175, 2.3, 0.05),
            0.01,
        );
    }
    for y in [0.4, 1.8] {
        b.bevel_box(
            Vec3::new(-0.68, y, 0.05),
            Vec3::new(0.68, y + 0.14, 0.075),
            0.01,
        );
    }
}

/// Stone around the door.
fn door_frame(b: &mut MeshBuilder) {
    for x in [-0.85f32, 0.85] {
        b.bevel_box(
            Vec3::new(x - 0.13, 0.0, -0.05),
            Vec3::new(x + 0.13, 2.32, 0.14),
            0.02,
        );
    }
    b.bevel_box(
        Vec3::new(-1.02, 2.32, -0.05),
        Vec3::new(1.02, 2.62, 0.16),
        0.02,
    );
    b.bevel_box(Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.12, 0.4), 0.02);
}
