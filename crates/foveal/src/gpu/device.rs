//! An open graphics device.

use super::compiled::{Compiled, Moment, ShaderName};
use crate::{AdapterStats, Error};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

#[cfg(test)]
pub(super) use super::faults::{Device, Queue};
#[cfg(not(test))]
pub(super) type Device = wgpu::Device;
#[cfg(not(test))]
pub(super) type Queue = wgpu::Queue;

/// An open graphics device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    /// Its queue.
    pub queue: Queue,
    lost: Arc<Mutex<Option<String>>>,
    /// An error that no scope caught.
    stray: Arc<Mutex<Option<String>>>,
    pub(super) compiled: Arc<Compiled>,
}

/// Sampled textures of a stage where tables are among them: more than the web's default. A host's
/// device that offers fewer has its tables in buffers.
const TEXTURES_WITH_TABLES: u32 = 20;

/// Limits of an adapter, as far as the renderer uses them. The full renderer's shaders cannot be
/// written in OpenGL's language, whatever the driver offers: there, the reduced renderer draws.
fn usable_limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
    let mut limits = adapter.limits();
    if adapter.get_info().backend == wgpu::Backend::Gl {
        limits.max_storage_buffers_per_shader_stage = 0;
        limits.max_storage_buffer_binding_size = 0;
    }
    limits
}

/// Without storage buffers there is nothing that the full renderer could do.
pub(crate) fn is_reduced(limits: &wgpu::Limits) -> bool {
    limits.max_storage_buffers_per_shader_stage == 0
}

fn note(lost: &Mutex<Option<String>>, reason: String) {
    if let Ok(mut slot) = lost.lock() {
        *slot = Some(reason);
    }
}

impl Gpu {
    /// Opens the adapter whose name, driver or backend contains `wanted` (case-insensitive), or
    /// whose number in [`Gpu::adapters`] it is; without `wanted`, the most capable one.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] and [`Error::NoDevice`].
    pub async fn open(wanted: Option<&str>) -> Result<Self, Error> {
        Self::from_adapter(&super::adapter::choose(wanted).await?).await
    }

    /// Opens a device of the host's adapter, with what [`Gpu::wanted_features`] and
    /// [`Gpu::wanted_limits`] say. Of an adapter that has OpenGL alone it is a device of the reduced
    /// renderer ([`Gpu::reduced_limits`]).
    ///
    /// # Errors
    /// [`Error::NoDevice`].
    pub async fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, Error> {
        let limits = usable_limits(adapter);
        let features = if is_reduced(&limits) {
            wgpu::Features::empty()
        } else {
            Self::wanted_features() & adapter.features()
        };
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("foveal"),
                required_features: features,
                required_limits: Self::wanted_limits(&limits),
                ..Default::default()
            })
            .await
            .map_err(|source| Error::NoDevice {
                adapter: adapter.get_info().name,
                source,
            })?;
        let gpu = Self::from_device(device, queue);
        // Not the device itself, which would never end while its own callback holds it.
        let lost = Arc::clone(&gpu.lost);
        gpu.device
            .set_device_lost_callback(move |reason, message| match message.as_str() {
                "" => note(&lost, format!("{reason:?}")),
                message => note(&lost, message.to_owned()),
            });
        // Without a handler wgpu panics.
        let stray = Arc::clone(&gpu.stray);
        gpu.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                note(&stray, error.to_string());
            }));
        Ok(gpu)
    }

    /// Takes the host's device and leaves all that is the host's alone: its error handler, its
    /// device-lost callback, its other submissions. The device must offer [`Gpu::required_limits`];
    /// a callback of the host's that hears of its loss should call [`Gpu::note_loss`].
    #[must_use]
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        #[cfg(test)]
        let device = Device::new(device, &Default::default());
        #[cfg(test)]
        let queue = Queue::new(queue, &device);
        Self {
            device,
            queue,
            lost: Arc::new(Mutex::new(None)),
            stray: Arc::new(Mutex::new(None)),
            compiled: Arc::default(),
        }
    }

    /// An error of this device that no scope caught, if there was one since the last question.
    pub(super) fn take_stray(&self) -> Option<String> {
        self.stray.lock().ok()?.take()
    }

    /// Takes down that the device is gone: from now on the renderer answers with
    /// [`Error::DeviceLost`].
    pub fn note_loss(&self, reason: impl Into<String>) {
        note(&self.lost, reason.into());
    }

    /// The limits that every device must offer; no feature is required.
    #[must_use]
    pub fn required_limits() -> wgpu::Limits {
        wgpu::Limits::default()
    }

    /// The limits that suffice for the reduced renderer, which needs neither storage buffers nor
    /// compute shaders: what WebGL 2 has. It draws every pixel, of one eye or two, culled or not;
    /// [`Settings::validate`](crate::Settings::validate) refuses all else.
    #[must_use]
    pub fn reduced_limits() -> wgpu::Limits {
        wgpu::Limits::downlevel_webgl2_defaults()
    }

    /// Whether the device has only what [`Gpu::reduced_limits`] say.
    #[must_use]
    pub fn is_reduced(&self) -> bool {
        is_reduced(&self.device.limits())
    }

    /// Whether the device keeps textures in blocks ([`foveal_scene::Encoding`]) as they are. Where
    /// not, they are decoded on the way to it and take as much memory as plain ones.
    #[must_use]
    pub fn reads_blocks(&self) -> bool {
        let blocks = wgpu::Features::TEXTURE_COMPRESSION_BC;
        self.device.features().contains(blocks)
    }

    /// Whether passes tell how long they took.
    pub(crate) fn tells_times(&self) -> bool {
        let features = self.device.features();
        cfg!(feature = "profiler") && features.contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// [`Error::Limit`] for the first of [`Gpu::required_limits`] that the device does not offer.
    pub(crate) fn check_limits(&self) -> Result<(), Error> {
        let mut missing = Ok(());
        let offered = self.device.limits();
        let required = if self.is_reduced() {
            Self::reduced_limits()
        } else {
            Self::required_limits()
        };
        required.check_limits_with_fail_fn(&offered, true, |name, value, limit| {
            missing = Err(Error::Limit {
                what: format!("the device limit {name} that the renderer needs"),
                value,
                limit,
                hint: ": open the device with Gpu::required_limits".to_owned(),
            });
        });
        missing
    }

    /// Features that the renderer uses where they are there; none is required.
    #[must_use]
    pub fn wanted_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY
            | wgpu::Features::PRIMITIVE_INDEX
            | wgpu::Features::CLIP_DISTANCES
            | wgpu::Features::MULTIVIEW
            | wgpu::Features::SUBGROUP
            | wgpu::Features::TEXTURE_COMPRESSION_BC
    }

    /// The limits that the renderer asks for: the web's defaults, the adapter's own sizes, and where it
    /// has them a few more textures.
    #[must_use]
    pub fn wanted_limits(adapter: &wgpu::Limits) -> wgpu::Limits {
        let least = if is_reduced(adapter) {
            Self::reduced_limits()
        } else {
            Self::required_limits()
        };
        wgpu::Limits {
            max_texture_dimension_2d: adapter.max_texture_dimension_2d,
            max_sampled_textures_per_shader_stage: (adapter.max_sampled_textures_per_shader_stage)
                .min(TEXTURES_WITH_TABLES)
                .max(least.max_sampled_textures_per_shader_stage),
            max_multiview_view_count: adapter.max_multiview_view_count.min(2),
            max_buffer_size: adapter.max_buffer_size,
            max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
            ..least
        }
    }

    /// All adapters of this machine, in the order in which numbers choose them.
    pub async fn adapters() -> Vec<AdapterStats> {
        super::adapter::all()
            .await
            .iter()
            .map(|a| super::adapter::describe(&a.get_info()))
            .collect()
    }

    /// What this device is.
    #[must_use]
    pub fn adapter_stats(&self) -> AdapterStats {
        super::adapter::describe(&self.device.adapter_info())
    }

    /// Whether the device is Mesa's processor, which Vulkan names as its driver and OpenGL as its
    /// adapter.
    pub(crate) fn is_lavapipe(&self) -> bool {
        let AdapterStats { name, driver, .. } = self.adapter_stats();
        driver.starts_with("llvmpipe") || name.starts_with("llvmpipe")
    }

    /// Whether the device is a graphics card of its own.
    pub(crate) fn is_discrete(&self) -> bool {
        self.device.adapter_info().device_type == wgpu::DeviceType::DiscreteGpu
    }

    /// Whether tables are textures (`gpu/table.rs`).
    pub(crate) fn has_texture_tables(&self) -> bool {
        let most = self.device.limits().max_sampled_textures_per_shader_stage;
        self.is_reduced() || most >= TEXTURES_WITH_TABLES && self.is_lavapipe()
    }

    /// Whether fragment shaders get their triangle's number from the device. Not on lavapipe, where its
    /// tables are textures: fetching vertices in the shader takes less time there.
    pub(crate) fn numbers_triangles(&self) -> bool {
        let numbered = wgpu::Features::PRIMITIVE_INDEX;
        self.device.features().contains(numbered) && !self.has_texture_tables()
    }

    /// Whether a pass can draw to two layers at once; what comes of it is for a trial to find out.
    pub(crate) fn has_multiview(&self) -> bool {
        !self.is_reduced()
            && self.device.features().contains(wgpu::Features::MULTIVIEW)
            && self.device.limits().max_multiview_view_count >= 2
    }

    /// Drives the device, and calls back those who wait for it.
    ///
    /// wgpu panics where the driver reports a loss while it is asked; the device is gone then.
    pub(crate) fn poll(&self, how: wgpu::PollType) -> Result<(), Error> {
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(how)));
        let reason = match polled {
            Ok(Ok(_)) => return Ok(()),
            Ok(Err(cause)) => cause.to_string(),
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or_else(|| panic.downcast_ref().copied());
                let reason = text.unwrap_or("the driver failed").to_owned();
                self.note_loss(reason.as_str());
                reason
            }
        };
        Err(Error::DeviceLost { reason })
    }

    /// [`Error::DeviceLost`] once the device is gone.
    pub(crate) fn check_alive(&self) -> Result<(), Error> {
        match self.lost.lock() {
            Ok(slot) => match slot.as_ref() {
                Some(reason) => Err(Error::DeviceLost {
                    reason: reason.clone(),
                }),
                None => Ok(()),
            },
            Err(_) => Ok(()),
        }
    }
}

// What is compiled once.
impl Gpu {
    /// Forgets what was compiled since then: something that could not be made may be among it.
    pub(super) fn forget_compiled(&self, since: Moment) {
        self.compiled.forget(since);
    }

    /// Lets go of compiled pipelines; renderers keep theirs. A device keeps some hundreds of the last
    /// ones, so that settings that come back and further renderers need not compile them again.
    pub fn trim(&self) {
        self.compiled.forget(Moment::FIRST);
    }

    pub(crate) fn bind_group_layout(
        &self,
        label: &str,
        entries: &[wgpu::BindGroupLayoutEntry],
    ) -> wgpu::BindGroupLayout {
        let wanted = wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries,
        };
        let make = || self.device.create_bind_group_layout(&wanted);
        self.compiled.group_layout(label, entries, make)
    }

    /// The layout of a pipeline whose bind groups are `groups` in order.
    pub(crate) fn pipeline_layout(
        &self,
        label: &str,
        groups: &[&wgpu::BindGroupLayout],
    ) -> wgpu::PipelineLayout {
        self.compiled.layout(label, groups, || {
            let groups: Vec<_> = groups.iter().map(|&g| Some(g)).collect();
            self.device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(label),
                    bind_group_layouts: &groups,
                    immediate_size: 0,
                })
        })
    }

    /// The module of a shader with this source.
    pub(crate) fn module(
        &self,
        label: &str,
        name: ShaderName,
        source: impl FnOnce() -> String,
    ) -> wgpu::ShaderModule {
        self.compiled.module(label, name, || {
            self.device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source: wgpu::ShaderSource::Wgsl(source().into()),
                })
        })
    }

    pub(crate) fn compute_pipeline(
        &self,
        wanted: &wgpu::ComputePipelineDescriptor<'_>,
    ) -> wgpu::ComputePipeline {
        let make = || self.device.create_compute_pipeline(wanted);
        self.compiled.compute(wanted, make)
    }

    pub(crate) fn render_pipeline(
        &self,
        wanted: &wgpu::RenderPipelineDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        let make = || self.device.create_render_pipeline(wanted);
        self.compiled.render(wanted, make)
    }
}
