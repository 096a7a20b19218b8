// Shading rates of quads (2 x 2 pixels) and what they make of pixels. CPU twin: `twin.rs`.

// Bits of a mask's texel. Both of the first two: one sample for the quad; the third besides: one
// for 2 x 2 quads.
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

// A sample in one word: its quad (14 bits across, 14 down: pictures of up to 32,768 pixels a side),
// the column and row of its upper left pixel there, and whether it is wide and tall. A wide one
// begins in the first column, so that bit marks a block.
fn packed_sample(texel: vec2u, rate: u32) -> u32 {
    let quad = texel >> vec2u(1u);
    let within = (texel.x & 1u) | ((texel.y & 1u) << 1u) | u32((rate & RATE_BLOCK) != 0u);
    return quad.x | (quad.y << 14u) | (within << 28u) | ((rate & 3u) << 30u);
}

struct Sample {
    // Its upper left pixel.
    first: vec2u,
    // Pixels across and down.
    extent: vec2u,
}

fn unpacked_sample(word: u32) -> Sample {
    let wide = vec2u(word >> 30u, word >> 31u) & vec2u(1u);
    let within = vec2u(word >> 28u, word >> 29u) & vec2u(1u);
    let block = wide.x & within.x;
    let first = vec2u(word & 0x3fffu, (word >> 14u) & 0x3fffu) * 2u + (within & (1u - wide));
    return Sample(first, select(1u + wide, vec2u(4u), block != 0u));
}
