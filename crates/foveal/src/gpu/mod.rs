//! The device: choosing an adapter, opening it, turning its failures into our errors, reading back.

mod adapter;
mod layout;
mod mips;
mod readback;
mod target;
mod timing;
mod trap;

pub(crate) use layout::{
    bind_group, bind_group_layout, sampled, storage_read, storage_write, uniform,
};
pub(crate) use mips::MipChain;
#[cfg(test)]
pub(crate) use readback::read_level;
pub(crate) use readback::{read_buffer, read_texture, submitted_work_done};
pub(crate) use target::target;
pub(crate) use timing::{CpuTimer, GpuTimer};
pub(crate) use trap::ErrorTrap;

use std::sync::{Arc, Mutex};

use crate::{AdapterStats, Error};

/// An open graphics device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    lost: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the adapter whose name, driver or backend contains `wanted` (case-insensitive), or whose number
    /// in [`Gpu::adapters`] it is; without `wanted`, the most capable one.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] and [`Error::NoDevice`].
    pub async fn open(wanted: Option<&str>) -> Result<Self, Error> {
        let adapter = adapter::choose(wanted).await?;
        let name = adapter.get_info().name;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("foveal"),
                required_features: Self::wanted_features() & adapter.features(),
                required_limits: Self::wanted_limits(&adapter.limits()),
                ..Default::default()
            })
            .await
            .map_err(|cause| Error::NoDevice {
                adapter: name,
                cause: cause.to_string(),
            })?;
        Ok(Self::from_device(device, queue))
    }

    /// Takes the host's device, which must have been opened with at least [`wgpu::Limits::default`].
    /// Its uncaptured-error handler is left alone; its device-lost callback is replaced.
    #[must_use]
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let lost = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            if let Ok(mut slot) = seen.lock() {
                *slot = Some(if message.is_empty() {
                    format!("{reason:?}")
                } else {
                    message.clone()
                });
            }
        });
        Self {
            device,
            queue,
            lost,
        }
    }

    /// Features that the renderer uses where they are there; none is required.
    #[must_use]
    pub fn wanted_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PRIMITIVE_INDEX
    }

    /// The limits that the renderer asks for: the web's defaults, and the adapter's own sizes.
    #[must_use]
    pub fn wanted_limits(adapter: &wgpu::Limits) -> wgpu::Limits {
        wgpu::Limits {
            max_texture_dimension_2d: adapter.max_texture_dimension_2d,
            max_buffer_size: adapter.max_buffer_size,
            max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
            ..wgpu::Limits::default()
        }
    }

    /// All adapters of this machine, in the order in which numbers choose them.
    pub async fn adapters() -> Vec<AdapterStats> {
        adapter::all()
            .await
            .iter()
            .map(|a| adapter::describe(&a.get_info()))
            .collect()
    }

    /// What this device is.
    #[must_use]
    pub fn adapter_stats(&self) -> AdapterStats {
        adapter::describe(&self.device.adapter_info())
    }

    /// [`Error::DeviceLost`] once the device is gone.
    pub(crate) fn check_alive(&self) -> Result<(), Error> {
        match self.lost.lock() {
            Ok(slot) => match slot.as_ref() {
                Some(reason) => Err(Error::DeviceLost {
                    reason: reason.clone(),
                }),
                None => Ok(()),
            },
            Err(_) => Ok(()),
        }
    }
}
