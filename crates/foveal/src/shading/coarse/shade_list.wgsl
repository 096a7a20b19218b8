// Shades the listed blocks of a level. After block.wgsl.

struct Level {
    level: u32,
}

@group(2) @binding(0) var<uniform> current: Level;
@group(2) @binding(1) var<storage, read> dispatches: array<vec4u, 9>;
@group(2) @binding(2) var<storage, read> blocks: array<u32>;
@group(2) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(64)
fn shade_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let dispatch = dispatches[current.level];
    let index = (group.y * dispatch.x + group.x) * 64u + local;
    if index >= dispatch.w {
        return;
    }
    let block = vec2u(blocks[index] & 0xffffu, blocks[index] >> 16u);
    textureStore(radiance, block, shade_block(block, current.level));
}
