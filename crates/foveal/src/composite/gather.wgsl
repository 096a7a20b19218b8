// The light of the samples around a pixel. The importing shader binds `gbuffer_depth` and says
// where a tile's sample lies (`sampled_at`) and what it holds (`light_of`). CPU twin:
// `composite/light_twin.rs`.
//
// A pixel of a tile of level l looks at the four points around it of the lattice of that level's
// centres, and at the samples of the tiles that hold them. Samples count by the distance of their
// points (bilinear), by how near they lie to the plane of the pixel's surface, and by how alike the
// normals are.

#import composite/tiling.wgsl
#import shading/coarse/light.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#expects gbuffer_depth, sampled_at, light_of

// Beyond this rise over distance a sample lies on another plane than the pixel, and below the
// second one on the same.
const OFF_PLANE: f32 = 0.6;
const ON_PLANE: f32 = 0.2;
// Weight of samples whose normal is at right angles to the pixel's.
const LEAST_ALIKE: f32 = 0.005;
// Below this sum of weights no sample speaks for a pixel.
const LEAST_WEIGHT: f32 = 0.02;
// Part of the variance within a sample's block that counts as one between samples. Found by
// measurement.
const WITHIN_A_BLOCK: f32 = 0.175;

// Change of depth per texel to the right and down.
fn depth_slopes(texel: vec2u, depth: f32) -> vec2f {
    return vec2f(depth_slope(texel, 0u, depth), depth_slope(texel, 1u, depth));
}

// Change of depth per texel along an axis: of the two sides of a texel the one that changes less.
fn depth_slope(texel: vec2u, axis: u32, depth: f32) -> f32 {
    let picture = picture_of(texel);
    var before = texel;
    var after = texel;
    before[axis] = max(texel[axis], picture.low[axis] + 1u) - 1u;
    after[axis] = min(texel[axis] + 1u, picture.end[axis] - 1u);
    let backwards = depth - load_depth(gbuffer_depth, before);
    let forwards = load_depth(gbuffer_depth, after) - depth;
    let takes_after = before[axis] == texel[axis] || (after[axis] != texel[axis] && abs(forwards) < abs(backwards));
    return select(backwards, forwards, takes_after);
}

// Weighted sums over the samples around a pixel.
struct Gathered {
    // Light on the pixel's own surface.
    diffuse: vec3f,
    specular: vec3f,
    // Where it comes from.
    direction: vec3f,
    specular_direction: vec3f,
    spread: f32,
    // Squared luminance of what the surface reflects by each sample.
    squares: f32,
    weight: f32,
}

// Whether no sample speaks for a pixel, or what they say of it lies too far apart: a shadow's edge or
// a highlight's lies between them. `lights`: what the surface reflects by all of them; `other`: what it
// shows of emission and the environment.
fn is_unsure(found: Gathered, lights: vec3f, other: vec3f) -> bool {
    let mean = luminance(lights);
    let variance = max(found.squares / found.weight - mean * mean, 0.0);
    let limit = frame.most_disagreement * (mean + luminance(other) + DARK / frame.exposure);
    return found.weight < LEAST_WEIGHT || variance > limit * limit;
}

// How far a sample at `offset` pixels rises from the plane through the pixel, over its distance.
fn rise(view: u32, depth: f32, slope: vec2f, offset: vec2f, sample_depth: f32) -> f32 {
    let expected = depth + dot(slope, offset);
    let there = view_distance(sample_depth);
    let pixel_side = pixel_width_at(view, there);
    let apart = abs(there - view_distance(max(expected, 1e-20)));
    return apart / (length(offset) * pixel_side + 1e-6 * there);
}

fn gather(texel: vec2u, own: Tile, s: Surface, by: LightFactors, v: vec3f, depth: f32, slope: vec2f) -> Gathered {
    let picture = picture_of(texel);
    let side = f32(1u << own.level);
    // Of the pixel on the lattice of the level's sample points.
    let place = (vec2f(texel) - floor(0.5 * side)) / side;
    let first = floor(place);
    let along = place - first;
    let low = vec2i(picture.low >> vec2u(own.level));
    let last = vec2i((picture.end - 1u) >> vec2u(own.level));
    let a2 = squared_alpha(s);
    var sum = Gathered(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0);
    for (var i = 0u; i < 4u; i++) {
        let step = vec2u(i & 1u, i >> 1u);
        let block = vec2u(clamp(vec2i(first) + vec2i(step), low, last));
        let tile = tile_at(sample_texel(block, own.level, 0u));
        let at = sampled_at(tile);
        let sampled = unpack_light(light_of(tile, at));
        let sample_depth = load_depth(gbuffer_depth, at);
        let offset = vec2f(at) - vec2f(texel);
        let near = mix(1.0 - along, along, vec2f(step));
        let steep = rise(view_of(texel), depth, slope, offset, max(sample_depth, 1e-20));
        let same_plane = 1.0 - smoothstep(ON_PLANE, OFF_PLANE, steep);
        let cosine = saturate(dot(s.normal, sampled.normal));
        let alike = mix(LEAST_ALIKE, 1.0, cosine * cosine * cosine * cosine);
        let weight = select(0.0, near.x * near.y * same_plane * alike, sample_depth > 0.0);
        let diffuse = sampled.diffuse * max(dot(s.normal, sampled.direction), LEAST_COSINE);
        let mirror = sampled.specular * highlight(s.normal, v, sampled.specular_direction, a2 + sampled.spread);
        sum.diffuse += weight * diffuse;
        sum.specular += weight * mirror;
        sum.direction += weight * luminance(diffuse) * sampled.direction;
        sum.specular_direction += weight * luminance(mirror) * sampled.specular_direction;
        sum.spread += weight * sampled.spread;
        let shown = luminance(reflected(by, diffuse, mirror));
        let turned = saturate((1.0 - cosine - NORMAL_ROUNDING) / (WHOLLY_TILTED - NORMAL_ROUNDING));
        let tilted = sampled.tilted_deviation * turned;
        let uneven = sampled.deviation * sampled.deviation + tilted * tilted;
        let whole = shown + DARK / frame.exposure;
        sum.squares += weight * (shown * shown + WITHIN_A_BLOCK * uneven * whole * whole);
        sum.weight += weight;
    }
    return sum;
}
