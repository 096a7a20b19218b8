// How much of the environment's light reaches a place, as far as depth tells: the part of the
// hemisphere, weighted by the cosine, that the nearest horizons leave free (Jimenez, Wu, Pesce and
// Jarabo 2016, 'Practical Real-Time Strategies for Accurate Indirect Occlusion'). CPU twin:
// `ambient/twin.rs`.

#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/normal_of_depth.wgsl

struct AmbientOcclusion {
    // Metres: what lies farther away occludes nothing.
    radius: f32,
    // Of the radius on the screen, in pixels: beyond, it is shortened.
    most_pixels: f32,
    // WebGL 2 binds multiples of 16 bytes.
    padding: vec2f,
}

#ifdef REDUCED
// Its bits.
@group(1) @binding(0) var gbuffer_depth: texture_2d<u32>;
#else
@group(1) @binding(0) var gbuffer_depth: texture_depth_2d_array;
#endif
@group(1) @binding(1) var<uniform> occlusion: AmbientOcclusion;

const PI: f32 = 3.14159265;

// Slices of the hemisphere that a pixel looks along, those of a place that stands for a block of
// pixels, and steps along each side of a slice.
const SLICES: u32 = 2u;
const BLOCK_SLICES: u32 = 4u;
const STEPS: u32 = 4u;

// Sines of angles above a surface. Below the first, what seems to rise may be depth's rounding or
// the bend between facets; from the second on an occluder counts in full.
const LEAST_RISE: f32 = 0.02;
const FULL_RISE: f32 = 0.06;

// Where a place's slices and steps begin, as parts of the way to the next: places side by side look
// in other directions, and `resolve.wgsl` joins as many as there are.
struct Pattern {
    turn: f32,
    jitter: f32,
    slices: u32,
}

// 3 x 3 pixels, or 2 x 2 blocks, look in different directions. `place`: column and row in the eye's
// own picture, so that two eyes are as each alone.
fn pattern_of(place: vec2u, level: u32) -> Pattern {
    let of_pixel = place.x % 3u + 3u * (place.y % 3u);
    let of_block = (place.x & 1u) + 2u * (place.y & 1u);
    let is_pixel = level == 0u;
    let number = select(of_block, of_pixel, is_pixel);
    let count = select(4u, 9u, is_pixel);
    let turn = (number * select(3u, 4u, is_pixel)) % count;
    let jitter = (number * select(1u, 2u, is_pixel) + 1u) % count;
    let even = 1.0 / f32(count);
    return Pattern((f32(turn) + 0.5) * even, (f32(jitter) + 0.5) * even, select(BLOCK_SLICES, SLICES, is_pixel));
}

// View-space position of what a texel shows.
fn place_seen(texel: vec2u, depth: f32) -> vec3f {
    return view_position(vec2f(texel) + 0.5, view_distance(depth));
}

// Integral of the cosine over the angles from the view to a horizon (Jimenez et al., equation 7):
// `normal` and `horizon` are angles from the view direction in the slice's plane.
fn arc(horizon: f32, normal: f32) -> f32 {
    return 0.25 * (cos(normal) + 2.0 * horizon * sin(normal) - cos(2.0 * horizon - normal));
}

// What a place sees from, view space.
struct Seer {
    texel: vec2u,
    position: vec3f,
    normal: vec3f,
    // To the eye.
    view: vec3f,
    // Metres.
    reach: f32,
}

// Cosine of the angle between the view and the horizon along a direction on the screen, `toward` its
// unit vector in pixels and `pixels` the reach; `low` where nothing rises.
fn horizon_along(s: Seer, toward: vec2f, pixels: f32, low: f32, jitter: f32) -> f32 {
    let picture = picture_of(s.texel);
    let first = vec2i(picture.low);
    let end = vec2i(picture.end);
    var horizon = low;
    for (var k = 0u; k < STEPS; k++) {
        let part = (f32(k) + jitter) / f32(STEPS);
        let away = max(part * part * pixels, f32(k) + 1.0);
        let at = vec2i(s.texel) + vec2i(round(toward * away));
        let inside = all(at >= first) && all(at < end);
        let texel = vec2u(clamp(at, first, end - 1));
        let depth = load_depth(gbuffer_depth, texel);
        let delta = place_seen(texel, max(depth, 1e-20)) - s.position;
        let size = max(length(delta), 1e-20);
        let near = saturate(2.0 - 2.0 * size / s.reach);
        let rises = saturate((dot(delta, s.normal) / size - LEAST_RISE) / (FULL_RISE - LEAST_RISE));
        let counts = select(0.0, near * rises, inside && depth > 0.0);
        horizon = max(horizon, mix(low, dot(delta, s.view) / size, counts));
    }
    return horizon;
}

// Part of the environment's light that reaches the surface at a texel whose depth is not 0.
fn visibility_from(texel: vec2u, pattern: Pattern) -> f32 {
    let depth = load_depth(gbuffer_depth, texel);
    let slope = vec2f(depth_step(texel, 0u, depth), depth_step(texel, 1u, depth));
    let normal = normal_from_steps(texel, depth, slope);
    let position = place_seen(texel, depth);
    let is_flat = frame.orthographic != 0u;
    let view = select(normalize(-position), vec3f(0.0, 0.0, 1.0), is_flat);
    let to_view = frame.views[view_of(texel)].view_from_ndc;
    // Pixels per metre.
    let scale = frame.size / (2.0 * abs(to_view.xy)) / select(-position.z, 1.0, is_flat);
    let reach = min(occlusion.radius, occlusion.most_pixels / max(scale.x, scale.y));
    let s = Seer(texel, position, normal, view, reach);
    var free = 0.0;
    var all_of_it = 1e-6;
    for (var i = 0u; i < pattern.slices; i++) {
        let angle = PI * (f32(i) + pattern.turn) / f32(pattern.slices);
        let along = vec3f(cos(angle), sin(angle), 0.0);
        let axis = normalize(cross(along, view));
        let in_slice = normal - axis * dot(normal, axis);
        let size = max(length(in_slice), 1e-6);
        let cosine = clamp(dot(in_slice, view) / size, 0.0, 1.0);
        let side = select(-1.0, 1.0, dot(along - view * dot(along, view), in_slice) >= 0.0);
        let tilt = side * acos(cosine);
        let on_screen = vec2f(along.x, -along.y) * scale;
        let pixels = length(on_screen);
        let toward = on_screen / pixels;
        let low = sin(tilt);
        let ahead = horizon_along(s, toward, pixels * reach, -low, pattern.jitter);
        let behind = horizon_along(s, -toward, pixels * reach, low, pattern.jitter);
        let most = min(acos(clamp(ahead, -1.0, 1.0)), tilt + 0.5 * PI);
        let least = max(-acos(clamp(behind, -1.0, 1.0)), tilt - 0.5 * PI);
        free += size * (arc(most, tilt) + arc(least, tilt));
        all_of_it += size * (cosine + tilt * low);
    }
    return saturate(free / all_of_it);
}

// A texel's column and row, or its block's, in its eye's picture.
fn place_of(texel: vec2u, level: u32) -> vec2u {
    return (texel - picture_of(texel).low) >> vec2u(level);
}
