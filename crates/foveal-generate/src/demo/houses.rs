//! House parts: cores, arcades, windows, roofs. Front at z = 0 facing +z, 12 m wide in three bays.

use std::array::from_fn;

use glam::{Vec2, Vec3};

use super::arches::{ArchWall, arch_wall, archivolt, column};
use super::kit::{Thing, model};
use super::materials::Materials;
use super::openings::{balcony_rail, balcony_slab, door_frame, door_leaf, shutters, window_frame};
use crate::build::{MeshBuilder, SceneBuilder};
use crate::trig::{shift, yaw};

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
