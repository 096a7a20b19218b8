//! Failures of the graphics interface as our errors.

use super::Gpu;
use crate::Error;

/// Catches what the device reports between its creation and [`ErrorTrap::finish`].
pub(crate) struct ErrorTrap {
    gpu: Gpu,
    doing: &'static str,
    memory: wgpu::ErrorScopeGuard,
    validation: wgpu::ErrorScopeGuard,
    internal: wgpu::ErrorScopeGuard,
}

impl ErrorTrap {
    pub(crate) fn new(gpu: &Gpu, doing: &'static str) -> Self {
        Self {
            gpu: gpu.clone(),
            doing,
            memory: gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory),
            validation: gpu.device.push_error_scope(wgpu::ErrorFilter::Validation),
            internal: gpu.device.push_error_scope(wgpu::ErrorFilter::Internal),
        }
    }

    /// The worst of what was reported: a lost device, then memory, then the rest.
    pub(crate) async fn finish(self) -> Result<(), Error> {
        // Scopes close in the reverse order of their opening.
        let internal = self.internal.pop().await;
        let validation = self.validation.pop().await;
        let memory = self.memory.pop().await;
        self.gpu.check_alive()?;
        if memory.is_some() {
            return Err(Error::OutOfMemory {
                doing: self.doing.to_owned(),
            });
        }
        match validation.or(internal) {
            Some(cause) => Err(Error::Validation {
                doing: self.doing.to_owned(),
                cause: cause.to_string(),
            }),
            None => Ok(()),
        }
    }
}
