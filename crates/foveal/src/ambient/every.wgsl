// Ambient visibility of every pixel by itself.

#import ambient/horizons.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

@group(1) @binding(2) var found: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn find_every(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if any(texel >= vec2u(frame.target_size)) || is_padding(texel, 0u) || load_depth(gbuffer_depth, texel) == 0.0 {
        return;
    }
    textureStore(found, texel, vec4f(visibility_from(texel, pattern_of(place_of(texel, 0u), 0u))));
}
