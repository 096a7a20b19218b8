//! Which samples are shaded.
#![cfg_attr(
    not(test),
    expect(dead_code, reason = "tests alone list texels on the CPU")
)]

use crate::gpu::Gpu;

/// What a shading pass visits.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Samples<'a> {
    /// Each pixel of the target, in a draw.
    EveryPixel,
    /// The texels of a list, in an indirect dispatch.
    List(&'a SampleList),
}

/// Texels on the device, and the dispatch that covers them.
#[derive(Debug)]
pub(crate) struct SampleList {
    /// `x | y << 16` each.
    pub(crate) texels: wgpu::Buffer,
    /// Workgroups in x, y, z (64 samples each, at most 65,535 in a row) and the number of samples.
    pub(crate) dispatch: wgpu::Buffer,
}

/// Threads of a shading workgroup.
const WORKGROUP: u32 = 64;
/// Workgroups that a dispatch may have in one dimension.
const MAX_ROW: u32 = 65_535;

impl SampleList {
    /// A list from texels that the CPU knows, `(x, y)` each.
    pub(crate) fn from_texels(gpu: &Gpu, texels: &[(u32, u32)]) -> Self {
        let packed: Vec<u32> = texels.iter().map(|&(x, y)| x | y << 16).collect();
        let buffer = |label, bytes: &[u8], usage| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (bytes.len() as u64).max(4),
                usage: usage | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let dispatch = dispatch_of(packed.len() as u32);
        Self {
            texels: buffer(
                "samples",
                bytemuck::cast_slice(&packed),
                wgpu::BufferUsages::empty(),
            ),
            dispatch: buffer(
                "sample dispatch",
                bytemuck::cast_slice(&dispatch),
                wgpu::BufferUsages::INDIRECT,
            ),
        }
    }
}

/// Workgroups in x, y, z, and the number of samples.
fn dispatch_of(samples: u32) -> [u32; 4] {
    let groups = samples.div_ceil(WORKGROUP);
    [groups.min(MAX_ROW), groups.div_ceil(MAX_ROW), 1, samples]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dispatch_covers_all_samples_and_stays_within_the_limit() {
        for samples in [0, 1, 64, 65, 4_194_240, 4_194_241, 33_177_600] {
            let [x, y, z, count] = dispatch_of(samples);
            assert_eq!(count, samples);
            assert!(x <= MAX_ROW && y <= MAX_ROW);
            assert!(u64::from(x) * u64::from(y) * u64::from(z) * 64 >= u64::from(samples));
        }
    }
}
