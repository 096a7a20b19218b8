//! Failures of the graphics interface as our errors.

use super::Gpu;
use super::compiled::Moment;
use crate::Error;

/// Catches what the device reports on this thread between its creation and [`ErrorTrap::finish`].
///
/// Nothing may be waited for in between: scopes belong to a thread and close in the reverse order of
/// their opening, whatever is polled meanwhile. It cannot happen unnoticed, since a future that
/// holds one is not `Send`, and tests check that the renderer's are.
pub(crate) struct ErrorTrap {
    made: Made,
    doing: &'static str,
    // Dropped in this order, the reverse of their opening: any other is a panic.
    internal: wgpu::ErrorScopeGuard,
    validation: wgpu::ErrorScopeGuard,
    memory: wgpu::ErrorScopeGuard,
}

/// What was compiled since a moment. Kept only where nothing is wrong with it: who gives up before
/// that is known lets go of it.
struct Made {
    gpu: Gpu,
    /// `None` once it is kept.
    since: Option<Moment>,
}

impl Drop for Made {
    fn drop(&mut self) {
        if let Some(since) = self.since {
            self.gpu.forget_compiled(since);
        }
    }
}

impl ErrorTrap {
    pub(crate) fn new(gpu: &Gpu, doing: &'static str) -> Self {
        Self {
            made: Made {
                gpu: gpu.clone(),
                since: Some(Moment::now()),
            },
            doing,
            memory: gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory),
            validation: gpu.device.push_error_scope(wgpu::ErrorFilter::Validation),
            internal: gpu.device.push_error_scope(wgpu::ErrorFilter::Internal),
        }
    }

    /// The worst of what was reported: a lost device, then memory, then the rest.
    pub(crate) fn finish(self) -> impl Future<Output = Result<(), Error>> {
        // Scopes close in the reverse order of their opening, and here: what is done before the
        // future is polled is no longer caught.
        let reports = (
            self.internal.pop(),
            self.validation.pop(),
            self.memory.pop(),
        );
        let (mut made, doing) = (self.made, self.doing);
        async move {
            let gpu = made.gpu.clone();
            let (internal, validation, memory) = reports;
            let (internal, validation, memory) = (internal.await, validation.await, memory.await);
            // A loss makes errors of all else. It is told when the device is asked; by browsers before
            // they answer what they are asked after it (Firefox tells the errors first).
            if internal.is_some() || validation.is_some() || memory.is_some() {
                #[cfg(not(target_arch = "wasm32"))]
                let _ = gpu.poll(wgpu::PollType::Poll);
                #[cfg(target_arch = "wasm32")]
                let _ = (gpu.device.push_error_scope(wgpu::ErrorFilter::Internal))
                    .pop()
                    .await;
            }
            gpu.check_alive()?;
            #[cfg(not(test))]
            let is_full = memory.is_some();
            #[cfg(test)]
            let is_full = gpu.device.faults.take_out_of_memory() || memory.is_some();
            let stray = gpu.take_stray();
            if is_full {
                return Err(Error::OutOfMemory {
                    doing: doing.to_owned(),
                });
            }
            match validation.or(internal).map(|e| e.to_string()).or(stray) {
                Some(cause) => Err(Error::Validation {
                    doing: doing.to_owned(),
                    cause,
                }),
                None => {
                    made.since.take();
                    Ok(())
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_compiled_is_kept_once_a_trap_has_found_nothing() {
        let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
        let kept = || gpu.compiled.sizes()[0];
        let compile = || gpu.bind_group_layout("tried", &[]);
        let before = kept();
        let trap = ErrorTrap::new(&gpu, "giving up");
        compile();
        assert_eq!(kept(), before + 1);
        drop(trap);
        assert_eq!(kept(), before);
        let trap = ErrorTrap::new(&gpu, "trying again");
        compile();
        pollster::block_on(trap.finish()).expect("nothing happened");
        assert_eq!(kept(), before + 1);
    }

    #[test]
    fn a_trap_that_is_left_early_closes_its_scopes_in_order() {
        let gpu = crate::testing::gpu();
        drop(ErrorTrap::new(gpu, "giving up"));
        let trap = ErrorTrap::new(gpu, "trying again");
        pollster::block_on(trap.finish()).expect("nothing happened");
    }
}
