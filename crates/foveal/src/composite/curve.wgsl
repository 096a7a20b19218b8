// Radiance within a tile: its patch, raised to pass through the tile's sample and through the
// midpoints between it and neighbours of its size: bilinear interpolation where tiles are alike.
// CPU twin of all of the smooth composite: `composite/twin.rs`.
//
// Patches meet along their edges, tiles raise a common edge alike and the sample's raise vanishes
// there, so the picture is continuous. Where radiance is affine, patches are and all raises are
// zero, so it is exact.

#import composite/patches.wgsl
#import composite/tiling.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl

// Two for each patch, and one.
@group(1) @binding(5) var<storage, read> patches: array<vec4u>;
@group(1) @binding(6) var<storage, read> upper_raises: array<u32>;

// `uv` and the sample's place `peak` lie within the tile, 0 to 1; `raise` is the sample's above the
// patch; `raise_x` that of the left or right edge, `raise_y` that of the upper or lower one,
// whichever are on uv's side of the sample.
fn curve(p: Patch, peak: vec2f, uv: vec2f, raise: vec3f, raise_x: vec3f, raise_y: vec3f) -> vec3f {
    // 1 at the sample, 0 at the edges.
    let slope = select(uv / peak, (1.0 - uv) / (1.0 - peak), uv > peak);
    // 1 at the centre of an edge, 0 at its ends.
    let tent = 1.0 - abs(2.0 * uv - 1.0);
    let radiance = patch_at(p, uv)
        + raise_x * ((1.0 - slope.x) * tent.y)
        + raise_y * ((1.0 - slope.y) * tent.x)
        + raise * (slope.x * slope.y);
    return clamp(radiance, vec3f(0.0), vec3f(65504.0));
}

fn corners_of(block: vec2u, level: u32) -> Patch {
    let index = patch_index(block, level);
    return unpack_corners(patches[2u * index], patches[2u * index + 1u].xy);
}

fn left_raise(block: vec2u, level: u32) -> vec3f {
    return unpack_left(patches[2u * patch_index(block, level) + 1u]);
}

fn upper_raise(block: vec2u, level: u32) -> vec3f {
    let index = patch_index(block, level);
    return unpack_upper(patches[2u * index + 1u], upper_raises[index]);
}

// Whether blocks of a tile's size, across and down, still begin in the tile's picture.
fn is_in_picture_of(tile: Tile, block: vec2u) -> vec2<bool> {
    return (block << vec2u(tile.level)) < picture_of(tile_low(tile)).end;
}

// Radiance of a tile at a position, continued beyond its edges as a constant.
fn tile_radiance(tile: Tile, value: vec4f, position: vec2f) -> vec3f {
    // A pixel has no patch; what is read in its place is not used.
    let level = max(tile.level, 1u);
    let p = corners_of(tile.block, level);
    let uv = saturate(within(tile, position));
    let peak = within(tile, sample_position(tile.block, tile.level, value.a));
    // A tile's right edge is the left one of the tile beside it.
    let next = tile.block + vec2u(uv > peak);
    let inside = is_in_picture_of(tile, next);
    let raise_x = select(vec3f(0.0), left_raise(vec2u(next.x, tile.block.y), level), inside.x);
    let raise_y = select(vec3f(0.0), upper_raise(vec2u(tile.block.x, next.y), level), inside.y);
    let radiance = curve(p, peak, uv, value.rgb - patch_at(p, peak), raise_x, raise_y);
    return select(radiance, value.rgb, tile.level == 0u);
}
