//! Sets of occludees through the border have the results of the Rust set, byte by byte.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    reason = "tests call the functions as C does, with pointers to their own variables"
)]

mod objects;

use core::ptr::{null, null_mut};
use std::sync::Arc;

use foveal_cull::{
    Aabb, Affine, CullError, Culler, Eye, FrameOptions, OccludeeId, OccludeeSet, OccluderMesh,
    OccluderSet, Projection, SingleThread, View, Visibility,
};
use foveal_cull_c::*;
use objects::{bounds, count, culler, insert, occludees, set, view, wall};

use FovealCullStatus as Status;

/// Xorshift (Marsaglia 2003).
struct Random(u64);

impl Random {
    fn range(&mut self, lo: f32, hi: f32) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        lo + (self.0 >> 40) as f32 / (1u64 << 24) as f32 * (hi - lo)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.range(0.0, n as f32) as usize).min(n.saturating_sub(1))
    }

    /// A box in front of the eye, now and then none.
    fn bounds(&mut self, origin: [f64; 3]) -> Aabb {
        if self.below(60) == 0 {
            return Aabb::new([f32::INFINITY, 0.0, 0.0], [1.0; 3]);
        }
        let z = self.range(-30.0, 1.0);
        let at = [self.range(-1.0, 1.0) * z, self.range(-1.0, 1.0) * z, z];
        let at: [f32; 3] = core::array::from_fn(|i| at[i] - origin[i] as f32);
        let size = self.range(0.0, 1.2);
        Aabb::new(at, at.map(|v| v + size))
    }
}

/// A world for C and the same one for Rust.
struct Twins {
    c: *mut FovealCullOccludees,
    rust: OccludeeSet,
    ids: Vec<(FovealCullOccludeeId, OccludeeId)>,
    origin: [f64; 3],
    c_waiting: *mut FovealCullRebuild,
    rust_waiting: Option<foveal_cull::OccludeeSnapshot>,
}

impl Twins {
    fn insert(&mut self, r: &mut Random, count: usize) {
        let boxes: Vec<Aabb> = (0..count).map(|_| r.bounds(self.origin)).collect();
        let ids = insert(self.c, &boxes);
        let same = boxes.iter().map(|b| self.rust.insert(*b));
        self.ids.extend(ids.into_iter().zip(same));
    }

    fn move_some(&mut self, r: &mut Random, count: usize) {
        let (mut ids, mut boxes) = (Vec::new(), Vec::new());
        for _ in 0..count.min(self.ids.len()) {
            let (c, rust) = self.ids[r.below(self.ids.len())];
            let (mut bounds, by) = (self.rust.bounds(rust).unwrap(), r.range(-0.5, 0.5));
            if r.below(30) == 0 {
                bounds = r.bounds(self.origin);
            }
            let bounds = Aabb::new(bounds.min.map(|v| v + by), bounds.max.map(|v| v + by));
            self.rust.set_bounds(rust, bounds).unwrap();
            ids.push(c);
            boxes.push(bounds);
        }
        // SAFETY: a live set, and lists as long as is said.
        let status = unsafe {
            foveal_cull_occludees_move(self.c, ids.as_ptr(), boxes.as_ptr().cast(), ids.len())
        };
        assert_eq!(status, Status::Ok);
    }

    fn remove_some(&mut self, r: &mut Random, count: usize) {
        let mut ids = Vec::new();
        for _ in 0..count.min(self.ids.len()) {
            let (c, rust) = self.ids.swap_remove(r.below(self.ids.len()));
            self.rust.remove(rust).unwrap();
            assert_eq!(self.rust.bounds(rust), Err(CullError::UnknownOccludee));
            ids.push(c);
        }
        // SAFETY: a live set, and as many ids as are said.
        let status = unsafe { foveal_cull_occludees_remove(self.c, ids.as_ptr(), ids.len()) };
        assert_eq!(status, Status::Ok);
    }

    /// Builds again now, or takes a snapshot, or adopts one that was taken some steps ago.
    fn rebuild(&mut self, r: &mut Random) {
        // SAFETY: live handles; a place for the snapshot; it is destroyed once.
        unsafe {
            match (r.below(3), self.rust_waiting.take()) {
                (0, _) => {
                    self.rust.rebuild();
                    assert_eq!(foveal_cull_occludees_rebuild(self.c), Status::Ok);
                    foveal_cull_rebuild_destroy(self.c_waiting);
                    self.c_waiting = null_mut();
                }
                (_, None) => {
                    self.rust_waiting = Some(self.rust.snapshot());
                    let to = &raw mut self.c_waiting;
                    assert_eq!(foveal_cull_occludees_snapshot(self.c, to), Status::Ok);
                }
                (_, Some(snapshot)) => {
                    self.rust.adopt(snapshot.build());
                    let rebuild = self.c_waiting;
                    assert_eq!(foveal_cull_rebuild_build(rebuild), Status::Ok);
                    assert_eq!(foveal_cull_occludees_adopt(self.c, rebuild), Status::Ok);
                    foveal_cull_rebuild_destroy(rebuild);
                    self.c_waiting = null_mut();
                }
            }
        }
    }

    /// Compares all that the two sets say.
    fn compare(&self, c: *const FovealCuller, rust: &Culler, found: &mut [usize; 4]) {
        let (mut result_count, mut wants) = (0, 9);
        let (own, others): (Vec<_>, Vec<_>) = self.ids.iter().copied().unzip();
        let mut indices = vec![u32::MAX; own.len()];
        // SAFETY: live handles; lists as long as is said; places for results.
        let results = unsafe {
            let to = indices.as_mut_ptr();
            let listed = foveal_cull_occludees_indices(self.c, own.as_ptr(), own.len(), to);
            assert_eq!(listed, Status::Ok);
            let counted = foveal_cull_occludees_result_count(self.c, &mut result_count);
            assert_eq!(counted, Status::Ok);
            let asked = foveal_cull_occludees_wants_rebuild(self.c, &mut wants);
            assert_eq!(asked, Status::Ok);
            let mut results = vec![9u8; result_count];
            let to = results.as_mut_ptr();
            let tested = foveal_culler_test_occludees(c, self.c, to, result_count);
            assert_eq!(tested, Status::Ok);
            results
        };
        let mut expected = vec![Visibility::Visible; self.rust.result_count()];
        rust.query_set(&self.rust, &mut expected).unwrap();
        let expected: Vec<u8> = expected.into_iter().map(|v| v as u8).collect();
        assert_eq!(results, expected);
        assert_eq!(wants == 1, self.rust.wants_rebuild());
        assert_eq!(count(self.c), self.rust.len());
        assert_eq!(count(self.c), self.ids.len());
        for ((index, own), other) in indices.into_iter().zip(own).zip(others) {
            assert_eq!(index as usize, other.index());
            let bits = |b: Aabb| [b.min, b.max].map(|v| v.map(f32::to_bits));
            let (ours, theirs) = (
                bounds(self.c, own).unwrap(),
                self.rust.bounds(other).unwrap(),
            );
            assert_eq!(bits(ours), bits(theirs));
            found[usize::from(results[index as usize])] += 1;
        }
    }
}

/// The eye of C's view for Rust.
fn rust_view(view: &FovealCullView) -> View {
    let eye = &view.eyes[0];
    let pose: [[f64; 3]; 4] =
        core::array::from_fn(|c| core::array::from_fn(|r| eye.world_from_eye[3 * c + r]));
    let frustum = Projection::Perspective {
        left: eye.left,
        right: eye.right,
        bottom: eye.bottom,
        top: eye.top,
        near_m: eye.near_m,
        far_m: eye.far_m,
    };
    View::mono(Eye::new(Affine::from(pose), frustum)).with_validity_radius(view.validity_radius_m)
}

#[test]
fn sets_that_change_have_the_results_of_the_rust_set_byte_by_byte() {
    let mut found = [0; 4];
    for seed in 1..=12 {
        let mut r = Random(0x9e37_79b9_7f4a_7c15 ^ (seed << 32));
        let origin = [[0.0; 3], [30.0, -7.0, 2.5]][seed as usize % 2];
        let (walls, culler, mut view) = (set(), culler(), view());
        view.validity_radius_m = [0.0, 0.0, 0.02][seed as usize % 3];
        let (mut rust_walls, mut rust_culler) = (OccluderSet::new(), Culler::new(64, 64).unwrap());
        let (mesh, rust_mesh) = {
            let solid = Aabb::new([-2.0, -2.0, -5.2], [2.0, 2.0, -5.0]);
            (wall(), Arc::new(OccluderMesh::from_box(solid).unwrap()))
        };
        let options = FrameOptions::default();
        // SAFETY: live handles; twelve numbers; a place for the id; structs of this version.
        unsafe {
            for _ in 0..5 {
                let [x, y, z] = [(); 3].map(|()| f64::from(r.range(-3.0, 3.0)));
                let place = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, x, y, z];
                let mut id = core::mem::zeroed();
                let added = foveal_cull_occluders_add(walls, mesh, place.as_ptr(), &mut id);
                assert_eq!(added, Status::Ok);
                let place = Affine::from_translation([x, y, z]);
                rust_walls.add(Arc::clone(&rust_mesh), place).unwrap();
            }
            let drawn = foveal_culler_rasterize(culler, &view, walls, null(), null());
            assert_eq!(drawn, Status::Ok);
            let rust_view = rust_view(&view);
            rust_culler
                .rasterize(&rust_view, &rust_walls, &options, &SingleThread)
                .unwrap();
        }
        let mut twins = Twins {
            c: occludees(origin),
            rust: OccludeeSet::new(origin),
            ids: Vec::new(),
            origin,
            c_waiting: null_mut(),
            rust_waiting: None,
        };
        twins.insert(&mut r, 1300);
        for _ in 0..24 {
            match r.below(4) {
                0 => twins.rebuild(&mut r),
                1 => twins.insert(&mut r, 40),
                2 => twins.remove_some(&mut r, 35),
                _ => twins.move_some(&mut r, 300),
            }
            // Without a refit too.
            if r.below(5) > 0 {
                twins.rust.refit();
                // SAFETY: a live set.
                let fitted = unsafe { foveal_cull_occludees_refit(twins.c) };
                assert_eq!(fitted, Status::Ok);
            }
            twins.compare(culler, &rust_culler, &mut found);
        }
        // SAFETY: nothing uses them any more.
        unsafe {
            foveal_cull_rebuild_destroy(twins.c_waiting);
            foveal_cull_occludees_destroy(twins.c);
            foveal_cull_occluders_destroy(walls);
            foveal_cull_mesh_destroy(mesh);
            foveal_culler_destroy(culler);
        }
    }
    // Visible, outside and occluded; the defaults cull few by size.
    assert!([0, 1, 3].iter().all(|k| found[*k] > 5000), "{found:?}");
}

/// A handle that another thread uses.
struct Sent<T>(*mut T);

// SAFETY: the header lets handles be used from any thread.
unsafe impl<T> Send for Sent<T> {}

impl<T> Sent<T> {
    fn get(&self) -> *mut T {
        self.0
    }
}

/// What a set and a list of the same boxes say of them.
#[derive(Debug, Default)]
struct Compared {
    hidden: usize,
    /// Hidden by their group, while the list sees them.
    more: usize,
    /// Hidden by their group, while the list has them outside or small.
    grouped: usize,
}

impl Compared {
    /// `boxes` are those of the set, in the order of their places.
    fn compare(
        &mut self,
        culler: *const FovealCuller,
        set: *mut FovealCullOccludees,
        boxes: &[Aabb],
    ) {
        let (mut results, mut list) = (vec![9u8; boxes.len()], vec![9u8; boxes.len()]);
        // SAFETY: live handles; lists as long as is said.
        let status = unsafe {
            let to = results.as_mut_ptr();
            let tested = foveal_culler_test_occludees(culler, set, to, boxes.len());
            let (from, to) = (boxes.as_ptr().cast(), list.as_mut_ptr());
            [
                tested,
                foveal_culler_test_boxes(culler, from, boxes.len(), null(), to),
            ]
        };
        assert_eq!(status, [Status::Ok; 2]);
        let [visible, occluded] = [Visibility::Visible as u8, Visibility::Occluded as u8];
        for ((of_set, of_list), bounds) in results.into_iter().zip(list).zip(boxes) {
            assert!(
                of_set == of_list || of_set == occluded,
                "{of_set} {of_list} {bounds:?}"
            );
            self.hidden += usize::from(of_set != visible);
            if of_set != of_list {
                self.more += usize::from(of_list == visible);
                self.grouped += usize::from(of_list != visible);
            }
        }
    }
}

#[test]
fn a_hierarchy_is_built_by_another_thread_while_frames_go_on() {
    let (set, walls, mesh, culler) = (occludees([0.0; 3]), set(), wall(), culler());
    let mut r = Random(77);
    // Every other box is behind the eye, so that the set takes its hierarchy, not a list.
    let mut boxes: Vec<Aabb> = (0..20_000)
        .map(|k| r.bounds([0.0, 0.0, if k % 2 == 0 { 0.0 } else { -40.0 }]))
        .collect();
    let (old, new) = boxes.split_at(10_000);
    let mut ids = insert(set, old);
    let (mut rebuild, mut wants, mut built) = (null_mut(), 9, 9);
    let (mut before, mut after) = (Compared::default(), Compared::default());
    // SAFETY: live handles, which outlive the thread; lists as long as is said; places for results.
    unsafe {
        // A wall from the left edge of the view to the right one, so that groups behind it are hidden
        // which reach out of the view.
        let wide = [
            4.0f64, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
        ];
        let mut id = core::mem::zeroed();
        let added = foveal_cull_occluders_add(walls, mesh, wide.as_ptr(), &mut id);
        assert_eq!(added, Status::Ok);
        let drawn = foveal_culler_rasterize(culler, &view(), walls, null(), null());
        assert_eq!(drawn, Status::Ok);
        // Half of them have a hierarchy, the others wait for theirs.
        assert_eq!(foveal_cull_occludees_rebuild(set), Status::Ok);
        ids.extend(insert(set, new));
        let asked = foveal_cull_occludees_wants_rebuild(set, &mut wants);
        assert_eq!((asked, wants), (Status::Ok, 1));
        let taken = foveal_cull_occludees_snapshot(set, &mut rebuild);
        assert_eq!(taken, Status::Ok);
        let sent = Sent(rebuild);
        let builder = std::thread::spawn(move || foveal_cull_rebuild_build(sent.get()));
        let mut frame = |compared: &mut Compared| {
            let n = r.below(ids.len());
            boxes[n] = r.bounds([0.0; 3]);
            let moved = (&raw const boxes[n]).cast::<f32>();
            let status = foveal_cull_occludees_move(set, &ids[n], moved, 1);
            assert_eq!(status, Status::Ok);
            assert_eq!(foveal_cull_occludees_refit(set), Status::Ok);
            compared.compare(culler, set, &boxes);
        };
        loop {
            frame(&mut before);
            // Not begun, in the making, done.
            let ended = builder.is_finished();
            let asked = foveal_cull_rebuild_is_built(rebuild, &mut built);
            assert_eq!(asked, Status::Ok);
            match foveal_cull_occludees_adopt(set, rebuild) {
                Status::Ok => break,
                Status::BadArgument | Status::Busy if !ended && built == 0 => {}
                other => panic!("{other:?}, built: {built}"),
            }
        }
        // Asking too early has not kept the builder out.
        assert_eq!(builder.join().unwrap(), Status::Ok);
        let asked = foveal_cull_occludees_wants_rebuild(set, &mut wants);
        assert_eq!((asked, wants, count(set)), (Status::Ok, 0, ids.len()));
        for _ in 0..3 {
            frame(&mut after);
        }
        foveal_cull_rebuild_destroy(rebuild);
        foveal_cull_occludees_destroy(set);
        foveal_cull_occluders_destroy(walls);
        foveal_cull_mesh_destroy(mesh);
        foveal_culler_destroy(culler);
    }
    // Groups are hidden, which a list has not: the hierarchy was walked, before and after.
    for compared in [before, after] {
        assert!(
            compared.hidden > 5000 && compared.grouped > 0,
            "{compared:?}"
        );
        assert!(compared.more * 100 < compared.hidden, "{compared:?}");
    }
}
