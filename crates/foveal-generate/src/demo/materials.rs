//! The market's surfaces: textures baked once, shared by tinted materials.

use glam::{Mat3, Vec3, Vec4};
use rayon::prelude::*;

use crate::build::SceneBuilder;
use crate::texture::{self, Baked};
use foveal_scene::{AlphaMode, Material, Texture, TextureRef};

/// Indices of all materials.
#[derive(Debug)]
pub(super) struct Materials {
    pub(super) cobbles: u32,
    pub(super) walls: [u32; 6],
    pub(super) stone: u32,
    pub(super) pale_stone: u32,
    pub(super) brick: u32,
    pub(super) roof: u32,
    pub(super) timber: u32,
    pub(super) wood: u32,
    pub(super) shutters: [u32; 3],
    pub(super) awnings: [u32; 6],
    pub(super) canvas: u32,
    pub(super) rugs: [u32; 3],
    pub(super) wicker: u32,
    pub(super) terracotta: u32,
    pub(super) glazes: [u32; 2],
    pub(super) iron: u32,
    pub(super) brass: u32,
    pub(super) copper: u32,
    pub(super) produce: u32,
    pub(super) fruits: [u32; 4],
    pub(super) spices: [u32; 4],
    pub(super) leaves: u32,
    pub(super) bark: u32,
    pub(super) rope: u32,
    pub(super) glass: u32,
    pub(super) bottles: u32,
    pub(super) water: u32,
    pub(super) steam: u32,
    pub(super) flame: u32,
    pub(super) bulb: u32,
    pub(super) papers: [u32; 4],
    pub(super) lit_windows: [u32; 2],
    pub(super) dark_window: u32,
    pub(super) clock: u32,
    pub(super) moon: u32,
}

/// Texture slots of one baked surface, at its size in metres.
#[derive(Clone, Copy)]
struct Surface {
    color: Option<TextureRef>,
    normal: Option<TextureRef>,
    orm: Option<TextureRef>,
}

fn slot(texture: u32, tile_m: f32) -> Option<TextureRef> {
    Some(TextureRef {
        texture,
        uv_set: 0,
        uv_transform: Mat3::from_diagonal(Vec3::new(1.0 / tile_m, 1.0 / tile_m, 1.0)),
    })
}

fn add_surface(scene: &mut SceneBuilder, baked: Baked, tile_m: f32) -> Surface {
    Surface {
        color: slot(scene.texture(baked.color), tile_m),
        normal: slot(scene.texture(baked.normal), tile_m),
        orm: slot(scene.texture(baked.orm), tile_m),
    }
}

impl Surface {
    /// The surface in a tint.
    fn material(self, name: &str, tint: [f32; 3]) -> Material {
        Material {
            name: name.to_owned(),
            base_color: Vec3::from(tint).extend(1.0),
            base_color_texture: self.color,
            normal_texture: self.normal,
            metallic_roughness_texture: self.orm,
            occlusion_texture: self.orm,
            ..Material::default()
        }
    }
}

/// A dielectric of one colour.
fn plain(name: &str, color: [f32; 3], roughness: f32) -> Material {
    Material {
        name: name.to_owned(),
        base_color: Vec3::from(color).extend(1.0),
        metallic: 0.0,
        roughness,
        ..Material::default()
    }
}

/// Something seen through.
fn clear(name: &str, color: [f32; 4], roughness: f32) -> Material {
    Material {
        base_color: Vec4::from(color),
        alpha_mode: AlphaMode::Blend,
        ..plain(name, [1.0; 3], roughness)
    }
}

/// Something that shines by itself.
fn glowing(name: &str, color: [f32; 3], radiance: f32) -> Material {
    Material {
        emissive: Vec3::from(color) * radiance,
        ..plain(name, color, 0.8)
    }
}

/// The awnings' names, stripe colours and ground colours (sRGB).
const AWNINGS: [(&str, [f32; 3], [f32; 3]); 6] = [
    ("awning red", [0.66, 0.13, 0.11], [0.90, 0.84, 0.72]),
    ("awning teal", [0.07, 0.38, 0.40], [0.88, 0.84, 0.74]),
    ("awning ochre", [0.80, 0.50, 0.12], [0.90, 0.85, 0.75]),
    ("awning indigo", [0.16, 0.17, 0.42], [0.84, 0.80, 0.74]),
    ("awning plum", [0.46, 0.13, 0.34], [0.86, 0.72, 0.52]),
    ("awning green", [0.18, 0.36, 0.17], [0.88, 0.83, 0.68]),
];

/// From pole to pole of a paper lantern, along the paper.
const PAPER_M: f32 = 0.62;

/// Fruit: name, linear colour, roughness.
const FRUITS: [(&str, [f32; 3], f32); 4] = [
    ("oranges", [0.85, 0.24, 0.01], 0.45),
    ("apples", [0.68, 0.04, 0.03], 0.25),
    ("limes", [0.26, 0.42, 0.03], 0.40),
    ("aubergines", [0.16, 0.03, 0.20], 0.20),
];

const SPICES: [(&str, [f32; 3]); 4] = [
    ("paprika", [0.62, 0.09, 0.02]),
    ("turmeric", [0.85, 0.42, 0.02]),
    ("grain", [0.72, 0.50, 0.24]),
    ("indigo", [0.06, 0.08, 0.36]),
];

const RUGS: [[[f32; 3]; 4]; 3] = [
    [
        [0.50, 0.09, 0.10],
        [0.13, 0.14, 0.30],
        [0.80, 0.62, 0.34],
        [0.88, 0.82, 0.70],
    ],
    [
        [0.10, 0.22, 0.36],
        [0.62, 0.18, 0.12],
        [0.82, 0.74, 0.58],
        [0.80, 0.52, 0.18],
    ],
    [
        [0.60, 0.30, 0.12],
        [0.30, 0.08, 0.14],
        [0.16, 0.36, 0.34],
        [0.90, 0.80, 0.60],
    ],
];

/// Bakes all textures at once on all cores, in a fixed order.
fn bake_surfaces() -> Vec<Baked> {
    let surfaces: [fn() -> Baked; 11] = [
        texture::cobbles,
        texture::plaster,
        texture::ashlar,
        texture::bricks,
        texture::roof_tiles,
        texture::planks,
        texture::canvas,
        texture::wicker,
        texture::clay,
        texture::hammered,
        texture::iron,
    ];
    surfaces.into_par_iter().map(|bake| bake()).collect()
}

fn paint_pictures() -> Vec<Texture> {
    let pictures: [fn() -> Texture; 6] = [
        texture::leaves,
        texture::window,
        texture::clock,
        texture::moon,
        texture::steam,
        texture::paper,
    ];
    pictures.into_par_iter().map(|paint| paint()).collect()
}

impl Materials {
    /// Adds all textures and materials to the scene.
    pub(super) fn new(scene: &mut SceneBuilder) -> Self {
        let tiles_m = [4.0, 4.0, 2.4, 1.2, 1.6, 1.28, 0.5, 0.32, 0.5, 0.4, 0.5];
        let surfaces: Vec<Surface> = bake_surfaces()
            .into_iter()
            .zip(tiles_m)
            .map(|(baked, tile_m)| add_surface(scene, baked, tile_m))
            .collect();
        let [
            cobbles,
            plaster,
            ashlar,
            bricks,
            roof,
            planks,
            canvas,
            wicker,
            clay,
            hammered,
            iron,
        ] = std::array::from_fn(|i| surfaces[i]);
        let pictures: Vec<_> = paint_pictures()
            .into_iter()
            .zip([1.0, 1.0, 1.0, 1.0, 1.0, PAPER_M])
            .map(|(picture, tile_m)| slot(scene.texture(picture), tile_m))
            .collect();
        let [leaves, window, clock, moon, steam, paper] = std::array::from_fn(|i| pictures[i]);
        let awnings = AWNINGS.map(|(name, color, ground)| {
            let cloth = slot(scene.texture(texture::stripes(name, color, ground)), 1.6);
            let material = Material {
                base_color_texture: cloth,
                double_sided: true,
                ..canvas.material(name, [1.0; 3])
            };
            scene.material(material)
        });
        let rugs = [0, 1, 2].map(|i| {
            let name = format!("rug {i}");
            let knots = slot(
                scene.texture(texture::rug(&name, RUGS[i], 400 + i as u32)),
                1.0,
            );
            let material = Material {
                base_color_texture: knots,
                double_sided: true,
                ..plain(&name, [1.0; 3], 0.95)
            };
            scene.material(material)
        });
        let mut add = |material| scene.material(material);
        Self {
            cobbles: add(cobbles.material("cobbles", [0.9; 3])),
            walls: [
                add(plaster.material("plaster ochre", [0.80, 0.58, 0.32])),
                add(plaster.material("plaster rose", [0.74, 0.44, 0.34])),
                add(plaster.material("plaster cream", [0.84, 0.76, 0.60])),
                add(plaster.material("plaster sienna", [0.66, 0.38, 0.22])),
                add(plaster.material("plaster grey-blue", [0.50, 0.56, 0.60])),
                add(bricks.material("house brick", [1.0; 3])),
            ],
            stone: add(ashlar.material("stone", [0.80, 0.74, 0.66])),
            pale_stone: add(plaster.material("pale stone", [0.78, 0.72, 0.62])),
            brick: add(bricks.material("brick", [0.9; 3])),
            roof: add(roof.material("roof tiles", [1.0; 3])),
            timber: add(planks.material("timber", [0.36, 0.23, 0.14])),
            wood: add(planks.material("wood", [0.62, 0.44, 0.27])),
            shutters: [
                add(planks.material("shutter green", [0.14, 0.30, 0.22])),
                add(planks.material("shutter blue", [0.16, 0.28, 0.42])),
                add(planks.material("shutter brown", [0.34, 0.18, 0.10])),
            ],
            awnings,
            canvas: add(Material {
                double_sided: true,
                ..canvas.material("canvas", [0.86, 0.78, 0.62])
            }),
            rugs,
            wicker: add(wicker.material("wicker", [1.0; 3])),
            terracotta: add(clay.material("terracotta", [0.70, 0.36, 0.22])),
            glazes: [
                add(Material {
                    roughness: 0.25,
                    metallic_roughness_texture: None,
                    metallic: 0.0,
                    ..clay.material("glaze blue", [0.08, 0.22, 0.48])
                }),
                add(Material {
                    roughness: 0.2,
                    metallic_roughness_texture: None,
                    metallic: 0.0,
                    ..clay.material("glaze green", [0.10, 0.36, 0.26])
                }),
            ],
            iron: add(iron.material("iron", [0.5; 3])),
            brass: add(hammered.material("brass", [0.90, 0.66, 0.28])),
            copper: add(hammered.material("copper", [0.90, 0.48, 0.32])),
            produce: add(plain("produce", [1.0; 3], 0.45)),
            fruits: FRUITS.map(|(name, color, roughness)| add(plain(name, color, roughness))),
            spices: SPICES.map(|(name, color)| add(plain(name, color, 0.95))),
            leaves: add(Material {
                base_color_texture: leaves,
                alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
                double_sided: true,
                ..plain("leaves", [1.0; 3], 0.6)
            }),
            bark: add(planks.material("bark", [0.26, 0.19, 0.13])),
            rope: add(plain("rope", [0.36, 0.28, 0.18], 0.95)),
            // Frosted: its own flame stands behind it, so that it must shine by itself.
            glass: add(Material {
                emissive: Vec3::new(1.0, 0.44, 0.11) * 1.7,
                ..clear("lantern glass", [1.0, 0.80, 0.50, 0.45], 0.15)
            }),
            bottles: add(clear("bottle glass", [0.10, 0.45, 0.32, 0.55], 0.06)),
            water: add(clear("water", [0.20, 0.40, 0.46, 0.55], 0.05)),
            steam: add(Material {
                base_color_texture: steam,
                double_sided: true,
                ..clear("steam", [1.0, 1.0, 1.0, 0.20], 1.0)
            }),
            flame: add(glowing("flame", [1.0, 0.55, 0.16], 9.0)),
            bulb: add(glowing("bulb", [1.0, 0.72, 0.36], 9.0)),
            papers: [
                ("paper amber", [1.0, 0.36, 0.06], 2.0),
                ("paper red", [1.0, 0.10, 0.04], 1.9),
                ("paper teal", [0.03, 0.72, 0.66], 1.5),
                ("paper magenta", [1.0, 0.05, 0.36], 1.6),
            ]
            .map(|(name, color, radiance)| {
                add(Material {
                    emissive_texture: paper,
                    ..glowing(name, color, radiance)
                })
            }),
            lit_windows: [4.5, 1.8].map(|radiance| {
                add(Material {
                    emissive: Vec3::splat(radiance),
                    emissive_texture: window,
                    ..plain("lit window", [0.05; 3], 0.3)
                })
            }),
            dark_window: add(plain("dark window", [0.02, 0.025, 0.035], 0.08)),
            clock: add(Material {
                emissive: Vec3::splat(2.6),
                emissive_texture: clock,
                ..plain("clock", [0.1; 3], 0.5)
            }),
            moon: add(Material {
                base_color_texture: moon,
                unlit: true,
                ..plain("moon", [1.0, 0.98, 0.92], 1.0)
            }),
        }
    }
}
