// Shades the listed blocks of a level; with LIGHT, their samples' light too.

#variant
#variant LIGHT
#variant AFFINE
#import shading/coarse/listed.wgsl
#ifdef LIGHT
#import shading/coarse/block_light.wgsl

@group(2) @binding(4) var light: texture_storage_2d<rgba32uint, write>;
#else
#import shading/coarse/block.wgsl
#endif

@compute @workgroup_size(64)
fn shade_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = place_in_list(group, local);
    if index >= dispatches[current.level].w {
        return;
    }
    let block = listed_block(index);
#ifdef LIGHT
    let lit = light_block(block, level_of(current.level));
    textureStore(radiance, block, lit.radiance);
    textureStore(light, block, lit.light);
#else
    textureStore(radiance, block, shade_block(block, current.level));
#endif
}
