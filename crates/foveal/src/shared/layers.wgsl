// Reading and writing what geometry was drawn into: one layer for the whole target, or one for each
// eye. With two, a layer is as wide as the stride between the eyes' pictures: from there on a texel
// of the target lies in the right eye's. Rust: `geometry/gbuffer.rs`.

// Column and row, and the layer, of a texel of the target; layers are `across` texels wide.
fn in_layers(across: u32, texel: vec2u) -> vec3u {
    let layer = u32(texel.x >= across);
    return vec3u(texel.x - layer * across, texel.y, layer);
}

fn load_words(layers: texture_2d_array<u32>, texel: vec2u) -> vec4u {
    let at = in_layers(textureDimensions(layers).x, texel);
    return textureLoad(layers, at.xy, at.z, 0);
}

#ifdef REDUCED
// The reduced renderer has no layers, and depth's bits.
fn load_depth(depths: texture_2d<u32>, texel: vec2u) -> f32 {
    return bitcast<f32>(textureLoad(depths, texel, 0).x);
}
#else
fn load_depth(layers: texture_depth_2d_array, texel: vec2u) -> f32 {
    let at = in_layers(textureDimensions(layers).x, texel);
    return textureLoad(layers, at.xy, at.z, 0);
}
#endif

// Columns and rows of all layers side by side.
fn whole_size(layers: texture_2d_array<u32>) -> vec2u {
    return textureDimensions(layers) * vec2u(textureNumLayers(layers), 1u);
}
