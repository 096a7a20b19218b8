// The interpolating composite of the original method (Imagire, 'Coarse pixel shading by stencil
// pyramid').
//
// The text gives the neighbours' tangential coordinate as `P_x` or `P_y`, and the fourth point's as
// that of the neighbour; here a neighbour keeps the pixel's own tangential coordinate, and the
// fourth point steps on perpendicularly from the neighbour that lies along the axis that is
// interpolated last. Points beyond the picture are moved to its border.

#import composite/tiling.wgsl
#import shared/frame.wgsl
#import shared/level.wgsl

struct Tap {
    center: vec2f,
    side: f32,
    color: vec3f,
    // Offset of the tap from its tile's centre, in sides.
    q: vec2f,
    at: vec2f,
}

fn tap(picture: Picture, position: vec2f) -> Tap {
    let at = clamp(position, vec2f(picture.low) + 0.5, vec2f(picture.end) - 0.5);
    let tile = tile_at(vec2u(at));
    let side = f32(1u << tile.level);
    let center = (vec2f(tile.block) + 0.5) * side;
    return Tap(center, side, sample_of(tile).rgb, (at - center) / side, at);
}

// Coordinate just outside a tile, on the side to which q points.
fn beyond(center: f32, side: f32, q: f32) -> f32 {
    return center + select(1.0, -1.0, q < 0.0) * (0.5 * side + 1.0);
}

@fragment
fn paper(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let picture = picture_of(texel);
    let p = tap(picture, vec2f(texel) + 0.5);
    if p.side == 1.0 {
        return vec4f(p.color, 1.0);
    }
    let px = tap(picture, vec2f(beyond(p.center.x, p.side, p.q.x), p.at.y));
    let py = tap(picture, vec2f(p.at.x, beyond(p.center.y, p.side, p.q.y)));
    let weight = abs(p.q);
    if weight.y < weight.x {
        let p2 = tap(picture, vec2f(px.at.x, beyond(px.center.y, px.side, px.q.y)));
        let here = mix(p.color, py.color, weight.y);
        return vec4f(mix(here, mix(px.color, p2.color, abs(px.q.y)), weight.x), 1.0);
    }
    let p2 = tap(picture, vec2f(beyond(py.center.x, py.side, py.q.x), py.at.y));
    let here = mix(p.color, px.color, weight.x);
    return vec4f(mix(here, mix(py.color, p2.color, abs(py.q.x)), weight.y), 1.0);
}
