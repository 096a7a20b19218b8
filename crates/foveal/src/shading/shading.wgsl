// Deferred shading: one lighting evaluation per sample. A sample is a texel of the G-buffer; which
// samples are shaded is the caller's choice: the fragments of a draw, or a list.

#import shading/input.wgsl
#import shared/environment.wgsl
#import shared/frame.wgsl
#import shared/lighting.wgsl
#import shared/surface.wgsl

// Radiance at a position in pixels, from what the G-buffer holds there.
fn radiance_at(pixel: vec2f, depth: f32, words: vec4u) -> vec4f {
    if depth == 0.0 {
        let far = world_position(pixel, 1.0);
        return vec4f(background(-direction_to_eye(view_at(pixel), far)), 1.0);
    }
    let distance = view_distance(depth);
    let position = world_position(pixel, distance);
    let surface = unpack_surface(words, position);
    // The largest half: brighter would become infinite in the target.
    return vec4f(min(lit(surface, pixel, distance), vec3f(65504.0)), 1.0);
}

// Radiance at a G-buffer texel.
fn shade(texel: vec2u) -> vec4f {
    return radiance_at(vec2f(texel) + 0.5, gbuffer_depth_at(texel), gbuffer_words_at(texel));
}
