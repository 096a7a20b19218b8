// A position in pixels, to a quarter of one, in one word.

fn pack_quarters(position: vec2f) -> u32 {
    let q = vec2u(round(position * 4.0));
    return q.x | (q.y << 16u);
}

fn unpack_quarters(word: u32) -> vec2f {
    return vec2f(f32(word & 0xffffu), f32(word >> 16u)) * 0.25;
}
