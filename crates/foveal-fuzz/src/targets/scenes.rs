//! Random scenes, and what must hold of them: those of the culler's own tests.

#[path = "../../../foveal-cull/tests/common/mod.rs"]
mod common;

pub(super) use common::*;
