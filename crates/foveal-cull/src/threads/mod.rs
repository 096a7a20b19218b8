//! Who does the work: this thread, the crate's own worker threads, the caller's, or rayon's.

mod run;
mod workers;

#[cfg(feature = "rayon")]
pub use run::Rayon;
pub use run::{SingleThread, Threads, ThreadsFn};
pub use workers::WorkerThreads;
