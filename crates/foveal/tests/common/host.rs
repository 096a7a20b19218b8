//! A host's own device.

use pollster::block_on;

/// A device of the first adapter, with those of these features that it has.
pub(crate) fn device(
    features: wgpu::Features,
    required_limits: wgpu::Limits,
) -> (wgpu::Device, wgpu::Queue) {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    block_on(async {
        let adapter = instance
            .request_adapter(&Default::default())
            .await
            .expect("the tests need a graphics adapter");
        let descriptor = wgpu::DeviceDescriptor {
            required_features: features & adapter.features(),
            required_limits,
            ..Default::default()
        };
        adapter.request_device(&descriptor).await.expect("a device")
    })
}
