//! Which graphics adapter.

#[cfg(not(target_family = "wasm"))]
use std::sync::{Mutex, PoisonError};

use crate::{AdapterStats, Error};

/// All adapters that the environment allows, best first.
pub(super) async fn all() -> Vec<wgpu::Adapter> {
    of(wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all())).await
}

/// The adapters to choose from when nothing is asked for: GL, which lacks much, where there is
/// nothing else.
async fn preferred() -> Vec<wgpu::Adapter> {
    if let Some(backends) = wgpu::Backends::from_env() {
        return of(backends).await;
    }
    let modern = of(wgpu::Backends::PRIMARY).await;
    if modern.is_empty() {
        of(wgpu::Backends::SECONDARY).await
    } else {
        modern
    }
}

/// The graphics interfaces `backends`, loaded for the caller alone. Devices of one instance share what
/// the driver keeps for it, and lavapipe (Mesa 22.3) reads there of other devices what their threads are
/// writing: devices that draw at the same time crash now and then. Devices of instances of their own do
/// not.
fn instance(backends: wgpu::Backends) -> wgpu::Instance {
    #[cfg(not(target_family = "wasm"))]
    keep_loaded(backends);
    new_instance(backends)
}

/// Keeps the drivers of `backends` loaded until the process ends, by an instance that nothing else
/// uses. With the last instance that is dropped a driver's library is unloaded, and what it has
/// arranged for a thread's end is then missing: a thread that has used NVIDIA's (580.159) and ends later
/// crashes.
#[cfg(not(target_family = "wasm"))]
fn keep_loaded(backends: wgpu::Backends) {
    static KEPT: Mutex<Vec<(wgpu::Backends, wgpu::Instance)>> = Mutex::new(Vec::new());
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.iter().all(|(of, _)| *of != backends) {
        kept.push((backends, new_instance(backends)));
    }
}

fn new_instance(backends: wgpu::Backends) -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::from_env_or_default(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

async fn of(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let instance = instance(backends);
    let mut adapters = instance.enumerate_adapters(backends).await;
    // A stable sort: the driver's order holds among equals.
    adapters.sort_by_key(|a| rank(&a.get_info()));
    adapters
}

/// Hardware before software, modern interfaces before GL.
fn rank(info: &wgpu::AdapterInfo) -> (u8, u8) {
    let reduced = u8::from(info.backend == wgpu::Backend::Gl);
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    (reduced, kind)
}

pub(crate) async fn choose(wanted: Option<&str>) -> Result<wgpu::Adapter, Error> {
    let adapters = if wanted.is_some() {
        all().await
    } else {
        preferred().await
    };
    let names: Vec<String> = adapters
        .iter()
        .enumerate()
        .map(|(i, a)| {
            let d = describe(&a.get_info());
            format!("{i}: {} ({}, {})", d.name, d.backend, d.driver)
        })
        .collect();
    let none = |wanted: String| Error::NoAdapter {
        wanted,
        available: if names.is_empty() {
            "none; install a Vulkan driver (on Debian: apt-get install mesa-vulkan-drivers)"
                .to_owned()
        } else {
            names.join("; ")
        },
    };
    match wanted {
        None => adapters
            .into_iter()
            .next()
            .ok_or_else(|| none("was found".to_owned())),
        Some(text) => {
            let by_number = text.parse::<usize>().ok();
            let lower = text.to_lowercase();
            adapters
                .into_iter()
                .enumerate()
                .find(|(i, a)| match by_number {
                    Some(n) => *i == n,
                    None => {
                        let d = describe(&a.get_info());
                        [d.name, d.backend, d.driver]
                            .iter()
                            .any(|s| s.to_lowercase().contains(&lower))
                    }
                })
                .map(|(_, a)| a)
                .ok_or_else(|| none(format!("matches '{text}'")))
        }
    }
}

pub(super) fn describe(info: &wgpu::AdapterInfo) -> AdapterStats {
    AdapterStats {
        name: info.name.clone(),
        backend: info.backend.to_str().to_owned(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete-gpu",
            wgpu::DeviceType::IntegratedGpu => "integrated-gpu",
            wgpu::DeviceType::VirtualGpu => "virtual-gpu",
            wgpu::DeviceType::Cpu => "cpu",
            wgpu::DeviceType::Other => "other",
        }
        .to_owned(),
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
    }
}
