//! One seam between the parallel and the single-threaded importer.

use rayon::prelude::*;

/// Maps `items` in order, on the rayon pool when `parallel`.
pub(crate) fn map<T: Sync, R: Send>(
    parallel: bool,
    items: &[T],
    f: impl Fn(&T) -> R + Sync + Send,
) -> Vec<R> {
    if parallel {
        items.par_iter().map(f).collect()
    } else {
        items.iter().map(f).collect()
    }
}

/// The same, with no more than `at_once` calls of `f` under way at a time.
pub(crate) fn map_few<T: Sync, R: Send>(
    parallel: bool,
    at_once: usize,
    items: &[T],
    f: impl Fn(&T) -> R + Sync + Send,
) -> Vec<R> {
    if !parallel || at_once >= items.len().min(rayon::current_num_threads()) {
        return map(parallel, items, f);
    }
    items
        .chunks(at_once.max(1))
        .flat_map(|few| map(at_once > 1, few, &f))
        .collect()
}

/// Calls `f` on each item, on the rayon pool when `parallel`.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn each<T: Send>(parallel: bool, items: &mut [T], f: impl Fn(&mut T) + Sync + Send) {
    if parallel {
        items.par_iter_mut().for_each(f);
    } else {
        items.iter_mut().for_each(f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn few_at_a_time_keep_the_order_and_the_limit() {
        let items: Vec<usize> = (0..50).collect();
        for at_once in [1, 2, 3, 100] {
            let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let twice = map_few(true, at_once, &items, |i| {
                most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                std::thread::yield_now();
                now.fetch_sub(1, Ordering::SeqCst);
                i * 2
            });
            assert!(twice.iter().zip(&items).all(|(a, b)| *a == b * 2));
            assert!(most.load(Ordering::SeqCst) <= at_once);
        }
    }
}
