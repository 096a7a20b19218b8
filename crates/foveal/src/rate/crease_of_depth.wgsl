// Creases between blocks of 2 x 2 pixels, by depth alone.

#import shared/normal_of_depth.wgsl
#expects depth_at

// Of five texels in a row from `first` on: depth's step between the first two, and between the last
// two, so that a crease anywhere between the second and the fourth lies between both steps; those
// before and after are the neighbours'. Both are the same beyond the picture's border, and where
// depth jumps there: that is the next block's edge.
fn steps_along(first: vec2i, axis: u32, last: vec2i) -> vec2f {
    var one = vec2i(0);
    one[axis] = 1;
    var d: array<f32, 5>;
    for (var i = 0; i < 5; i++) {
        d[i] = depth_at(min(first + i * one, last));
    }
    let near = d[1] - d[0];
    let bend = max(abs(d[1] - 2.0 * d[2] + d[3]), abs(d[2] - 2.0 * d[3] + d[4]));
    let goes_on = first[axis] + 4 <= last[axis] && bend <= 0.02 * d[2];
    return vec2f(near, select(near, d[4] - d[3], goes_on));
}

// As in crease_of_surface.wgsl.
fn turns(first: vec2i, last: vec2i) -> bool {
    let texel = vec2u(first);
    let depth = depth_at(first);
    let x = steps_along(first, 0u, last);
    let y = steps_along(first, 1u, last);
    let normal = normal_from_steps(texel, depth, vec2f(x.x, y.x));
    let right = normal_from_steps(texel, depth, vec2f(x.y, y.x));
    let down = normal_from_steps(texel, depth, vec2f(x.x, y.y));
    return min(dot(normal, right), dot(normal, down)) < 0.7;
}
