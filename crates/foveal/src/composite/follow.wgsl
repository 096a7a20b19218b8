// Pixels that are led take their leader's light; with KEPT, they keep it for the next frame.

#variant
#variant KEPT
#import composite/leaders.wgsl
#import shading/coarse/light.wgsl
#import shared/environment.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl

// The place of the list's workgroups and length.
override LIST: u32 = 0u;

@group(1) @binding(0) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d_array;
// Pixels' light.
@group(1) @binding(2) var light: texture_2d<u32>;
@group(1) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;
// From its end back: pixels as `led_entry` has them.
@group(1) @binding(4) var<storage, read> led: array<u32>;
@group(1) @binding(5) var<storage, read> dispatches: array<vec4u>;
#ifdef KEPT
// What pixels keep from here on, on its way to `light`.
@group(1) @binding(6) var gathered: texture_storage_2d<rgba32uint, write>;
#endif

@compute @workgroup_size(64)
fn follow(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = (group.y * dispatches[LIST].x + group.x) * 64u + local;
    if index >= dispatches[LIST].w {
        return;
    }
    let texel = led_texel(led[arrayLength(&led) - 1u - index]);
    let pixel = vec2f(texel) + 0.5;
    let distance = view_distance(load_depth(gbuffer_depth, texel));
    let position = world_position(pixel, distance);
    let v = direction_to_eye(view_at(pixel), position);
    let s = unpack_surface(load_words(gbuffer_surface, texel), position);
    var lit = unpack_light(textureLoad(light, leader_of(texel), 0));
    let look = environment_look(s, v, false);
    let shown = shown_of(lit, s, v, environment_seen(pixel, distance), look);
    textureStore(radiance, texel, vec4f(shown, 1.0));
#ifdef KEPT
    lit.normal = s.normal;
    textureStore(gathered, texel, pack_light(lit));
#endif
}
