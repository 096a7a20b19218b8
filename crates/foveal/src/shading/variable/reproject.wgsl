// What is known of each quad, reprojected from the frame before. CPU twin: `twin.rs`.
//
// Known are the luminances of the quad's four pixels when they were last shaded one by one: a quad
// that was shaded coarsely keeps those from before. So no rate ever depends on what coarse shading
// made of the picture.
//
// x: luminances, 8 bits each (upper left, upper right, lower left, lower right). y: the distance's
// upper half, as a rounded float of 16 bits, which is 0.4 % apart; the notes below; 14 bits of the
// instance's number + 1.

#import shading/variable/passes.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

const KNOWN_INSTANCE: u32 = 0x3fffu;
// Something is known.
const KNOWN_AT_ALL: u32 = 0x4000u;
// Shaded pixel by pixel in that frame: its picture says more than what is kept.
const KNOWN_FULL: u32 = 0x8000u;

// Relative difference of distances that counts as the same surface.
const SAME_DISTANCE: f32 = 0.02;

// An eye's affine maps. Both eyes' are read at constant places and chosen from: a place that
// differs from lane to lane is gathered lane by lane on some devices, which took as long as all
// textures together.
struct EyeMaps {
    // View-space xy at distance 1 from normalized device coordinates: (ndc * xy + zw).
    view_from_ndc: vec4f,
    // x, y and w of clip space in the frame before, of a point in view space.
    x_before: vec4f,
    y_before: vec4f,
    distance_before: vec4f,
}

// A row of the matrix that takes points from view space to clip space in the frame before.
fn row_before(view: u32, row: u32) -> vec4f {
    let previous = frame.views[view].previous_clip_from_world;
    return vec4f(previous[0][row], previous[1][row], previous[2][row], previous[3][row]) * frame.views[view].world_from_view;
}

fn maps_at(texel: vec2u) -> EyeMaps {
    let right = view_of(texel) != 0u;
    return EyeMaps(
        select(frame.views[0].view_from_ndc, frame.views[1].view_from_ndc, right),
        select(row_before(0u, 0u), row_before(1u, 0u), right),
        select(row_before(0u, 1u), row_before(1u, 1u), right),
        select(row_before(0u, 3u), row_before(1u, 3u), right),
    );
}

// A pixel's place on the plane at distance 1, or on any with parallel rays.
fn on_plane(maps: EyeMaps, picture: Picture, texel: vec2u) -> vec2f {
    return ndc_of(vec2f(texel - picture.low) + 0.5) * maps.view_from_ndc.xy + maps.view_from_ndc.zw;
}

// Rec. 709 luma of display values.
fn luma_at(texel: vec2u) -> f32 {
    return dot(textureLoad(picture_before, texel, 0).rgb, vec3f(0.2126, 0.7152, 0.0722));
}

fn measured(picture: Picture, quad: vec2u) -> u32 {
    let texel = quad * 2u;
    let last = min(texel + 1u, picture.end - 1u);
    return pack4x8unorm(vec4f(
        luma_at(texel),
        luma_at(vec2u(last.x, texel.y)),
        luma_at(vec2u(texel.x, last.y)),
        luma_at(last),
    ));
}

// What is known of the quad that begins at `texel`, where instance `who` (+ 1) is seen at depth
// `d`.
fn reprojected_to(picture: Picture, maps: EyeMaps, texel: vec2u, who: u32, d: f32, motion: vec2f) -> vec2u {
    var distance = 0.0;
    var expected = 0.0;
    if d > 0.0 {
        distance = view_distance(d);
        let parallel = frame.orthographic != 0u;
        let xy = on_plane(maps, picture, texel) * select(distance, 1.0, parallel);
        let w = dot(maps.distance_before, vec4f(xy, -distance, 1.0));
        expected = select(w, distance, parallel);
    }
    let place = ((bitcast<u32>(distance) + 0x8000u) & 0xffff0000u) | (who & KNOWN_INSTANCE);
    let then = vec2i(floor((vec2f(texel) + 1.0 - motion) * 0.5));
    let inside = all(then >= vec2i(picture.low / 2u)) && all(then < vec2i((picture.end + 1u) / 2u));
    var found = vec2u(0u, place);
    if inside && rates.reset == 0u {
        let old = textureLoad(before, then, 0).xy;
        let off = abs(bitcast<f32>(old.y & 0xffff0000u) - expected);
        if ((old.y ^ who) & KNOWN_INSTANCE) == 0u && off <= SAME_DISTANCE * expected {
            found = vec2u(old.x, place | (old.y & KNOWN_AT_ALL));
            if (old.y & KNOWN_FULL) != 0u {
                found = vec2u(measured(picture, vec2u(then)), place | KNOWN_AT_ALL);
            }
        }
    }
    return found;
}

// Motion in pixels since the frame before. A background without end moves as the camera turns; with
// parallel rays all of it is one direction.
fn motion_of(maps: EyeMaps, picture: Picture, texel: vec2u, who: vec2u) -> vec2f {
    let direction = vec4f(on_plane(maps, picture, texel), -1.0, 0.0);
    let before = vec3f(dot(maps.x_before, direction), dot(maps.y_before, direction), dot(maps.distance_before, direction));
    let now = ndc_of(vec2f(texel - picture.low) + 0.5);
    let moved = (now - before.xy / before.z) * vec2f(0.5, -0.5) * frame.size;
    let turned = select(vec2f(60000.0), clamp(moved, vec2f(-60000.0), vec2f(60000.0)), before.z > 0.0);
    return select(unpack2x16float(who.y), select(turned, vec2f(0.0), frame.orthographic != 0u), who.x == 0u);
}

// The first of two passes, where contrast is looked for beyond the quad.
@compute @workgroup_size(8, 8)
fn reproject(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy * 2u;
    let picture = picture_of(texel);
    if any(texel >= picture.end) {
        return;
    }
    let who = load_words(identity, texel).xy;
    let d = load_depth(depth, texel);
    let maps = maps_at(texel);
    let motion = motion_of(maps, picture, texel, who);
    let found = reprojected_to(picture, maps, texel, who.x, d, motion);
    textureStore(known, id.xy, vec4u(found, 0u, 0u));
}
