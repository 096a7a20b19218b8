// Which block of a level's list a thread visits.

struct Level {
    level: u32,
}

@group(2) @binding(0) var<uniform> current: Level;
@group(2) @binding(1) var<storage, read> dispatches: array<vec4u, 9>;
@group(2) @binding(2) var<storage, read> blocks: array<u32>;
@group(2) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;

// Its place in the list; not below `dispatches[level].w` where there is none.
fn place_in_list(group: vec3u, local: u32) -> u32 {
    return (group.y * dispatches[current.level].x + group.x) * 64u + local;
}

fn listed_block(index: u32) -> vec2u {
    return vec2u(blocks[index] & 0xffffu, blocks[index] >> 16u);
}
