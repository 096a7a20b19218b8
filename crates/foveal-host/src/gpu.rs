//! Opening the graphics device, with a word on what is missing where the machine has none that
//! suffices.

use anyhow::bail;
use foveal::{AdapterStats, Gpu};

use crate::console;

/// What to do on a machine without any adapter.
pub fn install_a_driver() -> String {
    without_adapter(std::env::var("WGPU_BACKEND").ok().as_deref())
}

fn without_adapter(backend: Option<&str>) -> String {
    match backend {
        Some(backend) => format!(
            "no graphics adapter was found on this machine that WGPU_BACKEND={backend} allows; unset it, or name \
             others: vulkan, metal, dx12, gl"
        ),
        None => "no graphics adapter was found on this machine; install a Vulkan driver (without a graphics card: \
                 apt-get install mesa-vulkan-drivers, which draws on the processor)"
            .to_owned(),
    }
}

/// Opens the adapter that `wanted` names, or the most capable one. Where that has OpenGL alone, a
/// warning says what is missing.
pub fn open(wanted: Option<&str>) -> anyhow::Result<Gpu> {
    let gpu = open_quietly(wanted)?;
    if gpu.is_reduced() {
        console::warn(&reduced(&gpu.adapter_stats()));
    }
    Ok(gpu)
}

/// As [`open`], without the warning.
pub fn open_quietly(wanted: Option<&str>) -> anyhow::Result<Gpu> {
    match pollster::block_on(Gpu::open(wanted)) {
        Ok(gpu) => Ok(gpu),
        Err(foveal::Error::NoAdapter { .. }) if pollster::block_on(Gpu::adapters()).is_empty() => {
            bail!(install_a_driver())
        }
        Err(error) => Err(error.into()),
    }
}

/// Warns where textures are to stay in blocks and the device does not read them.
pub fn check_blocks(gpu: &Gpu) {
    if !gpu.reads_blocks() {
        console::warn(&without_blocks(&gpu.adapter_stats()));
    }
}

fn without_blocks(adapter: &AdapterStats) -> String {
    format!(
        "'{}' ({}) does not read textures in blocks: they are decoded on the way to it, take as much memory as without \
         --texture-compression, and look as with it",
        adapter.name, adapter.driver
    )
}

/// Fails where there is no adapter, for those who open the device themselves; warns where the one
/// that they will get has OpenGL alone.
pub fn check(wanted: Option<&str>) -> anyhow::Result<()> {
    let adapters = pollster::block_on(Gpu::adapters());
    match adapters.first() {
        None => bail!(install_a_driver()),
        Some(first) if wanted.is_none() && adapters.iter().all(is_gl) => {
            console::warn(&reduced(first));
            Ok(())
        }
        Some(_) => Ok(()),
    }
}

fn is_gl(adapter: &AdapterStats) -> bool {
    adapter.backend == "gl"
}

fn reduced(adapter: &AdapterStats) -> String {
    format!(
        "'{}' ({}) can be used through OpenGL alone, so a reduced renderer draws: without contact shadows, a visibility buffer, anti-aliasing, coarse \
         and variable shading, debug views and times per pass. For all of them install a Vulkan driver (on Debian: \
         apt-get install mesa-vulkan-drivers, or the graphics card's own), and see `foveal adapters`",
        adapter.name, adapter.driver
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_that_has_only_gl_is_named_with_what_is_missing_and_what_to_install() {
        let adapter = |backend: &str| AdapterStats {
            name: "llvmpipe".to_owned(),
            backend: backend.to_owned(),
            kind: "cpu".to_owned(),
            driver: "4.5 Mesa 22.3.6".to_owned(),
        };
        assert!(is_gl(&adapter("gl")) && !is_gl(&adapter("vulkan")));
        let text = reduced(&adapter("gl"));
        for word in ["'llvmpipe'", "shadows", "mesa-vulkan-drivers"] {
            assert!(text.contains(word), "{text}");
        }
        assert!(without_adapter(None).contains("mesa-vulkan-drivers"));
        assert!(without_adapter(Some("dx12")).contains("WGPU_BACKEND=dx12"));
    }
}
