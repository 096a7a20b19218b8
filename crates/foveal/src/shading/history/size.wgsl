// Dispatches from the lengths of lists.

#import shading/history/layout.wgsl

// Workgroups that a dispatch may have in one dimension.
const MAX_ROW: u32 = 65535u;

@group(1) @binding(0) var<storage, read_write> listed: array<Listed, LISTS>;
@group(1) @binding(1) var<storage, read_write> dispatches: array<Dispatch, LISTS>;

@compute @workgroup_size(LISTS)
fn size_lists(@builtin(local_invocation_index) list: u32) {
    let count = atomicLoad(&listed[list].count);
    let groups = (count + 63u) / 64u;
    dispatches[list].groups = vec3u(min(groups, MAX_ROW), (groups + MAX_ROW - 1u) / MAX_ROW, 1u);
    dispatches[list].count = count;
}
