// Tone-map-aware averaging. After frame.wgsl.

// A colour's weight falls with its brightness, so that one bright sub-sample among dark ones does not bleach
// the pixel (Karis 2013, 'Tone mapping'; Wronski and Pesce describe the effect).
fn weight_of(radiance: vec3f) -> f32 {
    return 1.0 / (1.0 + frame.exposure * dot(radiance, vec3f(0.2126, 0.7152, 0.0722)));
}
