// Entry points of the draw that shades every pixel of its viewport. After shading.wgsl.

@vertex
fn full_screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn shade_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return shade(vec2u(position.xy));
}
