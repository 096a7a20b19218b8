//! Whether a way of submission is right on this device, and how fast it is: a small scene is drawn
//! by it and, eye by eye, in two passes.
//!
//! Drivers differ: multiview of Mesa 22.3.6 puts triangles of one eye into the other's layer once a
//! pass has several draws. Each way is tried once per renderer, when it is first wanted.

use super::Submission;
use crate::clock::{self, ms_between};
use crate::gpu::{self, ErrorTrap, Gpu, layered_target, start_reading, work_done};
use crate::{Clock, Error, shader};

/// Width and height of an eye's picture.
const SIDE: u32 = 64;
/// Draws of a pass, and vertices of a draw: `TRIANGLES` in `trial.wgsl`, three each.
const DRAWS: u32 = 64;
const VERTICES: u32 = 3 * 128;
/// Texels of both eyes that may differ: edges that another half of the target rounds otherwise. A
/// driver that is wrong has hundreds.
const ROUNDED: u32 = 2 * SIDE * SIDE / 200;
/// Times that a way is timed; the least counts.
const ROUNDS: u32 = 3;

const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What came of a way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// Texels of both eyes that are not what two passes draw.
    pub(crate) wrong: u32,
    /// From the first command until the device is done; 0 without a clock.
    pub(crate) ms: f64,
}

impl Verdict {
    /// Texels of both eyes.
    pub(crate) const TEXELS: u32 = 2 * SIDE * SIDE;

    pub(crate) fn is_right(self) -> bool {
        self.wrong <= ROUNDED
    }
}

/// The verdicts so far.
#[derive(Debug, Default)]
pub(crate) struct Trials {
    /// What two passes draw, eye after eye.
    expected: Vec<u32>,
    done: Vec<(Submission, Verdict)>,
}

impl Trials {
    /// The verdict on a way, tried now unless it was before.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`]. What the device refuses is no error but
    /// wrong.
    pub(crate) async fn of(
        &mut self,
        gpu: &Gpu,
        way: Submission,
        clock: Option<Clock>,
    ) -> Result<Verdict, Error> {
        if let Some((_, verdict)) = self.done.iter().find(|(done, _)| *done == way) {
            return Ok(*verdict);
        }
        if self.expected.is_empty() {
            self.expected = draw(gpu, Submission::TwoPass { clips: false }, clock)
                .await?
                .0;
        }
        let verdict = match draw(gpu, way, clock).await {
            Ok((seen, ms)) => {
                let pairs = seen.iter().zip(&self.expected);
                let wrong = pairs.filter(|(a, b)| a != b).count() as u32;
                Verdict { wrong, ms }
            }
            Err(Error::Validation { .. }) => Verdict {
                wrong: Verdict::TEXELS,
                ms: 0.0,
            },
            Err(error) => return Err(error),
        };
        self.done.push((way, verdict));
        Ok(verdict)
    }
}

/// What each eye's texels show, the left eye's first, and how long that took.
async fn draw(gpu: &Gpu, way: Submission, clock: Option<Clock>) -> Result<(Vec<u32>, f64), Error> {
    let trap = || ErrorTrap::new(gpu, "trying how two eyes are drawn");
    let making = trap();
    let trial = Trial::new(gpu, way);
    making.finish().await?;
    let mut least = f64::MAX;
    for round in 0..=ROUNDS {
        let drawing = trap();
        let start = clock::read(clock);
        trial.submit(gpu);
        let done = work_done(gpu, move || clock::read(clock));
        drawing.finish().await?;
        let end = done.take(gpu).await?;
        // The first one makes the driver compile.
        if round > 0 {
            least = least.min(ms_between(start, end));
        }
    }
    let reading_back = trap();
    let reading = start_reading(gpu, trial.color.texture());
    reading_back.finish().await?;
    let bytes = reading.bytes(gpu).await?;
    let texels: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
    if trial.layers == 2 {
        return Ok((texels, least));
    }
    let (side, rows) = (SIDE as usize, texels.chunks_exact(2 * SIDE as usize));
    let eye = |first: usize| rows.clone().flat_map(move |row| &row[first..first + side]);
    Ok((eye(0).chain(eye(side)).copied().collect(), least))
}

/// A way with what it draws into.
struct Trial {
    way: Submission,
    pipeline: wgpu::RenderPipeline,
    layers: u32,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Trial {
    fn new(gpu: &Gpu, way: Submission) -> Self {
        let (shader, vertex) = match way {
            Submission::Mono | Submission::TwoPass { .. } => (shader::STEREO_TRIAL, "eye_alone"),
            Submission::Instanced { clips: false } => (shader::STEREO_TRIAL, "eyes_beside"),
            Submission::Instanced { clips: true } => {
                (shader::STEREO_TRIAL.variant(&["CLIPPED"]), "eyes_clipped")
            }
            Submission::Multiview => (shader::STEREO_TRIAL.variant(&["LAYERED"]), "eyes_layered"),
        };
        let beside = matches!(way, Submission::Instanced { .. });
        let (size, layers) = if beside {
            ((2 * SIDE, SIDE), 1)
        } else {
            ((SIDE, SIDE), 2)
        };
        let none = wgpu::TextureUsages::empty();
        let target = |format| layered_target(gpu, "stereo trial", size, layers, format, none);
        Self {
            way,
            pipeline: pipeline(gpu, way, shader, vertex),
            layers,
            color: target(COLOR),
            depth: target(DEPTH),
        }
    }

    /// Submits all draws, for both eyes.
    fn submit(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        if matches!(self.way, Submission::TwoPass { .. }) {
            for eye in 0..2 {
                let layer = |view: &wgpu::TextureView| gpu::layer_of(view, eye);
                let (color, depth) = (layer(&self.color), layer(&self.depth));
                self.pass(&mut encoder, &color, &depth, super::Drawn::ForEye(eye));
            }
        } else {
            for &drawn in self.way.drawn() {
                self.pass(&mut encoder, &self.color, &self.depth, drawn);
            }
        }
        gpu.queue.submit([encoder.finish()]);
    }

    fn pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        color: &wgpu::TextureView,
        depth: &wgpu::TextureView,
        drawn: super::Drawn,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("stereo trial"),
            color_attachments: &[crate::recorder::overwritten(color)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            multiview_mask: self.way.multiview_mask(),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        for draw in 0..DRAWS {
            pass.draw(0..VERTICES, drawn.range(draw, 1));
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    way: Submission,
    shader: shader::Shader,
    vertex: &str,
) -> wgpu::RenderPipeline {
    let module = shader::module(gpu, "stereo trial", shader);
    gpu.render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("stereo trial"),
        layout: Some(&gpu.pipeline_layout("stereo trial", &[])),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("number"),
            compilation_options: Default::default(),
            targets: &[Some(COLOR.into())],
        }),
        multiview_mask: way.multiview_mask(),
        cache: None,
    })
}
