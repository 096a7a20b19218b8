// Radiance of a block. CPU twin: `shading/coarse/block.rs`.

#import shared/blocks.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#ifdef AFFINE
#import shading/coarse/affine.wgsl
#else
#import shading/input.wgsl
#import shading/shading.wgsl
#endif

// The sample whose depth and normal are nearest to the average of five, else the centre.
override TYPICAL: bool = false;

// Depth counts relative to the average, and as much as a turn of the normal.
fn typical_candidate(block: vec2u, level: u32) -> u32 {
    var depths: array<f32, 5>;
    var normals: array<vec3f, 5>;
    var depth_sum = 0.0;
    var normal_sum = vec3f(0.0);
    for (var i = 0u; i < 5u; i++) {
        let texel = sample_texel(block, level, i);
        depths[i] = load_depth(gbuffer_depth, texel);
        normals[i] = unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, texel).y));
        depth_sum += depths[i];
        normal_sum += normals[i];
    }
    var best = 0u;
    var least = 1e30;
    for (var i = 0u; i < 5u; i++) {
        let away = abs(depths[i] * 5.0 - depth_sum) / max(depth_sum, 1e-12) + distance(normals[i], normal_sum / 5.0);
        if away < least {
            least = away;
            best = i;
        }
    }
    return best;
}

fn candidate_of(block: vec2u, level: u32) -> u32 {
    if TYPICAL && level > 0u {
        return typical_candidate(block, level);
    }
    return 0u;
}

// Alpha is 1 + the number of the candidate that was shaded.
fn shade_block(block: vec2u, level: u32) -> vec4f {
    let candidate = candidate_of(block, level);
    let radiance = shade(sample_texel(block, level, candidate));
    return vec4f(radiance.rgb, f32(1u + candidate));
}
