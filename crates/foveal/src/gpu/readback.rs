//! From the device back to the caller.

use std::sync::{Arc, Mutex};
use std::task::{Poll, Waker};

use super::Gpu;
use crate::Error;

/// A value that a callback hands to a future.
pub(crate) struct Handover<T>(Arc<Mutex<(Option<T>, Option<Waker>)>>);

impl<T> Clone for Handover<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Handover<T> {
    fn new() -> Self {
        Self(Arc::new(Mutex::new((None, None))))
    }

    fn give(&self, value: T) {
        if let Ok(mut slot) = self.0.lock() {
            slot.0 = Some(value);
            if let Some(waker) = slot.1.take() {
                waker.wake();
            }
        }
    }

    /// The value, if it is there.
    pub(crate) fn take_now(&self) -> Option<T> {
        self.0.lock().ok()?.0.take()
    }

    /// Whether the value is there.
    pub(crate) fn is_given(&self) -> bool {
        self.0.lock().is_ok_and(|slot| slot.0.is_some())
    }

    /// Natively someone must drive the device; a browser does it by itself.
    pub(crate) async fn take(self, gpu: &Gpu) -> Result<T, Error> {
        #[cfg(not(target_arch = "wasm32"))]
        gpu.poll(wgpu::PollType::wait_indefinitely())?;
        gpu.check_alive()?;
        std::future::poll_fn(|context| match self.0.lock() {
            Ok(mut slot) => match slot.0.take() {
                Some(value) => Poll::Ready(Ok(value)),
                None => {
                    slot.1 = Some(context.waker().clone());
                    Poll::Pending
                }
            },
            Err(_) => Poll::Ready(Err(Error::DeviceLost {
                reason: "a callback of the driver panicked".to_owned(),
            })),
        })
        .await
    }
}

/// What `now` says when everything submitted so far is done.
pub(crate) fn work_done<T: Send + 'static>(
    gpu: &Gpu,
    now: impl FnOnce() -> T + Send + 'static,
) -> Handover<T> {
    let done = Handover::new();
    let given = done.clone();
    gpu.queue.on_submitted_work_done(move || given.give(now()));
    done
}

/// Begins to read mip 0 of a texture.
pub(crate) fn start_reading(gpu: &Gpu, texture: &wgpu::Texture) -> Reading {
    start_reading_level(gpu, texture, 0, (texture.width(), texture.height()))
}

/// The bytes of mip 0 of a texture, layer after layer, rows top to bottom without padding.
#[cfg(test)]
pub(crate) async fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, Error> {
    start_reading(gpu, texture).bytes(gpu).await
}

/// The bytes of the upper left `width` x `height` texels of a mip, layer after layer, rows top to
/// bottom without padding.
#[cfg(test)]
pub(crate) async fn read_level(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    mip_level: u32,
    size: (u32, u32),
) -> Result<Vec<u8>, Error> {
    let reading = start_reading_level(gpu, texture, mip_level, size);
    reading.bytes(gpu).await
}

fn start_reading_level(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    mip_level: u32,
    (width, height): (u32, u32),
) -> Reading {
    let bytes_per_texel = texture.format().block_copy_size(None).unwrap_or(4);
    let layers = texture.depth_or_array_layers();
    let row = width * bytes_per_texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = read_back_buffer(
        gpu,
        u64::from(padded) * u64::from(height) * u64::from(layers),
    );
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            mip_level,
            ..texture.as_image_copy()
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: Some(height),
            },
        },
        wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: layers,
        },
    );
    gpu.queue.submit([encoder.finish()]);
    let arriving = Arriving::of(buffer);
    arriving.submitted();
    Reading {
        arriving,
        padded: padded as usize,
        row: row as usize,
    }
}

/// A texture's texels on their way to the caller, who waits for them.
pub(crate) struct Reading {
    arriving: Arriving,
    /// Bytes of a row as they arrive, and of its texels.
    padded: usize,
    row: usize,
}

impl Reading {
    /// The bytes, layer after layer, rows top to bottom without padding.
    pub(crate) async fn bytes(self, gpu: &Gpu) -> Result<Vec<u8>, Error> {
        let bytes = self.arriving.bytes(gpu).await?;
        let rows = bytes.chunks_exact(self.padded);
        Ok(rows
            .flat_map(|padded_row| &padded_row[..self.row])
            .copied()
            .collect())
    }
}

/// The bytes of a buffer that can be copied from.
#[cfg(test)]
pub(crate) async fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, Error> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let arriving = Arriving::record(gpu, &mut encoder, buffer);
    gpu.queue.submit([encoder.finish()]);
    arriving.submitted();
    arriving.bytes(gpu).await
}

fn read_back_buffer(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A buffer's bytes on their way to the caller.
pub(crate) struct Arriving {
    copy: wgpu::Buffer,
    mapped: Handover<Result<(), wgpu::BufferAsyncError>>,
}

impl Arriving {
    /// Encodes the copy of a buffer that can be copied from.
    pub(crate) fn record(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
    ) -> Self {
        let copy = read_back_buffer(gpu, buffer.size());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        Self::of(copy)
    }

    fn of(copy: wgpu::Buffer) -> Self {
        Self {
            copy,
            mapped: Handover::new(),
        }
    }

    /// Call after the submission.
    pub(crate) fn submitted(&self) {
        let given = self.mapped.clone();
        let give = move |result| given.give(result);
        self.copy.map_async(wgpu::MapMode::Read, .., give);
    }

    /// Whether the bytes are there.
    pub(crate) fn is_there(&self) -> bool {
        self.mapped.is_given()
    }

    /// The bytes once they are there; empty where the copy failed.
    pub(crate) fn take(&self) -> Option<Vec<u8>> {
        let bytes = match self.mapped.take_now()? {
            Ok(()) => self.copy.get_mapped_range(..).map(|view| view.to_vec()),
            Err(_) => Ok(Vec::new()),
        };
        Some(bytes.unwrap_or_default())
    }

    /// Waits for the bytes.
    pub(crate) async fn bytes(self, gpu: &Gpu) -> Result<Vec<u8>, Error> {
        let failed = |cause: wgpu::BufferAsyncError| Error::Validation {
            doing: "reading back".to_owned(),
            cause: cause.to_string(),
        };
        let mapped = self.mapped.clone().take(gpu).await?;
        // A device that was lost meanwhile is the cause of all else.
        gpu.check_alive()?;
        mapped.map_err(failed)?;
        let view = self.copy.get_mapped_range(..);
        let view = view.map_err(|cause| Error::Validation {
            doing: "reading back".to_owned(),
            cause: cause.to_string(),
        })?;
        Ok(view.to_vec())
    }
}
