// A full-screen draw at one level of a mip chain. The level arrives as the draw's instance number,
// so that one pipeline serves all levels.

struct LevelVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) level: u32,
}

@vertex
fn level_screen(@builtin(vertex_index) index: u32, @builtin(instance_index) level: u32) -> LevelVertex {
    let corner = vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    return LevelVertex(corner, level);
}
