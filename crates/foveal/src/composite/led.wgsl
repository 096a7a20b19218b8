// Whether a pixel takes its leader's light.

#import composite/leaders.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#expects gbuffer_surface, gbuffer_depth

// Least cosine between normals of a leader and of a pixel that takes its light.
const LED_NORMAL: f32 = 0.95;
// Part of a pixel's distance by which its leader may lie off the plane of its surface, and by which
// the two may lie apart: where depth steps on one side alone, the plane follows the step.
const LED_OFF_PLANE: f32 = 0.005;
const LED_APART: f32 = 0.05;

// Whether a pixel in a block of this level takes its leader's light: it is of the same surface.
// `slope`: change of depth per texel.
fn is_led(texel: vec2u, level: u32, normal: vec3f, depth: f32, slope: vec2f) -> bool {
    let leader = leader_of(texel);
    let inside = all(leader < picture_of(texel).end);
    let at = select(texel, leader, inside);
    let there = load_depth(gbuffer_depth, at);
    let expected = depth + dot(slope, vec2f(at) - vec2f(texel));
    let other = unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, at).y));
    let here = view_distance(depth);
    let away = view_distance(max(there, 1e-20));
    let off_plane = abs(away - view_distance(max(expected, 1e-20)));
    let is_near = off_plane <= LED_OFF_PLANE * here && abs(away - here) <= LED_APART * here;
    return level >= LED_FROM && any(at != texel) && there > 0.0 && is_near && dot(other, normal) >= LED_NORMAL;
}
