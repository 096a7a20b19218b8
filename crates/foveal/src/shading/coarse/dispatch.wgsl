// Dispatches from counts: one thread per level.

// Workgroups that a dispatch may have in one dimension.
const MAX_ROW: u32 = 65535u;

@group(0) @binding(0) var<storage, read> counts: array<u32, 9>;
// Workgroups in x, y, z of 64 threads, and the number of tiles.
@group(0) @binding(1) var<storage, read_write> dispatches: array<vec4u, 9>;

@compute @workgroup_size(9)
fn size_dispatches(@builtin(local_invocation_index) level: u32) {
    let groups = (counts[level] + 63u) / 64u;
    dispatches[level] = vec4u(min(groups, MAX_ROW), (groups + MAX_ROW - 1u) / MAX_ROW, 1u, counts[level]);
}
