// Shading of the queue's entries: a further surface, or every sub-sample of a pixel.

#import antialias/queue.wgsl
#import antialias/samples.wgsl
#import antialias/stored.wgsl
#import antialias/weight.wgsl
#import shading/input.wgsl
#import shading/shading.wgsl
#import shared/layers.wgsl

// An entry stands for every sub-sample of its pixel, else for those of one surface.
override ALL: bool = false;

@group(2) @binding(2) var<storage, read> queue: Queue;
@group(2) @binding(3) var<storage, read> entries: array<Entry>;
// Per entry: as `pack_weighted` has it.
@group(2) @binding(4) var<storage, read_write> sums: array<vec2u>;

fn all_of(pixel: vec2u) -> vec4f {
    var sum = vec4f(0.0);
    for (var i = 0u; i < COUNT; i++) {
        let texel = sample_texel(pixel, i);
        let depth = load_depth(gbuffer_depth, texel);
        let words = load_words(gbuffer_surface, texel);
        sum += weighted(radiance_at(sample_position(pixel, i), depth, words).rgb, 1u, COUNT);
    }
    return sum;
}

fn surface_of(pixel: vec2u, members: u32) -> vec4f {
    let mean = blend_of(pixel, members);
    return weighted(radiance_at(mean.position, mean.depth, mean.words).rgb, countOneBits(members), COUNT);
}

@compute @workgroup_size(64)
fn shade_entries(@builtin(global_invocation_id) id: vec3u) {
    let index = queue.start + id.x;
    if index >= min(queue.total, arrayLength(&entries)) {
        return;
    }
    let entry = entries[index];
    if entry.samples == 0u {
        return;
    }
    if ALL {
        sums[index] = pack_weighted(all_of(pixel_of(entry)));
    } else {
        sums[index] = pack_weighted(surface_of(pixel_of(entry), entry.samples & 0xffffu));
    }
}
