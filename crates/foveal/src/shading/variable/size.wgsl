// The dispatch that covers a list.

// Workgroups that a dispatch may have in one dimension.
const MAX_ROW: u32 = 65535u;

// As `Listed` in mask.wgsl begins.
@group(0) @binding(0) var<storage, read_write> listed: array<u32>;

@compute @workgroup_size(1)
fn size_list() {
    let groups = (listed[3] + 63u) / 64u;
    listed[0] = min(groups, MAX_ROW);
    listed[1] = (groups + MAX_ROW - 1u) / MAX_ROW;
    listed[2] = 1u;
}
