// What the composites read: the tiling and its samples.

#import shared/blocks.wgsl

// Of 2 x 2 pixels each.
@group(1) @binding(0) var owner_levels: texture_2d<u32>;
// Mip l: the samples of level l.
@group(1) @binding(1) var samples: texture_2d<f32>;

struct Tile {
    level: u32,
    block: vec2u,
    // Surfaces end within it.
    has_edge: bool,
}

// The tile that holds a pixel.
fn tile_at(texel: vec2u) -> Tile {
    let cell = textureLoad(owner_levels, texel >> vec2u(1u), 0).x;
    let level = cell & CELL_LEVEL;
    return Tile(level, texel >> vec2u(level), (cell & CELL_EDGE) != 0u);
}

// Radiance in rgb, 1 + the sample's candidate in a.
fn sample_of(tile: Tile) -> vec4f {
    return textureLoad(samples, tile.block, tile.level);
}
