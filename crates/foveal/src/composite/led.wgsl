// Whether a pixel takes its leader's light.

#import composite/leaders.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#expects gbuffer_surface, gbuffer_depth

// Least cosine between normals of a leader and of a pixel that takes its light.
const LED_NORMAL: f32 = 0.95;
// Part of a pixel's depth by which its leader's may lie off the plane of its surface.
const LED_OFF_PLANE: f32 = 0.005;

// Whether a pixel in a block of this level takes its leader's light: it is of the same surface.
// `slope`: change of depth per texel.
fn is_led(texel: vec2u, level: u32, normal: vec3f, depth: f32, slope: vec2f) -> bool {
    let leader = leader_of(texel);
    let inside = all(leader < picture_of(texel).end);
    let at = select(texel, leader, inside);
    let there = load_depth(gbuffer_depth, at);
    let expected = depth + dot(slope, vec2f(at) - vec2f(texel));
    let other = unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, at).y));
    let is_same = abs(there - expected) <= LED_OFF_PLANE * depth && dot(other, normal) >= LED_NORMAL;
    return level >= LED_FROM && any(at != texel) && is_same;
}
