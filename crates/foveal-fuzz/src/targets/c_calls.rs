//! The C interface: random calls with good and bad arguments. Every call gives the code that a model
//! expects, and nothing crashes.
#![allow(
    unsafe_code,
    reason = "calls the functions as C does, with pointers to its own variables"
)]

use core::ffi::c_void;
use core::ptr::{null, null_mut};
use foveal_cull_c::*;

use FovealCullStatus as Status;

use super::c_arguments::{Arguments, Calls, boxes};
use super::c_occludees::Occludees;
use super::c_receivers::Receivers;
use crate::random::{Choices, random_bytes};

/// Makes 60 to 150 calls.
pub fn c_calls(input: &[u8]) {
    let mut choices = Choices::new(input);
    let r = &mut choices;
    let mut world = World::default();
    for _ in 0..60 + r.below(90) {
        match r.below(23) {
            0..2 => world.create(r),
            2..4 => world.bake(r),
            13 => world.bake_heights(r),
            4..9 => world.change_occluders(r),
            9..11 => world.frame(r),
            11 => world.reload(r),
            14..18 => world.occludees.change(r),
            18 => world.occludees.create(r),
            19 => world.receivers.create(r),
            20..23 => world.receivers.change(r),
            _ => world.destroy_some(r),
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Id {
    Lives,
    Removed,
}

/// Objects of one run, and what is known about them.
#[derive(Default)]
struct World {
    meshes: Vec<*mut FovealCullMesh>,
    sets: Vec<*mut FovealCullOccluders>,
    /// Ids that were given out, with the set's place in the list.
    ids: Vec<(FovealCullOccluderId, usize, Id)>,
    trees: Vec<(*mut FovealCullTree, usize)>,
    cullers: Vec<(*mut FovealCuller, usize)>,
    occludees: Occludees,
    receivers: Receivers,
    calls: Calls,
}

extern "C" fn run_some(user: *mut c_void, tasks: u32, task: FovealCullTask, context: *mut c_void) {
    // Which tasks are forgotten follows from the seed.
    let skip = user as usize as u32;
    (0..tasks)
        .filter(|i| skip >> (i % 8) & 1 == 0)
        .for_each(|i| task(context, i));
}

impl World {
    fn note(&mut self, status: Status) -> Status {
        self.calls.note(status)
    }

    fn bake(&mut self, r: &mut Choices<'_>) {
        let count = r.below(40);
        let stride = [12, 12, 16, 21, 8][r.below(5)];
        let bytes: Vec<u8> = (0..count * stride + 8).map(|_| r.bits() as u8).collect();
        let mut positions = bytes;
        if !r.one_in(4) {
            for i in 0..count {
                for k in 0..(stride / 4).min(3) {
                    let v = (r.number() as f32).to_ne_bytes();
                    let at = i * stride + 4 * k;
                    positions[at..at + 4].copy_from_slice(&v);
                }
            }
        }
        let indices: Vec<u32> = (0..r.below(90))
            .map(|_| {
                if r.one_in(300) {
                    r.bits() as u32
                } else {
                    r.below(count.max(1)) as u32
                }
            })
            .collect();
        let short: Vec<u16> = indices.iter().map(|i| *i as u16).collect();
        let wide = r.one_in(2);
        let source = FovealCullMeshSource {
            size: if r.one_in(30) {
                r.bits() as u32 % 100
            } else {
                size_of::<FovealCullMeshSource>() as u32
            },
            index_bytes: if wide { 4 } else { 2 },
            positions: r.or_null(positions.as_mut_ptr()).cast(),
            position_count: count,
            position_stride: stride,
            indices: if wide {
                indices.as_ptr().cast()
            } else {
                short.as_ptr().cast()
            },
            index_count: indices.len(),
            two_sided: r.below(2) as u32,
            adjacency: r.below(2) as u32,
            deformable: r.below(2) as u32,
            inner_shape: r.below(2) as u32,
        };
        // Larger sizes than the struct has bytes are the caller's broken word.
        if source.size as usize > size_of::<FovealCullMeshSource>() {
            return;
        }
        let mut mesh = null_mut();
        // SAFETY: arrays are as long as the source says.
        let status = unsafe { foveal_cull_mesh_bake(&source, &mut mesh) };
        if self.note(status) == Status::Ok {
            self.meshes.push(mesh);
        } else {
            assert!(mesh.is_null());
        }
    }

    fn bake_heights(&mut self, r: &mut Choices<'_>) {
        let (mut columns, rows) = (r.below(9), r.below(9));
        if rows == 0 && r.one_in(3) {
            columns = r.bits() as usize;
        }
        let heights: Vec<f32> = (0..columns * rows).map(|_| r.number() as f32).collect();
        let [x, z] = [0, 1].map(|_| r.number().abs() as f32);
        let step = if r.one_in(30) {
            r.bits() as usize
        } else {
            r.below(6)
        };
        let mut mesh = null_mut();
        // SAFETY: as many heights as are said, and a place for the mesh.
        let status = unsafe {
            foveal_cull_mesh_from_heights(heights.as_ptr(), columns, rows, x, z, step, &mut mesh)
        };
        if self.note(status) == Status::Ok {
            self.meshes.push(mesh);
        } else {
            assert!(mesh.is_null() && status == Status::NotFinite);
        }
    }

    /// Writes a mesh and reads it again, now and then with wrong bytes.
    fn reload(&mut self, r: &mut Choices<'_>) {
        if self.meshes.is_empty() {
            return;
        }
        let n = r.below(self.meshes.len());
        // SAFETY: a live mesh, and as many bytes as are said.
        let mut bytes = unsafe {
            let needed = foveal_cull_mesh_to_bytes(self.meshes[n], null_mut(), 0);
            let mut bytes = vec![0u8; needed];
            foveal_cull_mesh_to_bytes(self.meshes[n], bytes.as_mut_ptr(), needed);
            bytes
        };
        let mut expected = Status::Ok;
        if r.one_in(3) {
            let at = r.below(bytes.len());
            bytes[at] ^= 1 << r.below(8);
            expected = Status::BadMeshBytes;
        }
        let size = bytes.len() - usize::from(r.one_in(5));
        if size < bytes.len() {
            expected = Status::BadMeshBytes;
        }
        let mut mesh = null_mut();
        // SAFETY: at least as many bytes as are said.
        let status = unsafe { foveal_cull_mesh_from_bytes(bytes.as_ptr(), size, &mut mesh) };
        assert_eq!(self.note(status), expected);
        assert_eq!(mesh.is_null(), expected != Status::Ok);
        if !mesh.is_null() {
            let old = core::mem::replace(&mut self.meshes[n], mesh);
            // SAFETY: a live mesh that is used no more.
            unsafe { foveal_cull_mesh_destroy(old) };
        }
    }

    fn change_occluders(&mut self, r: &mut Choices<'_>) {
        if self.sets.is_empty() || self.meshes.is_empty() {
            return;
        }
        let n = r.below(self.sets.len());
        let set = self.sets[n];
        if self.ids.is_empty() || r.one_in(3) {
            let mesh = self.meshes[r.below(self.meshes.len())];
            let mesh = r.or_null(mesh);
            let place = r.place();
            let mut id = FovealCullOccluderId {
                set: 0,
                occluder: 0,
            };
            // SAFETY: live handles, twelve numbers, a place for the id.
            let status = unsafe { foveal_cull_occluders_add(set, mesh, place.as_ptr(), &mut id) };
            let good = !mesh.is_null() && place.iter().all(|v| v.is_finite());
            assert_eq!(self.note(status) == Status::Ok, good, "{status:?}");
            if good {
                assert!(self.ids.iter().all(|(other, ..)| *other != id));
                self.ids.push((id, n, Id::Lives));
            } else {
                assert_eq!((id.set, id.occluder), (0, 0));
            }
            return;
        }
        let k = r.below(self.ids.len());
        let (mut id, owner, state) = self.ids[k];
        let mut expected = match (owner == n, state) {
            (false, _) => Status::OtherSet,
            (true, Id::Lives) => Status::Ok,
            (true, Id::Removed) => Status::UnknownOccluder,
        };
        if r.one_in(20) {
            // A generation that no slot has reached.
            id.occluder |= 1 << 62;
            if expected != Status::OtherSet {
                expected = Status::UnknownOccluder;
            }
        }
        // Fits few meshes.
        let positions: Vec<f32> = (0..3 * r.below(40)).map(|_| r.number() as f32).collect();
        // SAFETY: live handles, one id, twelve numbers, and as many positions as are said.
        let status = unsafe {
            match r.below(5) {
                0 => {
                    let status = foveal_cull_occluders_remove(set, id);
                    if status == Status::Ok {
                        self.ids[k].2 = Id::Removed;
                    }
                    status
                }
                1 => foveal_cull_occluders_enable(set, id, r.below(2) as u32),
                2 => {
                    let count = positions.len() / 3;
                    let positions = positions.as_ptr();
                    let status = foveal_cull_occluders_deform(set, id, positions, count, 12);
                    // Of a mesh that may be deformable or not.
                    let refused = [Status::BadArgument, Status::WrongLength, Status::NotFinite];
                    if expected == Status::Ok && refused.contains(&status) {
                        expected = status;
                    }
                    status
                }
                _ => {
                    let place = r.place();
                    if !place.iter().all(|v| v.is_finite()) {
                        expected = Status::NotFinite;
                    }
                    foveal_cull_occluders_move(set, &id, place.as_ptr(), 1)
                }
            }
        };
        assert_eq!(self.note(status), expected);
        let lives = |(_, owner, state): &&(_, usize, Id)| *owner == n && *state == Id::Lives;
        let mut count = 0;
        // SAFETY: a live handle and a place for the count.
        let status = unsafe { foveal_cull_occluders_count(set, &mut count) };
        assert_eq!(
            (status, count),
            (Status::Ok, self.ids.iter().filter(lives).count())
        );
    }

    fn frame(&mut self, r: &mut Choices<'_>) {
        if self.cullers.is_empty() || self.sets.is_empty() {
            return;
        }
        let (culler, pixels) = self.cullers[r.below(self.cullers.len())];
        let set = self.sets[r.below(self.sets.len())];
        let set = r.or_null(set);
        let mut eyes = [r.numbers::<21>(), r.numbers()].map(|n| {
            let mut pose = [0.0; 12];
            pose.copy_from_slice(&n[..12]);
            FovealCullEye {
                world_from_eye: pose,
                left: n[12],
                right: n[13],
                bottom: n[14],
                top: n[15],
                near_m: n[16],
                far_m: n[17],
                orthographic: 0,
                reserved: 0,
            }
        });
        for eye in &mut eyes {
            // SAFETY: numbers of the right count and places for eyes.
            unsafe {
                if r.one_in(3) {
                    let m: [f64; 16] = r.numbers();
                    let status = foveal_cull_eye_from_matrix(m.as_ptr(), r.below(4) as u32, eye);
                    self.note(status);
                } else if !r.one_in(8) {
                    let [a, b, c] = [r.numbers::<3>(), r.numbers(), r.numbers()];
                    let (fov, near) = (r.number().abs() * 0.2, r.number().abs() * 0.01);
                    let at = [&a, &b, &c].map(|p| p.as_ptr());
                    let status = foveal_cull_eye_look_at(at[0], at[1], at[2], fov, 1.3, near, eye);
                    self.note(status);
                }
            }
        }
        let mut view = FovealCullView {
            size: size_of::<FovealCullView>() as u32,
            eye_count: 1 + r.below(8) as u32 / 6,
            eyes,
            validity_radius_m: if r.one_in(3) { r.number() * 0.01 } else { 0.0 },
        };
        let mut options = core::mem::MaybeUninit::uninit();
        let jobs = FovealCullJobs {
            size: size_of::<FovealCullJobs>() as u32,
            count: r.below(9) as u32,
            user: r.below(256) as *mut c_void,
            run: Some(run_some),
            wake: None,
        };
        if r.one_in(3) {
            let (width, height) = (r.below(70) as u32, r.below(70) as u32);
            // SAFETY: a struct of this version.
            let status = unsafe { foveal_cull_view_for_picture(&mut view, width, height) };
            self.note(status);
        }
        // SAFETY: live handles; structs of this version; lists as long as said.
        unsafe {
            foveal_cull_frame_options_init_sized(
                options.as_mut_ptr(),
                size_of::<FovealCullFrameOptions>(),
            );
            let mut options: FovealCullFrameOptions = options.assume_init();
            options.occludee_size_threshold = r.number().abs() as f32 * 0.01;
            options.occlusion = u32::from(!r.one_in(10));
            let jobs = if r.one_in(2) { null() } else { &raw const jobs };
            let status = foveal_culler_rasterize(culler, &view, set, &options, jobs);
            let drawn = self.note(status) == Status::Ok;
            let count = r.below(300);
            let boxes = boxes(r, count);
            let mut results = vec![9u8; count];
            let origin: [f64; 3] = r.numbers();
            let to = results.as_mut_ptr();
            let status =
                foveal_culler_test_boxes(culler, boxes.as_ptr(), count, origin.as_ptr(), to);
            let most = if drawn { 3 } else { 0 };
            if self.note(status) == Status::Ok {
                assert!(results.iter().all(|v| *v <= most));
            } else {
                assert!(results.iter().all(|v| *v == 9), "results of a failure");
            }
            for &(tree, count) in &self.trees {
                let mut results = vec![9u8; count + 1];
                let wrong = usize::from(r.one_in(5));
                let to = results.as_mut_ptr();
                let status = foveal_culler_test_tree(culler, tree, to, count + wrong);
                assert_eq!(status == Status::Ok, wrong == 0);
                if wrong == 0 {
                    assert!(results[..count].iter().all(|v| *v <= most));
                } else {
                    assert!(results.iter().all(|v| *v == 9), "results of a failure");
                }
            }
            self.occludees.test(r, culler, most);
            let mut depth = vec![9.0f32; pixels];
            let status = foveal_culler_read_depth(culler, depth.as_mut_ptr(), pixels);
            assert_eq!(status, Status::Ok);
            assert!(depth.iter().all(|d| (0.0..=1.0).contains(d)));
        }
    }

    fn create(&mut self, r: &mut Choices<'_>) {
        // SAFETY: places for handles; lists as long as said.
        unsafe {
            match r.below(3) {
                0 if self.sets.len() < 4 => {
                    let mut set = null_mut();
                    assert_eq!(foveal_cull_occluders_create(&mut set), Status::Ok);
                    self.sets.push(set);
                }
                1 if self.cullers.len() < 4 => {
                    let (w, h) = (r.below(80) as u32, r.below(80) as u32);
                    let mut culler = null_mut();
                    let status = foveal_culler_create(w, h, &mut culler);
                    let expected = if w * h == 0 {
                        Status::BadSize
                    } else {
                        Status::Ok
                    };
                    assert_eq!(self.note(status), expected);
                    if status == Status::Ok {
                        self.cullers.push((culler, (w * h) as usize));
                    }
                }
                2 if self.trees.len() < 4 => {
                    let count = r.below(200);
                    let boxes = boxes(r, count);
                    let mut tree = null_mut();
                    let status = foveal_cull_tree_build(boxes.as_ptr(), count, null(), &mut tree);
                    assert_eq!(self.note(status), Status::Ok);
                    self.trees.push((tree, count));
                }
                _ => {
                    for n in 0..self.trees.len() {
                        let (tree, count) = self.trees[n];
                        let boxes = boxes(r, count);
                        let status = foveal_cull_tree_refit(tree, boxes.as_ptr(), count);
                        assert_eq!(self.note(status), Status::Ok);
                    }
                }
            }
        }
    }

    fn destroy_some(&mut self, r: &mut Choices<'_>) {
        // SAFETY: each handle is taken out of its list and used no more.
        unsafe {
            if r.one_in(2) && !self.meshes.is_empty() {
                let n = r.below(self.meshes.len());
                foveal_cull_mesh_destroy(self.meshes.swap_remove(n));
            }
            if r.one_in(6) && !self.cullers.is_empty() {
                let n = r.below(self.cullers.len());
                foveal_culler_destroy(self.cullers.swap_remove(n).0);
            }
            if r.one_in(6) && !self.trees.is_empty() {
                let n = r.below(self.trees.len());
                foveal_cull_tree_destroy(self.trees.swap_remove(n).0);
            }
        }
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // SAFETY: nothing uses them any more.
        unsafe {
            self.meshes
                .iter()
                .for_each(|m| foveal_cull_mesh_destroy(*m));
            self.sets
                .iter()
                .for_each(|s| foveal_cull_occluders_destroy(*s));
            self.trees
                .iter()
                .for_each(|t| foveal_cull_tree_destroy(t.0));
            self.cullers.iter().for_each(|c| foveal_culler_destroy(c.0));
        }
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    random_bytes(256)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A model that refuses everything, or nothing, would prove nothing.
    #[test]
    fn calls_of_random_bytes_are_both_refused_and_done() {
        let mut calls = [0; 6];
        for seed in seeds() {
            let mut r = Choices::new(&seed);
            let mut world = World::default();
            for _ in 0..20 {
                world.create(&mut r);
                world.bake(&mut r);
                world.change_occluders(&mut r);
                world.occludees.create(&mut r);
                world.receivers.create(&mut r);
                for _ in 0..8 {
                    world.occludees.change(&mut r);
                    world.receivers.change(&mut r);
                }
                world.frame(&mut r);
            }
            let all = [
                world.calls.0,
                world.occludees.calls.0,
                world.receivers.calls.0,
            ]
            .concat();
            calls.iter_mut().zip(all).for_each(|(sum, n)| *sum += n);
        }
        assert!(calls.iter().all(|n| *n > 50), "{calls:?}");
    }
}
