// Each pixel's own surface in the light of the samples around it. CPU twin:
// `composite/light_twin.rs`.
//
// Where no sample counts, the pixel is listed, to be shaded by itself or to take its leader's light.

#import composite/gather.wgsl
#import composite/leaders.wgsl
#import composite/led.wgsl
#import composite/tiling.wgsl
#import shading/coarse/light.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#import shared/wanted.wgsl

@group(1) @binding(2) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(3) var gbuffer_depth: texture_depth_2d_array;
// Mip l: the light of level l's samples.
@group(1) @binding(4) var light: texture_2d<u32>;
@group(1) @binding(5) var radiance: texture_storage_2d<rgba16float, write>;
// The first is the number of pixels to be shaded, the second of those that are led.
@group(1) @binding(6) var<storage, read_write> counts: array<atomic<u32>, 9>;
// Pixels to be shaded, as x | y << 16; from the end back those that are led, as `led_entry` has them.
@group(1) @binding(7) var<storage, read_write> unlit: array<u32>;
// A bit for each pixel that is to be shaded.
@group(1) @binding(8) var<storage, read_write> wanted: array<atomic<u32>>;

// Samples lie at one of five places of their block, which their alpha tells.
override TYPICAL: bool = false;

fn sampled_at(tile: Tile) -> vec2u {
    var candidate = 0u;
    if TYPICAL {
        candidate = u32(sample_of(tile).a + 0.5) - 1u;
    }
    return sample_texel(tile.block, tile.level, candidate);
}

fn light_of(tile: Tile, at: vec2u) -> vec4u {
    return textureLoad(light, tile.block, tile.level);
}

@compute @workgroup_size(8, 8)
fn join(@builtin(global_invocation_id) id: vec3u) {
    let texel = id.xy;
    if any(texel >= vec2u(frame.target_size)) || is_padding(texel, 0u) {
        return;
    }
    let own = tile_at(texel);
    let pixel = vec2f(texel) + 0.5;
    let depth = load_depth(gbuffer_depth, texel);
    if own.level == 0u {
        textureStore(radiance, texel, vec4f(sample_of(own).rgb, 1.0));
        return;
    }
    let is_behind = depth == 0.0;
    // Of the backdrop any distance will do.
    let position = world_position(pixel, select(view_distance(depth), 1.0, is_behind));
    let v = direction_to_eye(view_at(pixel), position);
    let s = unpack_surface(load_words(gbuffer_surface, texel), position);
    let look = environment_look(s, v, is_behind);
    if is_behind {
        textureStore(radiance, texel, vec4f(background(look), 1.0));
        return;
    }
    let by = light_factors(s, v);
    let slope = depth_slopes(texel, depth);
    let found = gather(texel, own, s, by, v, depth, slope);
    let seen = environment_seen(pixel, view_distance(depth));
    let lights = reflected(by, found.diffuse, found.specular) / found.weight;
    let other = s.emissive + ambient(s, v, seen, look);
    if is_unsure(found, lights, other) {
        let led = is_led(texel, own.level, s.normal, depth, slope);
        if led {
            unlit[arrayLength(&unlit) - 1u - atomicAdd(&counts[1], 1u)] = led_entry(texel);
        }
        let shaded = select(texel, leader_of(texel), led);
        if is_first_to_want(shaded) {
            unlit[atomicAdd(&counts[0], 1u)] = shaded.x | (shaded.y << 16u);
        }
        return;
    }
    textureStore(radiance, texel, vec4f(min(other + lights, vec3f(65504.0)), 1.0));
}
