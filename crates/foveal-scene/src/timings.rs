//! How long the stages of loading took.

/// Wall-clock milliseconds per stage of [`load`](crate::load); zero for generated scenes and where
/// the platform has no clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadTimings {
    /// Reading the file and the buffers that it names.
    pub read_ms: f32,
    /// Understanding the JSON.
    pub parse_ms: f32,
    /// Vertices, indices, normals, tangents.
    pub geometry_ms: f32,
    /// Decoding pictures and building their mip levels.
    pub decode_ms: f32,
    /// Objects, instances and their exact world-space boxes, first pose included.
    pub bounds_ms: f32,
}

impl LoadTimings {
    /// The sum of all stages.
    #[must_use]
    pub fn total_ms(&self) -> f32 {
        self.read_ms + self.parse_ms + self.geometry_ms + self.decode_ms + self.bounds_ms
    }
}

/// A clock that stands still where there is none.
pub(crate) struct Stopwatch {
    #[cfg(not(target_arch = "wasm32"))]
    started: std::time::Instant,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            #[cfg(not(target_arch = "wasm32"))]
            started: std::time::Instant::now(),
        }
    }

    /// Milliseconds since the start.
    pub(crate) fn elapsed_ms(&self) -> f32 {
        #[cfg(not(target_arch = "wasm32"))]
        return self.started.elapsed().as_secs_f32() * 1e3;
        #[cfg(target_arch = "wasm32")]
        return 0.0;
    }

    /// Milliseconds since the start or the last lap.
    pub(crate) fn lap_ms(&mut self) -> f32 {
        let elapsed = self.elapsed_ms();
        *self = Self::start();
        elapsed
    }
}
