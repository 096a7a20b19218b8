// Compaction: the band's pixels that are shaded more than once, as a list and its dispatch.

struct Rows {
    // As in `Band`; the rest of it is not needed here.
    count: u32,
    side: u32,
    first_row: u32,
    rows: u32,
}

struct Dispatch {
    x: atomic<u32>,
    y: u32,
    z: u32,
    pixels: atomic<u32>,
}

struct Counters {
    edge_pixels: atomic<u32>,
    // Lighting evaluations at them, beyond the ordinary one of a pixel where that is one of them.
    extra: atomic<u32>,
}

// Evaluations at an edge pixel that the ordinary path has done: 1, or 0 where all sub-samples are shaded.
override DONE: u32 = 1u;

@group(1) @binding(0) var<uniform> rows: Rows;
@group(1) @binding(1) var tally: texture_2d<u32>;
@group(1) @binding(2) var<storage, read_write> list: array<u32>;
@group(1) @binding(3) var<storage, read_write> dispatch: Dispatch;
@group(1) @binding(4) var<storage, read_write> counters: Counters;

var<workgroup> found: atomic<u32>;
var<workgroup> found_extra: atomic<u32>;
var<workgroup> base: u32;

@compute @workgroup_size(256)
fn compact(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let width = textureDimensions(tally).x;
    let index = group.x * 256u + local;
    let pixel = vec2u(index % width, rows.first_row + index / width);
    var times = 1u;
    if index < width * rows.rows {
        times = textureLoad(tally, pixel, 0).x;
    }
    var place = 0u;
    if times > 1u {
        place = atomicAdd(&found, 1u);
        atomicAdd(&found_extra, times - DONE);
    }
    workgroupBarrier();
    if local == 0u {
        let count = atomicLoad(&found);
        if count > 0u {
            base = atomicAdd(&dispatch.pixels, count);
            atomicMax(&dispatch.x, (base + count + 63u) / 64u);
            atomicAdd(&counters.edge_pixels, count);
            atomicAdd(&counters.extra, atomicLoad(&found_extra));
        }
    }
    workgroupBarrier();
    if times > 1u {
        list[base + place] = pixel.x | (pixel.y << 16u);
    }
}
