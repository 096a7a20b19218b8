//! A renderer that draws only what is seen and shades only as finely as the eye resolves.
//!
//! [`Gpu`] opens a device, [`Renderer`] draws a [`foveal_scene::Scene`] through it, [`Settings`]
//! says how, [`FrameStats`] says what it cost. The library never reads a clock and never
//! touches a file by itself, so that it also runs in a browser: device creation and read-back are
//! async, and the clock is the caller's. [`Renderer::render_to`] and [`Renderer::update_pose`] wait for
//! nothing; setting a scene and reading back wait for the device, in a browser without blocking.
#![forbid(unsafe_code)]

pub mod gpu;

mod ambient;
mod antialias;
mod clock;
mod composite;
mod culling;
mod environment;
mod error;
mod every_pixel;
mod formats;
mod forward;
mod frame;
mod geometry;
mod lights;
mod output;
mod rate;
mod recorder;
#[cfg(test)]
mod reduced;
mod renderer;
mod scene;
mod settings;
mod shader;
mod shading;
mod shadow;
mod stats;
mod stereo;
mod targets;
#[cfg(test)]
mod testing;

/// The crates whose types are in this one's interface.
pub use {foveal_cull, foveal_scene, glam, wgpu};

pub use clock::Clock;
pub use culling::CullingStats;
pub use environment::EnvironmentMap;
pub use error::Error;
pub use foveal_cull::{CullStats, Visibility};
pub use gpu::Gpu;
pub use output::{RadianceImage, Target};
pub use rate::{MinPyramid, RateImage};
pub use renderer::{Frame, Renderer, RendererOptions};
#[cfg(feature = "serde")]
pub use settings::variant_names;
pub use settings::{
    AmbientOcclusion, Antialiasing, AntialiasingSettings, Background, COARSEST_LEVEL,
    CoarseBackend, CoarseSample, CoarseSettings, Composite, Contrast, Culling, CullingEyes,
    CullingSettings, DebugView, Display, EdgeTest, EnvironmentSource, EyeClipping, EyeFrusta,
    EyeSettings, Geometry, GeometrySettings, Kind, Lens, LensProfile, LightAssignment,
    LightingModel, LightingPass, LightingSettings, MaterialDispatch, Output, PictureSettings,
    RateCombine, RateSettings, RateSource, RateStage, RefineEdges, SamplePattern, Setting,
    Settings, Shading, ShadingSettings, ShadowSizes, Shadows, Stereo, StereoSettings, ToneMap,
    VariableSettings,
};

pub use stereo::ShownEyes;

pub use stats::{
    AdapterStats, CoarseStats, FrameStats, SceneStats, ShadowStats, StereoStats, Timing,
    VariableStats,
};

/// Renderers and devices may be given to other threads.
#[cfg(not(target_arch = "wasm32"))]
const _: () = {
    const fn is_send_and_sync<T: Send + Sync>() {}
    is_send_and_sync::<EnvironmentMap>();
    is_send_and_sync::<Error>();
    is_send_and_sync::<FrameStats>();
    is_send_and_sync::<Gpu>();
    is_send_and_sync::<RateImage>();
    is_send_and_sync::<Renderer>();
    is_send_and_sync::<Settings>();
};
