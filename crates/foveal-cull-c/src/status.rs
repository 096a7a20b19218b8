//! Error codes, their texts, and the guard that no panic passes.

use core::cell::RefCell;
use core::ffi::CStr;
use foveal_cull::CullError;
use std::borrow::Cow;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum FovealCullStatus {
    /// Done.
    Ok = 0,
    /// A pointer is null that may not be.
    NullPointer = 1,
    /// A struct's `size` is none that this version knows, or what is newer in it is not zero.
    BadStructSize = 2,
    /// A count, a stride, an enumerator or a pointer's alignment is not allowed, an array for results
    /// overlaps the boxes or ids of the call, an id to be removed is listed twice, or a rebuild is not
    /// built yet or was adopted.
    BadArgument = 3,
    /// A number is not finite, or out of its range: negative, or zero where it must be above zero.
    NotFinite = 4,
    /// A buffer side of 0 pixels or of more than 4,096, or a picture's or a shadow map's of 0 or of
    /// more than 16,384.
    BadSize = 5,
    /// A view cannot be culled for.
    BadView = 6,
    /// A list of indices is not a list of triangles, or names a vertex that is not there.
    BadIndices = 7,
    /// A mesh has too many triangles.
    TooLarge = 8,
    /// Two lists that belong together differ in length.
    WrongLength = 9,
    /// No occluder has this id, for instance since it was removed.
    UnknownOccluder = 10,
    /// The id, or the hierarchy, belongs to another set.
    OtherSet = 11,
    /// The object is in use by another call that changes it, or that this call would disturb.
    Busy = 12,
    /// An error inside the library. Please report it. The object stays usable, but for a rebuild that
    /// could not be built.
    Internal = 13,
    /// Bytes are not a baked mesh of this version.
    BadMeshBytes = 14,
    /// No occludee has this id, for instance since it was removed.
    UnknownOccludee = 15,
}

impl FovealCullStatus {
    pub(crate) const ALL: [Self; 16] = [
        Self::Ok,
        Self::NullPointer,
        Self::BadStructSize,
        Self::BadArgument,
        Self::NotFinite,
        Self::BadSize,
        Self::BadView,
        Self::BadIndices,
        Self::TooLarge,
        Self::WrongLength,
        Self::UnknownOccluder,
        Self::OtherSet,
        Self::Busy,
        Self::Internal,
        Self::BadMeshBytes,
        Self::UnknownOccludee,
    ];

    pub(crate) const fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::NullPointer => c"a pointer is null that may not be",
            Self::BadStructSize => c"a struct's size is none that this version knows",
            Self::BadArgument => c"an argument is not allowed",
            Self::NotFinite => c"a number is not finite, or out of its range",
            Self::BadSize => {
                c"a buffer's side must be 1 to 4096 pixels, a picture's or shadow map's 1 to 16384"
            }
            Self::BadView => c"the view cannot be culled for",
            Self::BadIndices => c"the indices are not triangles over the positions",
            Self::TooLarge => c"the mesh has too many triangles",
            Self::WrongLength => c"two lists that belong together differ in length",
            Self::UnknownOccluder => c"no occluder has this id",
            Self::OtherSet => c"the id, or the hierarchy, belongs to another set",
            Self::Busy => c"the object is in use by another call",
            Self::Internal => c"an error inside the library",
            Self::BadMeshBytes => c"the bytes are not a baked mesh of this version",
            Self::UnknownOccludee => c"no occludee has this id",
        }
    }
}

/// A failure: its code, and a text about this very case.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) status: FovealCullStatus,
    pub(crate) text: Cow<'static, str>,
}

impl Fault {
    pub(crate) fn new(status: FovealCullStatus, text: impl Into<Cow<'static, str>>) -> Self {
        Self {
            status,
            text: text.into(),
        }
    }

    pub(crate) fn busy() -> Self {
        Self::new(
            FovealCullStatus::Busy,
            "the object is in use by another call",
        )
    }

    pub(crate) fn argument(text: impl Into<Cow<'static, str>>) -> Self {
        Self::new(FovealCullStatus::BadArgument, text)
    }
}

impl From<CullError> for Fault {
    fn from(error: CullError) -> Self {
        use FovealCullStatus as Status;
        let status = match error {
            CullError::BadSize { .. }
            | CullError::BadShadowMap { .. }
            | CullError::BadReference { .. } => Status::BadSize,
            CullError::NotFinite(_) | CullError::NotPositive(_) | CullError::Negative(_) => {
                Status::NotFinite
            }
            CullError::BadView(_) => Status::BadView,
            CullError::NotTriangles { .. } | CullError::IndexOutOfRange { .. } => {
                Status::BadIndices
            }
            CullError::TooManyTriangles { .. } => Status::TooLarge,
            CullError::LengthMismatch { .. } => Status::WrongLength,
            CullError::UnknownOccluder => Status::UnknownOccluder,
            CullError::UnknownOccludee => Status::UnknownOccludee,
            CullError::BadMeshBytes(_) => Status::BadMeshBytes,
            _ => Status::BadArgument,
        };
        let text = match std::error::Error::source(&error) {
            Some(cause) => format!("{error}: {cause}"),
            None => error.to_string(),
        };
        Self::new(status, text)
    }
}

thread_local! {
    /// The text of this thread's last failure.
    static LAST: RefCell<Cow<'static, str>> = const { RefCell::new(Cow::Borrowed("")) };
}

/// Gives this thread's last failure to `read`.
pub(crate) fn with_last<T>(read: impl FnOnce(&str) -> T) -> T {
    LAST.with(|last| read(&last.borrow()))
}

fn remember(text: Cow<'static, str>) {
    // A thread that ends has no last failure any more.
    let _ = LAST.try_with(|last| {
        if let Ok(mut last) = last.try_borrow_mut() {
            *last = text;
        }
    });
}

/// Runs the body of a function for C. Nothing unwinds out of it.
pub(crate) fn guard(body: impl FnOnce() -> Result<(), Fault>) -> FovealCullStatus {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => FovealCullStatus::Ok,
        Ok(Err(fault)) => {
            remember(fault.text);
            fault.status
        }
        Err(payload) => {
            // Dropping it could panic once more.
            core::mem::forget(payload);
            remember(Cow::Borrowed("an error inside the library"));
            FovealCullStatus::Internal
        }
    }
}
