// Sorts the sub-samples of listed pixels into surfaces: the largest is noted, the others become
// entries.

#import antialias/counters.wgsl
#import antialias/ids.wgsl
#import antialias/quarters.wgsl
#import antialias/queue.wgsl
#import antialias/samples.wgsl
#import antialias/surfaces.wgsl
#import shared/frame.wgsl

@group(3) @binding(0) var<storage, read_write> queue: QueueCounters;
@group(3) @binding(1) var<storage, read_write> entries: array<Entry>;
// As in candidates.wgsl; 0 where the list has ended.
@group(3) @binding(2) var candidate_list: texture_2d<u32>;
// Sub-samples of the pixel's largest surface as bits; << 16: how often the pixel is shaded.
@group(3) @binding(3) var largest: texture_storage_2d<r32uint, write>;
// Of entry i, row by row: instance number + 1 and position, triangle, depth.
@group(3) @binding(4) var further_identity: texture_storage_2d<rg32uint, write>;
@group(3) @binding(5) var further_triangle: texture_storage_2d<r32uint, write>;
@group(3) @binding(6) var further_depth: texture_storage_2d<r32uint, write>;

fn list_surface(pixel: vec2u, members: u32, entry: u32) {
    let id = id_at(pixel, firstTrailingBit(members));
    let center = center_of_members(pixel, members);
    let row = u32(frame.target_size.x);
    let at = vec2u(entry % row, entry / row);
    textureStore(further_identity, at, vec4u(id.x, pack_quarters(center.xy), 0u, 0u));
    textureStore(further_triangle, at, vec4u(id.y, 0u, 0u, 0u));
    textureStore(further_depth, at, vec4u(bitcast<u32>(center.z), 0u, 0u, 0u));
}

@compute @workgroup_size(64)
fn sort_pixels(@builtin(global_invocation_id) id: vec3u) {
    let row = u32(frame.target_size.x);
    let candidate = textureLoad(candidate_list, vec2u(id.x % row, id.x / row), 0).x;
    if candidate == 0u {
        return;
    }
    let pixel = vec2u((candidate - 1u) & 0xffffu, (candidate - 1u) >> 16u);
    for (var i = 0u; i < COUNT; i++) {
        known[i] = look_up_facet(pixel, i);
    }
    let found = largest_surface(pixel);
    var shades = 1u;
    var base = 0u;
    let further = found.y - 1u;
    if further > 0u && reserve(further, further, &base) {
        shades = found.y;
        var left = all_samples() & ~found.x;
        for (var i = 0u; left != 0u; i++) {
            let members = surface_of_first(pixel, left);
            left &= ~members;
            entries[base + i] = Entry(pixel.x | (pixel.y << 16u), members | (i << 16u) | (further << 24u));
            list_surface(pixel, members, base + i);
        }
    }
    textureStore(largest, pixel, vec4u(found.x | (shades << 16u), 0u, 0u, 0u));
}
