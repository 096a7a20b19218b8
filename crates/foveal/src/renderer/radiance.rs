//! The last frame's radiance, for files and programs that map tones themselves.

use half::f16;

use super::Renderer;
use crate::gpu::{ErrorTrap, read_texture};
use crate::stereo::EyeLayout;
use crate::{DebugView, Error};

/// Linear light with the primaries and the white of sRGB.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RadianceImage {
    /// In pixels; of two eyes both, side by side.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Red, green and blue of each pixel, rows top to bottom, before exposure and tone map; not
    /// below 0, above 1 where it is brighter than white at an exposure of 0.
    pub rgb: Vec<[f32; 3]>,
}

impl Renderer {
    /// The last frame's radiance, at the size at which the frame was drawn
    /// ([`PictureSettings::render_scale`](crate::PictureSettings::render_scale) makes it smaller). Two eyes lie side by side,
    /// without lenses; eyes that see the same are one picture.
    ///
    /// # Errors
    /// [`Error::Setting`] where a debug view was drawn; [`Error::DeviceLost`],
    /// [`Error::OutOfMemory`].
    pub async fn read_radiance(&self) -> Result<RadianceImage, Error> {
        let settings = &self.stages.settings;
        if settings.picture.view != DebugView::Final {
            return Err(Error::Setting {
                name: "view",
                value: "a debug view".to_owned(),
                expected: "final: debug views have no radiance",
            });
        }
        let layout = EyeLayout::of(settings);
        let texture = self.stages.targets.radiance_view.texture();
        let trap = ErrorTrap::new(&self.gpu, "reading the radiance back");
        let bytes = read_texture(&self.gpu, texture).await;
        trap.finish().await?;
        let texels: Vec<[f16; 4]> = bytes?
            .as_chunks::<8>()
            .0
            .iter()
            .map(|t| [0, 2, 4, 6].map(|i| f16::from_le_bytes([t[i], t[i + 1]])))
            .collect();
        let row = texture.width() as usize;
        let width = layout.width as usize;
        let columns = (0..layout.eyes as usize).flat_map(|eye| {
            let first = eye * layout.stride as usize;
            first..first + width
        });
        let rgb = (0..layout.height as usize)
            .flat_map(|y| columns.clone().map(move |x| y * row + x))
            .map(|at| {
                let [r, g, b, _] = texels[at];
                [r, g, b].map(|v| v.to_f32().max(0.0))
            })
            .collect();
        Ok(RadianceImage {
            width: layout.eyes * layout.width,
            height: layout.height,
            rgb,
        })
    }
}
