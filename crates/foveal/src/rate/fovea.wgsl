// Where the eye looks, and how coarsely it resolves what lies beside. Rust: `rate/request.rs`.

#import shared/frame.wgsl

struct Request {
    // Gaze of the left and of the right eye, xy in pixels of the target.
    gaze: array<vec4f, 2>,
    // Squared radii in pixels from which on levels 1 to 8 are requested.
    squared_radii: array<vec4f, 2>,
    // Squared tangents of the angle to the lens's axis from which on levels 1 to 8 are requested,
    // of the left and of the right eye.
    lens_squared_radii: array<array<vec4f, 2>, 2>,
    // First column of the right eye.
    eye_width: f32,
    coarsest: u32,
    // Level of the constant source.
    constant_level: u32,
    // Pixels at edges that request 1 up to this level request finer ones instead.
    refine_up_to: u32,
    // Edges are looked for where the request is 1 up to this level.
    edges_up_to: u32,
    // By so many levels.
    refine_by: u32,
    // Side of a block at the gaze, in radians.
    block_at_gaze: f32,
    // Growth of a block's side per radian of eccentricity.
    block_growth: f32,
    // Tangents on the display of the left and of the right eye's picture, from normalized device
    // coordinates: scale in xy, offset in zw.
    display_from_ndc: array<vec4f, 2>,
    // Unit vectors from the left and from the right eye to where it looks; x right, y up, z to the
    // display.
    gaze_direction: array<vec4f, 2>,
}

@group(1) @binding(0) var<uniform> request: Request;

// Angle between two unit vectors in radians: from the chord, by the arcsine's series. The same
// operations on all devices, and within 0.4 % up to 90 degrees.
fn angle_between(a: vec3f, b: vec3f) -> f32 {
    let half = min(0.5 * distance(a, b), 0.75);
    let s = half * half;
    return 2.0 * half * (1.0 + s * (1.0 / 6.0 + s * (3.0 / 40.0 + s * (15.0 / 336.0))));
}

// Level of the largest block that the eye does not resolve at a pixel. A block's side in degrees
// grows with the angle to the gaze as the smallest resolvable angle does (Guenter et al. 2012,
// 'Foveated 3D graphics', eq. 1), and the pixel's own is that of the display there.
fn foveated_level(pixel: vec2f) -> u32 {
    let view = view_at(pixel);
    let to_display = request.display_from_ndc[view];
    let tangents = ndc_of(in_eye(pixel)) * to_display.xy + to_display.zw;
    let to_pixel = vec3f(tangents, 1.0);
    let near = inverseSqrt(dot(to_pixel, to_pixel));
    let eccentricity = angle_between(to_pixel * near, request.gaze_direction[view].xyz);
    // A pixel's width in radians, across the line to the display's centre, where it is larger than
    // along it.
    let pixel_side = 2.0 * to_display.x / frame.size.x * near;
    let side = (request.block_at_gaze + request.block_growth * eccentricity) / pixel_side;
    // floor(log2) by the float's exponent.
    return min(u32(max(i32(bitcast<u32>(side) >> 23u) - 127, 0)), request.coarsest);
}

// Number of radii that the distance to the gaze exceeds: the map of coarse shading's source.
fn radii_level(pixel: vec2f) -> u32 {
    let eye = u32(pixel.x >= request.eye_width);
    let offset = pixel - request.gaze[eye].xy;
    return radii_below(dot(offset, offset), request.squared_radii);
}

fn radii_below(squared: f32, squared_radii: array<vec4f, 2>) -> u32 {
    let beyond = vec4u(vec4f(squared) >= squared_radii[0]) + vec4u(vec4f(squared) >= squared_radii[1]);
    return beyond.x + beyond.y + beyond.z + beyond.w;
}
