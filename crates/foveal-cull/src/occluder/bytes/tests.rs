use super::*;
use crate::occluder::chunks::Chunking;
use crate::occluder::one_ring::{FIRST_OF_RING, FIRST_OF_SECOND, NO_TRIANGLE};
use crate::reference::{Reference, Seen};
use crate::{
    Aabb, Affine, BakeOptions, Culler, Eye, FrameOptions, OccluderSet, Projection, SingleThread,
    View, Visibility,
};
use std::sync::Arc;

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n
    }

    fn unit(&mut self) -> f32 {
        self.below(1 << 20) as f32 / (1 << 20) as f32
    }
}

/// A bumpy wall of 12 x 12 quads, 4 m wide, with a hole, some triangles twice, and some in a soup.
fn wall(r: &mut Random, options: BakeOptions) -> OccluderMesh {
    wall_in(r, options, Chunking::USUAL)
}

fn wall_in(r: &mut Random, options: BakeOptions, chunking: Chunking) -> OccluderMesh {
    let n = 12u32;
    let mut points: Vec<Vec3> = (0..=n * (n + 2))
        .map(|i| {
            let (x, y) = ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
            Vec3::new(
                x / 3.0 - 2.0,
                y / 3.0 - 2.0,
                0.2 * (x * 0.7).sin() * (y * 0.5).cos(),
            )
        })
        .collect();
    let mut indices: Vec<u32> = (0..n * n)
        .map(|q| q / n * (n + 1) + q % n)
        .filter(|a| !(60..63).contains(a))
        .flat_map(|a| {
            let b = a + n + 1;
            [a, a + 1, b + 1, a, b + 1, b]
        })
        .collect();
    for _ in 0..r.below(3) {
        let t = 3 * r.below(indices.len() / 3);
        indices.extend_from_within(t..t + 3);
    }
    for _ in 0..r.below(4) {
        let at = points.len() as u32;
        points.extend((0..3).map(|_| Vec3::new(r.unit(), r.unit(), r.unit()) * 2.0 - 1.0));
        indices.extend([at, at + 1, at + 2]);
    }
    OccluderMesh::bake_in(&points, &indices, options, chunking, &SingleThread).unwrap()
}

fn options(r: &mut Random) -> BakeOptions {
    BakeOptions::default()
        .with_two_sided(r.below(4) == 0)
        .with_adjacency(r.below(4) != 0)
}

#[test]
fn every_mesh_comes_back_as_it_was() {
    let mut r = Random(7);
    let empty = OccluderMesh::bake(&[[0.0f32; 3]], &[], BakeOptions::default()).unwrap();
    let solid = OccluderMesh::from_box(Aabb::new([0.0; 3], [1.0; 3])).unwrap();
    let large: Vec<[f32; 3]> = (0..300)
        .map(|i| [3e38 * [1.0, -1.0][i % 2], 0.0, 1e38 * (i % 3) as f32])
        .collect();
    let soup: Vec<u32> = (0..298).flat_map(|i| [i, i + 1, i + 2]).collect();
    let large = OccluderMesh::bake(&large, &soup, BakeOptions::default()).unwrap();
    let mut meshes = vec![empty, solid, large];
    for _ in 0..60 {
        let options = options(&mut r);
        meshes.push(wall(&mut r, options));
    }
    for mesh in meshes {
        let bytes = mesh.to_bytes();
        assert_eq!(bytes.capacity(), bytes.len(), "the length is known before");
        assert_eq!(bytes.len(), mesh.bytes_len());
        let again = OccluderMesh::from_bytes(&bytes).unwrap();
        // Boxes after the last cluster are NaN, which is never equal.
        assert_eq!(format!("{again:?}"), format!("{mesh:?}"));
    }
}

/// The sum of two opposite normals is as short as their rounding, and its square is not exact.
#[test]
fn triangles_back_to_back_come_back_from_bytes() {
    for tilt in [1e-19f32, 1e-21, 1.9967e-22, 1e-22, 5e-23, 1e-40] {
        let points = [Vec3::ZERO, Vec3::Y, Vec3::Z, Vec3::new(tilt, 1.0, 0.0)];
        let indices = [0, 1, 2, 0, 2, 3];
        let mesh = OccluderMesh::bake(&points, &indices, BakeOptions::default()).unwrap();
        let axis = mesh.clusters[0].cone_axis;
        assert!(axis == Vec3::ZERO || axis.is_normalized(), "{tilt}: {axis}");
        assert_eq!(mesh.triangle_count(), 2, "{tilt}");
        OccluderMesh::from_bytes(&mesh.to_bytes()).unwrap();
    }
}

#[test]
fn any_wrong_byte_is_noticed() {
    let mut r = Random(3);
    let bytes = wall(&mut r, BakeOptions::default()).to_bytes();
    let reason = |bytes: &[u8]| match OccluderMesh::from_bytes(bytes) {
        Err(CullError::BadMeshBytes(reason)) => reason,
        other => panic!("{other:?}"),
    };
    for i in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[i] ^= 1 << r.below(8);
        let reason = reason(&wrong);
        let expected = match i {
            0..8 => reason == MeshBytesError::NotAMesh,
            8..12 => matches!(reason, MeshBytesError::OtherVersion { known: 3, .. }),
            16..24 => matches!(reason, MeshBytesError::WrongLength { .. }),
            _ => reason == MeshBytesError::Corrupt,
        };
        assert!(expected, "byte {i}: {reason:?}");
    }
    for length in (0..200).chain(bytes.len() - 50..bytes.len()) {
        let reason = reason(&bytes[..length]);
        let short = matches!(reason, MeshBytesError::WrongLength { .. });
        assert!(short || length < 8 && reason == MeshBytesError::NotAMesh);
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(matches!(
        reason(&longer),
        MeshBytesError::WrongLength { .. }
    ));
    // Nothing is allocated for lists that are not there.
    let mut header = bytes[..HEADER].to_vec();
    header[16..24].copy_from_slice(&(HEADER as u64).to_le_bytes());
    header[56..84].fill(0xff);
    seal(&mut header);
    assert!(matches!(reason(&header), MeshBytesError::Invalid(_)));
}

/// The triangles of a mesh, as they are drawn.
fn triangles(mesh: &OccluderMesh) -> (Vec<Vec3>, Vec<u32>) {
    let v = &mesh.vertices;
    let points = (0..v.x.len()).map(|i| Vec3::new(v.x[i], v.y[i], v.z[i]));
    let mut indices = Vec::new();
    for c in &mesh.clusters {
        for q in 0..usize::from(c.quad_count) {
            let group = &mesh.quads[c.first_group as usize + q / 8];
            let corner = |k: usize| c.first_vertex + u32::from(group[k][q % 8]);
            indices.extend([0, 1, 2, 0, 2, 3].map(corner));
        }
    }
    (points.collect(), indices)
}

/// Small boxes behind the wall and beside it.
fn boxes(r: &mut Random) -> Vec<Aabb> {
    let one = |_| {
        let [x, y, z] = [0; 3].map(|_| r.unit() * 6.0 - 3.0);
        let h = 0.02 + 0.3 * r.unit();
        Aabb::new([x - h, y - h, z - 3.0 - h], [x + h, y + h, z - 3.0 + h])
    };
    (0..60).map(one).collect()
}

/// How many boxes are culled behind a mesh, for one eye and for a view region, none of which is
/// visible beside the mesh's own triangles.
fn culled_and_hidden(mesh: OccluderMesh, boxes: &[Aabb]) -> usize {
    let eye = |x: f64, y: f64| {
        let position = [x, y, 4.0];
        let target = [x, y, 0.0];
        let projection = Projection::perspective(1.0, 4.0 / 3.0, 0.1, f64::INFINITY);
        Eye::look_at(position, target, [0.0, 1.0, 0.0], projection)
    };
    let radius = 0.05;
    let mut culled = 0;
    let (points, indices) = triangles(&mesh);
    let two_sided = mesh.two_sided;
    let mut set = OccluderSet::new();
    set.add(Arc::new(mesh), Affine::IDENTITY).unwrap();
    let mut culler = Culler::new(64, 48).unwrap();
    for views in [
        &[[0.0, 0.0]][..],
        &[[radius * 0.999, 0.0], [0.0, -radius * 0.999]],
    ] {
        let region = if views.len() == 1 { 0.0 } else { radius };
        let view = View::mono(eye(0.0, 0.0)).with_validity_radius(region);
        let frame = FrameOptions::default();
        culler
            .rasterize(&view, &set, &frame, &SingleThread)
            .unwrap();
        let mut results = vec![Visibility::Visible; boxes.len()];
        culler.query(boxes, [0.0; 3], &mut results).unwrap();
        for &[x, y] in views {
            let mut exact = Reference::new(&eye(x, y), 64, 48).unwrap();
            exact.add(&points, &indices, Affine::IDENTITY, two_sided);
            exact.finish();
            for (b, result) in boxes.iter().zip(&results) {
                if *result == Visibility::Occluded {
                    culled += 1;
                    assert_ne!(exact.seen(b, [0.0; 3]), Seen::Visible, "{b:?}");
                }
            }
        }
    }
    culled
}

/// Bytes with right checksums and wrong contents are refused, or are another mesh, behind whose own
/// triangles nothing visible is culled: neither for one eye nor for a view region.
#[test]
fn wrong_bytes_with_a_right_checksum_cull_nothing_that_is_visible() {
    let mut r = Random(11);
    let boxes = boxes(&mut r);
    let (mut accepted, mut refused, mut culled) = (0, 0, 0);
    for _ in 0..1500 {
        let options = options(&mut r);
        let mut bytes = wall(&mut r, options).to_bytes();
        for _ in 0..1 + r.below(3) {
            // Half of them in the last lists, which are those of adjacency.
            let from = if r.below(2) == 0 {
                HEADER
            } else {
                bytes.len() * 2 / 3
            };
            let at = from + r.below(bytes.len() - from);
            bytes[at] = match r.below(3) {
                0 => r.below(256) as u8,
                1 => bytes[at].wrapping_add(1),
                _ => bytes[from + r.below(bytes.len() - from)],
            };
        }
        seal(&mut bytes);
        let mesh = match OccluderMesh::from_bytes(&bytes) {
            Ok(mesh) => mesh,
            Err(CullError::BadMeshBytes(MeshBytesError::Invalid(_))) => {
                refused += 1;
                continue;
            }
            Err(other) => panic!("{other}"),
        };
        accepted += 1;
        culled += culled_and_hidden(mesh, &boxes);
    }
    assert!(accepted > 100 && refused > 100, "{accepted} {refused}");
    assert!(culled > 10_000, "{culled}");
}

/// Walls in very small chunks, with holes, doubled triangles and loose ones across their borders.
#[test]
fn meshes_in_chunks_cull_nothing_that_is_visible() {
    let mut r = Random(5);
    let boxes = boxes(&mut r);
    for corners_around in [0, 40, usize::MAX] {
        let mut culled = 0;
        for triangles in [1, 7, 16, 100].into_iter().cycle().take(40) {
            let chunking = Chunking {
                triangles,
                corners_around,
            };
            let options = options(&mut r);
            culled += culled_and_hidden(wall_in(&mut r, options, chunking), &boxes);
        }
        assert!(culled > 1000, "{corners_around}: {culled}");
    }
}

#[test]
fn threads_bake_the_same_mesh() {
    // Enough for several parts.
    let n = 200u32;
    let points: Vec<Vec3> = (0..n * n)
        .map(|i| {
            let (x, z) = ((i % n) as f32, (i / n) as f32);
            Vec3::new(x, 3.0 * (x * 0.1).sin() * (z * 0.13).cos(), z)
        })
        .collect();
    let indices: Vec<u32> = (0..(n - 1) * (n - 1))
        .map(|q| q / (n - 1) * n + q % (n - 1))
        .flat_map(|a| [a, a + n, a + 1, a + 1, a + n, a + n + 1])
        .collect();
    let options = BakeOptions::default();
    let one = OccluderMesh::bake(&points, &indices, options).unwrap();
    for count in [2, 5] {
        let threads = crate::WorkerThreads::new(count);
        let many = OccluderMesh::bake_on(&points, &indices, options, &threads).unwrap();
        assert!(many.to_bytes() == one.to_bytes(), "{count} threads");
    }
}

const BOX: Aabb = Aabb {
    min: [0.0, -1.0, 0.5],
    max: [1.0, 2.0, 3.0],
};

/// A box inside a larger mesh.
fn inner_box() -> OccluderMesh {
    let solid = Aabb::new([-0.5, -1.5, 0.25], [1.5, 2.5, 3.5]);
    OccluderMesh::of_boxes(&[BOX], Some(solid), BakeOptions::default())
}

/// Bytes that a reader of this version has to know: a box with adjacency, and one inside a mesh.
#[test]
fn the_bytes_of_a_box_are_those_of_this_version() {
    for (mesh, known) in [
        (
            OccluderMesh::from_box(BOX).unwrap(),
            include_str!("box.hex"),
        ),
        (inner_box(), include_str!("inner.hex")),
    ] {
        let bytes = mesh.to_bytes();
        let rows = bytes.chunks(32).map(|row| {
            let row = row.iter().map(|byte| format!("{byte:02x}"));
            row.collect::<String>() + "\n"
        });
        assert_eq!(rows.collect::<String>(), known);
        let digits: Vec<u8> = known.bytes().filter(u8::is_ascii_hexdigit).collect();
        let value = |digit: u8| char::from(digit).to_digit(16).unwrap() as u8;
        let pairs = digits.chunks(2).map(|d| value(d[0]) << 4 | value(d[1]));
        let again = OccluderMesh::from_bytes(&pairs.collect::<Vec<_>>()).unwrap();
        assert_eq!(format!("{again:?}"), format!("{mesh:?}"));
        assert_eq!(again.triangle_count(), 12);
        assert_eq!(again.bounds(), mesh.bounds());
        assert_eq!(again.is_inner_shape(), mesh.is_inner_shape());
    }
}

#[test]
fn an_inner_shape_outside_of_its_mesh_is_refused() {
    let bytes = inner_box().to_bytes();
    let with = |at: usize, number: f32| {
        let mut wrong = bytes.clone();
        wrong[at..at + 4].copy_from_slice(&number.to_le_bytes());
        seal(&mut wrong);
        refusal(&wrong)
    };
    let outside = "an inner shape is outside of its mesh";
    for axis in 0..3 {
        let (low, high) = (84 + 4 * axis, 96 + 4 * axis);
        assert_eq!(with(low, BOX.min[axis].next_up()), outside);
        assert_eq!(with(high, BOX.max[axis].next_down()), outside);
        assert_eq!(with(low, f32::NEG_INFINITY), outside);
        assert_eq!(with(high, f32::NAN), outside);
    }
    let flags = |flags: u32, bytes: &[u8]| {
        let mut wrong = bytes.to_vec();
        wrong[12..16].copy_from_slice(&flags.to_le_bytes());
        seal(&mut wrong);
        refusal(&wrong)
    };
    assert_eq!(flags(14, &bytes), "a flag is not known");
    let none = "bounds of an inner shape where there is none";
    assert_eq!(flags(2, &bytes), none);
    let options = BakeOptions::default().with_adjacency(false);
    let two_sided = OccluderMesh::of_boxes(&[BOX], inner_box().solid, options).to_bytes();
    assert_eq!(flags(5, &two_sided), "an inner shape has no other side");
}

/// The reason why sealed bytes are refused.
fn refusal(bytes: &[u8]) -> &'static str {
    match OccluderMesh::from_bytes(bytes) {
        Err(CullError::BadMeshBytes(MeshBytesError::Invalid(why))) => why,
        other => panic!("{other:?}"),
    }
}

/// A mesh of one quad, as bytes, with a one-ring of eight triangles that it does not have: they go on
/// from the quad, so that a view region would see no silhouette at its edges.
#[test]
fn one_rings_of_invented_triangles_are_refused() {
    let corners = |h: f32| [[-h, -h], [h, -h], [h, h], [-h, h]].map(|[x, y]| [x, y, 0.0]);
    let near: [u8; 4] = [0, 1, 2, 3];
    let mut mesh =
        OccluderMesh::bake(&corners(1.0), &[0, 1, 2, 0, 2, 3], BakeOptions::default()).unwrap();
    let own = &mesh.vertices;
    // Vertices of the cluster are by number in welding, which is that of the list.
    let found = near.map(|v| [own.x[usize::from(v)], own.y[usize::from(v)]]);
    assert_eq!(found, corners(1.0).map(|[x, y, _]| [x, y]));
    assert_eq!(mesh.clusters[0].quad_count, 1);
    let rings = &mut mesh.one_rings;
    for i in 0..8 {
        let [x, y, z] = corners(20.0)[i.min(3)];
        rings.vertices.x.push(x);
        rings.vertices.y.push(y);
        rings.vertices.z.push(z);
    }
    let mut triangles: Vec<[u8; 3]> = Vec::new();
    for k in 0..4u8 {
        let (a, b) = (k, (k + 1) % 4);
        let (far_a, far_b) = (8 + a, 8 + b);
        // Beyond the quad's edge from a to b, clockwise from it to keep the face.
        triangles.push([far_a, b, a]);
        triangles.push([b, far_a, far_b]);
    }
    let mut group = [[0u8; 8]; 3];
    for (i, t) in triangles.iter().enumerate() {
        (0..3).for_each(|corner| group[corner][i] = t[corner]);
    }
    rings.triangles = vec![group];
    // All edges at the quad, each with the triangles on both sides.
    let quad = [0, 1, 2, 3].map(|corner: usize| mesh.quads[0][corner][0]);
    let mut all = vec![
        (0u16, [quad[0], quad[1], quad[2]]),
        (FIRST_OF_SECOND as u16, [quad[0], quad[2], quad[3]]),
    ];
    all.extend((FIRST_OF_RING as u16..).zip(triangles.iter().copied()));
    let sides = |t: [u8; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    rings.edges.clear();
    for &(n, t) in &all {
        for (a, b) in sides(t).into_iter().filter(|&(a, b)| a < 4 || b < 4) {
            let other = all.iter().find(|(_, t)| sides(*t).contains(&(b, a)));
            let other = other.map_or(NO_TRIANGLE, |o| o.0);
            if n < other {
                rings.edges.push(Edge {
                    triangles: [n, other],
                    vertices: [a, b],
                });
            }
        }
    }
    let closed = |e: &Edge| e.triangles[1] != NO_TRIANGLE;
    assert_eq!(rings.edges.len(), 13);
    assert!(rings.edges.iter().all(closed));
    rings.clusters[0].vertex_count = 8;
    rings.clusters[0].triangle_count = 8;
    rings.clusters[0].edges = 13;
    let expected = "a one-ring's triangle is none of the mesh";
    assert_eq!(refusal(&mesh.to_bytes()), expected);
    // The same one-ring is good where its triangles are there, in whichever cluster.
    let mut bytes = mesh.clone();
    let other = OccluderMesh::bake(
        &[corners(1.0), corners(20.0)].concat(),
        &triangles
            .iter()
            .flat_map(|t| t.map(|v| u32::from(if v < 8 { v } else { v - 4 })))
            .collect::<Vec<_>>(),
        BakeOptions::default().with_adjacency(false),
    )
    .unwrap();
    assert_eq!(other.cluster_count(), 1);
    bytes.append(OccluderMesh {
        one_rings: complete(&other),
        ..other
    });
    assert!(OccluderMesh::from_bytes(&bytes.to_bytes()).is_ok());
}

/// A one-ring says of its triangles where they are: of another one it is refused, though both are
/// there.
#[test]
fn one_rings_whose_triangles_are_elsewhere_are_refused() {
    let mesh = wall(&mut Random(5), BakeOptions::default());
    let bytes = mesh.to_bytes();
    let first = bytes.len() - 3 * mesh.one_rings.triangle_count() as usize;
    assert!(mesh.one_rings.triangle_count() > 20);
    for at in (first..bytes.len()).step_by(3) {
        let mut wrong = bytes.clone();
        let next = if at + 6 <= bytes.len() { at + 3 } else { first };
        wrong.copy_within(next..next + 3, at);
        seal(&mut wrong);
        let expected = "a one-ring's triangle is none of the mesh";
        if bytes[at..at + 3] == bytes[next..next + 3] {
            assert!(OccluderMesh::from_bytes(&wrong).is_ok());
        } else {
            assert_eq!(refusal(&wrong), expected);
        }
    }
}

#[test]
fn places_of_triangles_are_wider_where_clusters_are_many() {
    for clusters in [1u32, 1 << 16, (1 << 16) + 1, u32::MAX / 8] {
        let counts = [clusters, 0, 0, 0, 0, 0, 2];
        let wide = has_wide_homes(counts);
        let homes = [0, clusters - 1].map(|cluster| Home {
            cluster,
            number: 97,
        });
        let mut bytes = Vec::new();
        for home in homes {
            put_home(&mut bytes, home, wide);
        }
        let without = length([clusters, 0, 0, 0, 0, 0, 0], true);
        assert_eq!(length(counts, true), without + bytes.len() as u64);
        let mut from = Reader(&bytes);
        let read = from.list(2, |from| home(from, wide)).unwrap();
        assert_eq!(read, homes);
    }
}

/// A one-ring without triangles for the only cluster of a mesh: all edges are silhouette edges.
fn complete(mesh: &OccluderMesh) -> OneRings {
    let mut rings = OneRings::default();
    for q in 0..usize::from(mesh.clusters[0].quad_count) {
        let quad = [0, 1, 2, 3].map(|corner: usize| mesh.quads[q / 8][corner][q % 8]);
        let [a, b, c, d] = quad;
        let second = (c != d).then_some((FIRST_OF_SECOND + q, [a, c, d]));
        for (n, t) in [(q, [a, b, c])].into_iter().chain(second) {
            rings.edges.extend([0, 1, 2].map(|k| Edge {
                triangles: [n as u16, NO_TRIANGLE],
                vertices: [t[k], t[(k + 1) % 3]],
            }));
        }
    }
    rings.clusters.push(OneRing {
        first_vertex: 0,
        vertex_count: 0,
        first_group: 0,
        triangle_count: 0,
        first_edge: 0,
        edges: rings.edges.len() as u16,
    });
    rings
}

/// A mesh whose last cluster is cut away: its triangles are still in the one-rings of others.
#[test]
fn one_rings_of_a_cluster_that_was_removed_are_refused() {
    let mut mesh = wall(&mut Random(5), BakeOptions::default());
    assert!(mesh.cluster_count() > 2);
    let last = mesh.clusters.pop().unwrap();
    for list in [
        &mut mesh.vertices.x,
        &mut mesh.vertices.y,
        &mut mesh.vertices.z,
    ] {
        list.truncate(last.first_vertex as usize);
    }
    mesh.quads.truncate(last.first_group as usize);
    let rings = &mut mesh.one_rings;
    let ring = rings.clusters.pop().unwrap();
    for list in [
        &mut rings.vertices.x,
        &mut rings.vertices.y,
        &mut rings.vertices.z,
    ] {
        list.truncate(ring.first_vertex as usize);
    }
    rings.triangles.truncate(ring.first_group as usize);
    rings.edges.truncate(ring.first_edge as usize);
    let expected = "a one-ring's triangle is none of the mesh";
    assert_eq!(refusal(&mesh.to_bytes()), expected);
}

#[test]
fn centres_too_far_from_the_positions_are_refused() {
    let mut mesh = wall(&mut Random(5), BakeOptions::default());
    for far in [1e39, -1e300, f64::MAX] {
        mesh.center.y = far;
        assert_eq!(refusal(&mesh.to_bytes()), "the centre is too far away");
    }
    mesh.center.y = 1e30;
    let far = OccluderMesh::from_bytes(&mesh.to_bytes()).unwrap();
    let (near, bounds) = (mesh.bounds(), far.bounds());
    assert!(bounds.min[1] <= near.min[1] && bounds.max[1] >= near.max[1]);
}

#[test]
fn too_many_triangles_are_refused() {
    let most = MAX_TRIANGLES / 128;
    assert!(total_triangles(core::iter::repeat_n(128, most)).is_ok());
    let more = [
        core::iter::repeat_n(128, most),
        core::iter::repeat_n(128, 1),
    ];
    assert!(total_triangles(more.into_iter().flatten()).is_err());
    let wraps = core::iter::repeat_n(128, 1 << 25);
    assert!(total_triangles(wraps).is_err());
}

#[test]
fn nothing_but_what_is_needed_is_allocated() {
    let mesh = wall(&mut Random(5), BakeOptions::default());
    let again = OccluderMesh::from_bytes(&mesh.to_bytes()).unwrap();
    let rings = &again.one_rings;
    assert_eq!(again.clusters.capacity(), again.clusters.len());
    assert_eq!(rings.clusters.capacity(), rings.clusters.len());
    assert_eq!(rings.edges.capacity(), rings.edges.len());
    // A cluster without vertices ends the reading of clusters.
    let mut empty = mesh.to_bytes();
    let counts = HEADER + CLUSTER as usize - 4;
    empty[counts..counts + 2].fill(0);
    seal(&mut empty);
    let why = refusal(&empty);
    assert_eq!(why, "a cluster has none or too many vertices or quads");
}
