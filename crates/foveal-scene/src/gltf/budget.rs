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
    input: AtomicU64,
    allowed: AtomicU64,
    left: AtomicU64,
    /// Bytes of memory per byte of files.
    expansion: u64,
}

impl Budget {
    /// For a scene whose files have `input` bytes.
    pub(crate) fn new(input: u64, options: &LoadOptions) -> Self {
        let allowed = FREE_BYTES.saturating_add(input.saturating_mul(options.max_expansion));
        Self {
            input: AtomicU64::new(input),
            allowed: AtomicU64::new(allowed),
            left: AtomicU64::new(allowed),
            expansion: options.max_expansion,
        }
    }

    /// Adds files that were read since, of `bytes` together.
    pub(crate) fn add_files(&self, bytes: u64) {
        let grow = |what: &AtomicU64, by: u64| {
            what.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |before| {
                Some(before.saturating_add(by))
            })
            .unwrap_or_else(|before| before)
        };
        let more = bytes.saturating_mul(self.expansion);
        grow(&self.input, bytes);
        grow(&self.allowed, more);
        grow(&self.left, more);
    }

    /// Memory that the files may ask for in all.
    pub(crate) fn allowed(&self) -> u64 {
        self.allowed.load(Ordering::Relaxed)
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
                let (input, allowed) = (self.input.load(Ordering::Relaxed), self.allowed());
                // What is left is news only where something has been taken that one can see.
                let rest = if left < allowed / 10 * 9 {
                    format!(", of which {} are left", amount(left))
                } else {
                    String::new()
                };
                Flaw::beyond(
                    Limit::Expansion,
                    format!(
                        "wants {} for {what}; the limit for {} of files is {}{rest}",
                        amount(bytes),
                        amount(input),
                        amount(allowed)
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
        budget.add_files(1);
        assert!(budget.take(options.max_expansion, "textures").is_ok());
        assert!(budget.take(1, "textures").is_err());
        assert!(Budget::new(u64::MAX, &options).take(u64::MAX, "").is_ok());
    }
}
