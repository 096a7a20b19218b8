//! Software occlusion culling on the CPU: safe first, then fast.
//!
//! Occluders are rasterized into a small depth buffer; boxes are then tested against it. What is reported as
//! hidden *is* hidden: coverage is sampled on a 4x4 grid in every pixel, a pixel counts only when every
//! sample is covered, and its depth is the farthest one, so neither gaps thinner than a pixel nor grazing
//! surfaces let a visible thing vanish. No GPU, no scene format, no threads of its own, no clock.
//!
//! ```
//! use foveal_cull::*;
//! use glam::{DAffine3, DVec3, Vec3};
//! use std::sync::Arc;
//!
//! // A wall, 4 m wide and 3 m high, 5 m in front of the eye.
//! let wall = OccluderMesh::from_box(Aabb::new(Vec3::new(-2.0, -1.5, -5.2), Vec3::new(2.0, 1.5, -5.0))).unwrap();
//! let mut occluders = OccluderSet::new();
//! occluders.add(Arc::new(wall), DAffine3::IDENTITY)?;
//!
//! let view = View::perspective(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 16.0 / 9.0, 0.1);
//! let mut culler = Culler::new(640, 360)?;
//! culler.rasterize(&view, &occluders, &FrameOptions::default(), &SingleThread)?;
//!
//! let boxes = [
//!     Aabb::new(Vec3::new(-0.5, -0.5, -9.0), Vec3::new(0.5, 0.5, -8.0)), // behind the wall
//!     Aabb::new(Vec3::new(-0.5, -0.5, -4.0), Vec3::new(0.5, 0.5, -3.0)), // before it
//!     Aabb::new(Vec3::new(-0.5, -0.5, 8.0), Vec3::new(0.5, 0.5, 9.0)),   // behind the eye
//! ];
//! let mut results = [Visibility::Visible; 3];
//! culler.query(&boxes, DVec3::ZERO, &mut results)?;
//! assert_eq!(results, [Visibility::Occluded, Visibility::Visible, Visibility::Outside]);
//! # Ok::<(), CullError>(())
//! ```
//!
//! # Instruction sets
//! There are kernels for AVX-512, AVX2 and SSE2 on x86-64, for NEON on 64-bit ARM, and for WebAssembly's simd128; all give
//! the same bits as plain arrays, which serve everything else. On x86-64 the CPU is asked at run time. A WebAssembly module
//! cannot ask: compile it with `RUSTFLAGS="-C target-feature=+simd128"`, which all current browsers run; without that it has
//! plain arrays, at up to ten times the time.
#![deny(unsafe_code)]

mod bounds;
mod camera;
mod culler;
mod depth;
mod error;
mod format;
mod occluder;
mod options;
mod projection;
mod query;
mod raster;
#[cfg(any(test, feature = "reference"))]
pub mod reference;
mod simd;
mod stats;
mod threads;
mod view;
mod visibility;

pub use bounds::Aabb;
pub use culler::Culler;
pub use error::CullError;
pub use occluder::{BakeOptions, OccluderId, OccluderMesh, OccluderSet};
pub use options::{Budget, FrameOptions};
pub use query::tree::OccludeeTree;
pub use simd::InstructionSet;
pub use stats::CullStats;
#[cfg(feature = "rayon")]
pub use threads::Rayon;
pub use threads::{SingleThread, Threads, WorkerThreads};
pub use view::{Eye, Projection, View};
pub use visibility::Visibility;
