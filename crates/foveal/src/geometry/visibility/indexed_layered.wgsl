// As indexed.wgsl, once for each layer of the target. After indexed.wgsl.

@vertex
fn vertex_indexed_layered(in: VisibleIn, @builtin(view_index) view: u32) -> VisibleVertex {
    let d = Drawn(drawn[in.drawn_index], view);
    return visible_vertex(d, in.position, in.previous_position, in.uv, in.color.a);
}
