// Entry points of the draw that shades every pixel of its viewport. After shading.wgsl.

@fragment
fn shade_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return shade(vec2u(position.xy));
}
