// The smooth composite: each pixel takes its tile's patch, raised to pass through the tile's sample and through the
// middles between it and neighbours of its size: bilinear interpolation where tiles are alike. After seen.wgsl and
// patches.wgsl.
//
// Patches meet along their edges, tiles raise a common edge alike and the sample's raise vanishes there, so the
// picture is continuous. Where radiance is affine, patches are and all raises are zero, so it is exact. A pixel on
// another surface than its tile's sample takes the patches of the neighbours on its side that sampled its surface.

@group(1) @binding(5) var patches_0: texture_2d<f32>;
@group(1) @binding(6) var patches_1: texture_2d<f32>;
@group(1) @binding(7) var patches_2: texture_2d<f32>;

// How much radiance at the middle of an edge lies above the mean of the edge's ends, of which `turn` is the
// difference; `axis` is that across the edge. Both tiles find the same.
fn edge_raise(tile: Tile, value: vec4f, axis: u32, far: bool, mean: vec3f, turn: vec3f) -> vec3f {
    let low = vec2f(tile_low(tile));
    let high = vec2f(tile_high(tile));
    var middle = 0.5 * (low + high);
    middle[axis] = select(low[axis], high[axis], far);
    var probe = middle;
    probe[axis] += select(-0.5, 0.5, far);
    if any(probe < vec2f(0.0)) || any(probe >= frame.size) {
        return vec3f(0.0);
    }
    let other = tile_at(vec2u(probe));
    if other.level != tile.level {
        return vec3f(0.0);
    }
    let other_value = sample_of(other);
    let here_texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
    let there_texel = sample_texel(other.block, other.level, u32(other_value.a + 0.5) - 1u);
    if (tile.has_edge || other.has_edge) && !same_surface(seen_at(here_texel), seen_at(there_texel)) {
        return vec3f(0.0);
    }
    // Samples lie beside the centres; their mean lies beside the edge's middle by `beside`.
    let here = vec2f(here_texel) + 0.5;
    let there = vec2f(there_texel) + 0.5;
    let beside = 0.5 * (here + there) - middle;
    let along_edge = turn / (high[1u - axis] - low[1u - axis]);
    let apart = there - here;
    let normal_slope = (other_value.rgb - value.rgb - along_edge * apart[1u - axis]) / apart[axis];
    return 0.5 * (value.rgb + other_value.rgb) - normal_slope * beside[axis] - along_edge * beside[1u - axis] - mean;
}

// Radiance of a tile at a position, continued beyond its edges as a constant.
fn tile_radiance(tile: Tile, value: vec4f, position: vec2f) -> vec3f {
    if tile.level == 0u {
        return value.rgb;
    }
    let mip = tile.level - 1u;
    let p = unpack_patch(
        textureLoad(patches_0, tile.block, mip),
        textureLoad(patches_1, tile.block, mip),
        textureLoad(patches_2, tile.block, mip),
    );
    let uv = saturate(within(tile, position));
    let peak = within(tile, sample_position(tile.block, tile.level, value.a));
    let far = uv > peak;
    // 1 at the sample, 0 at the edges.
    let slope = select(uv / peak, (1.0 - uv) / (1.0 - peak), far);
    // 1 at the middle of an edge, 0 at its ends.
    let tent = 1.0 - abs(2.0 * uv - 1.0);

    // Ends of the vertical edge on the pixel's side, and of the horizontal one.
    let top = select(p.c00, p.c10, far.x);
    let bottom = select(p.c01, p.c11, far.x);
    let left = select(p.c00, p.c01, far.y);
    let right = select(p.c10, p.c11, far.y);
    let raise_x = edge_raise(tile, value, 0u, far.x, 0.5 * (top + bottom), bottom - top);
    let raise_y = edge_raise(tile, value, 1u, far.y, 0.5 * (left + right), right - left);
    let raise = value.rgb - patch_at(p, peak);
    let radiance = patch_at(p, uv)
        + raise_x * ((1.0 - slope.x) * tent.y)
        + raise_y * ((1.0 - slope.y) * tent.x)
        + raise * (slope.x * slope.y);
    return max(radiance, vec3f(0.0));
}

// Radiance at a pixel whose tile sampled another surface: a mean over the neighbours on the pixel's side of the tile
// that sampled the pixel's, nearer ones counting more; without any, the tile's own.
fn across_edge(position: vec2f, own: Tile, seen: Seen) -> vec3f {
    let low = vec2f(tile_low(own));
    let high = vec2f(tile_high(own));
    let near = select(low - 0.5, high + 0.5, 2.0 * position > low + high);
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 4u; i++) {
        // The last turn is for the tile itself, should no neighbour do.
        let probe = select(position, near, (vec2u(i + 1u, (i + 1u) >> 1u) & vec2u(1u)) == vec2u(1u));
        if any(probe < vec2f(0.0)) || any(probe >= frame.size) || (i == 3u && total > 0.0) {
            continue;
        }
        let tile = tile_at(vec2u(probe));
        let value = sample_of(tile);
        let texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
        if i == 3u || same_surface(seen, seen_at(texel)) {
            let away = probe - position;
            let weight = 1.0 / (dot(away, away) + 1.0);
            sum += weight * tile_radiance(tile, value, position);
            total += weight;
        }
    }
    return sum / total;
}

@fragment
fn smooth_composite(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    let value = sample_of(tile);
    if tile.level == 0u {
        return vec4f(value.rgb, 1.0);
    }
    let position = vec2f(texel) + 0.5;
    if tile.has_edge {
        let seen = seen_at(texel);
        let sampled = seen_at(sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u));
        if !same_surface(seen, sampled) {
            return vec4f(across_edge(position, tile, seen), 1.0);
        }
    }
    return vec4f(tile_radiance(tile, value, position), 1.0);
}
