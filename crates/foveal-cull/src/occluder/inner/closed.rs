//! Whether triangles bound a volume.

/// Whether every edge is there as often in one direction as in the other. Then the winding number
/// is a whole number at every point that is not on the surface, and the same at two points that
/// no triangle parts. Several shells, shells that cross and edges of four triangles all pass;
/// borders and neighbours that face opposite ways do not.
pub(super) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let directed = |t: &[u32; 3]| {
        [0, 1, 2].map(|k| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            // Both directions of an edge lie side by side; there are fewer than 2^31 vertices.
            u64::from(a.min(b)) << 32 | u64::from(a.max(b)) << 1 | u64::from(a > b)
        })
    };
    let mut edges: Vec<u64> = triangles.iter().flat_map(directed).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a >> 1 == b >> 1).all(|edge| {
        let backwards = edge.iter().filter(|e| *e & 1 == 1).count();
        backwards * 2 == edge.len()
    })
}
