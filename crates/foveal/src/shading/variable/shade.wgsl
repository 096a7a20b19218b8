// Lighting once per listed sample, at its centre, written to all of its pixels. CPU twin:
// `twin.rs`.

#import shading/input.wgsl
#import shading/variable/rates.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#import shared/lighting.wgsl
#import shared/surface.wgsl

// The surfaces of a sample's pixels are one already.
override ONE_SURFACE: bool = false;

@group(2) @binding(0) var<storage, read> samples: array<u32>;
@group(2) @binding(1) var<storage, read> listed: array<u32>;
@group(2) @binding(2) var radiance: texture_storage_2d<rgba16float, write>;

// Radiance of the pixels from `first` to `last`: depth and surface are averages of these two, which
// lie opposite each other; where the surface is a plane, depth's is exactly the centre's, because
// reversed depth is affine on the screen. A single pixel is lit to the bit as in full shading, by
// the same instructions (half of twice a number is the number): samples of all sizes lie side by
// side in a list, and a branch would make a group of lanes light twice.
fn shade_together(first: vec2u, last: vec2u) -> vec4f {
    let depth = 0.5 * (load_depth(gbuffer_depth, first) + load_depth(gbuffer_depth, last));
    let pixel = 0.5 * vec2f(first + last) + 0.5;
    let is_behind = depth == 0.0;
    let distance = select(view_distance(depth), 1.0, is_behind);
    var surface = unpack_surface(load_words(gbuffer_surface, first), world_position(pixel, distance));
    if !ONE_SURFACE {
        let other = unpack_surface(load_words(gbuffer_surface, last), vec3f(0.0));
        let single = all(first == last);
        surface.normal = select(normalize(surface.normal + other.normal), surface.normal, single);
        let vertex_normal = normalize(surface.vertex_normal + other.vertex_normal);
        surface.vertex_normal = select(vertex_normal, surface.vertex_normal, single);
        surface.base_color = 0.5 * (surface.base_color + other.base_color);
        surface.metallic = 0.5 * (surface.metallic + other.metallic);
        surface.roughness = 0.5 * (surface.roughness + other.roughness);
        surface.occlusion = 0.5 * (surface.occlusion + other.occlusion);
        surface.emissive = 0.5 * (surface.emissive + other.emissive);
        surface.dielectric = 0.5 * (surface.dielectric + other.dielectric);
    }
    return vec4f(radiance_of(surface, pixel, distance, is_behind), 1.0);
}

@compute @workgroup_size(64)
fn shade_samples(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = (group.y * listed[0] + group.x) * 64u + local;
    if index >= listed[3] {
        return;
    }
    let listed_one = unpacked_sample(samples[index]);
    let first = listed_one.first;
    let end = min(first + listed_one.extent, picture_of(first).end);
    let color = shade_together(first, end - 1u);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            textureStore(radiance, vec2u(x, y), color);
        }
    }
}
