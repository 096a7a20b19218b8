//! Texts of errors.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border;
use crate::status::{FovealCullStatus, guard, with_last};
use core::ffi::c_char;

/// The text of a status, never null. Unknown numbers have one too.
#[unsafe(no_mangle)]
pub extern "C" fn foveal_cull_status_text(status: i32) -> *const c_char {
    FovealCullStatus::ALL
        .into_iter()
        .find(|s| *s as i32 == status)
        .map_or(c"an unknown status", FovealCullStatus::text)
        .as_ptr()
}

/// Copies the text of this thread's last failure, which says more than its status: at most `size`
/// bytes with the final zero. Returns the bytes that all of it needs.
///
/// # Safety
/// `text` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_last_error(text: *mut c_char, size: usize) -> usize {
    let mut needed = 1;
    guard(|| {
        with_last(|last| {
            needed = last.len() + 1;
            if text.is_null() || size == 0 {
                return Ok(());
            }
            let mut copied = last.len().min(size - 1);
            while !last.is_char_boundary(copied) {
                copied -= 1;
            }
            // SAFETY: the caller says that there are `size` bytes, of which these are the first.
            let to = unsafe { border::zeroed_list(text.cast::<u8>(), copied + 1, "text") }?;
            to[..copied].copy_from_slice(&last.as_bytes()[..copied]);
            Ok(())
        })
    });
    needed
}
