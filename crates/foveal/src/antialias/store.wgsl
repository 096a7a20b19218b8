// The combined radiances go to their pixels.

#import antialias/queue.wgsl

@group(1) @binding(0) var<storage, read> queue: Queue;
@group(1) @binding(1) var<storage, read> entries: array<Entry>;
@group(1) @binding(2) var<storage, read_write> sums: array<vec2u>;
@group(1) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(64)
fn store(@builtin(global_invocation_id) id: vec3u) {
    let end = min(queue.total, arrayLength(&entries));
    for (var i = id.x; i < end; i += queue.all_groups.x * 64u) {
        let entry = entries[i];
        if is_first_of_its_pixel(entry) {
            let sum = unpack_half4(sums[i]);
            if sum.a > 0.0 {
                textureStore(radiance, pixel_of(entry), sum);
            }
        }
    }
}
