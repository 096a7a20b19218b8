// Shading of the entries whose materials were resolved from triangles.

#import antialias/quarters.wgsl
#import antialias/queue.wgsl
#import antialias/weight.wgsl
#import shading/input.wgsl
#import shading/shading.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

// Sub-samples per pixel.
override COUNT: u32 = 4u;
// Owner levels of 2 x 2 pixels each: what lies in coarse pixels is not shaded.
override COARSE: bool = false;

@group(2) @binding(0) var<storage, read> queue: Queue;
@group(2) @binding(1) var<storage, read> entries: array<Entry>;
@group(2) @binding(2) var<storage, read_write> sums: array<vec2u>;
@group(2) @binding(3) var further_identity: texture_2d<u32>;
@group(2) @binding(4) var further_depth: texture_2d<u32>;
@group(2) @binding(5) var owner_levels: texture_2d<u32>;

@compute @workgroup_size(64)
fn shade_further(@builtin(global_invocation_id) id: vec3u) {
    let end = min(queue.total, arrayLength(&entries));
    let row = u32(frame.target_size.x);
    for (var i = id.x; i < end; i += queue.all_groups.x * 64u) {
        let entry = entries[i];
        if entry.samples == 0u {
            continue;
        }
        if COARSE && (textureLoad(owner_levels, pixel_of(entry) / 2u, 0).x & 0xfu) != 0u {
            continue;
        }
        let texel = vec2u(i % row, i / row);
        let position = unpack_quarters(textureLoad(further_identity, texel, 0).y);
        let depth = bitcast<f32>(textureLoad(further_depth, texel, 0).x);
        let radiance = radiance_at(position, depth, load_words(gbuffer_surface, texel)).rgb;
        sums[i] = pack_weighted(weighted(radiance, countOneBits(entry.samples & 0xffffu), COUNT));
    }
}
