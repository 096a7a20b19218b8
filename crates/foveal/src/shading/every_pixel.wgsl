// Shades every pixel of a draw's viewport.

#variant
#variant REDUCED
#import shading/shading.wgsl
#import shared/full_screen.wgsl

@fragment
fn shade_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return shade(vec2u(position.xy));
}
