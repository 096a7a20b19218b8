// Lists the samples of the rate map's blocks.

#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

@group(1) @binding(0) var gbuffer_depth: texture_depth_2d_array;
// Of 2 x 2 pixels each.
@group(1) @binding(1) var owner_levels: texture_2d<u32>;
@group(1) @binding(2) var<storage, read_write> listed: array<u32>;
// The first is the number of listed texels.
@group(1) @binding(3) var<storage, read_write> counts: array<atomic<u32>, 9>;

@compute @workgroup_size(8, 8)
fn mark(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if any(texel >= vec2u(frame.target_size)) || is_padding(texel, 0u) || load_depth(gbuffer_depth, texel) == 0.0 {
        return;
    }
    let level = textureLoad(owner_levels, texel >> vec2u(1u), 0).x & CELL_LEVEL;
    if level > 0u && any(texel != sample_texel(texel >> vec2u(level), level, 0u)) {
        return;
    }
    listed[atomicAdd(&counts[0], 1u)] = texel.x | (texel.y << 14u) | (level << 28u);
}
