//! The last frame's radiance, for files and programs that map tones themselves.

use half::f16;

use crate::stereo::EyeLayout;

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

impl RadianceImage {
    /// From the bytes of a texture of half floats, `row` texels wide, in which eyes lie as `layout`
    /// says.
    pub(crate) fn new(bytes: &[u8], row: u32, layout: &EyeLayout) -> Self {
        let texels: Vec<[f16; 4]> = bytes
            .as_chunks::<8>()
            .0
            .iter()
            .map(|t| [0, 2, 4, 6].map(|i| f16::from_le_bytes([t[i], t[i + 1]])))
            .collect();
        let row = row as usize;
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
        Self {
            width: layout.eyes * layout.width,
            height: layout.height,
            rgb,
        }
    }
}
