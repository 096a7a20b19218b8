// Deferred shading: one lighting evaluation per sample. A sample is a texel of the G-buffer; which
// samples are shaded is the caller's choice: the fragments of a draw, or a list.

#import shading/input.wgsl
#import shared/frame.wgsl
#import shared/lighting.wgsl
#import shared/surface.wgsl

// Radiance at a position in pixels, from what the G-buffer holds there.
fn radiance_at(pixel: vec2f, depth: f32, words: vec4u) -> vec4f {
    let is_behind = depth == 0.0;
    let distance = select(view_distance(depth), 1.0, is_behind);
    let surface = unpack_surface(words, world_position(pixel, distance));
    return vec4f(radiance_of(surface, pixel, distance, is_behind), 1.0);
}

// Radiance at a G-buffer texel.
fn shade(texel: vec2u) -> vec4f {
    return radiance_at(vec2f(texel) + 0.5, gbuffer_depth_at(texel), gbuffer_words_at(texel));
}
