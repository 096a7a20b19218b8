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
