//! The quarter's wall, its towers and gates, the clock tower, the ground and the moon.

use glam::{Vec2, Vec3};

use super::arches::{ArchWall, arch_wall};
use super::kit::{Thing, model};
use super::materials::Materials;
use crate::build::{MeshBuilder, SceneBuilder};
use crate::trig::{pitch, shift, sin_cos_turns, yaw};

/// Length of one piece of the quarter's wall.
pub(super) const WALL_M: f32 = 12.0;
/// Edge of one tile of the ground.
pub(super) const GROUND_M: f32 = 24.0;
/// Width of the gate towers along the wall.
pub(super) const GATE_M: f32 = 8.8;
/// Height of the clock's middle.
const CLOCK_Y: f32 = 17.4;

/// What encloses the market.
#[derive(Debug)]
pub(super) struct Walls {
    /// 12 m along x, front towards +z, back at z = −1.2.
    pub(super) wall: Thing,
    pub(super) corner_tower: Thing,
    /// Passage along z.
    pub(super) gate: Thing,
    /// Straddles the alley north of the square, passage along z.
    pub(super) clock_tower: Thing,
    pub(super) ground: Thing,
    pub(super) moon: Thing,
}

impl Walls {
    pub(super) fn new(scene: &mut SceneBuilder, m: &Materials) -> Self {
        let wall = model(scene, "quarter wall", |b| {
            b.block(Vec3::new(-6.0, -0.2, -1.2), Vec3::new(6.0, 8.0, 0.0));
            b.block(Vec3::new(-6.0, 7.4, 0.0), Vec3::new(6.0, 7.7, 0.15));
            for i in 0..6u8 {
                let x = -5.7 + 2.0 * f32::from(i);
                b.bevel_box(Vec3::new(x, 8.0, -0.5), Vec3::new(x + 1.3, 9.2, 0.0), 0.04);
            }
        });
        let tower = model(scene, "corner tower", corner_tower);
        let cone = model(scene, "cone roof", |b| {
            b.lathe(&[(3.2, 12.9), (3.9, 12.6), (2.4, 15.2), (0.0, 18.0)], 24);
        });
        let gate = model(scene, "gate", |b| {
            passage(b, &GATE, 0.5 * GATE_M, 6.0, 11.0)
        });
        let clock_tower = model(scene, "clock tower", clock_tower);
        let pyramid = model(scene, "pyramid roof", pyramid);
        let faces = model(scene, "clock faces", |b| {
            for turned in [0.0, 0.5] {
                b.at(yaw(turned) * shift(0.0, CLOCK_Y, 2.64) * pitch(0.25));
                disc(b, 1.7);
            }
        });
        let bell = model(scene, "bell", |b| {
            b.at(shift(0.0, 21.6, 0.0)).lathe(
                &[
                    (0.75, 0.0),
                    (0.70, 0.08),
                    (0.5, 0.5),
                    (0.42, 1.0),
                    (0.2, 1.25),
                    (0.0, 1.3),
                ],
                20,
            );
        });
        let ground = model(scene, "ground", |b| {
            let half = 0.5 * GROUND_M;
            b.panel(
                Vec3::new(-half, 0.0, half),
                Vec3::X * GROUND_M,
                Vec3::NEG_Z * GROUND_M,
            );
        });
        let moon = model(scene, "moon", |b| {
            b.at(pitch(0.25));
            disc(b, 2.6);
        });
        Self {
            wall: Thing::new("wall", "walls", &[(wall, m.stone)]).occluding(),
            corner_tower: Thing::new("tower", "walls", &[(tower, m.stone), (cone, m.roof)])
                .occluding(),
            gate: Thing::new("gate", "walls", &[(gate, m.stone)]).occluding(),
            clock_tower: Thing::new(
                "clock tower",
                "walls",
                &[
                    (clock_tower, m.stone),
                    (pyramid, m.roof),
                    (faces, m.clock),
                    (bell, m.brass),
                ],
            )
            .occluding(),
            ground: Thing::new("ground", "ground", &[(ground, m.cobbles)]).occluding(),
            moon: Thing::new("moon", "sky", &[(moon, m.moon)]),
        }
    }
}

const GATE: ArchWall = ArchWall {
    opening: 2.3,
    half: 0.5 * GATE_M,
    spring: 3.0,
    rise: 2.3,
    top: 6.4,
    depth: 6.0,
};

/// A tower with a passage below: solid from the arch's top to `top`, centred on z.
fn passage(b: &mut MeshBuilder, arch: &ArchWall, half: f32, depth: f32, top: f32) {
    let z = 0.5 * depth;
    b.at(shift(0.0, 0.0, z));
    arch_wall(b, arch);
    b.at(shift(0.0, 0.0, 0.0));
    for s in [-1.0f32, 1.0] {
        let (a, c) = (s * arch.opening, s * half);
        b.block(
            Vec3::new(a.min(c), -0.2, -z),
            Vec3::new(a.max(c), arch.spring, z),
        );
        // The flank above the springing, which the arch wall leaves open.
        let x = s * half;
        let mut flank = [
            (arch.spring, z),
            (arch.spring, -z),
            (arch.top, -z),
            (arch.top, z),
        ]
        .map(|(y, z)| Vec3::new(x, y, z));
        if s < 0.0 {
            flank.reverse();
        }
        b.face(&flank);
    }
    b.block(Vec3::new(-half, arch.top, -z), Vec3::new(half, top, z));
    b.bevel_box(
        Vec3::new(-half - 0.18, top - 0.5, -z - 0.18),
        Vec3::new(half + 0.18, top, z + 0.18),
        0.05,
    );
    for i in 0..4u8 {
        let x = -half + (2.0 * half - 1.2) * f32::from(i) / 3.0;
        for s in [-z - 0.1, z - 0.5] {
            b.bevel_box(
                Vec3::new(x, top, s),
                Vec3::new(x + 1.2, top + 1.1, s + 0.6),
                0.04,
            );
        }
    }
}

/// A round tower with a corbelled head.
fn corner_tower(b: &mut MeshBuilder) {
    let body = [
        (3.5, -0.2),
        (3.3, 1.2),
        (3.2, 1.3),
        (3.1, 9.6),
        (3.5, 10.4),
        (3.5, 11.6),
        (3.35, 11.6),
        (3.35, 12.9),
        (3.2, 12.9),
    ];
    b.lathe(&body, 24);
}

/// Gate below, clock storey, open belfry on four piers.
fn clock_tower(b: &mut MeshBuilder) {
    passage(b, &GATE, 0.5 * GATE_M, 6.0, 8.2);
    let p = Vec3::new;
    b.block(p(-2.6, 8.2, -2.6), p(2.6, 20.2, 2.6));
    for y in [13.6, 20.0] {
        b.bevel_box(p(-2.85, y, -2.85), p(2.85, y + 0.35, 2.85), 0.06);
    }
    for (x, z) in [(-2.6, -2.6), (2.0, -2.6), (-2.6, 2.0), (2.0, 2.0)] {
        b.bevel_box(
            p(x - 0.08, 8.2, z - 0.08),
            p(x + 0.68, 20.0, z + 0.68),
            0.04,
        );
        b.block(p(x, 20.35, z), p(x + 0.6, 22.6, z + 0.6));
    }
    let belfry = ArchWall {
        opening: 2.0,
        half: 2.6,
        spring: 22.6,
        rise: 1.5,
        top: 24.6,
        depth: 0.6,
    };
    for i in 0..4u8 {
        b.at(yaw(0.25 * f32::from(i)) * shift(0.0, 0.0, 2.6));
        arch_wall(b, &belfry);
    }
    b.at(shift(0.0, 0.0, 0.0));
    b.bevel_box(p(-2.9, 24.6, -2.9), p(2.9, 24.95, 2.9), 0.06);
}

/// The clock tower's roof.
fn pyramid(b: &mut MeshBuilder) {
    for i in 0..4u8 {
        b.at(yaw(0.25 * f32::from(i)));
        let (l, r) = (Vec3::new(-3.1, 24.9, 3.1), Vec3::new(3.1, 24.9, 3.1));
        let top = Vec3::new(0.0, 29.6, 0.0);
        let n = (r - l).cross(top - l);
        let slope = top.distance((l + r) * 0.5);
        let a = b.vertex(l, n, Vec2::new(0.0, slope));
        let c = b.vertex(r, n, Vec2::new(6.2, slope));
        let d = b.vertex(top, n, Vec2::new(3.1, 0.0));
        b.triangle(a, c, d);
    }
}

/// A disc on the plane y = 0 facing up, textured once, its upper edge towards −z.
fn disc(b: &mut MeshBuilder, radius: f32) {
    const STEPS: u8 = 40;
    let middle = b.vertex(Vec3::ZERO, Vec3::Y, Vec2::splat(0.5));
    let rim: Vec<u32> = (0..STEPS)
        .map(|i| {
            let (sin, cos) = sin_cos_turns(f32::from(i) / f32::from(STEPS));
            let p = Vec3::new(sin, 0.0, cos);
            b.vertex(
                p * radius,
                Vec3::Y,
                Vec2::new(0.5 + 0.5 * sin, 0.5 + 0.5 * cos),
            )
        })
        .collect();
    for i in 0..rim.len() {
        b.triangle(middle, rim[i], rim[(i + 1) % rim.len()]);
    }
}
