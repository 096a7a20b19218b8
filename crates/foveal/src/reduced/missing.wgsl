// What WGSL has built in and GLSL ES 3.00, the language of WebGL 2, has not; these take its place.

fn pack4x8unorm(v: vec4f) -> u32 {
    let bytes = vec4u(floor(0.5 + 255.0 * saturate(v)));
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}

// Of a word that is not zero: the exponent of its lowest bit as a float.
fn firstTrailingBit(word: u32) -> u32 {
    return (bitcast<u32>(f32(word & (~word + 1u))) >> 23u) - 127u;
}
