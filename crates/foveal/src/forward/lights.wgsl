// The lights of blended surfaces. reduced/forward.wgsl stands in where there are no storage buffers.

@group(2) @binding(0) var<storage, read> lights: Lights;
@group(2) @binding(1) var<storage, read> cluster_lights: array<u32>;
