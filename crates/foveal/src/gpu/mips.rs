//! A chain of levels with a view of each.

use super::Gpu;

/// A texture whose mip l holds a texel per block of 2^l x 2^l pixels, blocks at the border
/// included.
#[derive(Debug)]
pub(crate) struct MipChain {
    pub(crate) texture: wgpu::Texture,
    /// All levels.
    pub(crate) whole: wgpu::TextureView,
    /// One level each.
    pub(crate) levels: Vec<wgpu::TextureView>,
    width: u32,
    height: u32,
    /// Level of mip 0.
    first: u32,
}

impl MipChain {
    /// Levels `first..=coarsest` for a picture of `width` x `height`. Mips halve their size
    /// rounding down where blocks round up, so the texture is padded to whole blocks of the
    /// coarsest level.
    pub(crate) fn new(
        gpu: &Gpu,
        label: &str,
        (width, height): (u32, u32),
        levels: std::ops::RangeInclusive<u32>,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Self {
        let (first, coarsest) = (*levels.start(), *levels.end());
        let padded = |pixels: u32| pixels.next_multiple_of(1 << coarsest) >> first;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: padded(width),
                height: padded(height),
                depth_or_array_layers: 1,
            },
            mip_level_count: coarsest - first + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let views = (0..=coarsest - first)
            .map(|mip| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    base_mip_level: mip,
                    mip_level_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        Self {
            whole: texture.create_view(&Default::default()),
            levels: views,
            texture,
            width,
            height,
            first,
        }
    }

    /// Bytes of all levels.
    pub(crate) fn bytes(&self) -> u64 {
        let size = self.texture.size();
        let texel = u64::from(self.texture.format().block_copy_size(None).unwrap_or(1));
        let texels = |mip| u64::from(size.width >> mip) * u64::from(size.height >> mip);
        (0..self.texture.mip_level_count())
            .map(|mip| texels(mip) * texel)
            .sum()
    }

    /// The view of a level.
    pub(crate) fn level(&self, level: u32) -> &wgpu::TextureView {
        &self.levels[(level - self.first) as usize]
    }

    /// All levels, finest first.
    pub(crate) fn range(&self) -> std::ops::Range<u32> {
        self.first..self.first + self.levels.len() as u32
    }

    /// Blocks across and down at a level.
    pub(crate) fn blocks(&self, level: u32) -> (u32, u32) {
        (
            self.width.div_ceil(1 << level),
            self.height.div_ceil(1 << level),
        )
    }

    /// Restricts a pass into a level to its blocks, and draws them with the level as instance
    /// number.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, level: u32) {
        let (width, height) = self.blocks(level);
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
        pass.draw(0..3, level..level + 1);
    }
}
