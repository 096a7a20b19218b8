// The queue of what is shaded besides the ordinary path. Rust: `antialias/targets.rs`.

struct Queue {
    // Workgroups for the band's entries, and how many entries there were before it.
    band_groups: vec3u,
    start: u32,
    // Workgroups for all entries, and how many there are; more than fit into the queue are left
    // out.
    all_groups: vec3u,
    total: u32,
    // Pixels that have entries, and their lighting evaluations.
    edge_pixels: u32,
    evaluations: u32,
    reserved: vec2u,
}

struct Entry {
    // x | y << 16
    pixel: u32,
    // Sub-samples as bits; << 16: the entry's number among the pixel's; << 24: how many those are.
    samples: u32,
}

fn pixel_of(entry: Entry) -> vec2u {
    return vec2u(entry.pixel & 0xffffu, entry.pixel >> 16u);
}

fn is_first_of_its_pixel(entry: Entry) -> bool {
    return (entry.samples >> 24u) != 0u && ((entry.samples >> 16u) & 0xffu) == 0u;
}

fn pack_half4(v: vec4f) -> vec2u {
    return vec2u(pack2x16float(v.xy), pack2x16float(v.zw));
}

fn unpack_half4(v: vec2u) -> vec4f {
    return vec4f(unpack2x16float(v.x), unpack2x16float(v.y));
}
