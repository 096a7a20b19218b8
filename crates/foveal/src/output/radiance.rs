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
    /// `eyes` pictures from the bytes of a texture of half floats, `row` texels wide, in which eyes
    /// lie as `layout` says: where both see the same, it holds one.
    pub(crate) fn new(bytes: &[u8], row: u32, layout: &EyeLayout, eyes: u32) -> Self {
        let texels: Vec<[f16; 4]> = bytes
            .as_chunks::<8>()
            .0
            .iter()
            .map(|t| [0, 2, 4, 6].map(|i| f16::from_le_bytes([t[i], t[i + 1]])))
            .collect();
        let row = row as usize;
        let width = layout.width as usize;
        let columns = (0..eyes).flat_map(|eye| {
            let first = (eye.min(layout.eyes - 1) * layout.stride) as usize;
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
            width: eyes * layout.width,
            height: layout.height,
            rgb,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eyes_that_are_drawn_once_are_given_twice() {
        let texels = [1.0, 2.0, 3.0, 4.0].map(|v| [v; 4].map(f16::from_f32));
        let bytes: Vec<u8> = texels
            .iter()
            .flatten()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let layout = |eyes, width| EyeLayout {
            eyes,
            width,
            height: 1,
            stride: width,
        };
        let red = |image: RadianceImage| {
            let row: Vec<f32> = image.rgb.iter().map(|c| c[0]).collect();
            assert_eq!(image.width as usize, row.len());
            row
        };
        let once = RadianceImage::new(&bytes, 4, &layout(1, 4), 2);
        assert_eq!(red(once), [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0]);
        let both = RadianceImage::new(&bytes, 4, &layout(2, 2), 2);
        assert_eq!(red(both), [1.0, 2.0, 3.0, 4.0]);
        let one = RadianceImage::new(&bytes, 4, &layout(1, 4), 1);
        assert_eq!(red(one), [1.0, 2.0, 3.0, 4.0]);
    }
}
