// As shade_list.wgsl, with the samples' light. After block_light.wgsl and listed.wgsl.

@group(2) @binding(4) var light: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(64)
fn shade_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = place_in_list(group, local);
    if index >= dispatches[current.level].w {
        return;
    }
    let block = listed_block(index);
    let lit = light_block(block, current.level);
    textureStore(radiance, block, lit.radiance);
    textureStore(light, block, lit.light);
}
