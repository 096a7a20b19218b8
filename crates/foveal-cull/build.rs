//! Says to the crate when it is compiled without optimization.
//!
//! Kernels are inlined into one function per instruction set. The compiler then gives every value of
//! every inlined function a place of its own on the stack unless it optimizes: megabytes of stack,
//! where threads have one or two. Without optimization the functions above `simd/` are therefore
//! calls.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(unoptimized)");
    if std::env::var("OPT_LEVEL").is_ok_and(|level| level == "0") {
        println!("cargo::rustc-cfg=unoptimized");
    }
}
