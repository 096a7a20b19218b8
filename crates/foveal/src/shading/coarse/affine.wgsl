// For tests: radiance that is an affine function of the sample's position, in place of
// shading.wgsl.

#import shared/frame.wgsl

// As lighting.wgsl and environment.wgsl have them.
override BLINN_PHONG: bool = false;
override BRUTE: bool = false;
override SHADOWS: u32 = 0u;
override ENVIRONMENT: u32 = 0u;
override BACKGROUND: u32 = 0u;
override MULTIPLE_SCATTERING: bool = false;
override AMBIENT_OCCLUSION: bool = false;

@group(1) @binding(0) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d_array;

fn shade(texel: vec2u) -> vec4f {
    let at = in_eye(vec2f(texel) + 0.5) / frame.size;
    if BLINN_PHONG && BRUTE && MULTIPLE_SCATTERING && AMBIENT_OCCLUSION && SHADOWS + ENVIRONMENT + BACKGROUND == 0u {
        return vec4f(0.0);
    }
    return vec4f(at.x, at.y, 0.5 + 0.25 * at.x - 0.5 * at.y, 1.0);
}
