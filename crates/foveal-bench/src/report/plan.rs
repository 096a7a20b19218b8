//! Which benches there are, how each is called, and what of it the page shows.

use std::path::Path;
use std::process::Command;

use foveal_host::command_line::quoted;
use serde_json::{Value, json};

use crate::changes::Changes;
use foveal_host::difference::BENCH_DISPLAY;

/// A column of the page's table.
pub(super) struct Column {
    pub(super) key: &'static str,
    pub(super) title: &'static str,
    /// Multiplied before it is shown, for percent and the like.
    pub(super) factor: f64,
    pub(super) digits: usize,
}

const fn column(key: &'static str, title: &'static str, digits: usize) -> Column {
    Column {
        key,
        title,
        factor: 1.0,
        digits,
    }
}

const fn percent(key: &'static str, title: &'static str) -> Column {
    Column {
        key,
        title,
        factor: 100.0,
        digits: 2,
    }
}

/// Two settings whose pictures are laid over each other.
pub(super) struct Pair {
    pub(super) title: &'static str,
    pub(super) before: Changes,
    pub(super) after: Changes,
}

/// How cost grows with the load.
pub(super) struct Load {
    /// What the rows are loaded with, and its title.
    pub(super) x: &'static str,
    pub(super) title: &'static str,
    /// Costs in milliseconds, and what of the row they are where there are several.
    pub(super) costs: &'static [(&'static str, &'static str)],
    /// The cost of the plain way, which all rows of a load share.
    pub(super) reference: Option<(&'static str, &'static str)>,
    /// What tells a line from the others.
    pub(super) series: &'static [&'static str],
    /// Only rows that have this.
    pub(super) only: Option<(&'static str, &'static str)>,
}

/// Quality against speed.
pub(super) struct Quality {
    /// What lies to the right, and where on that axis better is.
    pub(super) x: &'static str,
    pub(super) axis: &'static str,
    /// An error, and what it is called; small is good.
    pub(super) error: (&'static str, &'static str),
    /// Where the figure is not the error itself but a quality: the best one, from which it is counted.
    pub(super) best: Option<f64>,
    /// What grows along a curve, and its title; none: each row stands alone.
    pub(super) along: Option<(&'static str, &'static str)>,
    /// What tells a curve from the others.
    pub(super) series: &'static [&'static str],
    /// A plot for each of this.
    pub(super) apart: Option<&'static str>,
}

/// One bench.
pub(super) struct Bench {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) subcommand: &'static [&'static str],
    /// Scenes, [`THE_SCENE`] among them for the report's, and flags; fewer where it must be quick.
    quick: &'static [&'static str],
    full: &'static [&'static str],
    /// Whether it takes `--size`.
    sized: bool,
    /// Further words, one run and one row each; none: one run that gives all rows.
    pub(super) variants: &'static [&'static [&'static str]],
    pub(super) rows: fn(&Value) -> Option<Vec<Value>>,
    /// What tells a row from the others; the row's label is made of these.
    pub(super) label: &'static [&'static str],
    pub(super) columns: &'static [Column],
    /// The cost in the bar plot.
    pub(super) cost: &'static str,
    pub(super) quality: Option<Quality>,
    pub(super) load: Option<Load>,
    pub(super) pairs: &'static [Pair],
}

fn own_rows(figures: &Value) -> Option<Vec<Value>> {
    let rows = figures.get("rows").unwrap_or(figures);
    rows.as_array().cloned()
}

/// The stages of `foveal render --stats`.
fn stages(figures: &Value) -> Option<Vec<Value>> {
    let median = figures.get("median")?;
    let mut rows = Vec::new();
    for (unit, key) in [("CPU", "cpu_ms"), ("GPU", "gpu_ms")] {
        for timing in median.get(key)?.as_array()? {
            rows.push(json!({ "unit": unit, "stage": timing["name"], "ms": timing["ms"] }));
        }
    }
    rows.push(json!({ "unit": "both", "stage": "frame", "ms": median["frame_ms"] }));
    Some(rows)
}

/// The frame of `foveal render --stats` as one row.
fn frame(figures: &Value) -> Option<Vec<Value>> {
    let mut row = figures.get("median")?.as_object()?.clone();
    row.retain(|_, value| value.is_number());
    Some(vec![row.into()])
}

/// The rows of the first camera: one per scene where scenes are the load.
fn first_camera(figures: &Value) -> Option<Vec<Value>> {
    let mut rows = own_rows(figures)?;
    let first = rows.first()?["camera"].clone();
    rows.retain(|row| row["camera"] == first);
    Some(rows)
}

/// Stands for the scene that the report is about.
const THE_SCENE: &str = "SCENE";

/// The bench that the first page is made of.
pub(super) const VERDICT: &str = "verdict";

const FLIP: &str = "FLIP error: low is better";

/// The verdict, then in the order of the frame.
pub(super) const BENCHES: &[Bench] = &[
    Bench {
        name: VERDICT,
        title: "The verdict",
        about: "Each setting that may help, against the plain frame: whole frames, drawn in turn, in an order that is drawn by lot.",
        subcommand: &["bench", "verdict"],
        quick: &[THE_SCENE, "--rounds", "40"],
        full: &[THE_SCENE, "--rounds", "60"],
        sized: true,
        variants: &[],
        rows: own_rows,
        label: &["name"],
        columns: &[
            column("ratio", "plain / this", 2),
            column("low", "at least", 2),
            column("high", "at most", 2),
            column("work_ratio", "by processor time", 2),
            column("reference_ms", "plain ms", 2),
            column("chosen_ms", "this ms", 2),
            column("chosen_low_ms", "a tenth below", 2),
            column("chosen_high_ms", "a tenth above", 2),
            column("flip_mean", "FLIP", 4),
            column("jod", "JOD", 2),
            column("pairs", "pairs", 0),
        ],
        cost: "chosen_ms",
        quality: None,
        load: None,
        pairs: &[],
    },
    Bench {
        name: "baseline",
        title: "Baseline",
        about: "The plain frame that everything else is compared with: every pixel shaded once, no anti-aliasing, objects outside the frustum left out.",
        subcommand: &["render"],
        quick: &[THE_SCENE, "--warmup", "2", "--frames", "3"],
        full: &[THE_SCENE, "--warmup", "3", "--frames", "9"],
        sized: true,
        variants: &[],
        rows: stages,
        label: &["unit", "stage"],
        columns: &[column("ms", "ms", 2)],
        cost: "ms",
        quality: None,
        load: None,
        pairs: &[],
    },
    Bench {
        name: "culling",
        title: "Software occlusion culling",
        about: "Occluders are rasterized on the processor, then boxes are tested against their depth: what nothing can show is never submitted.",
        subcommand: &["bench", "culling"],
        quick: &[
            THE_SCENE,
            "--repetitions",
            "9",
            "--sizes",
            "640x360",
            "--quiet",
        ],
        full: &[
            THE_SCENE,
            "--repetitions",
            "31",
            "--sizes",
            "640x360,1280x720",
            "--quiet",
        ],
        sized: false,
        variants: &[],
        rows: own_rows,
        label: &["camera", "width", "height", "threads"],
        columns: &[
            column("occluder_triangles", "occluder triangles", 0),
            column("raster_ms", "rasterize ms", 3),
            column("query_boxes", "boxes", 0),
            column("query_ms", "test ms", 3),
            column("query_ns_per_box", "ns per box", 1),
            column("culled", "culled", 0),
            column("visible", "visible", 0),
        ],
        cost: "raster_ms",
        quality: None,
        load: None,
        pairs: &[Pair {
            title: "All objects, and those that are seen: the same picture",
            before: &[("culling", "off")],
            after: &[("culling", "occlusion")],
        }],
    },
    Bench {
        name: "culling-load",
        title: "Culling under load",
        about: "The demo scene with more and more objects, seen by its first camera; one thread.",
        subcommand: &["bench", "culling"],
        quick: &[
            "demo:1000",
            "demo:3000",
            "demo:10000",
            "--repetitions",
            "5",
            "--sizes",
            "640x360",
            "--threads",
            "1",
            "--quiet",
        ],
        full: &[
            "demo:1000",
            "demo:3000",
            "demo:10000",
            "demo:30000",
            "--repetitions",
            "31",
            "--sizes",
            "640x360",
            "--threads",
            "1",
            "--quiet",
        ],
        sized: false,
        variants: &[],
        rows: first_camera,
        label: &["occluder_triangles"],
        columns: &[
            column("occluder_triangles", "occluder triangles", 0),
            column("raster_ms", "rasterize ms", 3),
            column("query_boxes", "boxes", 0),
            column("query_ms", "test ms", 3),
            column("culled", "culled", 0),
        ],
        cost: "raster_ms",
        quality: None,
        load: Some(Load {
            x: "occluder_triangles",
            title: "occluder triangles",
            costs: &[("raster_ms", "rasterize"), ("query_ms", "test boxes")],
            reference: None,
            series: &[],
            only: None,
        }),
        pairs: &[],
    },
    Bench {
        name: "culling-frames",
        title: "Whole frames with culling",
        about: "The same picture with all objects, with those in the frustum, and with those that nothing hides.",
        subcommand: &["render"],
        quick: &[THE_SCENE, "--warmup", "1", "--frames", "3"],
        full: &[THE_SCENE, "--warmup", "2", "--frames", "9"],
        sized: true,
        variants: &[
            &["--culling", "off"],
            &["--culling", "frustum"],
            &["--culling", "occlusion"],
        ],
        rows: frame,
        label: &["variant"],
        columns: &[
            column("frame_ms", "frame ms", 2),
            column("objects_visible", "objects drawn", 0),
            column("draws", "draws", 0),
            column("triangles", "triangles", 0),
            column("ratio_to_first", "first / this", 2),
        ],
        cost: "frame_ms",
        quality: None,
        load: None,
        pairs: &[],
    },
    Bench {
        name: "stereo",
        title: "Instanced stereo",
        about: "Both eyes in one submission.",
        subcommand: &["bench", "stereo"],
        quick: &["materials", THE_SCENE, "--rounds", "10"],
        full: &["materials", "materials2", THE_SCENE],
        sized: false,
        variants: &[],
        rows: own_rows,
        label: &["scene", "stages", "mode"],
        columns: &[
            column("draws", "draws", 0),
            column("encode_ms", "encode ms", 3),
            column("submit_ms", "submit ms", 3),
            column("gpu_ms", "GPU ms", 1),
            column("frame_ms", "frame ms", 1),
            column("ratio_frame", "two-pass / frame", 2),
            column("ratio_frame_low", "at least", 2),
            column("ratio_frame_high", "at most", 2),
            column("ratio_cpu", "two-pass / CPU", 2),
            column("ratio_gpu", "two-pass / GPU", 2),
            column("ratio_mono", "mono / frame", 2),
        ],
        cost: "frame_ms",
        quality: None,
        load: Some(Load {
            x: "draws",
            title: "draws",
            costs: &[("encode_ms", "")],
            reference: None,
            series: &["mode"],
            only: Some(("stages", "frame")),
        }),
        pairs: &[Pair {
            title: "A pass per eye, and both eyes at once: the same picture",
            before: &[("stereo", "two-pass"), ("show", "side-by-side")],
            after: &[("stereo", "instanced"), ("show", "side-by-side")],
        }],
    },
    Bench {
        name: "coarse",
        title: "Coarse pixel shading",
        about: "Away from the gaze one lighting evaluation serves a whole block of pixels.",
        subcommand: &["bench", "coarse"],
        quick: &[
            THE_SCENE, "--pairs", "10", "--lights", "10", "--lights", "200",
        ],
        full: &[
            THE_SCENE, "--pairs", "12", "--lights", "10", "--lights", "50", "--lights", "200",
            "--lights", "1000",
        ],
        sized: true,
        variants: &[],
        rows: own_rows,
        label: &["composite", "backend", "lights"],
        columns: &[
            column("lights", "lights", 0),
            percent("shaded_fraction", "shaded %"),
            column("full_frame_ms", "full frame ms", 1),
            column("coarse_frame_ms", "coarse frame ms", 1),
            column("frame_ratio", "full / coarse frame", 2),
            column("frame_ratio_low", "at least", 2),
            column("frame_ratio_high", "at most", 2),
            column("full_ms", "full lighting ms", 1),
            column("coarse_ms", "coarse lighting ms", 1),
            column("ratio", "lighting alone", 2),
            column("flip_mean", "FLIP", 4),
            column("jod", "JOD", 2),
            column("psnr", "PSNR dB", 1),
        ],
        cost: "coarse_frame_ms",
        quality: Some(Quality {
            x: "frame_ratio",
            axis: "full / coarse, whole frames: right is better",
            error: ("flip_mean", FLIP),
            best: None,
            along: Some(("lights", "more lights")),
            series: &["composite", "backend"],
            apart: None,
        }),
        load: Some(Load {
            x: "lights",
            title: "lights",
            costs: &[("coarse_frame_ms", "")],
            reference: Some(("full_frame_ms", "every pixel")),
            series: &["composite", "backend"],
            only: Some(("backend", "compute")),
        }),
        pairs: &[
            Pair {
                title: "Every pixel, and the smooth composite",
                before: &[],
                after: &[("shading", "coarse"), ("composite", "smooth")],
            },
            Pair {
                title: "Every pixel, and the source's four taps",
                before: &[],
                after: &[("shading", "coarse"), ("composite", "paper")],
            },
        ],
    },
    Bench {
        name: "eye",
        title: "What the eye sees",
        about: "Each way of shading against every pixel lit, on displays that are seen at one point: lit samples, whole frames, and JOD: ten is no visible difference, one less is a difference that three of four observers see. Pictures show the display's middle, with its own pixels per degree. Of MSAA it is no loss, but the difference from a picture without anti-aliasing.",
        subcommand: &["bench", "eye"],
        quick: &[THE_SCENE, "--quick", "--display", "h60"],
        full: &[THE_SCENE],
        sized: true,
        variants: &[],
        rows: own_rows,
        label: &["display", "way"],
        columns: &[
            column("width", "pixels across", 0),
            column("degrees_across", "degrees", 1),
            column("pixels_per_degree", "pixels per degree", 1),
            percent("lit_fraction", "lit %"),
            column("jod", "JOD", 2),
            column("flip_mean", "FLIP", 4),
            percent("off_lit_fraction", "lit %, gaze off"),
            column("off_jod", "JOD, gaze off", 2),
            percent("video_lit_fraction", "lit %, video"),
            column("video_jod", "JOD, video", 2),
            column("flicker", "flicker by full's", 2),
            column("full_frame_ms", "full frame ms", 1),
            column("frame_ms", "frame ms", 1),
            column("frame_ratio", "full / this", 2),
            column("frame_ratio_low", "at least", 2),
            column("frame_ratio_high", "at most", 2),
        ],
        cost: "frame_ms",
        quality: Some(Quality {
            x: "frame_ratio",
            axis: "full / this, whole frames: right is better",
            error: ("jod", "JOD lost: low is better"),
            best: Some(10.0),
            along: None,
            series: &["way"],
            apart: Some("display"),
        }),
        load: None,
        pairs: &[Pair {
            title: "Every pixel, and samples of light",
            before: &[],
            after: &[
                ("shading", "coarse"),
                ("display", BENCH_DISPLAY),
                ("quality", "9.3"),
            ],
        }],
    },
    Bench {
        name: "variable",
        title: "Variable-rate shading in software",
        about: "Where the picture is flat, one evaluation serves a few pixels. The mask comes from the last frame, reprojected in the same pass.",
        subcommand: &["bench", "variable"],
        quick: &[THE_SCENE, "--rounds", "10", "--point-lights", "32"],
        full: &[
            THE_SCENE,
            "--rounds",
            "12",
            "--contrast-threshold",
            "0.02",
            "--contrast-threshold",
            "0.04",
            "--contrast-threshold",
            "0.08",
        ],
        sized: true,
        variants: &[],
        rows: own_rows,
        label: &["stage", "material_cost", "lights", "contrast_threshold"],
        columns: &[
            percent("shaded_fraction", "shaded %"),
            column("mask_ms", "mask ms", 2),
            column("full_frame_ms", "full frame ms", 1),
            column("variable_frame_ms", "variable frame ms", 1),
            column("frame_ratio", "full / variable frame", 2),
            column("frame_ratio_low", "at least", 2),
            column("frame_ratio_high", "at most", 2),
            column("full_ms", "full stage ms", 1),
            column("variable_ms", "variable stage ms", 1),
            column("net_ms", "net ms", 1),
            column("ratio", "stage alone", 2),
            column("flip_mean", "FLIP", 4),
            column("jod", "JOD", 2),
        ],
        cost: "variable_frame_ms",
        quality: Some(Quality {
            x: "frame_ratio",
            axis: "full / variable, whole frames: right is better",
            error: ("flip_mean", FLIP),
            best: None,
            along: Some(("contrast_threshold", "a higher contrast threshold")),
            series: &["stage", "lights"],
            apart: Some("material_cost"),
        }),
        load: Some(Load {
            x: "lights",
            title: "lights",
            costs: &[("variable_frame_ms", "")],
            reference: None,
            series: &["stage", "material_cost", "contrast_threshold"],
            only: Some(("material_cost", "plain")),
        }),
        pairs: &[Pair {
            title: "Every pixel, and at the rate that the content asks for",
            before: &[("geometry", "visibility")],
            after: &[
                ("geometry", "visibility"),
                ("shading", "variable"),
                ("rate", "content"),
                ("force-rate", "true"),
            ],
        }],
    },
    Bench {
        name: "antialiasing",
        title: "Anti-aliasing in compute",
        about: "Only pixels that several surfaces share are shaded more than once.",
        subcommand: &["bench", "antialiasing"],
        quick: &[THE_SCENE, "--rounds", "10", "--reference", "16"],
        full: &[THE_SCENE, "--rounds", "15"],
        sized: true,
        variants: &[],
        rows: own_rows,
        label: &["name"],
        columns: &[
            percent("edge_fraction", "edges %"),
            column("gbuffer_ms", "G-buffer ms", 1),
            column("shade_ms", "shade ms", 1),
            column("frame_ms", "frame ms", 1),
            column("frame_ratio", "none / frame", 2),
            column("frame_ratio_low", "at least", 2),
            column("frame_ratio_high", "at most", 2),
            column("shade_ratio", "none / shade", 2),
            column("flip_to_ssaa", "FLIP to ssaa", 4),
            column("flip_to_reference", "FLIP to truth", 4),
            column("jod_to_reference", "JOD to truth", 2),
        ],
        cost: "frame_ms",
        quality: Some(Quality {
            x: "frame_ms",
            axis: "ms a frame: left is better",
            error: ("flip_to_reference", FLIP),
            best: None,
            along: None,
            series: &["name"],
            apart: None,
        }),
        load: Some(Load {
            x: "samples",
            title: "samples",
            costs: &[("frame_ms", "")],
            reference: None,
            series: &["mode", "pattern", "geometry"],
            only: None,
        }),
        pairs: &[Pair {
            title: "None, and MSAA",
            before: &[],
            after: &[("aa", "msaa")],
        }],
    },
];

impl Bench {
    /// How many passes are made where all others make `passes`: some draw their sides in turn, and have intervals of their
    /// own.
    pub(super) fn passes(&self, passes: usize) -> usize {
        match self.name {
            VERDICT | "eye" => 1,
            _ => passes,
        }
    }

    /// The command's words, without where its figures go.
    pub(super) fn words(
        &self,
        scene: &str,
        size: (u32, u32),
        quick: bool,
        adapter: Option<&str>,
    ) -> Vec<String> {
        let mut words: Vec<String> = self.subcommand.iter().map(|&w| w.to_owned()).collect();
        if self.sized {
            words.extend(["--size".to_owned(), format!("{}x{}", size.0, size.1)]);
        }
        let own = if quick { self.quick } else { self.full };
        let named = |word| if word == THE_SCENE { scene } else { word };
        words.extend(own.iter().map(|&word| named(word).to_owned()));
        if let Some(adapter) = adapter
            && self.subcommand != ["bench", "culling"]
        {
            words.extend(["--adapter".to_owned(), adapter.to_owned()]);
        }
        words
    }

    /// The commands as a user types them: one for each variant, or one.
    pub(super) fn command_lines(&self, words: &[String]) -> Vec<String> {
        let output = match self.subcommand {
            ["render"] => " --output frame_#.png",
            _ => "",
        };
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        let line = |variant: &[&str]| {
            let variant: String = variant.iter().map(|word| format!(" {word}")).collect();
            format!("foveal {}{output}{variant}", words.join(" "))
        };
        match self.variants {
            [] => vec![line(&[])],
            variants => variants.iter().map(|variant| line(variant)).collect(),
        }
    }

    /// Adds where the figures go.
    pub(super) fn output(&self, command: &mut Command, folder: &Path, file: &Path) {
        if self.subcommand == ["render"] {
            command
                .arg("--quiet")
                .arg("--output")
                .arg(folder.join("frame_#.png"))
                .arg("--stats")
                .arg(file);
        } else {
            command.arg("--json").arg(file);
        }
    }
}
