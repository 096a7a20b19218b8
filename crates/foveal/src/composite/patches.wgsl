// A tile's patch: radiance at the corners of the tile's part inside the picture, bilinear between. After
// tiling.wgsl.

struct Patch {
    c00: vec3f,
    c10: vec3f,
    c01: vec3f,
    c11: vec3f,
}

fn unpack_patch(part_0: vec4f, part_1: vec4f, part_2: vec4f) -> Patch {
    return Patch(part_0.rgb, part_1.rgb, part_2.rgb, vec3f(part_0.a, part_1.a, part_2.a));
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
