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

// Exponent field of 2^-96: the sums' weights lie above it, as an exposure of 2^64 makes them of the
// brightest halves.
const LEAST_WEIGHT_BITS: u32 = 31u << 23u;

// A sum of such parts: the mean radiance in halves, and in the upper half of y the weight, at most 1,
// in 7 bits of exponent and 9 of mantissa. Halves of the products would lose what is far brighter than
// white.
fn pack_weighted(sum: vec4f) -> vec2u {
    let mean = min(sum.rgb / sum.a, vec3f(65504.0));
    let weight = (bitcast<u32>(sum.a) - LEAST_WEIGHT_BITS + (1u << 13u)) >> 14u;
    return vec2u(pack2x16float(mean.rg), pack2x16float(vec2f(mean.b, 0.0)) | (weight << 16u));
}

fn unpack_weighted(words: vec2u) -> vec4f {
    let weight = bitcast<f32>(((words.y >> 16u) << 14u) + LEAST_WEIGHT_BITS);
    return weight * vec4f(unpack2x16float(words.x), unpack2x16float(words.y).x, 1.0);
}
