// Shading rates of quads (2 x 2 pixels) and what they make of pixels. CPU twin: `twin.rs`.

// Bits of a mask's texel. Both of the first two: one sample for the quad; the third besides: one for 2 x 2 quads.
const RATE_WIDE: u32 = 1u;
const RATE_TALL: u32 = 2u;
const RATE_BLOCK: u32 = 4u;
const RATE: u32 = 7u;
// Shaded in full to be measured.
const RATE_PROBED: u32 = 16u;
// Shaded in full because nothing is known of it.
const RATE_UNKNOWN: u32 = 32u;

// Pixels across and down of a sample.
fn extent_at(rate: u32) -> vec2u {
    let quad = vec2u(1u + (rate & 1u), 1u + ((rate >> 1u) & 1u));
    return select(quad, vec2u(4u), (rate & RATE_BLOCK) != 0u);
}

// Whether a pixel is the upper left one of its sample's.
fn stands_for_sample(texel: vec2u, rate: u32) -> bool {
    return all((texel & (extent_at(rate) - 1u)) == vec2u(0u));
}
