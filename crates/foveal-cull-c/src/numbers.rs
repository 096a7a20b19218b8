//! Numbers of sets. Ids carry them, so that an id of another set is noticed.

use core::sync::atomic::{AtomicU64, Ordering};

static NEXT: AtomicU64 = AtomicU64::new(1);

/// A number that no other set of this process has had. Never zero.
pub(crate) fn set_number() -> u64 {
    NEXT.fetch_add(1, Ordering::Relaxed)
}
