// As shared/light_list.wgsl, from tables. After table.wgsl; the includer binds `light_table` and `cluster_table`.

fn light_row(row: u32) -> vec4u {
    return textureLoad(light_table, table_texel(row), 0);
}

fn light_count() -> u32 {
    return light_row(0u).x;
}

fn light_words() -> u32 {
    return light_row(0u).y;
}

fn light_at(index: u32) -> Light {
    let first = index * 4u + 1u;
    let position = bitcast<vec4f>(light_row(first));
    let radiant = light_row(first + 1u);
    let direction = bitcast<vec4f>(light_row(first + 2u));
    let cone = bitcast<vec4f>(light_row(first + 3u));
    return Light(
        position.xyz,
        position.w,
        bitcast<vec3f>(radiant.xyz),
        radiant.w,
        direction.xyz,
        direction.w,
        cone.x,
        cone.y,
        cone.z,
        cone.w,
    );
}

fn cluster_word(index: u32) -> u32 {
    let words = textureLoad(cluster_table, table_texel(index / 4u), 0);
    return words[index % 4u];
}
