//! Opening the graphics device, with a way out for a machine that has none that suffices.

use anyhow::bail;
use foveal::{AdapterStats, Gpu};

/// What to do on a machine without any adapter.
pub const INSTALL_A_DRIVER: &str = "no graphics adapter was found on this machine; install a Vulkan \
    driver (without a graphics card: apt-get install mesa-vulkan-drivers, which draws on the processor)";

/// Opens the adapter that `wanted` names, or the most capable one.
pub fn open(wanted: Option<&str>) -> anyhow::Result<Gpu> {
    match pollster::block_on(Gpu::open(wanted)) {
        // The full renderer's shaders cannot be said in desktop GL; the reduced one is for devices
        // that say so themselves.
        Ok(gpu) if is_gl(&gpu.adapter_stats()) && !gpu.is_reduced() => {
            bail!(only_gl(&gpu.adapter_stats()))
        }
        Ok(gpu) => Ok(gpu),
        Err(foveal::Error::NoAdapter { .. }) if pollster::block_on(Gpu::adapters()).is_empty() => {
            bail!(INSTALL_A_DRIVER)
        }
        Err(error) => Err(error.into()),
    }
}

/// Fails where no adapter would do, for those who open the device themselves.
pub fn check(wanted: Option<&str>) -> anyhow::Result<()> {
    let adapters = pollster::block_on(Gpu::adapters());
    match adapters.first() {
        None => bail!(INSTALL_A_DRIVER),
        Some(first) if wanted.is_none() && adapters.iter().all(is_gl) => bail!(only_gl(first)),
        Some(_) => Ok(()),
    }
}

fn is_gl(adapter: &AdapterStats) -> bool {
    adapter.backend == "gl"
}

fn only_gl(adapter: &AdapterStats) -> String {
    format!(
        "'{}' ({}) can be used through OpenGL alone, which lacks what the renderer needs; install a Vulkan driver \
         (on Debian: apt-get install mesa-vulkan-drivers, or the graphics card's own), and see `foveal adapters`",
        adapter.name, adapter.driver
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_that_has_only_gl_is_refused_with_what_to_install() {
        let adapter = |backend: &str| AdapterStats {
            name: "llvmpipe".to_owned(),
            backend: backend.to_owned(),
            kind: "cpu".to_owned(),
            driver: "4.5 Mesa 22.3.6".to_owned(),
        };
        assert!(is_gl(&adapter("gl")) && !is_gl(&adapter("vulkan")));
        let text = only_gl(&adapter("gl"));
        assert!(
            text.contains("'llvmpipe'") && text.contains("Vulkan"),
            "{text}"
        );
    }
}
