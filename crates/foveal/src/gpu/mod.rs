//! The device: choosing an adapter, opening it, turning its failures into our errors, reading back.

mod adapter;
mod compiled;
#[cfg(test)]
mod compiled_tests;
mod device;
#[cfg(test)]
pub(crate) mod faults;
mod layout;
mod mips;
#[cfg(feature = "profiler")]
mod profiled;
mod readback;
mod table;
#[cfg(test)]
mod table_tests;
mod target;
mod timing;
mod trap;
#[cfg(not(feature = "profiler"))]
mod unprofiled;

#[cfg(test)]
pub(crate) use adapter::choose as choose_adapter;
pub use device::Gpu;
pub(crate) use device::is_reduced;
pub(crate) use layout::{
    bind_group, bind_group_layout, sampled, sampled_layers, storage_read, storage_write, uniform,
    written, written_layers,
};

pub(crate) use mips::MipChain;
pub(crate) use readback::{Arriving, Handover, start_reading, work_done};
#[cfg(test)]
pub(crate) use readback::{read_buffer, read_level, read_texture};

#[cfg(feature = "profiler")]
pub(crate) use profiled::GpuTimer;
pub(crate) use table::Table;
pub(crate) use target::{layer_of, layered_target, layers_of, target};
pub(crate) use timing::CpuTimer;
pub(crate) use trap::ErrorTrap;
#[cfg(not(feature = "profiler"))]
pub(crate) use unprofiled::GpuTimer;
