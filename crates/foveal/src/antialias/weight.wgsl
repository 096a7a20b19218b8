// Tone-map-aware averaging.

#import shared/frame.wgsl

// A colour's weight falls with its brightness, so that one bright sub-sample among dark ones does
// not bleach the pixel (Karis 2013, 'Tone mapping'; Wronski and Pesce describe the effect).
fn weight_of(radiance: vec3f) -> f32 {
    return 1.0 / (1.0 + frame.exposure * dot(radiance, vec3f(0.2126, 0.7152, 0.0722)));
}

// What an entry that stands for `covered` of `count` sub-samples adds to its pixel's sum.
fn weighted(radiance: vec3f, covered: u32, count: u32) -> vec4f {
    return vec4f(radiance, 1.0) * (weight_of(radiance) * f32(covered) / f32(count));
}
