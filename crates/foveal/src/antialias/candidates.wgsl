// Lists the band's pixels that show several triangles: few, and the only ones whose triangles are
// looked at.

#import antialias/ids.wgsl
#import antialias/samples.wgsl
#import shared/frame.wgsl

struct Candidates {
    // Workgroups of 64 candidates, as an indirect dispatch wants them.
    groups_x: atomic<u32>,
    groups_y: u32,
    groups_z: u32,
    count: atomic<u32>,
}

@group(3) @binding(0) var<storage, read_write> candidates: Candidates;
// Pixels, x | y << 16, plus 1; row by row.
@group(3) @binding(1) var candidate_list: texture_storage_2d<r32uint, write>;

var<workgroup> found: atomic<u32>;
var<workgroup> first: u32;

fn shows_one_triangle(pixel: vec2u) -> bool {
    let leader = id_at(pixel, 0u);
    var same = true;
    for (var i = 1u; i < COUNT; i++) {
        let id = id_at(pixel, i);
        same = same && id.x == leader.x && (id.y == leader.y || id.x == 0u);
    }
    return same;
}

@compute @workgroup_size(8, 8)
fn list_candidates(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let pixel = vec2u(id.x, id.y + band.first_row);
    let inside = f32(id.x) < frame.target_size.x && id.y < band.rows;
    let listed = inside && !shows_one_triangle(pixel);
    var place = 0u;
    if listed {
        place = atomicAdd(&found, 1u);
    }
    workgroupBarrier();
    if local == 0u {
        let all_found = atomicLoad(&found);
        if all_found > 0u {
            first = atomicAdd(&candidates.count, all_found);
            atomicMax(&candidates.groups_x, min((first + all_found + 63u) / 64u, 65535u));
        }
    }
    workgroupBarrier();
    if listed {
        let row = u32(frame.target_size.x);
        let at = first + place;
        textureStore(candidate_list, vec2u(at % row, at / row), vec4u((pixel.x | (pixel.y << 16u)) + 1u, 0u, 0u, 0u));
    }
}
