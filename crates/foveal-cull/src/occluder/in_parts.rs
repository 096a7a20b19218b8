//! Baking in parts, one after the other or at once.

use crate::threads::Threads;
use std::sync::Mutex;

/// What `make` gives for every part below `parts`, in their order.
pub(super) fn in_parts<T: Send>(
    threads: &dyn Threads,
    parts: usize,
    make: &(dyn Fn(usize) -> T + Sync),
) -> Vec<T> {
    if parts <= 1 || threads.count() <= 1 {
        return (0..parts).map(make).collect();
    }
    let made: Vec<Mutex<Option<T>>> = (0..parts).map(|_| Mutex::new(None)).collect();
    threads.run(parts, &|i| {
        let part = make(i);
        if let Ok(mut to) = made[i].lock() {
            *to = Some(part);
        }
    });
    let made = made.into_iter().map(|m| m.into_inner().ok().flatten());
    made.enumerate()
        .map(|(i, part)| part.unwrap_or_else(|| make(i)))
        .collect()
}

/// Number of parts for `count` elements, at least `least` in each: some for each thread, since they
/// differ in cost.
pub(super) fn parts_of(threads: &dyn Threads, count: usize, least: usize) -> usize {
    match threads.count() {
        0 | 1 => 1,
        n => (n * 4).min(count / least).max(1),
    }
}

/// The elements of part `i`.
pub(super) fn part_range(count: usize, parts: usize, i: usize) -> core::ops::Range<usize> {
    count * i / parts..count * (i + 1) / parts
}
