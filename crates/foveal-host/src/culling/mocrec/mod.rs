//! Recorded occluder draws: the files of the frame recorder of Intel's masked occlusion culling.
//!
//! A recording is a list of clip-space draws and queries without any camera. Clip coordinates are
//! an eye space of their own: the point (x, y, -w) seen from the origin along -z lands at (x / w, y
//! / w), so an eye with tangents of ±1 and the recorded near plane sees exactly what was recorded;
//! that this space is sheared against the world is all one to visibility. Matrices become affine
//! placements of the recorded vertices.

mod agreement;
mod read;
mod replay;

pub use agreement::{Agreement, Recorded};
pub use read::{Record, Recording, Triangles, Verdict};
pub use replay::subjects;
