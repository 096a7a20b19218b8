//! A device and a queue that fail when a test says so: the nth creation, upload or submission is
//! refused, or the device is lost at it.
//!
//! In tests they stand in for wgpu's own: their calls hide those of the same names, so that no stage
//! knows of them.
#![allow(unreachable_pub, reason = "types of public fields, in tests alone")]

use std::ops::Deref;
use std::sync::{Arc, Mutex};

/// What becomes of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// There is no memory for it.
    OutOfMemory,
    /// The graphics interface finds it invalid.
    Invalid,
    /// The device is gone from here on.
    Lost,
    /// The driver has lost the device, and reports it when it is asked: wgpu panics then.
    LostByDriver,
}

/// Which call fails.
#[derive(Debug, Default)]
pub struct Plan {
    /// Creations, uploads and submissions since the last [`Plan::arm`].
    calls: u64,
    /// Polls since then that waited for the device.
    waits: u64,
    at: Option<(u64, Fault)>,
    has_struck: bool,
    /// The driver has lost the device.
    is_lost: bool,
    /// Out of memory, and no error scope has told of it.
    out_of_memory: bool,
}

/// The plan of a device and its queue.
#[derive(Clone, Debug, Default)]
pub struct Faults(Arc<Mutex<Plan>>);

impl Faults {
    /// The `at`th call from now on, counted from 0, fails.
    pub(crate) fn arm(&self, at: u64, fault: Fault) {
        *self.0.lock().expect("no test panicked") = Plan {
            at: Some((at, fault)),
            ..Plan::default()
        };
    }

    /// All calls are good again; whether one has failed since [`Faults::arm`].
    pub(crate) fn disarm(&self) -> bool {
        let plan = std::mem::take(&mut *self.0.lock().expect("no test panicked"));
        plan.has_struck
    }

    /// Calls since [`Faults::arm`] or [`Faults::disarm`].
    pub(crate) fn calls(&self) -> u64 {
        self.0.lock().expect("no test panicked").calls
    }

    /// Polls that waited for the device, since [`Faults::arm`] or [`Faults::disarm`].
    pub(crate) fn waits(&self) -> u64 {
        self.0.lock().expect("no test panicked").waits
    }

    /// Whether memory has run out since the last question.
    pub(crate) fn take_out_of_memory(&self) -> bool {
        let mut plan = self.0.lock().expect("no test panicked");
        std::mem::take(&mut plan.out_of_memory)
    }

    /// What becomes of this call.
    fn next(&self) -> Option<Fault> {
        let mut plan = self.0.lock().expect("no test panicked");
        let call = plan.calls;
        plan.calls += 1;
        let fault = plan.at.filter(|(at, _)| *at == call)?.1;
        plan.has_struck = true;
        plan.out_of_memory |= fault == Fault::OutOfMemory;
        plan.is_lost |= fault == Fault::LostByDriver;
        Some(fault)
    }
}

/// A device whose creations may fail.
#[derive(Clone, Debug)]
pub struct Device {
    device: wgpu::Device,
    pub(crate) faults: Faults,
}

impl Deref for Device {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}

impl Device {
    pub(super) fn new(device: wgpu::Device, faults: &Faults) -> Self {
        let faults = faults.clone();
        Self { device, faults }
    }

    /// Whether this call is given something invalid in place of what it was asked for.
    fn fails(&self) -> bool {
        match self.faults.next() {
            None | Some(Fault::LostByDriver) => false,
            Some(Fault::Lost) => {
                self.device.destroy();
                false
            }
            Some(Fault::OutOfMemory | Fault::Invalid) => true,
        }
    }

    pub(crate) fn poll(&self, how: wgpu::PollType) -> Result<wgpu::PollStatus, wgpu::PollError> {
        let is_lost = {
            let mut plan = self.faults.0.lock().expect("no test panicked");
            plan.waits += u64::from(how.is_wait());
            plan.is_lost
        };
        assert!(!is_lost, "Error in Device::poll: the device is lost");
        self.device.poll(how)
    }

    pub(crate) fn create_buffer(&self, wanted: &wgpu::BufferDescriptor<'_>) -> wgpu::Buffer {
        if !self.fails() {
            return self.device.create_buffer(wanted);
        }
        let usage = wanted.usage | wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
        let invalid = wgpu::BufferDescriptor {
            usage,
            ..wanted.clone()
        };
        self.device.create_buffer(&invalid)
    }

    pub(crate) fn create_texture(&self, wanted: &wgpu::TextureDescriptor<'_>) -> wgpu::Texture {
        if !self.fails() {
            return self.device.create_texture(wanted);
        }
        let invalid = wgpu::TextureDescriptor {
            sample_count: 3,
            ..wanted.clone()
        };
        self.device.create_texture(&invalid)
    }

    pub(crate) fn create_sampler(&self, wanted: &wgpu::SamplerDescriptor<'_>) -> wgpu::Sampler {
        if !self.fails() {
            return self.device.create_sampler(wanted);
        }
        let invalid = wgpu::SamplerDescriptor {
            lod_min_clamp: -1.0,
            ..wanted.clone()
        };
        self.device.create_sampler(&invalid)
    }

    pub(crate) fn create_shader_module(
        &self,
        wanted: wgpu::ShaderModuleDescriptor<'_>,
    ) -> wgpu::ShaderModule {
        if !self.fails() {
            return self.device.create_shader_module(wanted);
        }
        let invalid = wgpu::ShaderModuleDescriptor {
            label: wanted.label,
            source: wgpu::ShaderSource::Wgsl("no shader".into()),
        };
        self.device.create_shader_module(invalid)
    }

    pub(crate) fn create_bind_group_layout(
        &self,
        wanted: &wgpu::BindGroupLayoutDescriptor<'_>,
    ) -> wgpu::BindGroupLayout {
        if !self.fails() {
            return self.device.create_bind_group_layout(wanted);
        }
        let entries = [wanted.entries, wanted.entries].concat();
        let invalid = wgpu::BindGroupLayoutDescriptor {
            label: wanted.label,
            entries: &entries,
        };
        self.device.create_bind_group_layout(&invalid)
    }

    pub(crate) fn create_bind_group(
        &self,
        wanted: &wgpu::BindGroupDescriptor<'_>,
    ) -> wgpu::BindGroup {
        if !self.fails() {
            return self.device.create_bind_group(wanted);
        }
        let invalid = wgpu::BindGroupDescriptor {
            entries: &wanted.entries[1..],
            ..wanted.clone()
        };
        self.device.create_bind_group(&invalid)
    }

    pub(crate) fn create_render_pipeline(
        &self,
        wanted: &wgpu::RenderPipelineDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        if !self.fails() {
            return self.device.create_render_pipeline(wanted);
        }
        let mut invalid = wanted.clone();
        invalid.vertex.entry_point = Some("no entry point");
        self.device.create_render_pipeline(&invalid)
    }

    pub(crate) fn create_compute_pipeline(
        &self,
        wanted: &wgpu::ComputePipelineDescriptor<'_>,
    ) -> wgpu::ComputePipeline {
        if !self.fails() {
            return self.device.create_compute_pipeline(wanted);
        }
        let mut invalid = wanted.clone();
        invalid.entry_point = Some("no entry point");
        self.device.create_compute_pipeline(&invalid)
    }
}

/// A queue whose uploads and submissions may fail.
#[derive(Clone, Debug)]
pub struct Queue {
    queue: wgpu::Queue,
    device: Device,
}

impl Deref for Queue {
    type Target = wgpu::Queue;

    fn deref(&self) -> &wgpu::Queue {
        &self.queue
    }
}

impl Queue {
    pub(super) fn new(queue: wgpu::Queue, device: &Device) -> Self {
        let device = device.clone();
        Self { queue, device }
    }

    pub(crate) fn submit(
        &self,
        commands: impl IntoIterator<Item = wgpu::CommandBuffer>,
    ) -> wgpu::SubmissionIndex {
        if !self.device.fails() {
            return self.queue.submit(commands);
        }
        // Commands that were refused are not executed.
        drop(commands);
        self.refuse();
        self.queue.submit([])
    }

    pub(crate) fn write_buffer(&self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        if self.device.fails() {
            self.refuse();
        } else {
            self.queue.write_buffer(buffer, offset, bytes);
        }
    }

    pub(crate) fn write_texture(
        &self,
        texture: wgpu::TexelCopyTextureInfo<'_>,
        bytes: &[u8],
        layout: wgpu::TexelCopyBufferLayout,
        size: wgpu::Extent3d,
    ) {
        if self.device.fails() {
            self.refuse();
        } else {
            self.queue.write_texture(texture, bytes, layout, size);
        }
    }

    /// Reports an error.
    fn refuse(&self) {
        let nothing = wgpu::BufferDescriptor {
            label: Some("refused"),
            size: 4,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE,
            mapped_at_creation: false,
        };
        drop(self.device.device.create_buffer(&nothing));
    }
}
