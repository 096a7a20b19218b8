// Shading of edge pixels from the list: once per further surface, or once per sub-sample. One thread a pixel.
// After surfaces.wgsl and weight.wgsl.

// Every sub-sample is shaded; else the surfaces besides the largest, which the ordinary path shades.
override ALL: bool = false;

@group(2) @binding(2) var<storage, read> list: array<u32>;
// Workgroups in x, y, z and the number of pixels.
@group(2) @binding(3) var<storage, read> dispatch: array<u32, 4>;
// Sums over what is shaded: weighted radiance, and weights in alpha.
@group(2) @binding(4) var sums: texture_storage_2d<rgba16float, write>;

fn weighted(radiance: vec3f, coverage: u32) -> vec4f {
    return vec4f(radiance, 1.0) * (weight_of(radiance) * f32(coverage) / f32(band.count));
}

fn all_of(pixel: vec2u) -> vec4f {
    var sum = vec4f(0.0);
    for (var i = 0u; i < band.count; i++) {
        let texel = sample_texel(pixel, i);
        let depth = textureLoad(gbuffer_depth, texel, 0);
        let words = textureLoad(gbuffer_surface, texel, 0);
        sum += weighted(radiance_at(sample_position(pixel, i), depth, words).rgb, 1u);
    }
    return sum;
}

fn further_surfaces_of(pixel: vec2u) -> vec4f {
    let largest = largest_surface(pixel).x;
    var sum = vec4f(0.0);
    for (var left = all_samples() & ~largest; left != 0u;) {
        let members = surface_of_first(pixel, left);
        left &= ~members;
        let mean = blend_of(pixel, members);
        sum += weighted(radiance_at(mean.position, mean.depth, mean.words).rgb, countOneBits(members));
    }
    return sum;
}

@compute @workgroup_size(64)
fn shade_edges(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = group.x * 64u + local;
    if index >= dispatch[3] {
        return;
    }
    let pixel = vec2u(list[index] & 0xffffu, list[index] >> 16u);
    if ALL {
        textureStore(sums, pixel, all_of(pixel));
    } else {
        textureStore(sums, pixel, further_surfaces_of(pixel));
    }
}
