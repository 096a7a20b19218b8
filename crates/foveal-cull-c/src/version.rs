//! The version of the library.
#![allow(
    unsafe_code,
    reason = "functions for C have names that nothing mangles"
)]

use core::ffi::{CStr, c_char};

const fn number(text: &str) -> u32 {
    let (bytes, mut i, mut n) = (text.as_bytes(), 0, 0);
    while i < bytes.len() {
        n = n * 10 + (bytes[i] - b'0') as u32;
        i += 1;
    }
    n
}

const NUMBER: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 24
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 12
    | number(env!("CARGO_PKG_VERSION_PATCH"));

const TEXT: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(text) => text,
        Err(_) => c"",
    };

/// The version of the library: major << 24 | minor << 12 | patch. The header has its own in
/// FOVEAL_CULL_VERSION.
#[unsafe(no_mangle)]
pub extern "C" fn foveal_cull_version() -> u32 {
    NUMBER
}

/// The version of the library as text.
#[unsafe(no_mangle)]
pub extern "C" fn foveal_cull_version_text() -> *const c_char {
    TEXT.as_ptr()
}
