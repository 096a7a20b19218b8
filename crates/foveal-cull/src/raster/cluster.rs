//! Drawing one cluster: transform, silhouette margins if needed, set-up of its quads, and the
//! clipper for the rest.

use super::clip;
use super::facing::Facing;
use super::patch::PreparePatch;
use super::points::transform;
use super::scratch::Scratch;
use super::setup::draw_eight;
use super::visible_quads::VisibleQuads;
use crate::depth::band::Band;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::simd::{Lanes, four};

#[cfg_attr(not(unoptimized), inline(always))]
pub(crate) fn draw_cluster<L: Lanes>(
    l: L,
    band: &mut Band<'_>,
    scratch: &mut Scratch,
    mesh: &OccluderMesh,
    cluster: &Cluster,
    rows: &[[f64; 4]; 4],
    facing: Facing,
) {
    scratch.clusters += 1;
    let n = usize::from(cluster.vertex_count).next_multiple_of(8);
    let own = (&mesh.vertices, cluster.first_vertex as usize, n);
    let clipped = transform(&mut scratch.points, 0, own, rows);
    // Without a one-ring every polygon shrinks by itself.
    let patch = facing
        .radius
        .filter(|_| !facing.two_sided)
        .zip(mesh.one_rings.clusters.get(facing.cluster));
    let mut visible = VisibleQuads::all();
    if let Some((radius, ring)) = patch {
        visible = l.outlined(PreparePatch {
            band,
            points: &mut scratch.points,
            patch: &mut scratch.patch,
            mesh,
            cluster,
            ring,
            rows,
            mirrored: facing.mirrored,
            radius,
        });
    }
    let groups = usize::from(cluster.quad_count).div_ceil(8);
    let first = cluster.first_group as usize;
    for ((group, kept), _) in mesh.quads[first..first + groups]
        .iter()
        .zip(&scratch.patch.kept)
        .zip(visible.quads)
        .filter(|(_, visible)| *visible != 0)
    {
        let (i1, i3) = if facing.mirrored { (3, 1) } else { (1, 3) };
        let order = [0, i1, 2, i3];
        let index = four!(c => &group[order[c]]);
        let kept = patch.is_some().then_some((kept, scratch.patch.slack));
        scratch.polygons += draw_eight(l, band, &scratch.points, index, kept, facing);
    }
    scratch.patch.restore(band);
    if clipped {
        clip::draw_clipped(l, band, scratch, mesh, cluster, rows, facing);
    }
}
