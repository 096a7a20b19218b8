//! What a device has compiled, for whoever asks for the same again.
//!
//! A driver takes hundredths of a second to compile a pipeline, and whole seconds where it draws on
//! the processor. A second renderer of a device, settings that come back and a scene that is set
//! again therefore take layouts, modules and pipelines that are there. A request is the same where
//! all that a descriptor says is equal, labels included.

use std::collections::HashMap;
use std::hash::Hash;
use std::num::NonZeroU32;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::Gpu;
use crate::shader::Shader;

/// Beyond this number what was asked for longest ago is forgotten: constants come from settings,
/// which may take any value.
const MOST: usize = 256;

/// Counts requests, so that what was made since a moment can be told.
static REQUESTS: AtomicU64 = AtomicU64::new(0);

/// A moment among requests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment(u64);

impl Moment {
    pub(crate) fn now() -> Self {
        Self(REQUESTS.load(Ordering::Relaxed))
    }
}

/// Two threads that ask for the same thing at once make it once.
#[derive(Debug)]
struct Place<V> {
    /// The first and the last request for it.
    asked: [u64; 2],
    thing: Arc<OnceLock<V>>,
}

/// Things by what they were asked for as.
#[derive(Debug)]
struct Shelf<K, V>(Mutex<HashMap<K, Place<V>>>);

impl<K, V> Default for Shelf<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Hash + Eq, V: Clone> Shelf<K, V> {
    fn take(&self, key: K, make: impl FnOnce() -> V) -> V {
        let place = {
            let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if places.len() >= MOST && !places.contains_key(&key) {
                let oldest = places.values().map(|place| place.asked[1]).min();
                places.retain(|_, place| Some(place.asked[1]) != oldest);
            }
            let request = REQUESTS.fetch_add(1, Ordering::Relaxed);
            let place = places.entry(key).or_insert_with(|| Place {
                asked: [request; 2],
                thing: Arc::default(),
            });
            place.asked[1] = request;
            Arc::clone(&place.thing)
        };
        place.get_or_init(make).clone()
    }

    fn forget(&self, since: Moment) {
        (self.0.lock())
            .unwrap_or_else(PoisonError::into_inner)
            .retain(|_, place| place.asked[0] < since.0);
    }
}

#[derive(Debug, Default)]
pub(super) struct Compiled {
    group_layouts: Shelf<(String, Vec<wgpu::BindGroupLayoutEntry>), wgpu::BindGroupLayout>,
    layouts: Shelf<(String, Vec<wgpu::BindGroupLayout>), wgpu::PipelineLayout>,
    modules: Shelf<(String, Shader), wgpu::ShaderModule>,
    compute: Shelf<ComputeKey, wgpu::ComputePipeline>,
    render: Shelf<Box<RenderKey>, wgpu::RenderPipeline>,
}

/// An entry point of a module with its overrides.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Stage {
    module: wgpu::ShaderModule,
    entry_point: Option<String>,
    /// Names and the bits of values.
    constants: Vec<(String, u64)>,
    zeroes_memory: bool,
}

impl Stage {
    fn new(
        module: &wgpu::ShaderModule,
        entry_point: Option<&str>,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> Self {
        let constants = options.constants.iter();
        Self {
            module: module.clone(),
            entry_point: entry_point.map(str::to_owned),
            constants: (constants.map(|&(name, value)| (name.to_owned(), value.to_bits())))
                .collect(),
            zeroes_memory: options.zero_initialize_workgroup_memory,
        }
    }
}

#[derive(Debug, PartialEq, Eq, Hash)]
struct ComputeKey {
    label: Option<String>,
    layout: Option<wgpu::PipelineLayout>,
    stage: Stage,
}

type BufferKey = (u64, wgpu::VertexStepMode, Vec<wgpu::VertexAttribute>);

#[derive(Debug, PartialEq, Eq, Hash)]
struct RenderKey {
    label: Option<String>,
    layout: Option<wgpu::PipelineLayout>,
    vertex: Stage,
    buffers: Vec<Option<BufferKey>>,
    primitive: wgpu::PrimitiveState,
    depth_stencil: Option<wgpu::DepthStencilState>,
    multisample: wgpu::MultisampleState,
    fragment: Option<(Stage, Vec<Option<wgpu::ColorTargetState>>)>,
    multiview_mask: Option<NonZeroU32>,
}

impl RenderKey {
    fn new(wanted: &wgpu::RenderPipelineDescriptor<'_>) -> Self {
        let vertex = &wanted.vertex;
        let buffers = vertex.buffers.iter().map(|buffer| {
            let buffer = buffer.as_ref()?;
            let attributes = buffer.attributes.to_vec();
            Some((buffer.array_stride, buffer.step_mode, attributes))
        });
        let fragment = wanted.fragment.as_ref().map(|f| {
            let stage = Stage::new(f.module, f.entry_point, &f.compilation_options);
            (stage, f.targets.to_vec())
        });
        Self {
            label: wanted.label.map(str::to_owned),
            layout: wanted.layout.cloned(),
            vertex: Stage::new(
                vertex.module,
                vertex.entry_point,
                &vertex.compilation_options,
            ),
            buffers: buffers.collect(),
            primitive: wanted.primitive,
            depth_stencil: wanted.depth_stencil.clone(),
            multisample: wanted.multisample,
            fragment,
            multiview_mask: wanted.multiview_mask,
        }
    }
}

impl Gpu {
    /// Forgets what was compiled since then: something that could not be made may be among it.
    pub(crate) fn forget_compiled(&self, since: Moment) {
        let compiled = &self.compiled;
        compiled.group_layouts.forget(since);
        compiled.layouts.forget(since);
        compiled.modules.forget(since);
        compiled.compute.forget(since);
        compiled.render.forget(since);
    }

    /// Lets go of compiled pipelines that no renderer uses. A device keeps some hundreds of the last
    /// ones, so that settings that come back and further renderers need not compile them again.
    pub fn trim(&self) {
        self.forget_compiled(Moment(0));
    }

    pub(crate) fn bind_group_layout(
        &self,
        label: &str,
        entries: &[wgpu::BindGroupLayoutEntry],
    ) -> wgpu::BindGroupLayout {
        let key = (label.to_owned(), entries.to_vec());
        self.compiled.group_layouts.take(key, || {
            self.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries,
                })
        })
    }

    /// The layout of a pipeline whose bind groups are `groups` in order.
    pub(crate) fn pipeline_layout(
        &self,
        label: &str,
        groups: &[&wgpu::BindGroupLayout],
    ) -> wgpu::PipelineLayout {
        let key = (
            label.to_owned(),
            groups.iter().map(|&g| g.clone()).collect(),
        );
        self.compiled.layouts.take(key, || {
            let groups: Vec<_> = groups.iter().map(|&g| Some(g)).collect();
            self.device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(label),
                    bind_group_layouts: &groups,
                    immediate_size: 0,
                })
        })
    }

    /// A shader's module.
    pub(crate) fn module(&self, label: &str, shader: Shader) -> wgpu::ShaderModule {
        self.compiled.modules.take((label.to_owned(), shader), || {
            self.device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source: wgpu::ShaderSource::Wgsl(
                        shader.source(self.has_texture_tables()).into(),
                    ),
                })
        })
    }

    pub(crate) fn compute_pipeline(
        &self,
        wanted: &wgpu::ComputePipelineDescriptor<'_>,
    ) -> wgpu::ComputePipeline {
        let key = ComputeKey {
            label: wanted.label.map(str::to_owned),
            layout: wanted.layout.cloned(),
            stage: Stage::new(
                wanted.module,
                wanted.entry_point,
                &wanted.compilation_options,
            ),
        };
        let make = || self.device.create_compute_pipeline(wanted);
        self.compiled.compute.take(key, make)
    }

    pub(crate) fn render_pipeline(
        &self,
        wanted: &wgpu::RenderPipelineDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        let key = Box::new(RenderKey::new(wanted));
        let make = || self.device.create_render_pipeline(wanted);
        self.compiled.render.take(key, make)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{picture, rendered_on, small};
    use crate::{Shading, Shadows};

    #[test]
    fn a_second_renderer_compiles_nothing_and_draws_the_same() {
        let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
        let scene = foveal_generate::by_name("alpha").expect("it is generated");
        let settings = small(48, 32).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.lighting.shadows = Shadows::Soft;
            s.lighting.shadow_atlas = 256;
        });
        let draw = || rendered_on(&gpu, &scene, &scene.cameras[0], &settings);
        let first = picture(&draw());
        let made = sizes(&gpu.compiled);
        assert!(made.iter().all(|&n| n > 5), "{made:?}");
        assert!(picture(&draw()) == first);
        assert_eq!(sizes(&gpu.compiled), made);
        gpu.trim();
        assert_eq!(sizes(&gpu.compiled), [0; 5]);
        assert!(picture(&draw()) == first);
        assert_eq!(sizes(&gpu.compiled), made);
    }

    fn sizes(compiled: &Compiled) -> [usize; 5] {
        fn size<K, V>(shelf: &Shelf<K, V>) -> usize {
            shelf.0.lock().expect("no test panicked").len()
        }
        [
            size(&compiled.group_layouts),
            size(&compiled.layouts),
            size(&compiled.modules),
            size(&compiled.compute),
            size(&compiled.render),
        ]
    }

    #[test]
    fn a_full_shelf_forgets_what_was_asked_for_longest_ago() {
        let shelf = Shelf::default();
        for key in 0..MOST {
            assert_eq!(shelf.take(key, || key + 1), key + 1);
        }
        assert_eq!(shelf.take(3, || unreachable!("it is there")), 4);
        let moment = Moment::now();
        assert_eq!(shelf.take(MOST, || 0), 0);
        assert_eq!(shelf.take(MOST, || unreachable!("it is there")), 0);
        assert_eq!(shelf.take(3, || unreachable!("it is newer than others")), 4);
        assert_eq!(shelf.take(0, || 7), 7);
        shelf.forget(moment);
        assert_eq!(shelf.take(MOST, || 2), 2);
        assert_eq!(shelf.take(3, || unreachable!("it is older")), 4);
        assert_eq!(shelf.0.lock().expect("no test panicked").len(), MOST - 1);
    }
}
