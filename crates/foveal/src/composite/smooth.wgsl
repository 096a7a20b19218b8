// The smooth composite's draws.
//
// Large tiles, and those that hold an edge, are drawn as quads, whose vertices carry all that the
// tile's pixels need; then the other pixels, each looking up its own tile. A pixel on another
// surface than its tile's sample is marked and drawn again from the patches of the neighbours on
// its side that sampled its surface.

#variant
#variant BY_DEPTH
#import composite/curve.wgsl
#import composite/patches.wgsl
#import composite/seen.wgsl
#import composite/tiling.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/level.wgsl

@group(1) @binding(7) var<storage, read> quad_tiles: array<u32>;

// Clip space position of a tile's corner, numbered as a strip has them.
fn tile_corner(tile: Tile, number: u32) -> vec4f {
    let far = (vec2u(number, number >> 1u) & vec2u(1u)) == vec2u(1u);
    let corner = vec2f(select(tile_low(tile), tile_high(tile), far)) / frame.target_size;
    return vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
}

struct TileVertex {
    @builtin(position) position: vec4f,
    // Where the tile lies, and one over its size; then what `curve` takes.
    @location(0) @interpolate(flat) low_scale: vec4f,
    @location(1) @interpolate(flat) c00_peak_x: vec4f,
    @location(2) @interpolate(flat) c10_peak_y: vec4f,
    @location(3) @interpolate(flat) c01: vec3f,
    @location(4) @interpolate(flat) c11: vec3f,
    @location(5) @interpolate(flat) raise: vec3f,
    @location(6) @interpolate(flat) left: vec3f,
    @location(7) @interpolate(flat) right: vec3f,
    @location(8) @interpolate(flat) upper: vec3f,
    @location(9) @interpolate(flat) lower: vec3f,
}

@vertex
fn tile_vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) index: u32) -> TileVertex {
    let tile = unpack_quad(quad_tiles[index], false);
    let p = corners_of(tile.block, tile.level);
    let value = sample_of(tile);
    let peak = within(tile, sample_position(tile.block, tile.level, value.a));
    let next = tile.block + 1u;
    let inside = is_in_picture_of(tile, next);
    let low = vec2f(tile_low(tile));
    return TileVertex(
        tile_corner(tile, number),
        vec4f(low, 1.0 / (vec2f(tile_high(tile)) - low)),
        vec4f(p.c00, peak.x),
        vec4f(p.c10, peak.y),
        p.c01,
        p.c11,
        value.rgb - patch_at(p, peak),
        left_raise(tile.block, tile.level),
        select(vec3f(0.0), left_raise(vec2u(next.x, tile.block.y), tile.level), inside.x),
        upper_raise(tile.block, tile.level),
        select(vec3f(0.0), upper_raise(vec2u(tile.block.x, next.y), tile.level), inside.y),
    );
}

@fragment
fn tile_pixel(in: TileVertex) -> @location(0) vec4f {
    let p = Patch(in.c00_peak_x.rgb, in.c10_peak_y.rgb, in.c01, in.c11, vec3f(0.0), vec3f(0.0));
    let peak = vec2f(in.c00_peak_x.a, in.c10_peak_y.a);
    let uv = (in.position.xy - in.low_scale.xy) * in.low_scale.zw;
    let far = uv > peak;
    let raise_x = select(in.left, in.right, far.x);
    let raise_y = select(in.upper, in.lower, far.y);
    return vec4f(curve(p, peak, uv, in.raise, raise_x, raise_y), 1.0);
}

// Pixels that no quad covered.
@fragment
fn other_pixel(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    return vec4f(tile_radiance(tile, sample_of(tile), vec2f(texel) + 0.5), 1.0);
}

struct EdgeVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) tile: u32,
    // What the tile's sample saw.
    @location(1) @interpolate(flat) instance: u32,
    @location(2) @interpolate(flat) world: vec3f,
    @location(3) @interpolate(flat) normal: vec3f,
}

@vertex
fn edge_vertex(@builtin(vertex_index) number: u32, @builtin(instance_index) index: u32) -> EdgeVertex {
    let word = quad_tiles[arrayLength(&quad_tiles) / 2u + index];
    let tile = unpack_quad(word, true);
    let seen = seen_at(sample_texel(tile.block, tile.level, u32(sample_of(tile).a + 0.5) - 1u));
    return EdgeVertex(tile_corner(tile, number), word, seen.instance, seen.position, seen.normal);
}

// Marks pixels that show another surface than their tile's sample.
@fragment
fn mark_edge_pixel(in: EdgeVertex) {
    if same_surface(seen_at(vec2u(in.position.xy)), Seen(in.instance, in.world, in.normal)) {
        discard;
    }
}

// Radiance at a pixel whose tile sampled another surface: a mean over the neighbours on the pixel's
// side of the tile that sampled the pixel's, nearer ones counting more; without any, over those
// across from them; else the tile's own.
fn across_edge(position: vec2f, own: Tile, seen: Seen) -> vec3f {
    let low = vec2f(tile_low(own));
    let high = vec2f(tile_high(own));
    let picture = picture_of(tile_low(own));
    let is_far = 2.0 * position > low + high;
    let near = select(low - 0.5, high + 0.5, is_far);
    let across = select(high + 0.5, low - 0.5, is_far);
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 6u; i++) {
        if i >= 3u && total > 0.0 {
            break;
        }
        // Beside, above or below, both; then across; the last turn is for the tile itself, should
        // no neighbour do.
        let turn = vec2u(i + 1u, (i + 1u) >> 1u) & vec2u(1u);
        let turn_across = vec2u(u32(i == 3u), u32(i == 4u));
        let probe_near = select(position, near, turn == vec2u(1u));
        let probe = select(probe_near, select(position, across, turn_across == vec2u(1u)), i >= 3u);
        if any(probe < vec2f(picture.low)) || any(probe >= vec2f(picture.end)) {
            continue;
        }
        let tile = tile_at(vec2u(probe));
        let value = sample_of(tile);
        let texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
        if i == 5u || same_surface(seen, seen_at(texel)) {
            let away = probe - position;
            let weight = 1.0 / (dot(away, away) + 1.0);
            sum += weight * tile_radiance(tile, value, position);
            total += weight;
        }
    }
    return sum / total;
}

// Marked pixels. Nothing is discarded here, so that the stencil test may come first.
@fragment
fn edge_pixel(in: EdgeVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    return vec4f(across_edge(vec2f(texel) + 0.5, unpack_quad(in.tile, true), seen_at(texel)), 1.0);
}
