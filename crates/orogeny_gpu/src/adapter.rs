//! Adapters: what there is, and which of it to take.

use crate::{Error, Result};

/// Which adapter to take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A real GPU, discrete before integrated. None is an error: the caller then uses the CPU back end.
    RealGpu,
    /// A software driver, as lavapipe is. For tests and off-screen drawing.
    Software,
    /// The first whose name contains this, whatever its kind; case does not matter.
    Named(String),
}

/// An adapter, for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterDescription {
    /// As the driver names it.
    pub name: String,
    /// `Vulkan`, `Metal` or `Dx12`.
    pub backend: String,
    /// `discrete GPU`, `integrated GPU`, `virtual GPU`, `software` or `other`.
    pub kind: &'static str,
    /// The driver and its version.
    pub driver: String,
    /// Whether it calculates on the CPU.
    pub is_software: bool,
}

impl AdapterDescription {
    pub(crate) fn new(info: &wgpu::AdapterInfo) -> Self {
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        };
        Self {
            name: info.name.clone(),
            backend: format!("{:?}", info.backend),
            kind,
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            is_software: is_software(info),
        }
    }
}

impl std::fmt::Display for AdapterDescription {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}, {}, {})", self.name, self.kind, self.backend, self.driver)
    }
}

/// Not every software driver says that it is one, so its name is looked at too.
fn is_software(info: &wgpu::AdapterInfo) -> bool {
    let name = info.name.to_lowercase();
    info.device_type == wgpu::DeviceType::Cpu
        || ["llvmpipe", "swiftshader", "softpipe"].iter().any(|s| name.contains(s))
}

/// All adapters, best first: discrete, integrated, virtual, other, software.
#[must_use]
pub fn list_adapters() -> Vec<AdapterDescription> {
    adapters(&new_instance()).iter().map(|adapter| AdapterDescription::new(&adapter.get_info())).collect()
}

/// Where adapters are looked for: never by OpenGL, even where another crate has its support built in. It cannot read and write the
/// textures of kernels, and a driver that has no other way is as good as none.
#[must_use]
pub fn new_instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

fn adapters(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| {
        let info = adapter.get_info();
        match info.device_type {
            _ if is_software(&info) => 4,
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other | wgpu::DeviceType::Cpu => 3,
        }
    });
    adapters
}

/// The best adapter for a choice.
pub(crate) fn choose(choice: &AdapterChoice, instance: &wgpu::Instance) -> Result<wgpu::Adapter> {
    choose_of(choice, adapters(instance))
}

/// The same of those that can show what they draw in a window.
pub(crate) fn choose_for_surface(
    choice: &AdapterChoice,
    instance: &wgpu::Instance,
    surface: &wgpu::Surface<'_>,
) -> Result<wgpu::Adapter> {
    let can_show = |adapter: &wgpu::Adapter| adapter.is_surface_supported(surface);
    choose_of(choice, adapters(instance).into_iter().filter(can_show).collect())
}

fn choose_of(choice: &AdapterChoice, adapters: Vec<wgpu::Adapter>) -> Result<wgpu::Adapter> {
    let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let matches = |info: &wgpu::AdapterInfo| match choice {
        AdapterChoice::RealGpu => !is_software(info),
        AdapterChoice::Software => is_software(info),
        AdapterChoice::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
    };
    adapters.into_iter().find(|adapter| matches(&adapter.get_info())).ok_or_else(|| {
        let (wanted, remedy) = match choice {
            AdapterChoice::RealGpu => ("real GPU".to_owned(), "use `--adapter cpu`".to_owned()),
            AdapterChoice::Software => {
                ("software driver".to_owned(), format!("{}, or use `--adapter cpu`", SOFTWARE_DRIVER_REMEDY))
            }
            AdapterChoice::Named(name) => {
                (format!("adapter whose name contains `{name}`"), "give one of those, or `cpu`".to_owned())
            }
        };
        let found = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Error::NoAdapter { wanted, found, remedy }
    })
}

#[cfg(target_os = "linux")]
const SOFTWARE_DRIVER_REMEDY: &str =
    "install Mesa's (Debian and Ubuntu: `sudo apt-get install -y libvulkan1 mesa-vulkan-drivers`)";
#[cfg(not(target_os = "linux"))]
const SOFTWARE_DRIVER_REMEDY: &str = "install one (for example SwiftShader)";
