// A dispatch over one level of a mip chain, which the last group holds: what `shared/level.wgsl` is
// for draws. Rust: `every_pixel/level.rs`.

#import shared/blocks.wgsl

@group(2) @binding(0) var dispatched_cells: texture_storage_2d<r32uint, write>;
@group(2) @binding(1) var<uniform> dispatched_level: u32;

// Whether a block is one of the level's: workgroups may reach beyond them.
fn is_of_level(block: vec2u) -> bool {
    return all(block < blocks_at(dispatched_level));
}

fn write_cell(block: vec2u, cell: u32) {
    textureStore(dispatched_cells, block, vec4u(cell, 0u, 0u, 0u));
}
