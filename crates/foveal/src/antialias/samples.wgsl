// The sub-samples of a pixel in the band of the supersampled G-buffer. After shading.wgsl, whose G-buffer is
// the band here. Rust: `antialias/pattern.rs`.

struct Band {
    // Sub-samples per pixel.
    count: u32,
    // Side of the grid; 0 for a rotated pattern, whose sub-samples lie in tiles one below the other.
    side: u32,
    // The band's first row of pixels, and how many rows it has.
    first_row: u32,
    rows: u32,
    // Positions within the pixel of a rotated pattern, two in each.
    offsets: array<vec4f, 4>,
}

@group(2) @binding(0) var<uniform> band: Band;
@group(2) @binding(1) var sample_identity: texture_2d<u32>;

fn sample_texel(pixel: vec2u, index: u32) -> vec2u {
    let in_band = pixel - vec2u(0u, band.first_row);
    if band.side == 0u {
        return in_band + vec2u(0u, index * band.rows);
    }
    return in_band * band.side + vec2u(index % band.side, index / band.side);
}

// In pixels of the frame.
fn sample_position(pixel: vec2u, index: u32) -> vec2f {
    if band.side == 0u {
        let two = band.offsets[index >> 1u];
        return vec2f(pixel) + select(two.xy, two.zw, (index & 1u) == 1u);
    }
    let cell = vec2f(f32(index % band.side), f32(index / band.side)) + 0.5;
    return vec2f(pixel) + cell / f32(band.side);
}
