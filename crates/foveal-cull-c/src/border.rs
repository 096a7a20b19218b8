//! From pointers to references: the checks that every argument from C passes.
#![allow(unsafe_code, reason = "pointers from C; see the SAFETY lines")]

use crate::status::{Fault, FovealCullStatus};
use core::ops::RangeInclusive;
use foveal_cull::Visibility;
use std::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};

/// Types for which any bits that C can write are a value.
///
/// # Safety
/// No bit pattern may be invalid.
pub(crate) unsafe trait Plain: Copy {}

// SAFETY: every pattern is a number.
unsafe impl Plain for f32 {}
// SAFETY: every pattern is a number.
unsafe impl Plain for f64 {}
// SAFETY: every pattern is a number.
unsafe impl Plain for u8 {}
// SAFETY: arrays of numbers.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}
// SAFETY: six numbers.
unsafe impl Plain for foveal_cull::Aabb {}

/// Sizes above this are no size of a struct, but memory that was not initialized.
pub(crate) const LARGEST_STRUCT: usize = 4096;

/// Whether a version of `T` may have this size: others end within a field.
fn is_whole<T>(size: usize) -> bool {
    size.is_multiple_of(align_of::<T>())
}

fn check<T>(pointer: *const T, name: &str) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault::new(
            FovealCullStatus::NullPointer,
            format!("'{name}' is null"),
        ));
    }
    if !pointer.is_aligned() {
        return Err(Fault::argument(format!("'{name}' is not aligned")));
    }
    Ok(())
}

/// An object by its handle.
///
/// # Safety
/// The pointer is null, or names an object that nothing destroys or changes during `'a`.
pub(crate) unsafe fn object<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Fault> {
    check(pointer, name)?;
    // SAFETY: not null and aligned, and the caller says that the object lives.
    Ok(unsafe { &*pointer })
}

/// A list that is read.
///
/// # Safety
/// The pointer is null, or names `length` values that nothing changes during `'a`.
pub(crate) unsafe fn list<'a, T: Plain>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<&'a [T], Fault> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer, name)?;
    fits::<T>(length, name)?;
    // SAFETY: not null, aligned, at most isize::MAX bytes; the caller says that the values are
    // there, and any bits are a value.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// A list that is written, filled with zeros first: C need not have initialized it.
///
/// # Safety
/// The pointer is null, or `length` values can be written to it that nothing else uses during `'a`.
/// Zero bytes are a value of `T`.
pub(crate) unsafe fn zeroed_list<'a, T>(
    pointer: *mut T,
    length: usize,
    name: &str,
) -> Result<&'a mut [T], Fault> {
    check_list(pointer, length, name)?;
    if length == 0 {
        return Ok(&mut []);
    }
    // SAFETY: not null, aligned, at most isize::MAX bytes, and the caller says that they can be
    // written. After that they are values of `T`.
    Ok(unsafe {
        pointer.write_bytes(0, length);
        core::slice::from_raw_parts_mut(pointer, length)
    })
}

/// Results of an earlier call, which C may have changed: other numbers than those of results are
/// refused.
///
/// # Safety
/// The pointer is null, or names `length` bytes that nothing changes during `'a`.
pub(crate) unsafe fn results<'a>(
    pointer: *const u8,
    length: usize,
    name: &str,
) -> Result<&'a [Visibility], Fault> {
    // SAFETY: the caller's word.
    let bytes = unsafe { list(pointer, length, name) }?;
    if let Some(at) = bytes.iter().position(|b| *b > Visibility::Occluded as u8) {
        let text = format!("'{name}'[{at}] is {}: no FovealCullVisibility", bytes[at]);
        return Err(Fault::argument(text));
    }
    // SAFETY: the same bytes, each of which is a `Visibility`.
    Ok(unsafe { core::slice::from_raw_parts(bytes.as_ptr().cast(), length) })
}

/// Results that are read and written. Other numbers than those of results are refused.
///
/// # Safety
/// The pointer is null, or names `length` bytes that nothing else uses during `'a`.
pub(crate) unsafe fn results_mut<'a>(
    pointer: *mut u8,
    length: usize,
    name: &str,
) -> Result<&'a mut [Visibility], Fault> {
    // SAFETY: the caller's word. What is returned is used no more.
    unsafe { results(pointer, length, name) }?;
    if length == 0 {
        return Ok(&mut []);
    }
    // SAFETY: not null, at most isize::MAX bytes, each a `Visibility`, by the check above; the
    // caller says that nothing else uses them.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer.cast(), length) })
}

/// Checks a list for results without writing to it: a call that fails leaves it as it was.
pub(crate) fn check_list<T>(pointer: *const T, length: usize, name: &str) -> Result<(), Fault> {
    if length == 0 {
        return Ok(());
    }
    check(pointer, name)?;
    fits::<T>(length, name)
}

/// Checks that a list that is read and one for results share no byte: there may be no references to
/// both. Call it before there are any. Lists without elements share none.
pub(crate) fn disjoint<A, B>(
    (read, read_length, read_name): (*const A, usize, &str),
    (written, written_length, written_name): (*const B, usize, &str),
) -> Result<(), Fault> {
    let end = |start: usize, size: usize, length: usize| {
        start.saturating_add(size.saturating_mul(length))
    };
    let (a, b) = (read.addr(), written.addr());
    let a_end = end(a, size_of::<A>(), read_length);
    let b_end = end(b, size_of::<B>(), written_length);
    if a.max(b) < a_end.min(b_end) {
        return Err(Fault::argument(format!(
            "'{written_name}' overlaps '{read_name}'"
        )));
    }
    Ok(())
}

fn fits<T>(length: usize, name: &str) -> Result<(), Fault> {
    if length > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Fault::argument(format!("'{name}' has too many elements")));
    }
    Ok(())
}

/// Checks a place for a result.
pub(crate) fn check_out<T>(pointer: *const T, name: &str) -> Result<(), Fault> {
    check(pointer, name)
}

/// Writes a result.
///
/// # Safety
/// The pointer is null, or a `T` can be written to it.
pub(crate) unsafe fn put<T>(pointer: *mut T, value: T, name: &str) -> Result<(), Fault> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the caller says that it can be written.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Reads a struct that begins with its size in bytes, as the caller's version of the header has it.
/// Fields that the caller's version lacks keep the value of `default`; fields that this version
/// lacks must be zero.
///
/// # Safety
/// The pointer is null, or names as many bytes as the struct's first field says.
pub(crate) unsafe fn sized<T: Plain>(
    pointer: *const T,
    least: usize,
    default: T,
    name: &str,
) -> Result<T, Fault> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the first field is a u32 that is there in every version.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    let wrong = |why: &str| {
        let text = format!("'{name}' has the size {size}, {why}");
        Err(Fault::new(FovealCullStatus::BadStructSize, text))
    };
    if size < least {
        return wrong("which is too small: set it to sizeof");
    }
    if size > LARGEST_STRUCT {
        return wrong("which is too large: set it to sizeof");
    }
    if !is_whole::<T>(size) {
        return wrong("which no struct has: set it to sizeof");
    }
    let known = size.min(size_of::<T>());
    let mut value = default;
    // SAFETY: `known` bytes are there by the caller's word, and fit into `value`, for which any
    // bits are a value.
    unsafe {
        let to = (&raw mut value).cast::<u8>();
        core::ptr::copy_nonoverlapping(pointer.cast::<u8>(), to, known);
    }
    // SAFETY: the caller says that `size` bytes are there.
    let newer = unsafe { list(pointer.cast::<u8>().add(known), size - known, name) }?;
    if newer.iter().any(|b| *b != 0) {
        return wrong("and uses fields that this version of the library does not know");
    }
    Ok(value)
}

/// Writes a struct that begins with its size, as far as the caller's version of the header has it.
/// Sizes outside `allowed` are refused.
///
/// # Safety
/// The pointer is null, or names as many bytes as the struct's first field says, which can be
/// written.
pub(crate) unsafe fn put_sized<T: Plain>(
    pointer: *mut T,
    allowed: RangeInclusive<usize>,
    value: &T,
    name: &str,
) -> Result<(), Fault> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the first field is a u32 that is there in every version.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    if size > *allowed.end() {
        return Err(wrong_size(size, name));
    }
    // SAFETY: the caller's word.
    unsafe { init_sized(pointer, size, *allowed.start(), value, name) }
}

fn wrong_size(size: usize, name: &str) -> Fault {
    Fault::new(
        FovealCullStatus::BadStructSize,
        format!("'{name}' has the size {size}: set it to sizeof"),
    )
}

/// Fills a struct that begins with its size, of which the caller's version of the header has `size`
/// bytes: no more are written, and its first field becomes `size`.
///
/// # Safety
/// The pointer is null, or `size` bytes can be written to it.
pub(crate) unsafe fn init_sized<T: Plain>(
    pointer: *mut T,
    size: usize,
    least: usize,
    value: &T,
    name: &str,
) -> Result<(), Fault> {
    check(pointer, name)?;
    if !(least..=LARGEST_STRUCT).contains(&size) || !is_whole::<T>(size) {
        return Err(wrong_size(size, name));
    }
    let header = size_of::<u32>();
    let known = size.min(size_of::<T>());
    // SAFETY: `size` bytes can be written by the caller's word; `known` of them are in `value`. The
    // first field is a u32 that is there in every version.
    unsafe {
        pointer.cast::<u32>().write(size as u32);
        let (from, to) = (
            core::ptr::from_ref(value).cast::<u8>(),
            pointer.cast::<u8>(),
        );
        core::ptr::copy_nonoverlapping(from.add(header), to.add(header), known - header);
        to.add(known).write_bytes(0, size - known);
    }
    Ok(())
}

/// Hands an object over to C.
///
/// # Safety
/// The pointer is null, or a pointer can be written to it.
pub(crate) unsafe fn give<T>(
    to: *mut *mut T,
    make: impl FnOnce() -> Result<T, Fault>,
) -> Result<(), Fault> {
    check(to, "out")?;
    // SAFETY: checked above, and the caller's word.
    unsafe { to.write(core::ptr::null_mut()) };
    let object = Box::into_raw(Box::new(make()?));
    // SAFETY: as above.
    unsafe { to.write(object) };
    Ok(())
}

/// Takes an object back from C and drops it. Null is nothing.
///
/// # Safety
/// The pointer is null, or comes from [`give`] and is used no more.
pub(crate) unsafe fn take<T>(object: *mut T) {
    if object.is_null() {
        return;
    }
    crate::status::guard(|| {
        // SAFETY: it comes from `Box::into_raw`, and nobody else has it.
        drop(unsafe { Box::from_raw(object) });
        Ok(())
    });
}

/// Access to an object that changes nothing.
pub(crate) fn read<T>(lock: &RwLock<T>) -> Result<RwLockReadGuard<'_, T>, Fault> {
    match lock.try_read() {
        Ok(guard) => Ok(guard),
        // A call panicked; what it left is usable, see `Culler::rasterize`.
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(Fault::busy()),
    }
}

/// Access to an object that changes it.
pub(crate) fn write<T>(lock: &RwLock<T>) -> Result<RwLockWriteGuard<'_, T>, Fault> {
    match lock.try_write() {
        Ok(guard) => Ok(guard),
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(Fault::busy()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second version of a struct that once ended with `first`.
    #[derive(Clone, Copy)]
    #[repr(C)]
    struct Grown {
        size: u32,
        first: u32,
        second: u64,
    }

    // SAFETY: numbers.
    unsafe impl Plain for Grown {}

    #[test]
    fn lists_that_share_a_byte_are_refused() {
        let disjoint = |read: usize, reads: usize, written: usize, writes: usize| {
            let read = (read as *const [u32; 2], reads, "read");
            let written = (written as *const u8, writes, "written");
            disjoint(read, written).map_err(|fault| (fault.status, fault.text.into_owned()))
        };
        let text = "'written' overlaps 'read'".to_owned();
        let refused = Err((FovealCullStatus::BadArgument, text));
        // 800 to 824 is read.
        for (written, writes) in [
            (790, 11),
            (800, 1),
            (800, 24),
            (823, 1),
            (823, 9),
            (700, 300),
        ] {
            assert_eq!(disjoint(800, 3, written, writes), refused, "{written}");
        }
        for (written, writes) in [(790, 10), (824, 1), (810, 0), (0, 800), (824, usize::MAX)] {
            assert_eq!(disjoint(800, 3, written, writes), Ok(()), "{written}");
        }
        assert_eq!(disjoint(800, 0, 790, 30), Ok(()), "nothing is read");
        assert_eq!(disjoint(800, usize::MAX, usize::MAX - 1, 1), refused);
    }

    #[test]
    fn a_struct_of_an_older_header_is_filled_and_nothing_beyond_it() {
        let known = Grown {
            size: 16,
            first: 7,
            second: 8,
        };
        for (size, second) in [(8, u64::MAX), (16, 8)] {
            let mut memory = Grown {
                size: u32::MAX,
                first: u32::MAX,
                second: u64::MAX,
            };
            // SAFETY: at most the struct's bytes are written, and read back.
            let again = unsafe {
                init_sized(&mut memory, size, 8, &known, "memory").unwrap();
                sized(&memory, 8, known, "memory").unwrap()
            };
            assert_eq!(memory.size as usize, size);
            assert_eq!((memory.first, memory.second), (7, second));
            assert_eq!((again.first, again.second), (7, 8));
        }
    }
}
