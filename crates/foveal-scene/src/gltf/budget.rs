//! What a file may ask for, added up before anything is allocated.
//!
//! The options limit each kind of thing for itself; the [`Budget`] limits all of them together by
//! the size of the files: a few bytes can name the same data many times over, promise pictures of a
//! billion texels, or multiply instances by primitives, and none of that may fill the memory.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::LoadOptions;
use crate::error::{Flaw, Limit, Parsed, amount};

/// Memory that any file may ask for, however short it is.
const FREE_BYTES: u64 = 160 << 20;

/// The memory that a file of its size may ask for, and what is left of it.
pub(crate) struct Budget {
    input: u64,
    allowed: u64,
    left: AtomicU64,
}

impl Budget {
    /// For a scene whose files have `input` bytes.
    pub(crate) fn new(input: u64, options: &LoadOptions) -> Self {
        let allowed = FREE_BYTES.saturating_add(input.saturating_mul(options.max_expansion));
        Self {
            input,
            allowed,
            left: AtomicU64::new(allowed),
        }
    }

    /// Memory that the files may ask for in all.
    pub(crate) fn allowed(&self) -> u64 {
        self.allowed
    }

    /// Memory that is left.
    pub(crate) fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }

    /// Counts memory that `what` is about to take.
    pub(crate) fn take(&self, bytes: u64, what: &str) -> Parsed<()> {
        let rest = |left: u64| left.checked_sub(bytes);
        self.left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, rest)
            .map(|_| ())
            .map_err(|left| {
                // What is left is news only where something has been taken that one can see.
                let rest = if left < self.allowed / 10 * 9 {
                    format!(", of which {} are left", amount(left))
                } else {
                    String::new()
                };
                Flaw::beyond(
                    Limit::Expansion,
                    format!(
                        "wants {} for {what}; the limit for {} of files is {}{rest}",
                        amount(bytes),
                        amount(self.input),
                        amount(self.allowed)
                    ),
                )
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_grows_with_the_files_and_runs_out() {
        let options = LoadOptions::default();
        let budget = Budget::new(1_000_000, &options);
        let allowed = FREE_BYTES + 256_000_000;
        assert!(budget.take(allowed - 10, "vertices").is_ok());
        assert!(budget.take(10, "instances").is_ok());
        let flaw = budget.take(1, "instances").unwrap_err();
        let text = flaw.in_file("a.glb").to_string();
        assert!(
            text.contains("wants 1 bytes for instances; the limit for 1 MB of files is 423.8 MB"),
            "{text}"
        );
        assert!(Budget::new(u64::MAX, &options).take(u64::MAX, "").is_ok());
    }
}
