// A position in pixels, to a quarter of one, in one word. It stays within its pixel, which may be the
// last one of an eye's picture.

fn pack_quarters(position: vec2f) -> u32 {
    let q = min(vec2u(round(position * 4.0)), vec2u(position) * 4u + 3u);
    return q.x | (q.y << 16u);
}

fn unpack_quarters(word: u32) -> vec2f {
    return vec2f(f32(word & 0xffffu), f32(word >> 16u)) * 0.25;
}
