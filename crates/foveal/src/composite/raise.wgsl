// How far radiance at the middle of an edge between two tiles of one size lies above the mean of the edge's ends:
// interpolation between the two samples instead of between corners. After seen.wgsl and patches.wgsl. Each tile
// holds the raises of its left and its upper edge; where the neighbour has another size or shows another surface,
// and at the picture's border, there is none.

@group(1) @binding(5) var corners_0: texture_2d<f32>;
@group(1) @binding(6) var corners_1: texture_2d<f32>;
@group(1) @binding(7) var corners_2: texture_2d<f32>;

struct RaiseOut {
    @location(0) left: vec4f,
    @location(1) upper: vec4f,
}

// `axis` is that across the edge, `begin` and `end` are the edge's ends.
fn edge_raise(tile: Tile, value: vec4f, axis: u32, begin: vec3f, end: vec3f) -> vec4f {
    let low = vec2f(tile_low(tile));
    let high = vec2f(tile_high(tile));
    var middle = 0.5 * (low + high);
    middle[axis] = low[axis];
    var probe = middle;
    probe[axis] -= 0.5;
    let border = vec2f(picture_of(tile_low(tile)).low);
    let other = tile_at(vec2u(max(probe, border)));
    let other_value = sample_of(other);
    let here_texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
    let there_texel = sample_texel(other.block, other.level, u32(other_value.a + 0.5) - 1u);
    let both_pure = !tile.has_edge && !other.has_edge;
    let same = both_pure || same_surface(seen_at(here_texel), seen_at(there_texel));
    // Samples lie beside the centres; their mean lies beside the edge's middle by `beside`.
    let here = vec2f(here_texel) + 0.5;
    let there = vec2f(there_texel) + 0.5;
    let beside = 0.5 * (here + there) - middle;
    let along = (end - begin) / (high[1u - axis] - low[1u - axis]);
    let apart = here - there;
    let across = (value.rgb - other_value.rgb - along * apart[1u - axis]) / apart[axis];
    let between = 0.5 * (value.rgb + other_value.rgb) - across * beside[axis] - along * beside[1u - axis];
    let joined = probe[axis] > border[axis] && other.level == tile.level && same;
    return vec4f(select(vec3f(0.0), between - 0.5 * (begin + end), joined), 0.0);
}

@fragment
fn raise_edges(in: LevelVertex) -> RaiseOut {
    let block = vec2u(in.position.xy);
    let first = block << vec2u(in.level);
    let tile = tile_at(min(first, picture_of(first).end - 1u));
    let value = sample_of(tile);
    let mip = in.level - 1u;
    let corners = unpack_patch(
        textureLoad(corners_0, block, mip),
        textureLoad(corners_1, block, mip),
        textureLoad(corners_2, block, mip),
    );
    return RaiseOut(
        edge_raise(tile, value, 0u, corners.c00, corners.c01),
        edge_raise(tile, value, 1u, corners.c00, corners.c10),
    );
}
