// Shades the listed blocks of a level. After block.wgsl and listed.wgsl.

@compute @workgroup_size(64)
fn shade_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = place_in_list(group, local);
    if index >= dispatches[current.level].w {
        return;
    }
    let block = listed_block(index);
    textureStore(radiance, block, shade_block(block, current.level));
}
