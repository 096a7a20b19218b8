// The vertex shader that is run once for each layer of the target, which is an eye's. After vertex.wgsl.

@vertex
fn vertex_layered(in: VertexIn, @builtin(view_index) view: u32) -> VertexOut {
    return vertex_of(in, Drawn(drawn[in.drawn_index], view));
}
