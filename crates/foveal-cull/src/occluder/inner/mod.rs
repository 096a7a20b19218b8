//! Inner shapes: a few boxes inside a closed mesh, which hide nearly as much as the mesh for a
//! hundredth of the work.
//!
//! `closed` says whether a mesh bounds a volume, `grid` lays cells over it, `touched` finds those
//! that its surface may meet, `inside` those within it, `greedy` large boxes of them, and `kept`
//! how much of the mesh's outline the boxes fill. `shape` does all of it and decides.
//!
//! Nothing here relies on a surface without self-intersections: a cell is inside where no triangle
//! comes near it and the winding number around it is at least 1. A ray that comes from outside the
//! mesh's bounds, where the number is 0, and ends in such a cell has then crossed a triangle from
//! its front.
//!
//! Sources of the idea: Darnell 2011, *Automated occluders for GPU culling*; Silvennoinen,
//! Saransaari, Laine and Lehtinen 2014, *Occluder simplification using planar sections*. Both work
//! on voxels too; neither keeps a margin. Winding numbers by solid angles: van Oosterom and
//! Strackee 1983.

mod closed;
mod greedy;
mod grid;
mod inside;
mod kept;
mod shape;
#[cfg(test)]
mod tests;
mod touched;

pub(super) use shape::{inner_boxes, may_have_boxes};
