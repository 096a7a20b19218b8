// Reprojects each pixel's light from the frame before, puts the pixel's surface into it, and
// chooses what is reshaded. CPU twin: `shading/history/twin.rs`.

#variant
#variant DISPATCHED
#import composite/tiling.wgsl
#ifdef TABLES
#import gpu/table.wgsl
#endif
#import shading/coarse/light.wgsl
#import shading/history/layout.wgsl
#import shading/history/parameters.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/identity.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#ifndef DISPATCHED
#import shared/full_screen.wgsl
#endif

@group(1) @binding(1) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(2) var gbuffer_depth: texture_depth_2d_array;
@group(1) @binding(3) var gbuffer_identity: texture_2d_array<u32>;
@group(1) @binding(4) var<uniform> parameters: HistoryParameters;
// Where changed lights reach, now or in the frame before: centre and radius, world space. Nothing
// is kept there. A negative radius ends them.
#ifdef TABLES
@group(1) @binding(10) var changed_table: texture_2d<u32>;
#else
@group(1) @binding(10) var<storage, read> changed: array<vec4f>;
#endif
// Of the frame before: pixels' light, and what else they keep.
@group(1) @binding(5) var light_before: texture_2d<u32>;
@group(1) @binding(6) var seen_before: texture_2d<u32>;
// A texel for each tile: `TileHistory`.
@group(1) @binding(7) var tiles: texture_2d<f32>;
@group(1) @binding(8) var<storage, read_write> listed: array<Listed, LISTS>;
// Pixels that ask for a sample, as entries with a choice in place of a level.
@group(1) @binding(9) var<storage, read_write> chosen: array<u32>;

// Least cosine between normals that count as the same surface.
const SAME_NORMAL: f32 = 0.95;
// Fewest samples a pixel and frame, so that change is noticed everywhere; of larger blocks one each.
const LEAST_RENEWAL: f32 = 1.0 / 512.0;
// A coarse block is renewed at most by so many samples a frame.
const MOST_A_BLOCK: f32 = 2.0;

// Clip space of a place in the frame before.
fn clip_before(texel: vec2u, position: vec3f) -> vec4f {
    let left = frame.views[0].previous_clip_from_world;
    let right = frame.views[1].previous_clip_from_world;
    let is_right = view_of(texel) != 0u;
    let x = select(left[0], right[0], is_right) * position.x;
    let y = select(left[1], right[1], is_right) * position.y;
    let z = select(left[2], right[2], is_right) * position.z;
    return x + y + z + select(left[3], right[3], is_right);
}

// Part of a highlight's width, the square root of the squared alpha, by which the direction to the
// eye may turn in a frame where highlights show: mirrored light is kept as that of one direction,
// and says nothing of highlights that come from beside it. Found by measurement, as what follows.
const MOST_TURNED: f32 = 0.1;
// What a turn below that counts as an error.
const TURN_AS_ERROR: f32 = 2.0;
// No highlight is narrower.
const LEAST_SQUARED_ALPHA: f32 = 0.0004;
// Part of scattered light that a highlight's peak exceeds before it counts.
const HARDLY_SHOWS: f32 = 0.2;

// By how much the direction to the eye, `v`, has turned since the frame before, as a part of a
// highlight's width; less where highlights hardly show.
fn turn_by_width(s: Surface, v: vec3f, before: vec3f) -> f32 {
    let by = light_factors(s, v);
    let a2 = max(squared_alpha(s), LEAST_SQUARED_ALPHA);
    let peak = luminance(by.mirrored) * 0.25 / (PI * a2);
    let share = saturate(peak / max(luminance(by.scattered), 1e-3) - HARDLY_SHOWS);
    return distance(v, before) * inverseSqrt(a2) * share;
}

// Surfaces are taken to be seen no more from the side than by this cosine.
const LEAST_FACING: f32 = 0.2;
// By how many times a pixel of the frame before may be larger on a surface than one is now. Slow
// approach is left to renewal.
const MOST_LARGER: f32 = 1.19;

// Whether a pixel of the frame before was larger on a surface than one is now, along or across: after
// a cut to a closer view. `sides`: of a pixel that faces the eye, then and now; `facing`: cosines of
// the surface to the eye.
fn was_larger(sides: vec2f, facing: vec2f) -> bool {
    let seen = max(abs(facing), vec2f(LEAST_FACING));
    return sides.x * max(seen.x, seen.y) > MOST_LARGER * sides.y * seen.x;
}

// What must agree for a memory to be that of a pixel's surface.
struct Expected {
    normal: vec3f,
    // In the frame before.
    distance: f32,
    instance: u32,
    level: u32,
}

fn changed_light(i: u32) -> vec4f {
#ifdef TABLES
    return bitcast<vec4f>(textureLoad(changed_table, table_texel(i), 0));
#else
    return changed[i];
#endif
}

// Whether a light that lights a place has changed.
fn has_changed(position: vec3f) -> bool {
    var found = false;
    var i = 0u;
    loop {
        let lamp = changed_light(i);
        let away = position - lamp.xyz;
        found = found || (lamp.w > 0.0 && dot(away, away) < lamp.w * lamp.w);
        i++;
        continuing {
            break if lamp.w < 0.0;
        }
    }
    return found;
}

struct Memory {
    is_known: bool,
    seen: u32,
    light: vec4u,
    tile: TileHistory,
}

fn history_at(place: vec2i, texel: vec2u, picture: Picture, expected: Expected) -> Memory {
    let inside = all(place >= vec2i(picture.low)) && all(place < vec2i(picture.end));
    let origin = select(texel, vec2u(place), inside);
    let noted = textureLoad(seen_before, origin, 0).x;
    let by_itself = (noted | SEEN_OWN) & ~(SEEN_LEVEL << SEEN_LEVEL_SHIFT);
    let old = select(noted, by_itself, parameters.whole_round != 0u);
    let words = textureLoad(light_before, origin, 0);
    let measured = textureLoad(tiles, origin / 8u, 0).xy;
    let tile = TileHistory(measured.x, measured.y);
    let known = inside
        && (old & SEEN_AT_ALL) != 0u
        && (old & SEEN_INSTANCE) == expected.instance
        && abs(distance_from_bits(old) - expected.distance) <= SAME_DISTANCE * expected.distance
        && ((old >> SEEN_LEVEL_SHIFT) & SEEN_LEVEL) <= expected.level
        && tile.change < parameters.change
        && dot(unpack_light(words).normal, expected.normal) > SAME_NORMAL;
    return Memory(known, old, words, tile);
}

// The first place of the frame before that tells a pixel's light: the one that motion names, then the
// other three of the four around it.
fn remember(before: vec2f, texel: vec2u, picture: Picture, expected: Expected, places: u32) -> Memory {
    let rounded = floor(before + parameters.rounding);
    let first = floor(before - 0.5);
    var memory = Memory(false, 0u, vec4u(0u), TileHistory(0.0, 0.0));
    // A loop that ends early, and asks at its end: where all branches are run, loops alone save work,
    // and the body of one that asks first runs once more.
    var i = 0u;
    loop {
        let other = first + abs(rounded - first - vec2f(vec2u(i, i >> 1u) & vec2u(1u)));
        if i < places {
            memory = history_at(vec2i(other), texel, picture, expected);
        }
        i++;
        continuing {
            break if i >= places || memory.is_known;
        }
    }
    return memory;
}

// Whether a pixel's share of its block's samples is due. What proved wrong is renewed sooner.
fn is_due(texel: vec2u, level: u32, error: f32) -> bool {
    let block = exp2(-2.0 * f32(level));
    let haste = clamp(error / parameters.tolerance, 1.0, MOST_A_BLOCK / parameters.renewal);
    let share = clamp(block * parameters.renewal * haste, min(LEAST_RENEWAL, block), 1.0);
    return f32(order_of(texel) + parameters.phase) < share * 4294967296.0;
}

// What a pixel keeps, and what it shows.
struct Reprojected {
    @location(0) light: vec4u,
    @location(1) seen: u32,
    @location(2) radiance: vec4f,
}

// The list is written at one place: devices that run all branches pay for each place, whether or not
// anything is written there. What few pixels need follows in list.wgsl.
fn reprojected(texel: vec2u) -> Reprojected {
    let pixel = vec2f(texel) + 0.5;
    if is_padding(texel, 0u) {
        return Reprojected();
    }
    let depth = load_depth(gbuffer_depth, texel);
    let is_behind = depth == 0.0;
    let distance = select(view_distance(depth), 1.0, is_behind);
    let position = world_position(pixel, distance);
    let v = direction_to_eye(view_at(pixel), position);
    let s = unpack_surface(load_words(gbuffer_surface, texel), position);
    let look = environment_look(s, v, is_behind);
    if is_behind {
        return Reprojected(vec4u(0u), 0u, vec4f(background(look), 1.0));
    }
    let own = tile_at(texel);
    let who = load_words(gbuffer_identity, texel).xy;
    let clip_then = clip_before(texel, position);
    let is_orthographic = frame.orthographic != 0u;
    let distance_then = select(clip_then.w, view_distance(clip_then.z), is_orthographic);
    let is_right = view_of(texel) != 0u;
    let eye_then = select(frame.views[0].previous_eye, frame.views[1].previous_eye, is_right);
    let half_width_then = select(frame.views[0].previous_half_width, frame.views[1].previous_half_width, is_right);
    let half_width = abs(select(frame.views[0].view_from_ndc.x, frame.views[1].view_from_ndc.x, is_right));
    let v_then = select(normalize(eye_then - position), eye_then, is_orthographic);
    let sides = vec2f(abs(half_width_then) * clip_then.w, half_width * select(distance, 1.0, is_orthographic));
    let is_coarser = was_larger(sides, vec2f(dot(s.normal, v_then), dot(s.normal, v)));
    let expected = Expected(s.normal, distance_then, who.x & SEEN_INSTANCE, own.level);
    let picture = picture_of(texel);
    let motion = unpack2x16float(who.y);
    let before = pixel - motion;
    // Other light falls on what has moved. Without `||`, which would branch on a uniform alone.
    let has_moved = (who.y & HAS_MOVED) != 0u;
    let turned = turn_by_width(s, v, v_then);
    let is_other = (parameters.reset != 0u) | has_changed(position) | has_moved | is_coarser | (turned > MOST_TURNED);
    let memory = remember(before, texel, picture, expected, select(4u, 0u, is_other));

    let sample = sample_texel(own.block, own.level, 0u);
    let is_coarse = own.level > 0u;
    let is_renewed = is_due(texel, own.level, max(memory.tile.error, TURN_AS_ERROR * turned));
    let is_reprojected = memory.is_known && !is_renewed;
    // Shaded by itself; a block's sample is shaded for its block.
    let is_shaded = !is_reprojected && !(is_coarse && (!memory.is_known || all(texel == sample)));
    let is_bare = !is_reprojected && !is_shaded;

    let was_own = (memory.seen & SEEN_OWN) != 0u;
    if is_shaded || is_bare {
        let known_from = select(EXPECTED_AROUND, EXPECTED_OWN, was_own);
        let itself = CHOSEN_ITSELF + u32(select(EXPECTED_NOTHING, known_from, memory.is_known));
        let entry = sample_entry(texel, select(own.level, itself, is_shaded));
        chosen[atomicAdd(&listed[CHOSEN].count, 1u)] = entry;
    }
    var notes = memory.seen & (SEEN_OWN | (SEEN_LEVEL << SEEN_LEVEL_SHIFT));
    notes = select(notes, SEEN_OWN, is_shaded);
    notes = select(notes, min(own.level, SEEN_LEVEL) << SEEN_LEVEL_SHIFT, is_bare);
    let seen = (who.x & SEEN_INSTANCE) | SEEN_AT_ALL | distance_bits(distance) | notes;
    let shown = shown_of(unpack_light(memory.light), s, v, environment_seen(pixel, distance), look);
    return Reprojected(memory.light, seen, vec4f(shown, 1.0));
}

#ifdef DISPATCHED
@group(2) @binding(0) var light_kept: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(1) var seen_kept: texture_storage_2d<r32uint, write>;
@group(2) @binding(2) var radiance_shown: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn reproject_all(@builtin(global_invocation_id) at: vec3u) {
    if all(at.xy < textureDimensions(light_kept)) {
        let kept = reprojected(at.xy);
        textureStore(light_kept, at.xy, kept.light);
        textureStore(seen_kept, at.xy, vec4u(kept.seen, 0u, 0u, 0u));
        textureStore(radiance_shown, at.xy, kept.radiance);
    }
}
#else
@fragment
fn reproject(@builtin(position) pixel_center: vec4f) -> Reprojected {
    return reprojected(vec2u(pixel_center.xy));
}
#endif
