//! Where a cluster is on the screen, and the candidate that it makes there.

use super::candidates::Candidate;
use crate::format::{BLOCK_SAMPLES, encode};
use crate::occluder::mesh::Cluster;
use crate::projection::near::{Clipped, clip_box};
use crate::projection::screen::Screen;

/// Least growth of the rectangles of clipped boxes, samples, against rounding.
const GROWN: f32 = 1.0;

/// Boxes whose rectangle may be wrong by more samples than this count as everywhere.
const LOST: f32 = 1e5;

/// The place of a cluster on the screen.
#[derive(Debug)]
pub(super) struct Place {
    /// Left, top, right, bottom, samples.
    pub(super) rect: [f32; 4],
    /// Nearest depth.
    pub(super) depth: f32,
    /// Its box crosses the near plane, and this is the place of the part beyond.
    pub(super) crossing: bool,
}

/// About the rounding of a box's rectangle, samples: one rounding of the sum of sizes that go into a
/// clip row's value, of which there are a few. A rectangle that is too small would leave polygons
/// out of some threads' rows, and not out of others'; it covers nothing that polygons do not.
/// Distances are at least 1 where a box is clipped, so that an error of a clip row's value is at most
/// one of the quotient.
fn rounding(screen: &Screen<'_>, cluster: &Cluster) -> f32 {
    let reach = cluster.center.abs() + cluster.half;
    let size = |r: &[f32; 4]| {
        r[0].abs() * reach.x + r[1].abs() * reach.y + r[2].abs() * reach.z + r[3].abs()
    };
    let [x, y, _, w] = &screen.rows;
    let widest = screen.width.max(screen.height);
    (size(x) + size(y) + size(w) * widest) * f32::EPSILON
}

/// The place of a cluster whose box crosses the near plane: of the part of the box that is on the
/// screen, beyond the far plane too, since polygons are not cut there and every band must draw the
/// same. None if there is no such part, or if all of it is beyond the far plane.
#[inline(never)]
pub(super) fn crossing(screen: &Screen<'_>, cluster: &Cluster) -> Option<Place> {
    let rounding = rounding(screen, cluster);
    if rounding.is_nan() || rounding > LOST {
        return Some(Place {
            rect: [0.0, 0.0, screen.width, screen.height],
            depth: f32::INFINITY,
            crossing: true,
        });
    }
    let far_depth = screen.far_depth;
    // Up to the end of the last blocks: polygons are drawn there too, by whichever thread has them.
    let block = BLOCK_SAMPLES as f32;
    let screen = Screen {
        dilate: rounding.max(GROWN),
        far_depth: f32::MIN,
        width: (screen.width / block).ceil() * block,
        height: (screen.height / block).ceil() * block,
        ..*screen
    };
    if screen.is_beside(cluster.center, cluster.half) {
        return None;
    }
    let (rect, depth) = match clip_box(&screen, cluster.center, cluster.half) {
        Clipped::Outside => return None,
        Clipped::Visible => ([0.0, 0.0, screen.width, screen.height], f32::INFINITY),
        Clipped::Rect(_, depth) if depth < far_depth => return None,
        Clipped::Rect(rect, depth) => (rect, depth),
    };
    Some(Place {
        rect,
        depth,
        crossing: true,
    })
}

/// The candidate at a place; none if it covers no sample.
#[cfg_attr(not(unoptimized), inline(always))]
pub(super) fn candidate(place: &Place, width: f32, height: f32) -> Option<Candidate> {
    let [x0, y0, x1, y1] = place.rect;
    // Nothing between two half-sample steps: no sample can be covered.
    if ((x0 * 2.0).floor() == (x1 * 2.0).floor()) | ((y0 * 2.0).floor() == (y1 * 2.0).floor()) {
        return None;
    }
    let block = |v: f32, size: f32| {
        let last = ((size - 1.0) / BLOCK_SAMPLES as f32) as u16;
        ((v / BLOCK_SAMPLES as f32) as u16).min(last)
    };
    Some(Candidate {
        hash: 0,
        instance: 0,
        cluster: 0,
        blocks: [
            block(x0, width),
            block(y0, height),
            block(x1, width),
            block(y1, height),
        ],
        code: encode(place.depth),
        crossing: place.crossing,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Aabb;
    use crate::occluder::OccluderMesh;

    /// The thread that has the lower rows did not draw what reaches them only beside the picture, in
    /// the pixels that fill the last column of blocks. One thread for all rows did, so that groups of
    /// boxes there were hidden or not by the number of threads.
    #[test]
    fn the_place_of_a_cluster_reaches_to_the_end_of_the_last_blocks() {
        let bounds = Aabb::new([0.8, -1.0, 0.5], [1.0, 1.0, 1.2]);
        let mesh = OccluderMesh::from_box(bounds).unwrap();
        let c = mesh.center.as_vec3();
        // Perspective, and sheared: what is lower lies farther to the right.
        let rows = [
            [100.0, 60.0, 82.0, 0.0],
            [0.0, 100.0, 94.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
        .map(|r: [f32; 4]| {
            [
                r[0],
                r[1],
                r[2],
                r[3] + r[0] * c.x + r[1] * c.y + r[2] * c.z,
            ]
        });
        let place = |width: f32, height: f32| {
            let screen = Screen {
                rows,
                width,
                height,
                far_depth: 0.0,
                dilate: 0.0,
                grow: 0.0,
                hiz: None,
            };
            crossing(&screen, &mesh.clusters[0]).unwrap().rect
        };
        let block = BLOCK_SAMPLES as f32;
        let whole = place(6.0 * block, 6.0 * block);
        assert_eq!(place(164.0, 188.0), whole);
        assert!(whole[3] > 5.0 * block, "{whole:?}");
        // Wider by a block, it is another one.
        assert_ne!(place(7.0 * block, 6.0 * block), whole);
    }
}
