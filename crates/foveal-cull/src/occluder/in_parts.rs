//! Baking in parts, one after the other or at once.

use crate::threads::Threads;
use std::sync::{Mutex, PoisonError};

/// What `make` gives for every part below `parts`, in their order. Threads that run a task twice, or
/// not at all, change nothing, as long as `make` gives the same each time.
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
        // Held while the part is made: who comes second waits, and finds it.
        if let Ok(mut part) = made[i].lock() {
            part.get_or_insert_with(|| make(i));
        }
    });
    let made = made.into_iter().map(|m| m.into_inner().ok().flatten());
    made.enumerate()
        .map(|(i, part)| part.unwrap_or_else(|| make(i)))
        .collect()
}

/// [`in_parts`] for parts that `make` changes, for instance the order of their elements.
pub(super) fn in_parts_of<P: Send, T: Send>(
    threads: &dyn Threads,
    parts: &mut [P],
    make: &(dyn Fn(&mut P) -> T + Sync),
) -> Vec<T> {
    let parts: Vec<Mutex<&mut P>> = parts.iter_mut().map(Mutex::new).collect();
    in_parts(threads, parts.len(), &|i| {
        make(&mut parts[i].lock().unwrap_or_else(PoisonError::into_inner))
    })
}

/// Number of parts for `count` elements, at least `least` in each: some for each thread, since they
/// differ in cost.
pub(super) fn parts_of(threads: &dyn Threads, count: usize, least: usize) -> usize {
    match threads.count() {
        0 | 1 => 1,
        n => n.saturating_mul(4).min(count / least).max(1),
    }
}

/// The elements of part `i`.
pub(super) fn part_range(count: usize, parts: usize, i: usize) -> core::ops::Range<usize> {
    // 64 bits where the product exceeds 32.
    let begin = |i: usize| (count as u64 * i as u64 / parts as u64) as usize;
    begin(i)..begin(i + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BakeOptions, OccluderMesh, SingleThread, ThreadsFn};

    #[test]
    fn threads_that_run_tasks_twice_or_never_bake_the_same_mesh() {
        let n = 150u32;
        let points: Vec<[f32; 3]> = (0..n * n)
            .map(|i| [(i % n) as f32, ((i * 7919) % 13) as f32, (i / n) as f32])
            .collect();
        let indices: Vec<u32> = (0..(n - 1) * (n - 1))
            .map(|q| q / (n - 1) * n + q % (n - 1))
            .flat_map(|a| [a, a + n, a + 1, a + 1, a + n, a + n + 1])
            .collect();
        let options = BakeOptions::default();
        let bake = |threads: &dyn Threads| {
            OccluderMesh::bake_on(&points, &indices, options, threads)
                .unwrap()
                .to_bytes()
        };
        let one = bake(&SingleThread);
        let twice = ThreadsFn::new(4, |tasks, task| {
            (0..tasks).for_each(task);
            (0..tasks).rev().for_each(task);
        });
        assert!(bake(&twice) == one, "twice, one after the other");
        let at_once = ThreadsFn::new(4, |tasks, task| {
            std::thread::scope(|scope| {
                for i in (0..tasks).flat_map(|i| [i, i]) {
                    scope.spawn(move || task(i));
                }
            });
        });
        assert!(bake(&at_once) == one, "twice at once");
        let never = ThreadsFn::new(4, |_, _| ());
        assert!(bake(&never) == one, "never");
    }

    #[test]
    fn parts_cover_everything_and_no_number_overflows() {
        let countless = ThreadsFn::new(usize::MAX, |_, _| ());
        assert_eq!(parts_of(&countless, 10_000, 10), 1000);
        assert_eq!(parts_of(&SingleThread, 10_000, 10), 1);
        for (count, parts) in [(10, 3), (7, 7), (u32::MAX as usize, 1 << 20)] {
            assert_eq!(part_range(count, parts, 0).start, 0);
            assert_eq!(part_range(count, parts, parts - 1).end, count);
            let (one, next) = (part_range(count, parts, 1), part_range(count, parts, 2));
            assert_eq!(one.end, next.start);
            assert!(one.len().abs_diff(next.len()) <= 1);
        }
    }
}
