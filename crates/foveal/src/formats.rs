//! Texture formats that stages share.

/// Reversed: 1 at the near plane, 0 where nothing is.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub(crate) const SURFACE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
pub(crate) const IDENTITY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

pub(crate) const TRIANGLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// Linear radiance, before exposure.
pub(crate) const RADIANCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A sample's light: `pack_light` in `shading/coarse/light.wgsl`.
pub(crate) const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

/// A stencil whose mips can be attached one by one.
pub(crate) const STENCIL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Stencil8;

/// sRGB values, encoded by the shaders, so that every adapter rounds alike.
pub(crate) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
