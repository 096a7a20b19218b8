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
// Of a tile's left and upper edge.
@group(1) @binding(8) var raises_left: texture_2d<f32>;
@group(1) @binding(9) var raises_upper: texture_2d<f32>;

// Radiance of a tile at a position, continued beyond its edges as a constant.
fn tile_radiance(tile: Tile, value: vec4f, position: vec2f) -> vec3f {
    // A pixel has no patch; what is read in its place is not used.
    let mip = max(tile.level, 1u) - 1u;
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

    // A tile's right edge is the left one of the tile beside it.
    let next = tile.block + vec2u(far);
    let inside = (next << vec2u(tile.level)) < picture_of(tile_low(tile)).end;
    let left = textureLoad(raises_left, vec2u(next.x, tile.block.y), mip).rgb;
    let upper = textureLoad(raises_upper, vec2u(tile.block.x, next.y), mip).rgb;
    let raise_x = select(vec3f(0.0), left, inside.x);
    let raise_y = select(vec3f(0.0), upper, inside.y);
    let raise = value.rgb - patch_at(p, peak);
    let radiance = patch_at(p, uv)
        + raise_x * ((1.0 - slope.x) * tent.y)
        + raise_y * ((1.0 - slope.y) * tent.x)
        + raise * (slope.x * slope.y);
    return select(max(radiance, vec3f(0.0)), value.rgb, tile.level == 0u);
}

// Radiance at a pixel whose tile sampled another surface: a mean over the neighbours on the pixel's side of the tile
// that sampled the pixel's, nearer ones counting more; without any, the tile's own.
fn across_edge(position: vec2f, own: Tile, seen: Seen) -> vec3f {
    let low = vec2f(tile_low(own));
    let high = vec2f(tile_high(own));
    let picture = picture_of(tile_low(own));
    let near = select(low - 0.5, high + 0.5, 2.0 * position > low + high);
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 4u; i++) {
        // The last turn is for the tile itself, should no neighbour do.
        let probe = select(position, near, (vec2u(i + 1u, (i + 1u) >> 1u) & vec2u(1u)) == vec2u(1u));
        if any(probe < vec2f(picture.low)) || any(probe >= vec2f(picture.end)) || (i == 3u && total > 0.0) {
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

// Every pixel, as if its tile held one surface.
@fragment
fn smooth_composite(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    return vec4f(tile_radiance(tile, sample_of(tile), vec2f(texel) + 0.5), 1.0);
}

// Marks pixels that show another surface than their tile's sample.
@fragment
fn mark_edges(in: LevelVertex) {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    if tile.level == 0u || !tile.has_edge {
        discard;
    }
    let texel_sampled = sample_texel(tile.block, tile.level, u32(sample_of(tile).a + 0.5) - 1u);
    if same_surface(seen_at(texel), seen_at(texel_sampled)) {
        discard;
    }
}

// Marked pixels. Nothing is discarded here, so that the stencil test may come first.
@fragment
fn smooth_edges(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    return vec4f(across_edge(vec2f(texel) + 0.5, tile, seen_at(texel)), 1.0);
}
