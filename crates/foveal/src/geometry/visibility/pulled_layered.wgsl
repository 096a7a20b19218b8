// As pulled.wgsl, once for each layer of the target. After pulled.wgsl.

@vertex
fn vertex_pulled_layered(
    @builtin(instance_index) drawn_index: u32,
    @builtin(vertex_index) at: u32,
    @builtin(view_index) view: u32,
) -> VisibleVertex {
    return pulled_vertex(Drawn(drawn[drawn_index], view), at);
}
