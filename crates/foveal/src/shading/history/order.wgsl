// In which order pixels are renewed.

// A pixel's place in it: any share of the least numbers lies evenly in the picture (the additive recurrence by the plastic
// number: Roberts 2018, 'The Unreasonable Effectiveness of Quasirandom Sequences').
fn order_of(texel: vec2u) -> u32 {
    return texel.x * 3242174889u + texel.y * 2447445414u;
}
