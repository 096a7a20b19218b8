// The sub-samples of a pixel in the band of supersampled texels, which the importing shader binds
// as `band`. Rust: `antialias/pattern.rs`.

#expects band

// Sub-samples per pixel.
override COUNT: u32 = 4u;
// Side of the grid; 0 for a rotated pattern, whose sub-samples lie in tiles one below the other.
override SIDE: u32 = 2u;

struct Band {
    // The band's first row of pixels, and how many rows it has.
    first_row: u32,
    rows: u32,
    reserved: vec2u,
    // Positions within the pixel of a rotated pattern, two in each.
    offsets: array<vec4f, 4>,
}

fn sample_texel(pixel: vec2u, index: u32) -> vec2u {
    let in_band = pixel - vec2u(0u, band.first_row);
    if SIDE == 0u {
        return in_band + vec2u(0u, index * band.rows);
    }
    return in_band * SIDE + vec2u(index % max(SIDE, 1u), index / max(SIDE, 1u));
}

// In pixels of the frame.
fn sample_position(pixel: vec2u, index: u32) -> vec2f {
    if SIDE == 0u {
        let two = band.offsets[index >> 1u];
        return vec2f(pixel) + select(two.xy, two.zw, (index & 1u) == 1u);
    }
    let cell = vec2f(f32(index % max(SIDE, 1u)), f32(index / max(SIDE, 1u))) + 0.5;
    return vec2f(pixel) + cell / f32(max(SIDE, 1u));
}
