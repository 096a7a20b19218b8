// Shades every pixel: of a draw's viewport, or of a target in one dispatch.

#variant
#variant REDUCED
#variant DISPATCHED
#import shading/shading.wgsl

#ifdef DISPATCHED
@group(2) @binding(0) var radiance: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn shade_all(@builtin(global_invocation_id) at: vec3u) {
    if all(at.xy < textureDimensions(radiance)) {
        textureStore(radiance, at.xy, shade(at.xy));
    }
}
#else
#import shared/full_screen.wgsl

@fragment
fn shade_pixel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return shade(vec2u(position.xy));
}
#endif
