//! Who rasterizes.

use foveal_cull::{SingleThread, Threads, WorkerThreads};

/// Most threads where the settings name no number: a frame's occluders are few.
#[cfg(not(target_arch = "wasm32"))]
const MOST: usize = 8;

/// Who rasterizes: this thread alone, or it and others that wait for work.
#[derive(Debug)]
pub(super) enum Workers {
    One,
    Some(WorkerThreads),
}

impl Workers {
    /// 0 `threads`: as many as the machine has, up to [`MOST`].
    pub(super) fn new(threads: u8) -> Self {
        let threads = match threads {
            #[cfg(not(target_arch = "wasm32"))]
            0 => std::thread::available_parallelism().map_or(1, |n| n.get().min(MOST)),
            #[cfg(target_arch = "wasm32")]
            0 => 1,
            n => n.into(),
        };
        match threads {
            1 => Self::One,
            n => Self::Some(WorkerThreads::new(n)),
        }
    }

    pub(super) fn threads(&self) -> &dyn Threads {
        match self {
            Self::One => &SingleThread,
            Self::Some(pool) => pool,
        }
    }
}
