//! Software occlusion culling on the CPU.
#![forbid(unsafe_code)]
