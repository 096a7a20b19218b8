// From the band of triangles to one triangle per pixel, the largest surface's. Materials are
// evaluated afterwards, once for each.

#import antialias/ids.wgsl
#import antialias/samples.wgsl
#import antialias/surfaces.wgsl
#import shared/full_screen.wgsl

// As sort.wgsl left it; 0 where the pixel shows one triangle.
@group(3) @binding(0) var largest: texture_2d<u32>;

struct Classified {
    // Of the ordinary G-buffer.
    @location(0) identity: vec2u,
    @location(1) triangle: u32,
    // How often the pixel is shaded, and how many sub-samples the texel stands for.
    @location(2) tally: vec2u,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn classify(@builtin(position) position: vec4f) -> Classified {
    let pixel = vec2u(position.xy);
    let sorted = textureLoad(largest, pixel, 0).x;
    let members = select(sorted & 0xffffu, all_samples(), sorted == 0u);
    let texel = sample_texel(pixel, firstTrailingBit(members));
    return Classified(
        textureLoad(sample_identity, texel, 0).xy,
        textureLoad(sample_triangle, texel, 0).x,
        vec2u(max(sorted >> 16u, 1u), countOneBits(members)),
        center_of_members(pixel, members).z,
    );
}
