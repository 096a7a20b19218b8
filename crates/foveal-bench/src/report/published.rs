//! What the sources publish about their own techniques, on their own machines.

use serde_json::{Value, json};

use crate::stereo::SOURCE_RATIOS;

/// The source's table; `null` for the baseline.
pub(super) fn of(bench: &str) -> Value {
    match bench {
        "culling-frames" => json!({
            "source": "Intel, Software Occlusion Culling sample (castle scene)",
            "machine": "4 cores, 8 threads, 2.3 GHz",
            "columns": ["", "frame ms", "draws"],
            "rows": [
                ["no culling", 266.67, 22877],
                ["frustum", 95.96, 7683],
                ["occlusion", 31.71, 1845],
            ],
        }),
        "culling" => json!({
            "source": "Intel, Software Occlusion Culling sample (castle scene, 1,050,000 occluder triangles, 26,897 boxes)",
            "machine": "4 cores, 8 threads, 2.3 GHz",
            "columns": ["", "ms"],
            "rows": [["rasterize", 3.77], ["test", 2.23]],
        }),
        "stereo" => json!({
            "source": "yvt, instanced stereo rendering",
            "machine": "the original method's; two passes / instanced: above 1 instancing is faster",
            "columns": ["", "two-pass / CPU", "two-pass / GPU"],
            "rows": SOURCE_RATIOS.map(|(scene, draws, cpu, gpu)| json!([format!("{scene}: {draws} draws"), cpu, gpu])),
        }),
        "coarse" => json!({
            "source": "Imagire, coarse pixel shading by stencil pyramid",
            "machine": "Radeon RX 560, 200 lights, 9 levels",
            "columns": ["", "frames per second", "ratio to full"],
            "rows": [
                ["full", 36.4, 1.0],
                ["interpolated", 60.1, 1.65],
                ["nearest", 68.6, 1.88],
            ],
        }),
        "eye" => json!({
            "source": "Guenter et al. 2012; VaFR, from deferred shading at retinal resolution; Patney et al. 2016",
            "machine": "the sources', at qualities that are theirs to judge",
            "columns": ["", "gain"],
            "rows": [
                ["Foveated 3D graphics", "5 to 6 times"],
                ["Visual acuity-consistent foveated rendering", "6.5 to 9.3 times"],
                ["Towards foveated rendering", "up to 70 % fewer shades"],
            ],
        }),
        "variable" => json!({
            "source": "Monsho, software variable-rate shading",
            "machine": "the original method's",
            "columns": ["", "ms"],
            "rows": [
                ["G-buffer pass", 0.28],
                ["saved", 0.06],
                ["mask", 0.08],
                ["reprojection", 0.02],
            ],
        }),
        "antialiasing" => json!({
            "source": "tatsy, compute anti-aliasing (Sponza)",
            "machine": "GTX 960, about 1000x1500",
            "columns": ["", "frames per second"],
            "rows": [
                ["none", "> 60"],
                ["MSAA", "about 30"],
                ["SSAA", "about 10"],
            ],
        }),
        _ => Value::Null,
    }
}
