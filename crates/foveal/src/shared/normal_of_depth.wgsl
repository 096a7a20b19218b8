// The normal seen at a texel, world space, where surfaces are not evaluated at every pixel: the
// triangle's, from depth. CPU twin: `shading/twin.rs`, `normal_of_depth`.
//
// Reversed depth is affine on the screen along a plane: its change per texel tells how the plane is
// tilted.

#import shared/frame.wgsl
#import shared/layers.wgsl
#expects gbuffer_depth

// As in normal_of_surface.wgsl: 45 degrees, as at the creases that mark tiles
// (rate/crease_of_depth.wgsl).
const SAME_NORMAL: f32 = 0.7;

// Unit normal, view space, of the plane through a texel whose depth changes by `steps` per texel
// right and down.
fn normal_from_steps(texel: vec2u, depth: f32, steps: vec2f) -> vec3f {
    let to_view = frame.views[view_of(texel)].view_from_ndc;
    let at = ndc_of(in_eye(vec2f(texel) + 0.5)) * to_view.xy + to_view.zw;
    let slope = steps / (vec2f(2.0, -2.0) / frame.size * to_view.xy);
    let perspective = vec3f(-slope, depth - dot(at, slope));
    let orthographic = vec3f(-slope * frame.depth_range, 1.0);
    return normalize(select(perspective, orthographic, frame.orthographic != 0u));
}

// Change of depth from a texel to the next along an axis, on the side where the surface goes on
// more evenly.
fn depth_step(texel: vec2u, axis: u32, depth: f32) -> f32 {
    let picture = picture_of(texel);
    var one = vec2i(0);
    one[axis] = 1;
    let first = vec2i(picture.low);
    let last = vec2i(picture.end) - 1;
    var d = array<f32, 4>(depth, depth, depth, depth);
    for (var i = 0; i < 4; i++) {
        // Two before, one before, one after, two after.
        let away = i - 2 + i / 2;
        d[i] = load_depth(gbuffer_depth, vec2u(clamp(vec2i(texel) + away * one, first, last)));
    }
    let bend_before = abs(d[0] - 2.0 * d[1] + depth);
    let bend_after = abs(d[3] - 2.0 * d[2] + depth);
    let is_first = i32(texel[axis]) == first[axis];
    let is_last = i32(texel[axis]) == last[axis];
    let takes_after = is_first || (!is_last && bend_after <= bend_before);
    return select(depth - d[1], d[2] - depth, takes_after);
}

fn normal_seen(texel: vec2u) -> vec3f {
    let depth = load_depth(gbuffer_depth, texel);
    let n = normal_from_steps(texel, depth, vec2f(depth_step(texel, 0u, depth), depth_step(texel, 1u, depth)));
    return (frame.views[view_of(texel)].world_from_view * vec4f(n, 0.0)).xyz;
}
