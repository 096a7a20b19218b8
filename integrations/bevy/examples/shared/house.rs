//! A house of equal rooms in a square, generated: walls with doorways, and furniture.
//!
//! Its parts reach into each other. Where two meshes only touch, the rounding of `f32` on the GPU may
//! open a crack of a pixel, and what is seen through it depends on what was culled.

use super::place::Place;
use bevy::prelude::*;
use bevy_foveal_cull::Occluder;

/// Side of a room from wall centre to wall centre, metres.
const ROOM: f32 = 6.0;
/// Height from the floor to the ceiling.
const HEIGHT: f32 = 3.0;
/// Thickness of walls, floors and ceilings.
const THICK: f32 = 0.2;
/// How far parts reach into each other.
const OVERLAP: f32 = 0.04;
/// Width and height of a doorway.
const DOOR: Vec2 = Vec2::new(1.1, 2.1);

/// What to generate.
#[derive(Clone, Copy, Debug)]
pub struct House {
    /// Rooms along each side.
    pub side: usize,
    /// Pieces of furniture in each room.
    pub furniture: usize,
    /// Whether doorways have doors that open and close.
    pub doors: bool,
    /// Point lights with shadows, in rooms along the walk; without them a light without shadows
    /// goes with the camera.
    pub lights: usize,
    /// How far they shine, metres.
    pub range: f32,
}

/// A door leaf, turning about its hinge.
#[derive(Component)]
pub struct Door {
    /// Where in its swing it begins, 0 to 1.
    pub phase: f32,
    closed: Transform,
}

impl Door {
    /// The leaf after so many seconds: it is closed for a third of the time.
    pub fn at(&self, seconds: f32) -> Transform {
        let swing = (seconds * 0.1 + self.phase).fract();
        let open = (1.5 * (core::f32::consts::TAU * swing).sin()).clamp(0.0, 1.0);
        let hinge = self.closed.rotation * Vec3::new(DOOR.x * 0.5, 0.0, 0.0);
        let turn = Quat::from_rotation_y(open * 1.5);
        Transform {
            translation: self.closed.translation - hinge + turn * hinge,
            rotation: turn * self.closed.rotation,
            ..self.closed
        }
    }
}

/// Random numbers that are the same everywhere (splitmix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

impl House {
    fn center_of(&self, x: usize, z: usize) -> Vec3 {
        Vec3::new(x as f32 * ROOM, 0.0, z as f32 * ROOM)
    }

    /// The rooms in the order of the walk: row by row, to and fro.
    fn walk(&self) -> impl Iterator<Item = (usize, usize)> {
        let side = self.side;
        (0..side * side).map(move |i| {
            let (row, column) = (i / side, i % side);
            let along = if row % 2 == 0 {
                column
            } else {
                side - 1 - column
            };
            (along, row)
        })
    }

    /// Where a walker is who has walked so many rooms, and where they look.
    pub fn walker(&self, rooms: f32) -> Transform {
        let path: Vec<Vec3> = self.walk().map(|(x, z)| self.center_of(x, z)).collect();
        let at = |rooms: f32| {
            let rooms = rooms.clamp(0.0, (path.len() - 1) as f32);
            let (i, part) = (rooms as usize, rooms.fract());
            path[i].lerp(path[(i + 1).min(path.len() - 1)], part)
        };
        let eye = at(rooms) + Vec3::new(0.11, 1.6, 0.07);
        let mut ahead = at(rooms + 0.6) + Vec3::Y * 1.5;
        if ahead.distance(eye) < 0.5 {
            ahead = eye + Vec3::X;
        }
        let sway = Quat::from_rotation_y(0.4 * (rooms * 2.3).sin());
        let mut pose = Transform::from_translation(eye).looking_at(ahead, Vec3::Y);
        pose.rotation = sway * pose.rotation;
        pose
    }

    /// Spawns everything but a camera; returns the number of meshes.
    pub fn spawn(&self, world: &mut World) -> usize {
        let mut builder = Builder::new(world, 7);
        let side = self.side;
        let mut connected = std::collections::HashSet::new();
        let rooms: Vec<_> = self.walk().collect();
        for pair in rooms.windows(2) {
            connected.insert((pair[0].min(pair[1]), pair[0].max(pair[1])));
        }
        for x in 0..side {
            for z in 0..side {
                let center = self.center_of(x, z);
                // Two heights, as on a chessboard: neighbours overlap, and no two faces coincide.
                let step = if (x + z) % 2 == 0 { 0.0 } else { 0.01 };
                builder.slab(center - Vec3::Y * (THICK * 0.5 + step));
                builder.slab(center + Vec3::Y * (HEIGHT + THICK * 0.5 + step));
                self.furnish(&mut builder, center);
            }
        }
        // Walls towards larger x and z, and around the house; pillars where walls meet.
        for i in 0..=side {
            for j in 0..=side {
                let corner = self.center_of(i, j) - Vec3::new(ROOM, 0.0, ROOM) * 0.5;
                builder.block(
                    corner + Vec3::Y * HEIGHT * 0.5,
                    Vec3::new(THICK + OVERLAP, HEIGHT + OVERLAP, THICK + OVERLAP),
                    Quat::IDENTITY,
                );
                if j < side {
                    let open = i > 0 && i < side && {
                        let rooms = ((i - 1, j), (i, j));
                        connected.contains(&rooms) || builder.random.unit() < 0.3
                    };
                    let turn = Quat::from_rotation_y(core::f32::consts::FRAC_PI_2);
                    builder.wall(corner + Vec3::Z * ROOM * 0.5, turn, open, self.doors);
                }
                if i < side {
                    let open = j > 0 && j < side && {
                        let rooms = ((i, j - 1), (i, j));
                        connected.contains(&rooms) || builder.random.unit() < 0.3
                    };
                    builder.wall(
                        corner + Vec3::X * ROOM * 0.5,
                        Quat::IDENTITY,
                        open,
                        self.doors,
                    );
                }
            }
        }
        let meshes = builder.meshes;
        self.light(world);
        meshes
    }

    fn furnish(&self, builder: &mut Builder<'_>, center: Vec3) {
        // On a grid, so that no two faces lie in each other.
        let cells = (self.furniture as f32).sqrt().ceil().max(1.0);
        let cell = (ROOM - 1.0) / cells;
        for i in 0..self.furniture {
            let (column, row) = (i as f32 % cells, (i as f32 / cells).floor());
            let corner = center - Vec3::new(1.0, 0.0, 1.0) * (ROOM - 1.0) * 0.5;
            let spot = corner + Vec3::new(column + 0.5, 0.0, row + 0.5) * cell;
            builder.thing(spot, cell * 0.62);
        }
    }

    fn light(&self, world: &mut World) {
        world.insert_resource(GlobalAmbientLight {
            brightness: 400.0,
            ..default()
        });
        let rooms: Vec<_> = self.walk().collect();
        for i in 0..self.lights {
            let (x, z) = rooms[(i * 3 + 1) % rooms.len()];
            world.spawn((
                PointLight {
                    shadow_maps_enabled: true,
                    intensity: 300_000.0,
                    range: self.range,
                    ..default()
                },
                Transform::from_translation(self.center_of(x, z) + Vec3::new(0.3, 2.6, 0.2)),
            ));
        }
    }
}

impl Place for House {
    fn spawn(&mut self, world: &mut World) {
        House::spawn(self, world);
    }

    fn walker(&self, metres: f32) -> Transform {
        House::walker(self, metres / ROOM)
    }

    fn length(&self) -> f32 {
        ROOM * (self.side * self.side - 1) as f32
    }
}

struct Builder<'w> {
    world: &'w mut World,
    random: Random,
    meshes: usize,
    cube: Handle<Mesh>,
    shapes: Vec<Handle<Mesh>>,
    plaster: Handle<StandardMaterial>,
    wood: Handle<StandardMaterial>,
    colors: Vec<Handle<StandardMaterial>>,
}

impl<'w> Builder<'w> {
    fn new(world: &'w mut World, seed: u64) -> Self {
        let (cube, shapes) = {
            let mut meshes = world.resource_mut::<Assets<Mesh>>();
            let cube = meshes.add(Cuboid::new(1.0, 1.0, 1.0));
            let shapes = vec![
                cube.clone(),
                meshes.add(Sphere::new(0.5).mesh().uv(24, 14)),
                meshes.add(Cylinder::new(0.5, 1.0)),
                meshes.add(Torus::new(0.25, 0.5)),
                meshes.add(Capsule3d::new(0.25, 0.5)),
            ];
            (cube, shapes)
        };
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let plaster = materials.add(Color::srgb(0.75, 0.72, 0.66));
        let wood = materials.add(Color::srgb(0.42, 0.28, 0.16));
        let colors = (0..8)
            .map(|i| materials.add(Color::hsl(i as f32 * 45.0, 0.6, 0.5)))
            .collect();
        Self {
            world,
            random: Random(seed),
            meshes: 0,
            cube,
            shapes,
            plaster,
            wood,
            colors,
        }
    }

    /// A part of the building, which occludes.
    fn block(&mut self, center: Vec3, size: Vec3, rotation: Quat) {
        self.meshes += 1;
        self.world.spawn((
            Mesh3d(self.cube.clone()),
            MeshMaterial3d(self.plaster.clone()),
            Transform {
                translation: center,
                rotation,
                scale: size,
            },
            Occluder::default(),
        ));
    }

    /// A floor or a ceiling.
    fn slab(&mut self, center: Vec3) {
        let side = ROOM + 2.0 * OVERLAP;
        self.block(center, Vec3::new(side, THICK, side), Quat::IDENTITY);
    }

    /// A wall along the turned x axis, between two pillars.
    fn wall(&mut self, foot: Vec3, turn: Quat, open: bool, doors: bool) {
        // From inside one pillar to inside the next, and into floor and ceiling.
        let (length, height) = (ROOM - THICK, HEIGHT + OVERLAP);
        let middle = foot + Vec3::Y * HEIGHT * 0.5;
        if !open {
            self.block(middle, Vec3::new(length, height, THICK), turn);
            return;
        }
        let piece = (length - DOOR.x) * 0.5;
        for side in [-1.0, 1.0] {
            let off = turn * Vec3::X * side * (DOOR.x + piece) * 0.5;
            self.block(middle + off, Vec3::new(piece, height, THICK), turn);
        }
        let lintel = HEIGHT - DOOR.y + OVERLAP;
        let size = Vec3::new(DOOR.x + 2.0 * OVERLAP, lintel, THICK - OVERLAP);
        self.block(foot + Vec3::Y * (DOOR.y + lintel * 0.5), size, turn);
        if doors {
            let closed = Transform {
                translation: foot + Vec3::Y * DOOR.y * 0.5,
                rotation: turn,
                scale: Vec3::new(DOOR.x + OVERLAP, DOOR.y + OVERLAP, 0.06),
            };
            self.meshes += 1;
            let phase = self.random.unit();
            self.world.spawn((
                Mesh3d(self.cube.clone()),
                MeshMaterial3d(self.wood.clone()),
                closed,
                Door { phase, closed },
                Occluder::default(),
            ));
        }
    }

    /// A piece of furniture, which is tested and does not occlude.
    fn thing(&mut self, spot: Vec3, size: f32) {
        let shape = (self.random.unit() * self.shapes.len() as f32) as usize;
        let color = (self.random.unit() * self.colors.len() as f32) as usize;
        let height = self.random.range(0.2, 1.0);
        self.meshes += 1;
        self.world.spawn((
            Mesh3d(self.shapes[shape].clone()),
            MeshMaterial3d(self.colors[color].clone()),
            Transform {
                translation: spot + Vec3::Y * height * 0.5,
                rotation: Quat::from_rotation_y(self.random.range(0.0, 6.2)),
                scale: Vec3::new(size, height, size),
            },
        ));
    }
}
