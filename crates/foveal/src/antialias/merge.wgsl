// Merge: from the band of sub-samples to one G-buffer texel per pixel, which the ordinary stages read, and to
// the tally of how often the pixel is shaded. After surfaces.wgsl.

// Which pixels are edges: 0 none, 1 all, 2 by depth, 3 by surface.
override EDGES: u32 = 3u;

struct MergeOut {
    @location(0) surface: vec4u,
    @location(1) identity: vec2u,
    // How often the pixel is shaded, and how many sub-samples the texel stands for.
    @location(2) tally: vec2u,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn full_screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// As tatsy's shader has it, on our depth: reversed, 1 at the near plane.
fn depths_differ(pixel: vec2u) -> bool {
    let first = textureLoad(gbuffer_depth, sample_texel(pixel, 0u), 0);
    for (var i = 1u; i < band.count; i++) {
        if abs(textureLoad(gbuffer_depth, sample_texel(pixel, i), 0) - first) > 1e-4 {
            return true;
        }
    }
    return false;
}

@fragment
fn merge(@builtin(position) position: vec4f) -> MergeOut {
    let pixel = vec2u(position.xy);
    var members = 1u;
    var shades = 1u;
    if EDGES == 1u || (EDGES == 2u && depths_differ(pixel)) {
        shades = min(band.count, 255u);
    } else if EDGES == 3u {
        let found = largest_surface(pixel);
        members = found.x;
        shades = found.y;
    }
    let texel = sample_texel(pixel, firstTrailingBit(members));
    let identity = textureLoad(sample_identity, texel, 0).xy;
    if EDGES == 3u {
        let mean = blend_of(pixel, members);
        return MergeOut(mean.words, identity, vec2u(shades, countOneBits(members)), mean.depth);
    }
    let words = textureLoad(gbuffer_surface, texel, 0);
    return MergeOut(words, identity, vec2u(shades, 1u), textureLoad(gbuffer_depth, texel, 0));
}
