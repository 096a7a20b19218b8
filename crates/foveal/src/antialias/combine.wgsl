// Combination: what the entries of a pixel came to, with the ordinary path's radiance for the rest
// of its coverage. The result stays in the sums: no texture is read and written in one step, so
// store.wgsl follows.

#import antialias/queue.wgsl
#import antialias/weight.wgsl

// The entries hold all of a pixel; else the largest surface is the ordinary path's.
override ALL: bool = false;
// Sub-samples per pixel.
override COUNT: u32 = 4u;

@group(1) @binding(0) var<storage, read> queue: Queue;
@group(1) @binding(1) var<storage, read> entries: array<Entry>;
@group(1) @binding(2) var<storage, read_write> sums: array<vec2u>;
// Owner levels of 2 x 2 pixels each: coarse pixels stay as they are.
override COARSE: bool = false;
@group(1) @binding(4) var owner_levels: texture_2d<u32>;
@group(1) @binding(3) var ordinary: texture_2d<f32>;
// Entries of the pixels that do not stay as they are.
@group(1) @binding(5) var<storage, read_write> combined: atomic<u32>;

@compute @workgroup_size(64)
fn combine(@builtin(global_invocation_id) id: vec3u) {
    let end = min(queue.total, arrayLength(&entries));
    var count = 0u;
    for (var i = id.x; i < end; i += queue.all_groups.x * 64u) {
        let entry = entries[i];
        if !is_first_of_its_pixel(entry) {
            continue;
        }
        if COARSE && (textureLoad(owner_levels, pixel_of(entry) / 2u, 0).x & 0xfu) != 0u {
            sums[i] = pack_half4(vec4f(0.0));
            continue;
        }
        var sum = vec4f(0.0);
        var rest = COUNT;
        let of_pixel = entry.samples >> 24u;
        count += of_pixel;
        for (var k = 0u; k < of_pixel; k++) {
            sum += unpack_weighted(sums[i + k]);
            rest -= countOneBits(entries[i + k].samples & 0xffffu);
        }
        if !ALL {
            let largest = textureLoad(ordinary, pixel_of(entry), 0).rgb;
            sum += vec4f(largest, 1.0) * (weight_of(largest) * f32(rest) / f32(COUNT));
        }
        // Rounding may leave the range of halves. Alpha says that there is something to store.
        let mean = min(sum.rgb / sum.a, vec3f(65504.0));
        sums[i] = pack_half4(vec4f(mean, 1.0));
    }
    if count > 0u {
        atomicAdd(&combined, count);
    }
}
