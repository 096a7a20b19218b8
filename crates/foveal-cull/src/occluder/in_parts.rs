//! Baking in parts, one after the other or at once.

use crate::threads::Threads;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// What `make` gives for every part below `parts`, in their order. Threads that run a task twice, not
/// at all, or beyond the last one change nothing, as long as `make` gives the same each time.
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
        if let Some(Ok(mut part)) = made.get(i).map(Mutex::lock) {
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

/// Hands what `make` gives for every part below `parts` to `take`, in their order and as soon as the
/// parts before are there, so that few wait. Threads may run a task twice, not at
/// all, or beyond the last one.
pub(super) fn in_order<T: Send>(
    threads: &dyn Threads,
    parts: usize,
    make: &(dyn Fn(usize) -> T + Sync),
    take: &mut (dyn FnMut(T) + Send),
) {
    if parts <= 1 || threads.count() <= 1 {
        (0..parts).for_each(|i| take(make(i)));
        return;
    }
    let line = Mutex::new(Line {
        next: 0,
        waiting: BTreeMap::new(),
        take,
    });
    threads.run(parts, &|i| {
        if i >= parts {
            return;
        }
        let part = make(i);
        if let Ok(mut line) = line.lock() {
            line.give(i, part);
        }
    });
    let mut line = line.into_inner().unwrap_or_else(PoisonError::into_inner);
    while line.next < parts {
        let i = line.next;
        line.give(i, make(i));
    }
}

/// Parts on their way to whoever takes them.
struct Line<'a, T> {
    next: usize,
    waiting: BTreeMap<usize, T>,
    take: &'a mut (dyn FnMut(T) + Send),
}

impl<T> Line<'_, T> {
    fn give(&mut self, i: usize, part: T) {
        if i >= self.next {
            self.waiting.insert(i, part);
        }
        while let Some(part) = self.waiting.remove(&self.next) {
            (self.take)(part);
            self.next += 1;
        }
    }
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
        let beyond = ThreadsFn::new(4, |tasks, task| {
            (0..tasks + 5).rev().for_each(task);
            task(usize::MAX);
        });
        assert!(bake(&beyond) == one, "beyond the last");
    }
}
