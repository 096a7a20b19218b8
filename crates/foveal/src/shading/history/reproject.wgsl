// Reprojects each pixel's light from the frame before, puts the pixel's surface into it, and
// lists what is reshaded. CPU twin: `shading/history/twin.rs`.

#import composite/tiling.wgsl
#import shading/coarse/light.wgsl
#import shading/history/layout.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl

@group(1) @binding(1) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(2) var gbuffer_depth: texture_depth_2d_array;
@group(1) @binding(3) var gbuffer_identity: texture_2d_array<u32>;
@group(1) @binding(4) var<storage, read> history: History;
// Of the frame before: pixels' light, and what else they keep.
@group(1) @binding(5) var light_before: texture_2d<u32>;
@group(1) @binding(6) var seen_before: texture_2d<u32>;
@group(1) @binding(7) var<storage, read> tiles: array<TileHistory>;
@group(1) @binding(8) var light: texture_storage_2d<rgba32uint, write>;
@group(1) @binding(9) var seen: texture_storage_2d<r32uint, write>;
@group(1) @binding(10) var radiance: texture_storage_2d<rgba16float, write>;
@group(1) @binding(11) var<storage, read_write> listed: array<Listed, 3>;
@group(1) @binding(12) var<storage, read_write> samples_listed: array<vec2u>;
// Pixels that have no history, as entries of the block that they take their light from.
@group(1) @binding(13) var<storage, read_write> bare: array<u32>;
// A bit for each pixel that is a block's sample.
@group(1) @binding(14) var<storage, read_write> wanted: array<atomic<u32>>;

// Least cosine between normals that count as the same surface.
const SAME_NORMAL: f32 = 0.95;
// Fewest samples a pixel and frame, so that change is noticed everywhere.
const LEAST_RENEWAL: f32 = 1.0 / 512.0;
// A coarse block is renewed at most by so many samples a frame.
const MOST_A_BLOCK: f32 = 2.0;

fn distance_before(texel: vec2u, position: vec3f) -> f32 {
    let left = frame.views[0].previous_clip_from_world;
    let right = frame.views[1].previous_clip_from_world;
    let row = select(
        vec4f(left[0].w, left[1].w, left[2].w, left[3].w),
        vec4f(right[0].w, right[1].w, right[2].w, right[3].w),
        view_of(texel) != 0u,
    );
    return dot(row, vec4f(position, 1.0));
}

fn list_sample(texel: vec2u, level: u32, expected: vec2f) {
    atomicAdd(&listed[SAMPLES].of_level[level], 1u);
    samples_listed[atomicAdd(&listed[SAMPLES].count, 1u)] = vec2u(sample_entry(texel, level), pack2x16float(expected));
}

// What must agree for a memory to be that of a pixel's surface.
struct Expected {
    normal: vec3f,
    // In the frame before.
    distance: f32,
    instance: u32,
    level: u32,
}

// Whether a light that lights a place has changed.
fn has_changed(position: vec3f) -> bool {
    var found = false;
    for (var i = 0u; i < history.changed_count; i++) {
        let lamp = history.changed[i];
        let away = position - lamp.xyz;
        found = found || dot(away, away) < lamp.w * lamp.w;
    }
    return found;
}

struct Memory {
    is_known: bool,
    seen: u32,
    light: vec4u,
    tile: TileHistory,
}

fn history_at(place: vec2i, texel: vec2u, expected: Expected) -> Memory {
    let picture = picture_of(texel);
    let inside = all(place >= vec2i(picture.low)) && all(place < vec2i(picture.end));
    let origin = select(texel, vec2u(place), inside);
    let old = textureLoad(seen_before, origin, 0).x;
    let words = textureLoad(light_before, origin, 0);
    let tile = tiles[tile_number(origin)];
    let known = inside && history.reset == 0u
        && (old & SEEN_AT_ALL) != 0u
        && (old & SEEN_INSTANCE) == expected.instance
        && abs(distance_from_bits(old) - expected.distance) <= SAME_DISTANCE * expected.distance
        && ((old >> SEEN_LEVEL_SHIFT) & SEEN_LEVEL) <= expected.level
        && tile.change < history.change
        && dot(unpack_light(words).normal, expected.normal) > SAME_NORMAL;
    return Memory(known, old, words, tile);
}

// Lists the sample of a pixel's block once, whoever asks for it.
fn want_block(own: Tile) {
    let texel = sample_texel(own.block, own.level, 0u);
    let number = texel.y * u32(frame.target_size.x) + texel.x;
    let bit = 1u << (number & 31u);
    if (atomicOr(&wanted[number >> 5u], bit) & bit) == 0u {
        list_sample(texel, own.level, vec2f(0.0, EXPECTED_NOTHING));
    }
}

@compute @workgroup_size(8, 8)
fn reproject(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if any(texel >= vec2u(frame.target_size)) || is_padding(texel, 0u) {
        return;
    }
    let pixel = vec2f(texel) + 0.5;
    let depth = load_depth(gbuffer_depth, texel);
    let distance = select(view_distance(depth), 1.0, depth == 0.0);
    let position = world_position(pixel, distance);
    let v = direction_to_eye(view_at(pixel), position);
    if depth == 0.0 {
        textureStore(seen, texel, vec4u(0u));
        textureStore(radiance, texel, vec4f(background(-v), 1.0));
        return;
    }
    let own = tile_at(texel);
    let s = unpack_surface(load_words(gbuffer_surface, texel), position);
    let who = load_words(gbuffer_identity, texel).xy;
    let distance_then = select(distance_before(texel, position), distance, frame.orthographic != 0u);
    let expect = Expected(s.normal, distance_then, who.x & SEEN_INSTANCE, own.level);
    let before = pixel - unpack2x16float(who.y);
    let rounded = floor(before + history.rounding);
    var memory = history_at(vec2i(rounded), texel, expect);
    let is_lit_otherwise = has_changed(position);
    if !memory.is_known && history.reset == 0u && !is_lit_otherwise {
        // The other three of the four pixels around the place.
        let first = floor(before - 0.5);
        for (var i = 1u; i < 4u; i++) {
            let other = first + abs(rounded - first - vec2f(vec2u(i, i >> 1u) & vec2u(1u)));
            let found = history_at(vec2i(other), texel, expect);
            if found.is_known && !memory.is_known {
                memory = found;
            }
        }
    }
    let known = memory.is_known && !is_lit_otherwise;
    let old = memory.seen;
    let tile = memory.tile;
    let now = (who.x & SEEN_INSTANCE) | SEEN_AT_ALL | distance_bits(distance);

    // What proved wrong is renewed sooner.
    let block = exp2(-2.0 * f32(own.level));
    let haste = clamp(tile.error / history.tolerance, 1.0, MOST_A_BLOCK / history.renewal);
    let share = clamp(block * history.renewal * haste, LEAST_RENEWAL, 1.0);
    let is_renewed = f32(order_of(texel) + history.phase) < share * 4294967296.0;

    let is_block_sample = own.level > 0u && all(texel == sample_texel(own.block, own.level, 0u));
    if known && !(is_renewed && is_block_sample) {
        let words = memory.light;
        let l = unpack_light(words);
        let diffuse = l.diffuse * max(dot(s.normal, l.direction), LEAST_COSINE);
        let mirror = l.specular * highlight(s.normal, v, l.specular_direction, squared_alpha(s) + l.spread);
        let reaching = environment_seen(pixel, distance);
        let lamps = diffuse_color(s) / PI * diffuse + environment_reflectance(s, v) * mirror;
        let sum = min(s.emissive + ambient(s, v, reaching) + lamps, vec3f(65504.0));
        if is_renewed {
            let source = select(EXPECTED_AROUND, EXPECTED_OWN, (old & SEEN_OWN) != 0u);
            list_sample(texel, 0u, vec2f(min(luminance(sum), 65504.0), source));
            textureStore(seen, texel, vec4u(now | SEEN_OWN));
        } else {
            textureStore(light, texel, words);
            textureStore(radiance, texel, vec4f(sum, 1.0));
            textureStore(seen, texel, vec4u(now | (old & (SEEN_OWN | (SEEN_LEVEL << SEEN_LEVEL_SHIFT)))));
        }
        return;
    }
    if own.level == 0u {
        list_sample(texel, 0u, vec2f(0.0, EXPECTED_NOTHING));
        textureStore(seen, texel, vec4u(now | SEEN_OWN));
        return;
    }
    want_block(own);
    bare[atomicAdd(&listed[BARE].count, 1u)] = sample_entry(texel, 0u);
    textureStore(seen, texel, vec4u(now | (min(own.level, SEEN_LEVEL) << SEEN_LEVEL_SHIFT)));
}
