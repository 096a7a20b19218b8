// The scene's instances, and which of them are drawn. With vertex.wgsl; reduced/instances.wgsl stands in where there are
// no storage buffers.

@group(0) @binding(1) var<storage, read> instances: array<Instance>;
// Which instance each drawn one is.
@group(0) @binding(2) var<storage, read> drawn: array<u32>;

fn instance_at(number: u32) -> Instance {
    return instances[number];
}

fn drawn_at(index: u32) -> u32 {
    return drawn[index];
}
