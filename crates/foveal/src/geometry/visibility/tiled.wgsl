// Where tiles of a rate map are sampled, and nowhere else: the shading looks at no other pixel. After frame.wgsl,
// blocks.wgsl and the binding of `mask`, the owner levels; before bins.wgsl or resolve.wgsl.

// Any of five candidates may be asked for: as in shading/coarse/block.wgsl.
override TYPICAL: bool = false;

// The owner level.
fn rate_at(quad: vec2u) -> u32 {
    return textureLoad(mask, quad, 0).x & CELL_LEVEL;
}

fn is_listed(texel: vec2u, level: u32) -> bool {
    let block = texel >> vec2u(level);
    var found = all(texel == sample_texel(block, level, 0u));
    if TYPICAL {
        for (var candidate = 1u; candidate < 5u; candidate++) {
            found = found || all(texel == sample_texel(block, level, candidate));
        }
    }
    return found;
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
fn middle_of(texel: vec2u) -> vec2f {
    return vec2f(texel) + 0.5;
}
