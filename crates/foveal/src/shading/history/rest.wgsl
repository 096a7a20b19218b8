// While nothing moves: lists the pixels whose turn it is, so that after a round each was shaded by
// itself.

#import shading/history/layout.wgsl
#import shading/history/parameters.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

@group(1) @binding(0) var<uniform> parameters: HistoryParameters;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d_array;
@group(1) @binding(2) var<storage, read_write> listed: array<Listed, LISTS>;
@group(1) @binding(3) var<storage, read_write> samples_listed: array<vec2u>;

// Frames of a round.
override ROUND: u32 = 16u;

@compute @workgroup_size(8, 8)
fn list_turn(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if any(texel >= vec2u(frame.target_size)) || is_padding(texel, 0u) || load_depth(gbuffer_depth, texel) == 0.0 {
        return;
    }
    if (order_of(texel) >> 16u) * ROUND / 65536u == parameters.phase {
        atomicAdd(&listed[SAMPLES].of_level[0], 1u);
        samples_listed[atomicAdd(&listed[SINGLE].count, 1u)] = vec2u(sample_entry(texel, 0u), pack2x16float(vec2f(0.0, EXPECTED_NOTHING)));
    }
}
