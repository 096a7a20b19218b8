// The scene's instances, and which of them are drawn. Rust: `scene/instances.rs`.

#ifdef TABLES
#import gpu/table.wgsl
#endif

struct Instance {
    // Rows of the affine world_from_object.
    world_x: vec4f,
    world_y: vec4f,
    world_z: vec4f,
    previous_x: vec4f,
    previous_y: vec4f,
    previous_z: vec4f,
}

#ifdef TABLES
@group(0) @binding(1) var instance_table: texture_2d<u32>;
@group(0) @binding(2) var drawn_table: texture_2d<u32>;

fn instance_row(number: u32, row: u32) -> vec4f {
    return bitcast<vec4f>(textureLoad(instance_table, table_texel(number * 6u + row), 0));
}

fn instance_at(number: u32) -> Instance {
    return Instance(
        instance_row(number, 0u),
        instance_row(number, 1u),
        instance_row(number, 2u),
        instance_row(number, 3u),
        instance_row(number, 4u),
        instance_row(number, 5u),
    );
}

fn drawn_at(index: u32) -> u32 {
    let words = textureLoad(drawn_table, table_texel(index / 4u), 0);
    return words[index % 4u];
}
#else
@group(0) @binding(1) var<storage, read> instances: array<Instance>;
// Which instance each drawn one is.
@group(0) @binding(2) var<storage, read> drawn: array<u32>;

fn instance_at(number: u32) -> Instance {
    return instances[number];
}

fn drawn_at(index: u32) -> u32 {
    return drawn[index];
}
#endif
