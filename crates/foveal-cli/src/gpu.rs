//! Opening the graphics device, with a way out for a machine that has none.

use anyhow::bail;
use foveal::Gpu;

/// What to do on a machine without any adapter.
pub(crate) const INSTALL_A_DRIVER: &str = "no graphics adapter was found on this machine; install a Vulkan \
    driver (without a graphics card: apt-get install mesa-vulkan-drivers, which draws on the processor)";

/// Opens the adapter that `wanted` names, or the most capable one.
pub(crate) fn open(wanted: Option<&str>) -> anyhow::Result<Gpu> {
    match pollster::block_on(Gpu::open(wanted)) {
        Ok(gpu) => Ok(gpu),
        Err(foveal::Error::NoAdapter { .. }) if pollster::block_on(Gpu::adapters()).is_empty() => {
            bail!(INSTALL_A_DRIVER)
        }
        Err(error) => Err(error.into()),
    }
}
