//! Flags of coarse shading, and the picture that a rate map may come from.

use std::path::Path;

use anyhow::bail;
use clap::builder::TypedValueParser;
use foveal::{
    Backend, CoarseSample, Composite, RateCombine, RateImage, RateSource, RefineEdges, Settings,
    Shading,
};

use super::settings::set;
use crate::picture::Picture;
use crate::values::{self, VariantParser};

/// A flag for each setting of coarse shading.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Coarse shading")]
pub(super) struct CoarseArgs {
    /// One lighting evaluation per pixel, or per tile of a rate map [default: full]
    #[arg(long, value_name = "RATE", value_parser = VariantParser::<Shading>::new())]
    shading: Option<Shading>,

    /// By what means tiles are visited; auto measures both [default: auto]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<Backend>::new())]
    backend: Option<Backend>,

    /// Coarsest level, 0 to 8: tiles of at most 2^N pixels a side [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=8))]
    coarsest_level: Option<u8>,

    /// Where wished levels come from: foveated, constant, image, or a PNG file (black: every pixel, white: level 8)
    /// [default: foveated]
    #[arg(long, value_name = "SOURCE|FILE.png", value_parser = source)]
    rate: Option<Source>,

    /// A second source of wishes [default: constant]
    #[arg(long, value_name = "SOURCE", value_parser = VariantParser::<RateSource>::new())]
    rate_other: Option<RateSource>,

    /// What becomes of the second source: not looked at, or the coarser or finer wish of both
    /// [default: first]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<RateCombine>::new())]
    rate_combine: Option<RateCombine>,

    /// The constant source's level, 0 to 8 [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=8))]
    rate_level: Option<u8>,

    /// The image source's file
    #[arg(long, value_name = "FILE.png")]
    rate_image: Option<String>,

    /// Where the eye looks, as fractions of the picture from its top left corner [default: 0.5,0.5]
    #[arg(long, value_name = "X,Y", value_parser = values::vec2, allow_hyphen_values = true)]
    gaze: Option<[f32; 2]>,

    /// Radius around the gaze where every pixel is shaded, by the picture's height [default: 0.125]
    #[arg(long, value_name = "R", value_parser = values::finite)]
    fovea_inner: Option<f32>,

    /// Radius from which on the coarsest level is wished, by the picture's height [default: 0.9]
    #[arg(long, value_name = "R", value_parser = values::finite)]
    fovea_outer: Option<f32>,

    /// How levels follow between the radii: 1 in even steps, above 1 in steps that widen [default: 1.5]
    #[arg(long, value_name = "X", value_parser = values::positive)]
    fovea_curve: Option<f32>,

    /// Whether neighbouring tiles differ by one level at most [default: true]
    #[arg(long, value_name = "BOOL")]
    rate_balance: Option<bool>,

    /// Where geometric edges are shaded more finely: two levels everywhere (graded), pixel by pixel outside the
    /// periphery (inner) or everywhere, or nowhere [default: graded]
    #[arg(long, value_name = "WHERE", value_parser = VariantParser::<RefineEdges>::new())]
    refine_edges: Option<RefineEdges>,

    /// Which of its pixels a tile's sample looks at: the centre, or the most typical of five [default: center]
    #[arg(long, value_name = "WHICH", value_parser = VariantParser::<CoarseSample>::new())]
    coarse_sample: Option<CoarseSample>,

    /// How samples become pixels [default: smooth]
    #[arg(long, value_name = "HOW", value_parser = VariantParser::<Composite>::new())]
    composite: Option<Composite>,
}

/// What `--rate` names.
#[derive(Clone, Debug)]
enum Source {
    Known(RateSource),
    File(String),
}

fn source(text: &str) -> Result<Source, String> {
    let parser = VariantParser::<RateSource>::new();
    match parser.parse_ref(&clap::Command::new("rate"), None, text.as_ref()) {
        Ok(known) => Ok(Source::Known(known)),
        Err(_) if text.to_lowercase().ends_with(".png") => Ok(Source::File(text.to_owned())),
        Err(_) => Err("neither foveated, constant or image, nor a .png file".to_owned()),
    }
}

impl CoarseArgs {
    pub(super) fn apply(self, settings: &mut Settings) {
        let Self {
            shading,
            backend,
            coarsest_level,
            rate,
            rate_other,
            rate_combine,
            rate_level,
            rate_image,
            gaze,
            fovea_inner,
            fovea_outer,
            fovea_curve,
            rate_balance,
            refine_edges,
            coarse_sample,
            composite,
        } = self;
        match rate {
            Some(Source::Known(known)) => settings.rate = known,
            Some(Source::File(file)) => {
                settings.rate = RateSource::Image;
                settings.rate_image = file;
            }
            None => {}
        }
        set(&mut settings.shading, shading);
        set(&mut settings.backend, backend);
        set(&mut settings.coarsest_level, coarsest_level);
        set(&mut settings.rate_other, rate_other);
        set(&mut settings.rate_combine, rate_combine);
        set(&mut settings.rate_level, rate_level);
        set(&mut settings.rate_image, rate_image);
        set(&mut settings.gaze, gaze);
        set(&mut settings.fovea_inner, fovea_inner);
        set(&mut settings.fovea_outer, fovea_outer);
        set(&mut settings.fovea_curve, fovea_curve);
        set(&mut settings.rate_balance, rate_balance);
        set(&mut settings.refine_edges, refine_edges);
        set(&mut settings.coarse_sample, coarse_sample);
        set(&mut settings.composite, composite);
    }
}

/// The picture that the rate map comes from, where it comes from one.
pub(super) fn rate_image(settings: &Settings) -> anyhow::Result<Option<RateImage>> {
    let second = settings.rate_combine != RateCombine::First;
    let used =
        settings.rate == RateSource::Image || second && settings.rate_other == RateSource::Image;
    if settings.shading == Shading::Full || !used {
        return Ok(None);
    }
    if settings.rate_image.is_empty() {
        bail!(
            "the rate map shall come from a picture, but none is named: add --rate-image FILE.png"
        );
    }
    let picture = Picture::read(Path::new(&settings.rate_image))?;
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
