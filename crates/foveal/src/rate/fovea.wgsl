// Where the eye looks. Before wish.wgsl or shading/variable/mask.wgsl. Rust: `rate/wish.rs`.

struct Wish {
    // Gaze of the left and of the right eye, xy in pixels of the target.
    gaze: array<vec4f, 2>,
    // Squared radii in pixels from which on levels 1 to 8 are wished.
    squared_radii: array<vec4f, 2>,
    // Squared tangents of the angle to the lens's axis from which on levels 1 to 8 are wished, of the left and of the
    // right eye.
    lens_squared_radii: array<array<vec4f, 2>, 2>,
    // First column of the right eye.
    eye_width: f32,
    coarsest: u32,
    // Level of the constant source.
    constant_level: u32,
    // Pixels at edges that wish 1 up to this level wish finer ones instead.
    refine_up_to: u32,
    // Edges are looked for where the wish is 1 up to this level.
    edges_up_to: u32,
    // By so many levels.
    refine_by: u32,
    // Keep the size a multiple of 16 bytes.
    reserved_1: u32,
    reserved_2: u32,
}

@group(1) @binding(0) var<uniform> wish: Wish;

// Number of radii that the distance to the gaze exceeds.
fn foveated_level(pixel: vec2f) -> u32 {
    let eye = u32(pixel.x >= wish.eye_width);
    let offset = pixel - wish.gaze[eye].xy;
    return radii_below(dot(offset, offset), wish.squared_radii);
}

fn radii_below(squared: f32, squared_radii: array<vec4f, 2>) -> u32 {
    let beyond = vec4u(vec4f(squared) >= squared_radii[0]) + vec4u(vec4f(squared) >= squared_radii[1]);
    return beyond.x + beyond.y + beyond.z + beyond.w;
}
