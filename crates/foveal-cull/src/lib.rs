//! Software occlusion culling on the CPU: safe first, then fast.
//!
//! Occluders are rasterized into a small occlusion buffer, and boxes are then tested against it. It
//! needs no GPU, no scene format and no clock, and starts no threads unless you ask for them.
//!
//! # The promise
//! No box is reported hidden that is visible at a pixel centre of a picture of the buffer's size,
//! or of four times its size per axis. A box that shows only between these points may be reported
//! hidden. [`Culler::for_picture`] and [`View::for_picture`] fit buffer and view to a picture of
//! any size, so that its pixel centres are those points. [`View::with_validity_radius`] with a tiny
//! radius holds at every point of the picture.
//!
//! How: coverage is sampled on a 4x4 grid in every pixel. A pixel hides only where every sample is
//! covered, at the depth of the farthest.
//!
//! The reverse is approximate: some hidden boxes are reported as visible (0.4 % of them in a castle
//! at 640x360 pixels).
//!
//! The same scene and view give the same results on every instruction set, with any number of
//! threads, and in whatever order occluders were added.
//!
//! # Conventions
//! Lengths are metres. Space is right-handed with y up, and eyes look along their own -z. World
//! positions are `f64`. Boxes are `f32`, relative to an origin that the caller names in `f64`, so
//! that worlds far from zero lose nothing. Triangles are counter-clockwise from outside. Pixels
//! count from the top left. Depth is `near / distance`: 1 at the near plane, 0 at infinity.
//!
//! The interface takes plain numbers: arrays, and whatever turns into them, such as vectors of glam,
//! nalgebra or mint in any version. Matrices are column-major. An engine's own `clip_from_world`
//! matrix makes a view by [`View::from_clip_from_world`], for any depth range and either handedness.
//!
//! # Size of the picture
//! The buffer has a quarter of the picture's size per axis, rounded up: `width.div_ceil(4)` by
//! `height.div_ceil(4)` pixels. Where a side of the picture is no multiple of 4, the buffer reaches
//! beyond the picture on the right or at the bottom, and the view must be wider by as much.
//! Otherwise the samples are not the pixel centres, and what shows through slits narrower than a
//! pixel may be reported hidden. [`Culler::for_picture`] makes the buffer, [`View::for_picture`]
//! widens the view.
//!
//! - Upscaling: the size is that at which the frame is drawn.
//! - Temporal anti-aliasing: the view is that of the matrix with the frame's jitter, so that the
//!   samples are those of the frame; or it has a validity radius.
//! - Multisampling: the view has a validity radius.
//!
//! # A static level
#![doc = include_str!("../pictures/static_level.svg")]
//!
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! // When the level loads: bake each mesh once and place it.
//! // Here a wall, 4 m wide and 3 m high, 5 m in front of the eye.
//! let wall = Aabb::new([-2.0, -1.5, -5.2], [2.0, 1.5, -5.0]);
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(OccluderMesh::from_box(wall)?), Affine::IDENTITY)?;
//! let boxes = [
//!     // Behind the wall, in front of it, and behind the eye.
//!     Aabb::new([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0]),
//!     Aabb::new([-0.5, -0.5, -4.0], [0.5, 0.5, -3.0]),
//!     Aabb::new([-0.5, -0.5, 8.0], [0.5, 0.5, 9.0]),
//! ];
//! let origin = [0.0; 3];
//! let tree = OccludeeTree::build(&boxes, origin);
//! // The picture's size in pixels: any.
//! let (width, height) = (1366, 768);
//! let mut culler = Culler::for_picture(width, height)?;
//! let mut results = [Visibility::Visible; 3];
//!
//! // In each frame: rasterize, then query. The eye is at the origin and looks along -z.
//! let [eye, target, up] = [[0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
//! let aspect = f64::from(width) / f64::from(height);
//! let view = View::perspective(eye, target, up, 1.0, aspect, 0.1).for_picture(width, height);
//! culler.rasterize(&view, &occluders, &FrameOptions::default(), &SingleThread)?;
//! culler.query_tree(&tree, &mut results)?;
//! let expected = [Visibility::Occluded, Visibility::Visible, Visibility::Outside];
//! assert_eq!(results, expected);
//!
//! // Boxes without a tree, for instance of things that move.
//! culler.query(&boxes[..1], origin, &mut results[..1])?;
//! assert_eq!(results[0], Visibility::Occluded);
//! # Ok::<(), CullError>(())
//! ```
//!
//! Meshes need no authored occluders. With [`BakeOptions::inner_shape`] boxes inside a dense closed
//! mesh take its place where they hide nearly as much for less: `OccluderMesh::bake(&positions,
//! &indices, BakeOptions::default().with_inner_shape(true))`.
//!
//! # A moving world
//! Occluders move by their transforms. Occludees that come, move and go are an [`OccludeeSet`]: a
//! hierarchy that follows them, and that is built again now and then, on another thread if one
//! likes.
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! // A door in front of the eye, and a cart behind it.
//! let leaf = OccluderMesh::from_box(Aabb::new([-2.0, -2.0, -0.1], [2.0, 2.0, 0.1]))?;
//! let mut occluders = OccluderSet::new();
//! let door = occluders.add(Arc::new(leaf), Affine::from_translation([0.0, 0.0, -5.0]))?;
//! let mut objects = OccludeeSet::new([0.0; 3]);
//! let cart = objects.insert(Aabb::new([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0]));
//! objects.rebuild();
//!
//! let [eye, target, up] = [[0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
//! let view = View::perspective(eye, target, up, 1.0, 16.0 / 9.0, 0.1);
//! let mut culler = Culler::new(640, 360)?;
//! let mut frame = |occluders: &OccluderSet, objects: &OccludeeSet| {
//!     culler.rasterize(&view, occluders, &FrameOptions::default(), &SingleThread)?;
//!     let mut results = vec![Visibility::Visible; objects.result_count()];
//!     culler.query_set(objects, &mut results)?;
//!     Ok::<_, CullError>(results[cart.index()])
//! };
//! assert_eq!(frame(&occluders, &objects)?, Visibility::Occluded);
//!
//! // The cart drives to the right, out from behind the door.
//! objects.set_bounds(cart, Aabb::new([3.5, -0.5, -9.0], [4.5, 0.5, -8.0]))?;
//! objects.refit();
//! assert_eq!(frame(&occluders, &objects)?, Visibility::Visible);
//!
//! // It drives back, and the door opens.
//! objects.set_bounds(cart, Aabb::new([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0]))?;
//! objects.refit();
//! occluders.set_transform(door, Affine::from_translation([4.0, 0.0, -5.0]))?;
//! assert_eq!(frame(&occluders, &objects)?, Visibility::Visible);
//!
//! // Built again on another thread when it is worth it, while frames go on.
//! if objects.wants_rebuild() {
//!     let snapshot = objects.snapshot();
//!     let built = std::thread::spawn(|| snapshot.build());
//!     if let Ok(hierarchy) = built.join() {
//!         objects.adopt(hierarchy);
//!     }
//! }
//! # Ok::<(), CullError>(())
//! ```
//!
//! Occluders of a mesh that was baked [`deformable`](BakeOptions::deformable) change their shape by
//! [`OccluderSet::set_positions`], and [`OccluderMesh::from_heights`] bakes terrains.
//!
//! # Two eyes
//! One conservative test serves both eyes of a headset, and head movement until the picture is
//! shown. The results hold for every eye position in the view region, and hide somewhat less than
//! two exact tests.
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! let wall = Aabb::new([-2.0, -1.5, -5.2], [2.0, 1.5, -5.0]);
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(OccluderMesh::from_box(wall)?), Affine::IDENTITY)?;
//!
//! // The tangents of each eye's frustum, as the headset's runtime gives them.
//! let eye = |x: f64, left: f64, right: f64| {
//!     let frustum = Projection::Perspective {
//!         left,
//!         right,
//!         bottom: -1.0,
//!         top: 1.0,
//!         near_m: 0.1,
//!         far_m: f64::INFINITY,
//!     };
//!     Eye::new(Affine::from_translation([x, 0.0, 0.0]), frustum)
//! };
//! let (left, right) = (eye(-0.032, -1.2, 0.9), eye(0.032, -0.9, 1.2));
//! let view = View::stereo(left, right).with_validity_radius(0.01);
//! let mut culler = Culler::new(480, 480)?;
//! culler.rasterize(&view, &occluders, &FrameOptions::default(), &SingleThread)?;
//!
//! let behind = [Aabb::new([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0])];
//! let mut results = [Visibility::Visible];
//! culler.query(&behind, [0.0; 3], &mut results)?;
//! assert_eq!(results, [Visibility::Occluded]);
//! # Ok::<(), CullError>(())
//! ```
//!
//! # Lights and shadows
//! The same culler looks from a light: casters that others hide from it need not be drawn into its
//! shadow map. A [`ReceiverMask`] leaves out those whose shadows fall on nothing that the camera
//! sees. A map without a receiver need not be drawn. A light is left out as a whole where the camera's
//! culler hides its range: query a box around it.
//!
//! The shadow map must draw the faces that occluders hide with: front faces, and both faces of
//! occluders that are baked [two-sided](BakeOptions::two_sided). A map of back faces only does not
//! hold a wall that has no back, and the shadow of what is behind the wall is lost. For such a map
//! bake the light's occluders one-sided and from closed meshes.
//!
#![doc = include_str!("../pictures/receivers.svg")]
//!
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! // A wall between the eye and a lamp, two crates behind it, and one beside it that can be seen.
//! let wall = Aabb::new([-2.0, 0.0, -5.2], [2.0, 4.0, -5.0]);
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(OccluderMesh::from_box(wall)?), Affine::IDENTITY)?;
//! let things = [
//!     wall,
//!     Aabb::new([-1.0, 0.0, -9.0], [0.0, 1.0, -8.0]),
//!     Aabb::new([1.0, 3.0, -9.0], [2.0, 4.0, -8.0]),
//!     Aabb::new([4.0, 0.0, -9.0], [5.0, 1.0, -8.0]),
//! ];
//! let (origin, mut seen) = ([0.0; 3], [Visibility::Visible; 4]);
//! let view = View::perspective([0.0, 1.5, 0.0], [0.0, 1.5, -9.0], [0.0, 1.0, 0.0], 1.2, 1.78, 0.1);
//! let (mut culler, options) = (Culler::new(640, 360)?, FrameOptions::default());
//! culler.rasterize(&view, &occluders, &options, &SingleThread)?;
//! culler.query(&things, origin, &mut seen)?;
//! assert_eq!(seen.map(Visibility::is_visible), [true, false, false, true]);
//!
//! // The right one of the lamp's six shadow maps, 512 texels a side.
//! let side = Projection::perspective(std::f64::consts::FRAC_PI_2, 1.0, 0.05, 10.0);
//! let lamp = [-2.5, 1.0, -8.5];
//! let side = View::mono(Eye::look_at(lamp, [9.0, 1.0, -8.5], [0.0, 1.0, 0.0], side));
//! let mut mask = ReceiverMask::new(&side, 512)?;
//! mask.receive(&things, origin, &seen)?;
//! // The culler's samples are the map's texels.
//! let mut map = Culler::for_picture(512, 512)?;
//! map.rasterize(&side.for_picture(512, 512), &occluders, &options, &SingleThread)?;
//! let mut casters = [Visibility::Visible; 4];
//! map.query(&things, origin, &mut casters)?;
//! mask.cull(&things, origin, &mut casters)?;
//! // The lower crate's shadow falls on the one that is seen, the upper one's on nothing.
//! assert_eq!(casters.map(Visibility::is_visible), [true, true, false, true]);
//! # Ok::<(), CullError>(())
//! ```
//!
//! # Your own threads
//! [`WorkerThreads`] are the crate's own, `Rayon` comes with the feature `rayon`, and any job
//! system fits behind [`ThreadsFn`] or [`Threads`].
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! // Threads for each run: simple, but slower than threads that stay.
//! let jobs = ThreadsFn::new(4, |tasks, task| {
//!     std::thread::scope(|scope| {
//!         (0..tasks).for_each(|i| drop(scope.spawn(move || task(i))));
//!     });
//! });
//!
//! let pillar = Aabb::new([-1.0, -9.0, -6.0], [1.0, 9.0, -5.0]);
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(OccluderMesh::from_box(pillar)?), Affine::IDENTITY)?;
//! let [eye, target, up] = [[0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
//! let view = View::perspective(eye, target, up, 1.0, 1.0, 0.1);
//! let options = FrameOptions::default();
//! let mut culler = Culler::new(256, 256)?;
//! let mut depths = [vec![0.0; 256 * 256], vec![0.0; 256 * 256]];
//!
//! culler.rasterize(&view, &occluders, &options, &SingleThread)?;
//! culler.read_depth(&mut depths[0])?;
//! culler.rasterize(&view, &occluders, &options, &jobs)?;
//! culler.read_depth(&mut depths[1])?;
//! assert_eq!(depths[0], depths[1]);
//! # Ok::<(), CullError>(())
//! ```
//!
//! # On the web
//! The same code runs in a browser, on one thread ([compile it with SIMD](#instruction-sets)). A time limit
//! goes by the page's clock. What is not drawn in time hides nothing, so results stay safe.
//! ```
//! use foveal_cull::*;
//! use std::sync::Arc;
//!
//! // In a browser `performance.now()`, for instance by the crate `web-sys`.
//! fn now_ms() -> f64 {
//!     // ..
//! #   0.0
//! }
//!
//! let wall = Aabb::new([-2.0, -1.5, -5.2], [2.0, 1.5, -5.0]);
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(OccluderMesh::from_box(wall)?), Affine::IDENTITY)?;
//! // The matrix that the page draws with: WebGL's depth is from -1 to 1.
//! let clip_from_world: [f32; 16] = [
//!     1.0, 0.0, 0.0, 0.0, //
//!     0.0, 1.5, 0.0, 0.0, //
//!     0.0, 0.0, -1.0, -1.0, //
//!     0.0, 0.0, -0.2, 0.0,
//! ];
//! let view = View::from_clip_from_world(clip_from_world, ClipDepth::MinusOneToOne)?;
//! let view = view.for_picture(1280, 720);
//! let mut culler = Culler::for_picture(1280, 720)?;
//!
//! // In each frame: half a millisecond for the occluders.
//! let clock = || (now_ms() * 1e6) as u64;
//! let budget = Budget::new(&clock, clock() + 500_000);
//! let options = FrameOptions::default().with_budget(Some(budget));
//! culler.rasterize(&view, &occluders, &options, &SingleThread)?;
//! let behind = [Aabb::new([-0.5, -0.5, -9.0], [0.5, 0.5, -8.0])];
//! let mut results = [Visibility::Visible];
//! culler.query(&behind, [0.0; 3], &mut results)?;
//! assert_eq!(results, [Visibility::Occluded]);
//! # Ok::<(), CullError>(())
//! ```
//!
//! # Occluders that hide nothing
//! [`OccluderUsefulness`] learns from frame to frame which occluders help to hide what is asked for,
//! and leaves the others out. With a [`Budget`] it draws those that hide most for their time.
//!
//! # Cost
//! Baking is O(n log n) in triangles and belongs to load time, another shape takes a tenth of it;
//! [`OccluderMesh::to_bytes`] keeps its result, which [`OccluderMesh::from_bytes`] checks and reads. A
//! frame costs the clusters that may be visible and the blocks of 8x8 pixels that they touch, and each
//! query some nanoseconds. On one core of an AMD EPYC (Zen 5, AVX-512) at 640x360 pixels: 0.22 ms for
//! 48,700 occluder triangles of a castle seen from around it, and 5 ns for a random box. A tree of 26,894
//! objects takes 0.06 ms at 1280x720. `cargo bench -p foveal-cull` measures the kernels on your machine.
//!
//! # Instruction sets
//! There are kernels for AVX-512, AVX2 and SSE2 on x86-64, for NEON on 64-bit ARM, and for
//! WebAssembly's simd128. All give the same bits as plain arrays, which serve every other target.
//! On x86-64 the CPU is asked at run time. A WebAssembly module cannot ask: compile it with
//! `RUSTFLAGS="-C target-feature=+simd128"`, which all current browsers run. Without it the module
//! uses plain arrays, which take up to ten times as long.
//!
//! # Features
//! - `glam`: conversions of [`Affine`] and [`Matrix4`] from and to types of glam 0.34. Off by
//!   default. Vectors need no feature.
//! - `rayon`: [`Threads`] on the current rayon thread pool. Off by default.
//! - `reference`: the slow, exact reference that results are compared with. Off by default.
//!
//! # Sources
//! Greene, Kass and Miller 1993, *Hierarchical Z-buffer visibility*; Hasselgren, Andersson and
//! Akenine-Möller 2016, *Masked software occlusion culling*; Wonka, Wimmer and Schmalstieg 2000,
//! *Visibility preprocessing with occluder fusion for urban walkthroughs*; Intel's software
//! occlusion culling sample (thresholds and stats).
#![deny(unsafe_code)]

#[cfg(feature = "bench")]
#[doc(hidden)]
pub mod bench;
mod bounds;
mod camera;
mod clip_space;
mod culler;
mod depth;
mod error;
mod format;
mod learning;
mod limits;
mod occluder;
mod options;
mod projection;
mod query;
mod raster;
#[cfg(any(test, feature = "reference"))]
pub mod reference;
mod simd;
mod stats;
#[cfg(feature = "testing")]
#[doc(hidden)]
pub mod testing;
mod threads;
mod transform;
mod view;
mod visibility;

pub use bounds::Aabb;
pub use clip_space::ClipDepth;
pub use culler::Culler;
pub use error::{CullError, MeshBytesError, Quantity, ViewError};
pub use limits::MAX_SIDE_PX;
pub use occluder::{BakeOptions, OccluderId, OccluderMesh, OccluderSet, OccluderUsefulness};
pub use options::{Budget, FrameOptions};
pub use query::moving::OccludeeSet;
pub use query::occludee_id::OccludeeId;
pub use query::rebuild::{OccludeeRebuild, OccludeeSnapshot};
pub use query::receivers::ReceiverMask;
pub use query::tree::OccludeeTree;
pub use simd::InstructionSet;
pub use stats::CullStats;
#[cfg(feature = "rayon")]
pub use threads::Rayon;
pub use threads::{SingleThread, Threads, ThreadsFn, WorkerThreads};
pub use transform::{Affine, Matrix4};
pub use view::{Eye, Projection, View};
pub use visibility::Visibility;

/// The public types cross threads.
const _: () = {
    const fn send_and_sync<T: Send + Sync>() {}
    send_and_sync::<Aabb>();
    send_and_sync::<Affine>();
    send_and_sync::<BakeOptions>();
    send_and_sync::<Budget<'_>>();
    send_and_sync::<ClipDepth>();
    send_and_sync::<CullError>();
    send_and_sync::<CullStats>();
    send_and_sync::<Culler>();
    send_and_sync::<Eye>();
    send_and_sync::<FrameOptions<'_>>();
    send_and_sync::<InstructionSet>();
    send_and_sync::<Matrix4>();
    send_and_sync::<MeshBytesError>();
    send_and_sync::<OccludeeId>();
    send_and_sync::<OccludeeRebuild>();
    send_and_sync::<OccludeeSet>();
    send_and_sync::<OccludeeSnapshot>();
    send_and_sync::<OccludeeTree>();
    send_and_sync::<OccluderId>();
    send_and_sync::<OccluderMesh>();
    send_and_sync::<OccluderSet>();
    send_and_sync::<OccluderUsefulness>();
    send_and_sync::<Projection>();
    send_and_sync::<Quantity>();
    send_and_sync::<ReceiverMask>();
    send_and_sync::<SingleThread>();
    send_and_sync::<ThreadsFn<fn(usize, &(dyn Fn(usize) + Sync))>>();
    send_and_sync::<View>();
    send_and_sync::<ViewError>();
    send_and_sync::<Visibility>();
    send_and_sync::<WorkerThreads>();
};
