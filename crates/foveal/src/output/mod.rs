//! Output: what the picture shows, as 8-bit sRGB.

mod tone_map;
mod view;

pub(crate) use tone_map::ToneMapPass;
pub(crate) use view::ViewPass;

/// sRGB values, encoded by the shaders, so that every adapter rounds alike.
pub(crate) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A colour attachment that is written whole.
fn overwritten(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
            store: wgpu::StoreOp::Store,
        },
    })
}
