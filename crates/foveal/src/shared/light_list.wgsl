// The scene's lights and the clusters' bits. The includer binds `lights` and `cluster_lights`; reduced/lights.wgsl stands
// in where there are no storage buffers.

fn light_count() -> u32 {
    return lights.count;
}

// 32-light words per cluster.
fn light_words() -> u32 {
    return lights.words;
}

fn light_at(index: u32) -> Light {
    return lights.items[index];
}

fn cluster_word(index: u32) -> u32 {
    return cluster_lights[index];
}
