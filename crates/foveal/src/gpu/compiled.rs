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

/// Beyond this number what was asked for longest ago is forgotten: constants come from settings,
/// which may take any value.
const MOST: usize = 256;

/// Counts requests, so that what was made since a moment can be told.
static REQUESTS: AtomicU64 = AtomicU64::new(0);

/// A moment among requests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment(u64);

impl Moment {
    /// Before all requests.
    pub(super) const FIRST: Self = Self(0);

    pub(crate) fn now() -> Self {
        Self(REQUESTS.load(Ordering::Relaxed))
    }
}

/// Two threads that ask for the same thing at once make it once.
#[derive(Debug)]
struct Place<V> {
    /// The last request for it.
    asked: u64,
    /// With the number of requests when its making began.
    thing: Arc<OnceLock<(u64, V)>>,
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
                let oldest = places.values().map(|place| place.asked).min();
                places.retain(|_, place| Some(place.asked) != oldest);
            }
            let request = REQUESTS.fetch_add(1, Ordering::Relaxed);
            let place = places.entry(key).or_insert_with(|| Place {
                asked: request,
                thing: Arc::default(),
            });
            place.asked = request;
            Arc::clone(&place.thing)
        };
        let made = || {
            let number = REQUESTS.fetch_add(1, Ordering::Relaxed);
            (number, make())
        };
        place.get_or_init(made).1.clone()
    }

    fn forget(&self, since: Moment) {
        (self.0.lock())
            .unwrap_or_else(PoisonError::into_inner)
            .retain(|_, place| place.thing.get().is_none_or(|made| made.0 < since.0));
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        self.0.lock().expect("no test panicked").len()
    }
}

/// A shader's file, and the names that its variant defines.
pub(crate) type ShaderName = (&'static str, &'static [&'static str]);

#[derive(Default)]
pub(super) struct Compiled {
    group_layouts: Shelf<(String, Vec<wgpu::BindGroupLayoutEntry>), wgpu::BindGroupLayout>,
    layouts: Shelf<(String, Vec<wgpu::BindGroupLayout>), wgpu::PipelineLayout>,
    modules: Shelf<(String, ShaderName), wgpu::ShaderModule>,
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

impl ComputeKey {
    fn new(wanted: &wgpu::ComputePipelineDescriptor<'_>) -> Self {
        Self {
            label: wanted.label.map(str::to_owned),
            layout: wanted.layout.cloned(),
            stage: Stage::new(
                wanted.module,
                wanted.entry_point,
                &wanted.compilation_options,
            ),
        }
    }
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

impl std::fmt::Debug for Compiled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Compiled").finish_non_exhaustive()
    }
}

impl Compiled {
    /// Forgets what was made since then.
    pub(super) fn forget(&self, since: Moment) {
        self.group_layouts.forget(since);
        self.layouts.forget(since);
        self.modules.forget(since);
        self.compute.forget(since);
        self.render.forget(since);
    }

    pub(super) fn group_layout(
        &self,
        label: &str,
        entries: &[wgpu::BindGroupLayoutEntry],
        make: impl FnOnce() -> wgpu::BindGroupLayout,
    ) -> wgpu::BindGroupLayout {
        let key = (label.to_owned(), entries.to_vec());
        self.group_layouts.take(key, make)
    }

    pub(super) fn layout(
        &self,
        label: &str,
        groups: &[&wgpu::BindGroupLayout],
        make: impl FnOnce() -> wgpu::PipelineLayout,
    ) -> wgpu::PipelineLayout {
        let groups = groups.iter().map(|&g| g.clone()).collect();
        self.layouts.take((label.to_owned(), groups), make)
    }

    pub(super) fn module(
        &self,
        label: &str,
        name: ShaderName,
        make: impl FnOnce() -> wgpu::ShaderModule,
    ) -> wgpu::ShaderModule {
        self.modules.take((label.to_owned(), name), make)
    }

    pub(super) fn compute(
        &self,
        wanted: &wgpu::ComputePipelineDescriptor<'_>,
        make: impl FnOnce() -> wgpu::ComputePipeline,
    ) -> wgpu::ComputePipeline {
        self.compute.take(ComputeKey::new(wanted), make)
    }

    pub(super) fn render(
        &self,
        wanted: &wgpu::RenderPipelineDescriptor<'_>,
        make: impl FnOnce() -> wgpu::RenderPipeline,
    ) -> wgpu::RenderPipeline {
        self.render.take(Box::new(RenderKey::new(wanted)), make)
    }

    /// How many things of each kind are kept.
    #[cfg(test)]
    pub(super) fn sizes(&self) -> [usize; 5] {
        [
            self.group_layouts.len(),
            self.layouts.len(),
            self.modules.len(),
            self.compute.len(),
            self.render.len(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(shelf.len(), MOST - 1);
    }
}
