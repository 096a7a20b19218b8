// Each pixel's ambient visibility from what was found at the nine samples around it, which together
// look in all directions of the pattern. Samples off the plane of the pixel's surface count less,
// and next to nothing where they lie on another one. CPU twin: `ambient/twin.rs`.

#variant
#variant RATES
#variant REDUCED
#import ambient/horizons.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#ifdef REDUCED
#import shared/full_screen.wgsl
#endif
#import shared/layers.wgsl
#import shared/normal_of_depth.wgsl

#ifdef REDUCED
// Its bits.
@group(1) @binding(2) var found: texture_2d<u32>;

fn found_at(texel: vec2u) -> f32 {
    return bitcast<f32>(textureLoad(found, texel, 0).x);
}
#else
@group(1) @binding(2) var found: texture_2d<f32>;
@group(1) @binding(3) var resolved: texture_storage_2d<rg32float, write>;

fn found_at(texel: vec2u) -> f32 {
    return textureLoad(found, texel, 0).x;
}
#endif
#ifdef RATES
// Of 2 x 2 pixels each.
@group(1) @binding(4) var owner_levels: texture_2d<u32>;
#endif

// Weight of samples on another surface: where there are no others, the one that is nearest to the
// pixel's counts most.
const ELSEWHERE: f32 = 1e-3;
// Of the radius, and of the distance on the screen: how far from the plane a sample may lie.
const OFF_PLANE: vec2f = vec2f(0.05, 0.5);

fn level_at(texel: vec2u) -> u32 {
#ifdef RATES
    return textureLoad(owner_levels, texel >> vec2u(1u), 0).x & CELL_LEVEL;
#else
    return 0u;
#endif
}

// The texel that was looked from for the block around a place.
fn sample_for(place: vec2u) -> vec2u {
    let level = level_at(place);
    return select(sample_texel(place >> vec2u(level), level, 0u), place, level == 0u);
}

// Visibility, and the distance of the surface that has it, along the view axis; the distance of the
// backdrop is negative.
fn resolved_at(texel: vec2u) -> vec2f {
    let depth = load_depth(gbuffer_depth, texel);
    if depth == 0.0 {
        return vec2f(1.0, -1.0);
    }
    let level = level_at(texel);
    let side = f32(1u << level);
    let picture = picture_of(texel);
    let low = vec2i(picture.low >> vec2u(level));
    let last = vec2i((picture.end - 1u) >> vec2u(level));
    // On the lattice of the level's samples: the nearest one, and how far it is.
    let place = (vec2f(texel) - floor(0.5 * side)) / side;
    let nearest = floor(place + 0.5);
    let past = place - nearest;
    let slope = vec2f(depth_step(texel, 0u, depth), depth_step(texel, 1u, depth));
    let to_view = frame.views[view_of(texel)].view_from_ndc;
    let is_flat = frame.orthographic != 0u;
    var sum = 0.0;
    var weights = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let step = vec2i(vec2u(i % 3u, i / 3u)) - 1;
        let block = vec2i(nearest) + step;
        let inside = all(block >= low) && all(block <= last);
        let at = sample_for(sample_texel(vec2u(clamp(block, low, last)), level, 0u));
        let there = view_distance(max(load_depth(gbuffer_depth, at), 1e-20));
        let offset = vec2f(at) - vec2f(texel);
        let expected = view_distance(max(depth + dot(slope, offset), 1e-20));
        let pixel_side = 2.0 * abs(to_view.x) / frame.size.x * select(there, 1.0, is_flat);
        let allowed = dot(OFF_PLANE, vec2f(occlusion.radius, length(offset) * pixel_side)) + 1e-5 * abs(there);
        // Two blocks wide for blocks, three pixels for pixels.
        let wide = select(saturate(1.0 - abs(vec2f(step)) * 0.5 + vec2f(step) * past), vec2f(1.0), level == 0u);
        let off = abs(there - expected) / allowed;
        let weight = wide.x * wide.y * (saturate(2.0 - off) + ELSEWHERE / (1.0 + off * off));
        let counts = select(0.0, weight, inside && load_depth(gbuffer_depth, at) > 0.0);
        sum += counts * found_at(at);
        weights += counts;
    }
    // Where only the backdrop is around it, nothing occludes it.
    let visibility = select(1.0, sum / max(weights, 1e-20), weights > 0.0);
    return vec2f(visibility, view_distance(depth));
}

#ifdef REDUCED
// Their bits.
@fragment
fn resolve(@builtin(position) position: vec4f) -> @location(0) vec2u {
    return bitcast<vec2u>(resolved_at(vec2u(position.xy)));
}
#else
@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if all(texel < vec2u(frame.target_size)) && !is_padding(texel, 0u) {
        textureStore(resolved, texel, vec4f(resolved_at(texel), 0.0, 0.0));
    }
}
#endif
