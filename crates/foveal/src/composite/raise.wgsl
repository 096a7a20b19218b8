// How far radiance at the centre of an edge between two tiles of one size lies above the mean of
// the edge's ends: interpolation between the two samples instead of between corners. Each tile
// holds the raises of its left and its upper edge; where the neighbour has another size or shows
// another surface, and at the picture's border, there is none.

#import composite/patches.wgsl
#import composite/seen.wgsl
#import composite/tiling.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl

// `axis` is that across the edge, `begin` and `end` are the edge's ends.
fn edge_raise(tile: Tile, value: vec4f, seen: Seen, axis: u32, begin: vec3f, end: vec3f) -> vec3f {
    let low = vec2f(tile_low(tile));
    let high = vec2f(tile_high(tile));
    var center = 0.5 * (low + high);
    center[axis] = low[axis];
    var probe = center;
    probe[axis] -= 0.5;
    let border = vec2f(picture_of(tile_low(tile)).low);
    let other = tile_at(vec2u(max(probe, border)));
    let other_value = sample_of(other);
    let here_texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
    let there_texel = sample_texel(other.block, other.level, u32(other_value.a + 0.5) - 1u);
    let both_pure = !tile.has_edge && !other.has_edge;
    let same = both_pure || same_surface(seen, seen_at(there_texel));
    // Samples lie beside the centres; their mean lies beside the edge's centre by `beside`.
    let here = vec2f(here_texel) + 0.5;
    let there = vec2f(there_texel) + 0.5;
    let beside = 0.5 * (here + there) - center;
    let along = (end - begin) / (high[1u - axis] - low[1u - axis]);
    let apart = here - there;
    let across = (value.rgb - other_value.rgb - along * apart[1u - axis]) / apart[axis];
    let between = 0.5 * (value.rgb + other_value.rgb) - across * beside[axis] - along * beside[1u - axis];
    let joined = probe[axis] > border[axis] && other.level == tile.level && same;
    return select(vec3f(0.0), between - 0.5 * (begin + end), joined);
}
