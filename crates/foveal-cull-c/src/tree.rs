//! Trees of boxes.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::status::{Fault, FovealCullStatus, guard};
use foveal_cull::{Aabb, OccludeeTree};
use std::sync::RwLock;

/// A hierarchy over boxes that are tested in many frames.
#[derive(Debug)]
pub struct FovealCullTree(pub(crate) RwLock<OccludeeTree>);

/// Builds a tree.
///
/// # Safety
/// `boxes` is null or `6 * count` numbers; `origin` is null or three; `out` is null or can be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_tree_build(
    boxes: *const f32,
    count: usize,
    origin: *const f64,
    out: *mut *mut FovealCullTree,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                if u32::try_from(count).is_err() {
                    return Err(Fault::argument("'count' is more than 2^32 - 1"));
                }
                let boxes = border::list(boxes.cast::<Aabb>(), count, "boxes")?;
                let origin = crate::place::origin(origin)?;
                Ok(FovealCullTree(RwLock::new(OccludeeTree::build(
                    boxes, origin,
                ))))
            })
        }
    })
}

/// Takes new boxes for the same objects.
///
/// # Safety
/// `tree` is null or lives; `boxes` is null or `6 * count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_tree_refit(
    tree: *mut FovealCullTree,
    boxes: *const f32,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let tree = border::object(tree, "tree")?;
            let boxes = border::list(boxes.cast::<Aabb>(), count, "boxes")?;
            Ok(border::write(&tree.0)?.refit(boxes)?)
        }
    })
}

/// Drops a tree. Null is nothing.
///
/// # Safety
/// `tree` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_tree_destroy(tree: *mut FovealCullTree) {
    // SAFETY: the caller's word.
    unsafe { border::take(tree) };
}
