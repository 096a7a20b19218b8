//! The picture that a rate map may come from.

use std::path::Path;

use anyhow::bail;
use foveal::{RateCombine, RateImage, RateSource, Settings, Shading};

use crate::picture::Picture;

/// The picture that the rate map comes from, where it comes from one.
pub fn rate_image(settings: &Settings) -> anyhow::Result<Option<RateImage>> {
    if !is_read(settings) {
        return Ok(None);
    }
    if settings.coarse.image_name.is_empty() {
        bail!(
            "the rate map shall come from a picture, but none is named: add --rate-image FILE.png"
        );
    }
    let picture = Picture::read(Path::new(&settings.coarse.image_name))?;
    // Rec. 601 luma, as the grey of a grey picture.
    let luma = picture
        .rgb_bytes()
        .as_chunks::<3>()
        .0
        .iter()
        .map(|&[r, g, b]| {
            ((299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b) + 500) / 1000) as u8
        })
        .collect();
    Ok(RateImage::new(picture.width, picture.height, luma))
}

/// Whether frames with these settings take shading rates from a picture.
pub fn is_read(settings: &Settings) -> bool {
    let second = settings.coarse.combine != RateCombine::First;
    let named = settings.coarse.source == RateSource::Image
        || second && settings.coarse.other_source == RateSource::Image;
    settings.shading.mode != Shading::Full && named
}
