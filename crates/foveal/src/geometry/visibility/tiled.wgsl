// Where tiles of a rate map are sampled, and nowhere else: the shading looks at no other pixel.

#import shared/blocks.wgsl
#expects mask

// Any of five candidates may be asked for: as in shading/coarse/block.wgsl.
override TYPICAL: bool = false;

// The owner level.
fn rate_at(quad: vec2u) -> u32 {
    return textureLoad(mask, quad, 0).x & CELL_LEVEL;
}

// Whether a block is sampled within one of 2^shift pixels a side.
fn is_sampled(block: vec2u, level: u32, within: vec2u, shift: u32) -> bool {
    var found = all(within == sample_texel(block, level, 0u) >> vec2u(shift));
    if TYPICAL {
        for (var candidate = 1u; candidate < 5u; candidate++) {
            found = found || all(within == sample_texel(block, level, candidate) >> vec2u(shift));
        }
    }
    return found;
}

fn has_listed(quad: vec2u, level: u32) -> bool {
    return level == 0u || is_sampled((quad * 2u) >> vec2u(level), level, quad, 1u);
}

fn is_listed(texel: vec2u, level: u32) -> bool {
    return is_sampled(texel >> vec2u(level), level, texel, 0u);
}

fn is_read(texel: vec2u, level: u32) -> bool {
    return is_listed(texel, level);
}

fn covered_by(texel: vec2u) -> vec2u {
    return vec2u(1u);
}

// Textures are filtered over the tile.
fn extent_of(texel: vec2u) -> vec2u {
    return vec2u(1u << rate_at(texel / 2u));
}

// Depth is the texel's own: so is its surface.
fn center_of(texel: vec2u) -> vec2f {
    return vec2f(texel) + 0.5;
}
