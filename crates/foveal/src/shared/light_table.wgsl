// The scene's lights. Rust: `lights/upload.rs`.

#import shared/light.wgsl
#ifdef TABLES
#import gpu/table.wgsl
#expects light_table
#else
#expects lights
#endif

#ifdef TABLES
fn light_row(row: u32) -> vec4u {
    return textureLoad(light_table, table_texel(row), 0);
}

fn light_count() -> u32 {
    return light_row(0u).x;
}

fn light_words() -> u32 {
    return light_row(0u).y;
}

// How many lights are directional; they come first.
fn directional_lights() -> u32 {
    return light_row(0u).z;
}

// A light's position, and its range in w.
fn light_sphere(index: u32) -> vec4f {
    return bitcast<vec4f>(light_row(index * 4u + 1u));
}

fn light_at(index: u32) -> Light {
    return light_in(index, light_sphere(index));
}

// The same where its sphere is known.
fn light_in(index: u32, sphere: vec4f) -> Light {
    let first = index * 4u + 1u;
    let radiant = light_row(first + 1u);
    let direction = bitcast<vec4f>(light_row(first + 2u));
    let cone = bitcast<vec4f>(light_row(first + 3u));
    return Light(
        sphere.xyz,
        sphere.w,
        bitcast<vec3f>(radiant.xyz),
        bitcast<f32>(radiant.w),
        direction.xyz,
        direction.w,
        cone.x,
        cone.y,
        bitcast<u32>(cone.z),
        cone.w,
    );
}
#else
fn light_count() -> u32 {
    return lights.count;
}

// 32-light words per cluster.
fn light_words() -> u32 {
    return lights.words;
}

// How many lights are directional; they come first.
fn directional_lights() -> u32 {
    return lights.directional;
}

// A light's position, and its range in w.
fn light_sphere(index: u32) -> vec4f {
    return vec4f(lights.items[index].position, lights.items[index].range);
}

fn light_at(index: u32) -> Light {
    return lights.items[index];
}

// The same where its sphere is known.
fn light_in(index: u32, sphere: vec4f) -> Light {
    return lights.items[index];
}
#endif
