//! The settings of a frame: a struct per stage that the library, the program's flags and a TOML
//! file share. In each enum the first variant is the default.

mod choices;
mod coarse;
mod define;
mod eye;
mod limits;
mod list;
mod stereo;
mod variable;

pub use choices::{
    AmbientOcclusion, Antialiasing, Background, Culling, CullingEyes, DebugView, EdgeTest,
    EnvironmentSource, LightAssignment, LightingModel, LightingPass, MaterialDispatch,
    SamplePattern, ShadowSizes, Shadows, ToneMap,
};

pub use coarse::{
    COARSEST_LEVEL, CoarseBackend, CoarseSample, Composite, RateCombine, RateSource, RefineEdges,
    Shading,
};

#[cfg(feature = "serde")]
pub use define::variant_names;
pub use define::{Kind, Setting};
pub use eye::Display;
pub use list::{
    AntialiasingSettings, CoarseSettings, CullingSettings, EyeSettings, GeometrySettings,
    LightingSettings, PictureSettings, RateSettings, Settings, ShadingSettings, StereoSettings,
    VariableSettings,
};

pub use stereo::{EyeClipping, EyeFrusta, Lens, LensProfile, Output, Stereo};
pub use variable::{Contrast, Geometry, RateStage};
