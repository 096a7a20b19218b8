//! A picture as a source of requested levels.

/// A grey picture stretched over the frame: 0 asks for every pixel, 255 for level 8.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RateImage {
    width: u32,
    height: u32,
    luma: Vec<u8>,
}

impl RateImage {
    /// A picture from its rows, top to bottom; `None` unless there are `width * height` bytes and
    /// at least one.
    #[must_use]
    pub fn new(width: u32, height: u32, luma: Vec<u8>) -> Option<Self> {
        let bytes = u64::from(width) * u64::from(height);
        (bytes > 0 && luma.len() as u64 == bytes).then_some(Self {
            width,
            height,
            luma,
        })
    }

    /// The level, 0 to 8, that a grey value asks for.
    #[must_use]
    pub fn level_of(luma: u8) -> u8 {
        // luma * 8 / 255, rounded.
        ((u16::from(luma) * 8 + 127) / 255) as u8
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Requested levels, rows top to bottom.
    pub(crate) fn levels(&self) -> Vec<u8> {
        self.luma.iter().map(|&l| Self::level_of(l)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_asks_for_every_pixel_and_white_for_the_coarsest_level() {
        assert_eq!(RateImage::level_of(0), 0);
        assert_eq!(RateImage::level_of(255), 8);
        for luma in 0..=255u8 {
            let nearest = (f32::from(luma) * 8.0 / 255.0).round();
            assert_eq!(f32::from(RateImage::level_of(luma)), nearest, "{luma}");
        }
    }

    #[test]
    fn a_picture_has_as_many_bytes_as_pixels() {
        assert!(RateImage::new(2, 2, vec![0; 4]).is_some());
        assert!(RateImage::new(2, 2, vec![0; 3]).is_none());
        assert!(RateImage::new(0, 2, Vec::new()).is_none());
    }
}
