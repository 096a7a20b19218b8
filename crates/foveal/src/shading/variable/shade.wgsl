// Lighting once per listed sample, at its centre, written to all of its pixels. After shading.wgsl and rates.wgsl.
// CPU twin: `twin.rs`.

// The surfaces of a sample's pixels are one already.
override ONE_SURFACE: bool = false;

@group(2) @binding(0) var<storage, read> samples: array<u32>;
@group(2) @binding(1) var<storage, read> listed: array<u32>;
@group(2) @binding(2) var mask: texture_2d<u32>;
@group(2) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;

// Radiance of the pixels from `first` up to `end`: depth and surface are the pixels' averages, which on a plane are
// those of the centre. A single pixel is lit to the bit as in full shading, by the same instructions: samples of all
// sizes lie side by side in a list, and a branch would make a group of lanes light twice.
fn shade_together(first: vec2u, end: vec2u) -> vec4f {
    var depth = load_depth(gbuffer_depth, first);
    var sum = unpack_surface(load_words(gbuffer_surface, first), vec3f(0.0));
    let extent = end - first;
    let count = extent.x * extent.y;
    for (var y = first.y; y < end.y; y++) {
        // The first pixel is in the sums already.
        for (var x = first.x + u32(y == first.y); x < end.x; x++) {
            let texel = vec2u(x, y);
            depth += load_depth(gbuffer_depth, texel);
            if !ONE_SURFACE {
                let one = unpack_surface(load_words(gbuffer_surface, texel), vec3f(0.0));
                sum.normal += one.normal;
                sum.base_color += one.base_color;
                sum.metallic += one.metallic;
                sum.roughness += one.roughness;
                sum.occlusion += one.occlusion;
                sum.emissive += one.emissive;
            }
        }
    }
    let pixel = 0.5 * vec2f(first + end);
    if depth == 0.0 {
        return vec4f(environment(-direction_to_eye(view_at(pixel), world_position(pixel, 1.0))), 1.0);
    }
    let share = select(1.0 / f32(count), 1.0, ONE_SURFACE);
    let distance = view_distance(depth / f32(count));
    let surface = Surface(
        world_position(pixel, distance),
        select(normalize(sum.normal), sum.normal, count == 1u || ONE_SURFACE),
        sum.base_color * share,
        sum.metallic * share,
        sum.roughness * share,
        sum.occlusion * share,
        sum.emissive * share,
    );
    return vec4f(min(lit(surface, pixel, distance), vec3f(65504.0)), 1.0);
}

@compute @workgroup_size(64)
fn shade_samples(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = (group.y * listed[0] + group.x) * 64u + local;
    if index >= listed[3] {
        return;
    }
    let first = vec2u(samples[index] & 0xffffu, samples[index] >> 16u);
    let end = min(first + extent_at(textureLoad(mask, first / 2u, 0).x), picture_of(first).end);
    let color = shade_together(first, end);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            textureStore(radiance, vec2u(x, y), color);
        }
    }
}
