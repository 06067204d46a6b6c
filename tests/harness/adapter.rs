//! The device that GPU tests run on.

use orogeny_gpu::{AdapterChoice, Gpu};

/// Names the adapter: `real` for a real GPU, otherwise a part of its name. Without it, a software driver.
const VARIABLE: &str = "OROGENY_TEST_ADAPTER";

/// A new device of its own, so that one test's errors, or its destroying the device, are no other test's.
///
/// # Panics
/// Where there is no such adapter, with what to do about it. A GPU test never passes by being left out.
#[must_use]
pub fn gpu() -> Gpu {
    let choice = choice(std::env::var(VARIABLE).ok().as_deref());
    Gpu::open(&choice).unwrap_or_else(|err| panic!("GPU tests need an adapter: {err} ({VARIABLE} names it)"))
}

fn choice(name: Option<&str>) -> AdapterChoice {
    match name {
        None | Some("") => AdapterChoice::Software,
        Some("real") => AdapterChoice::RealGpu,
        Some(name) => AdapterChoice::Named(name.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_chooses_the_adapter() {
        assert_eq!(choice(None), AdapterChoice::Software);
        assert_eq!(choice(Some("")), AdapterChoice::Software);
        assert_eq!(choice(Some("real")), AdapterChoice::RealGpu);
        assert_eq!(choice(Some("llvmpipe")), AdapterChoice::Named("llvmpipe".to_owned()));
    }

    #[test]
    fn an_absent_adapter_is_an_error_with_a_remedy() {
        let absent = AdapterChoice::Named("no such adapter".to_owned());
        let message = Gpu::open(&absent).unwrap_err().to_string();
        assert!(message.contains("no such adapter") && message.contains("give one of those"), "{message}");
    }

    #[test]
    fn a_validation_error_is_noticed_and_noticed_once() {
        let gpu = gpu();
        gpu.check().unwrap();
        // Nothing may be copied out of a buffer that was not made for it.
        let buffer = |usage| {
            let descriptor =
                wgpu::BufferDescriptor { label: None, size: 16, usage, mapped_at_creation: false };
            gpu.create_buffer(&descriptor).unwrap()
        };
        let (from, to) = (buffer(wgpu::BufferUsages::COPY_DST), buffer(wgpu::BufferUsages::COPY_DST));
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&from, 0, &to, 0, 16);
        gpu.queue().submit([encoder.finish()]);
        let noticed = gpu.check().unwrap_err();
        assert!(matches!(noticed, orogeny_gpu::Error::Validation { .. }), "{noticed}");
        gpu.check().unwrap();
    }
}
