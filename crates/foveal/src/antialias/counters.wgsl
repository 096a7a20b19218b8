// The queue while it is filled; the importing shader binds `queue` and `entries`.

#import antialias/queue.wgsl
#expects queue, entries

// `Queue`, to be counted in.
struct QueueCounters {
    band_groups_x: atomic<u32>,
    band_groups_y: u32,
    band_groups_z: u32,
    start: u32,
    all_groups_x: atomic<u32>,
    all_groups_y: u32,
    all_groups_z: u32,
    total: atomic<u32>,
    edge_pixels: atomic<u32>,
    evaluations: atomic<u32>,
    reserved: vec2u,
}

// Room for a pixel's entries, or false where the queue is full.
fn reserve(count: u32, evaluations: u32, base: ptr<function, u32>) -> bool {
    let first = atomicAdd(&queue.total, count);
    *base = first;
    let end = first + count;
    if end > arrayLength(&entries) {
        // Nothing to shade in what room there is.
        for (var i = first; i < min(end, arrayLength(&entries)); i++) {
            entries[i] = Entry(0u, 0u);
        }
        return false;
    }
    atomicMax(&queue.band_groups_x, (end - queue.start + 63u) / 64u);
    atomicMax(&queue.all_groups_x, min((end + 63u) / 64u, 65535u));
    atomicAdd(&queue.edge_pixels, 1u);
    atomicAdd(&queue.evaluations, evaluations);
    return true;
}
