// Ambient visibility of every pixel by itself: of a target in one dispatch, or of a draw's viewport.

#variant
#variant REDUCED
#import ambient/horizons.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#ifdef REDUCED
#import shared/full_screen.wgsl
#endif

fn shows_surface(texel: vec2u) -> bool {
    return !is_padding(texel, 0u) && load_depth(gbuffer_depth, texel) != 0.0;
}

fn visibility_at(texel: vec2u) -> f32 {
    return visibility_from(texel, pattern_of(place_of(texel, 0u), 0u));
}

#ifdef REDUCED
// Its bits.
@fragment
fn find_every(@builtin(position) position: vec4f) -> @location(0) u32 {
    let texel = vec2u(position.xy);
    if !shows_surface(texel) {
        return 0u;
    }
    return bitcast<u32>(visibility_at(texel));
}
#else
@group(1) @binding(2) var found: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn find_every(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if all(texel < vec2u(frame.target_size)) && shows_surface(texel) {
        textureStore(found, texel, vec4f(visibility_at(texel)));
    }
}
#endif
