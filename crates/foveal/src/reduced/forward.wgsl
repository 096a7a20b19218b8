// As forward/lights.wgsl, from tables.

@group(2) @binding(0) var light_table: texture_2d<u32>;
@group(2) @binding(1) var cluster_table: texture_2d<u32>;
