//! Who rasterizes.

use foveal_cull::{SingleThread, Threads, WorkerThreads};

/// Who rasterizes: everybody, this thread alone, or a pool of so many.
#[derive(Debug)]
pub(super) enum Workers {
    #[cfg(not(target_arch = "wasm32"))]
    All,
    One,
    Some(WorkerThreads),
}

impl Workers {
    pub(super) fn new(threads: u8) -> Self {
        match threads {
            #[cfg(not(target_arch = "wasm32"))]
            0 => Self::All,
            #[cfg(target_arch = "wasm32")]
            0 => Self::One,
            1 => Self::One,
            n => Self::Some(WorkerThreads::new(n.into())),
        }
    }

    pub(super) fn threads(&self) -> &dyn Threads {
        match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::All => &foveal_cull::Rayon,
            Self::One => &SingleThread,
            Self::Some(pool) => pool,
        }
    }
}
