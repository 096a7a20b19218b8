// Every pixel stands for itself.

// What tells which pixels of a quad are listed.
fn rate_at(quad: vec2u) -> u32 {
    return 0u;
}

// Whether any of a quad's pixels is listed or read.
fn has_listed(quad: vec2u, rate: u32) -> bool {
    return true;
}

fn is_listed(texel: vec2u, rate: u32) -> bool {
    return true;
}

// Whether the surface there is read, or emptied where nothing is seen; so are all that are listed.
fn is_read(texel: vec2u, rate: u32) -> bool {
    return true;
}

// Pixels across and down to which a listed pixel's surface is written.
fn covered_by(texel: vec2u) -> vec2u {
    return vec2u(1u);
}

// Pixels across and down for which it stands.
fn extent_of(texel: vec2u) -> vec2u {
    return vec2u(1u);
}

// Where its material is evaluated, in texels.
fn center_of(texel: vec2u) -> vec2f {
    return vec2f(texel) + 0.5 * vec2f(extent_of(texel));
}
