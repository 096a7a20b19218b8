//! Cluster

use super::clip;
use super::facing::Facing;
use super::open::Open;
use super::patch::Prepare;
use super::points::transform;
use super::scratch::Scratch;
use super::setup::draw_eight;
use crate::depth::band::Band;
use crate::occluder::mesh::{Cluster, OccluderMesh};
use crate::simd::{Lanes, four};

#[inline(always)]
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
    // Without a ring every polygon shrinks by itself.
    let sheet = facing
        .radius
        .filter(|_| !facing.two_sided)
        .zip(mesh.rings.rings.get(facing.cluster));
    let mut open = Open::all();
    if let Some((radius, ring)) = sheet {
        open = l.apart(Prepare {
            band,
            points: &mut scratch.points,
            sheet: &mut scratch.sheet,
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
        .zip(&scratch.sheet.kept)
        .zip(open.quads)
        .filter(|(_, open)| *open != 0)
    {
        let (i1, i3) = if facing.mirrored { (3, 1) } else { (1, 3) };
        let order = [0, i1, 2, i3];
        let index = four!(c => &group[order[c]]);
        let kept = sheet.is_some().then_some((kept, scratch.sheet.slack));
        scratch.polygons += draw_eight(l, band, &scratch.points, index, kept, facing);
    }
    scratch.sheet.restore(band);
    if clipped {
        clip::draw_clipped(l, band, scratch, mesh, cluster, rows, facing);
    }
}
