// Pixels that have no history take the light of the samples around them.

#import composite/gather.wgsl
#import composite/leaders.wgsl
#import composite/led.wgsl
#import composite/tiling.wgsl
#import shading/coarse/light.wgsl
#import shading/history/layout.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#import shared/wanted.wgsl

@group(1) @binding(1) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(2) var gbuffer_depth: texture_depth_2d_array;
// Pixels' light, where it was reprojected or sampled.
@group(1) @binding(3) var light: texture_2d<u32>;
@group(1) @binding(4) var radiance: texture_storage_2d<rgba16float, write>;
@group(1) @binding(5) var<storage, read_write> listed: array<Listed, LISTS>;
// Of the pixels that have no history.
@group(1) @binding(9) var<storage, read> dispatch: Dispatch;
@group(1) @binding(6) var<storage, read> bare: array<u32>;
// Pixels to be shaded where no sample speaks for them.
@group(1) @binding(7) var<storage, read_write> unlit: array<vec2u>;
// What pixels keep from here on, on its way to `light`.
@group(1) @binding(8) var gathered: texture_storage_2d<rgba32uint, write>;
// From its end back: pixels that are led, as `led_entry` has them.
@group(1) @binding(10) var<storage, read_write> led: array<u32>;
// A bit for each pixel that is to be shaded.
@group(1) @binding(11) var<storage, read_write> wanted: array<atomic<u32>>;

fn sampled_at(tile: Tile) -> vec2u {
    return sample_texel(tile.block, tile.level, 0u);
}

fn light_of(tile: Tile, at: vec2u) -> vec4u {
    return textureLoad(light, at, 0);
}

@compute @workgroup_size(64)
fn gather_light(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = list_index(group, local, dispatch.groups.x);
    if index >= dispatch.count {
        return;
    }
    let texel = entry_texel(bare[index]);
    let pixel = vec2f(texel) + 0.5;
    let depth = load_depth(gbuffer_depth, texel);
    let position = world_position(pixel, view_distance(depth));
    let v = direction_to_eye(view_at(pixel), position);
    let s = unpack_surface(load_words(gbuffer_surface, texel), position);
    let by = light_factors(s, v);
    let own = tile_at(texel);
    let slope = depth_slopes(texel, depth);
    let found = gather(texel, own, s, by, v, depth, slope);
    let diffuse = found.diffuse / found.weight;
    let mirror = found.specular / found.weight;
    let lights = reflected(by, diffuse, mirror);
    let seen = environment_seen(pixel, view_distance(depth));
    let other = s.emissive + ambient(s, v, seen, environment_look(s, v, false));
    if is_unsure(found, lights, other) {
        let takes = is_led(texel, own.level, s.normal, depth, slope);
        if takes {
            led[arrayLength(&led) - 1u - atomicAdd(&listed[LED].count, 1u)] = led_entry(texel);
        }
        let shaded = select(texel, leader_of(texel), takes);
        if is_first_to_want(shaded) {
            unlit[atomicAdd(&listed[UNLIT].count, 1u)] = vec2u(sample_entry(shaded, 0u), 0u);
        }
        textureStore(gathered, texel, vec4u(0u));
        return;
    }
    textureStore(radiance, texel, vec4f(min(other + lights, vec3f(65504.0)), 1.0));
    // As light from one direction each, which gives the same on this surface.
    let direction = direction_or(found.direction, s.normal);
    let specular_direction = direction_or(found.specular_direction, s.normal);
    let spread = rounded_spread(found.spread / found.weight);
    let lobe = highlight(s.normal, v, specular_direction, squared_alpha(s) + spread);
    textureStore(gathered, texel, pack_light(SampleLight(
        diffuse / max(dot(s.normal, direction), LEAST_COSINE),
        mirror / max(lobe, 1e-6),
        direction,
        specular_direction,
        spread,
        s.normal,
        0.0,
        0.0,
    )));
}
