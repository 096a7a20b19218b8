// A tile's patch: radiance at the corners of the tile's part inside the picture, bilinear between,
// and how far the midpoints of its left and its upper edge are raised above that.

#import composite/tiling.wgsl
#import shared/frame.wgsl

struct Patch {
    c00: vec3f,
    c10: vec3f,
    c01: vec3f,
    c11: vec3f,
    left: vec3f,
    upper: vec3f,
}

// 18 halves: c00, c10, c01.rg; c01.b, c11, left, upper.r; upper.gb. The first two parts of all
// patches lie in one array, the third ones in another.
struct PackedPatch {
    part_0: vec4u,
    part_1: vec4u,
    part_2: u32,
}

fn pack_patch(p: Patch) -> PackedPatch {
    return PackedPatch(
        vec4u(
            pack2x16float(p.c00.rg),
            pack2x16float(vec2f(p.c00.b, p.c10.r)),
            pack2x16float(p.c10.gb),
            pack2x16float(p.c01.rg),
        ),
        vec4u(
            pack2x16float(vec2f(p.c01.b, p.c11.r)),
            pack2x16float(p.c11.gb),
            pack2x16float(p.left.rg),
            pack2x16float(vec2f(p.left.b, p.upper.r)),
        ),
        pack2x16float(p.upper.gb),
    );
}

// Number of a tile's patch: those of level 1 come first, in rows, then those of level 2, and so on.
// The samples' texture is padded to whole blocks of the coarsest level, so each level has a quarter
// of the one before.
fn patch_index(block: vec2u, level: u32) -> u32 {
    let all = textureDimensions(samples, 0);
    let pixels = all.x * all.y;
    let before = (pixels - (pixels >> (2u * (level - 1u)))) / 3u;
    return before + block.y * (all.x >> level) + block.x;
}

// The corners alone.
fn unpack_corners(part_0: vec4u, part_1: vec2u) -> Patch {
    let b = unpack2x16float(part_0.y);
    let c = unpack2x16float(part_1.x);
    return Patch(
        vec3f(unpack2x16float(part_0.x), b.x),
        vec3f(b.y, unpack2x16float(part_0.z)),
        vec3f(unpack2x16float(part_0.w), c.x),
        vec3f(c.y, unpack2x16float(part_1.y)),
        vec3f(0.0),
        vec3f(0.0),
    );
}

fn unpack_left(part_1: vec4u) -> vec3f {
    return vec3f(unpack2x16float(part_1.z), unpack2x16float(part_1.w).x);
}

fn unpack_upper(part_1: vec4u, part_2: u32) -> vec3f {
    return vec3f(unpack2x16float(part_1.w).y, unpack2x16float(part_2));
}

fn tile_low(tile: Tile) -> vec2u {
    return tile.block << vec2u(tile.level);
}

fn tile_high(tile: Tile) -> vec2u {
    let low = tile_low(tile);
    return min(low + (1u << tile.level), picture_of(low).end);
}

// Position in a tile's part inside the picture, 0 to 1.
fn within(tile: Tile, position: vec2f) -> vec2f {
    let low = vec2f(tile_low(tile));
    return (position - low) / (vec2f(tile_high(tile)) - low);
}

fn patch_at(p: Patch, uv: vec2f) -> vec3f {
    return mix(mix(p.c00, p.c10, uv.x), mix(p.c01, p.c11, uv.x), uv.y);
}

// A tile in one word.
fn pack_quad(tile: Tile) -> u32 {
    return tile.block.x | (tile.block.y << 14u) | (tile.level << 28u);
}

fn unpack_quad(word: u32, has_edge: bool) -> Tile {
    return Tile(word >> 28u, vec2u(word & 0x3fffu, (word >> 14u) & 0x3fffu), has_edge);
}
