//! The graphics card: adapter, device, and what happens when it is lost.
//!
//! A [`Gpu`] is one device from the day it was found to the day it is lost. Nothing repairs a lost device: everything
//! on it is made anew, and each new one has a higher [`Gpu::generation`].
//!
//! Stages of the mountain have twins here, [`GpuTransport`] and [`GpuFolds`]: they implement the same traits as the
//! stages on the processor, and fall back to them.

mod folds;
pub mod layout;
mod program;
mod stage;
mod transport;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

pub use folds::GpuFolds;
pub use stage::OnCard;
pub use transport::GpuTransport;

/// Devices made so far in this process.
static GENERATIONS: AtomicU64 = AtomicU64::new(0);

/// Why there is no graphics card to draw with.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter answers.
    #[error("no graphics adapter (Vulkan, Metal, DirectX 12 or OpenGL): {0}")]
    NoAdapter(String),
    /// There is an adapter, and it gives no device.
    #[error("the graphics adapter {0} gives no device: {1}")]
    NoDevice(String, String),
    /// The window's surface cannot be drawn into.
    #[error("the window cannot be drawn into: {0}")]
    Surface(String),
    /// The card refused some work.
    #[error("the graphics card refused: {0}")]
    Refused(String),
}

/// One graphics device and its queue.
#[derive(Debug)]
pub struct Gpu {
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What the adapter says of itself.
    pub info: wgpu::AdapterInfo,
    generation: u64,
    lost: Arc<AtomicBool>,
    /// The first thing the device refused since somebody asked.
    fault: Arc<Mutex<Option<String>>>,
}

/// What a window system lends, so that a picture can be shown on it.
pub type Display = Box<dyn wgpu::wgt::WgpuHasDisplayHandle>;

/// An entry to the interfaces of this machine that are asked first: Vulkan, Metal, DirectX 12.
///
/// A window's surface must be made by the instance that its device comes from.
pub fn instance(display: Option<Display>) -> wgpu::Instance {
    entry(wgpu::Backends::PRIMARY, display)
}

/// An entry to OpenGL, for machines where [`instance`] finds nothing: it is slow to ask and talks on standard error.
/// It can show pictures only on the `display` that is named here.
pub fn fallback_instance(display: Option<Display>) -> wgpu::Instance {
    entry(wgpu::Backends::GL, display)
}

/// `WGPU_BACKEND` may name fewer interfaces.
fn entry(backends: wgpu::Backends, display: Option<Display>) -> wgpu::Instance {
    let descriptor = wgpu::InstanceDescriptor {
        display,
        ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
    };
    let backends = descriptor.backends & backends;
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..descriptor
    })
}

impl Gpu {
    /// The best device that needs no window: a graphics card if there is one, else a software adapter.
    ///
    /// # Errors
    /// When no adapter gives a device.
    pub fn offscreen() -> Result<Self, GpuError> {
        Self::find(&instance(None), None).or_else(|first| {
            // What the better interfaces said tells more than that OpenGL has nothing either.
            Self::find(&fallback_instance(None), None).map_err(|_| first)
        })
    }

    /// The best device that computes, for stages alone: what they wait for keeps no picture waiting.
    ///
    /// # Errors
    /// When no adapter of the better interfaces gives a device, or the best of them only draws.
    pub fn computing() -> Result<Self, GpuError> {
        let gpu = Self::find(&instance(None), None)?;
        gpu.can_compute()?;
        Ok(gpu)
    }

    /// The best device that can draw into `surface`, which `instance` made.
    ///
    /// # Errors
    /// When no adapter of `instance` can; then try again with a surface of [`fallback_instance`].
    pub fn for_window(instance: &wgpu::Instance, surface: &wgpu::Surface<'_>) -> Result<Self, GpuError> {
        Self::find(instance, Some(surface))
    }

    fn find(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        let mut fault = GpuError::NoAdapter("none answers".to_owned());
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        if let Some(surface) = surface {
            adapters.retain(|adapter| adapter.is_surface_supported(surface));
        }
        adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
        for adapter in adapters {
            match Self::open(adapter) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => fault = error,
            }
        }
        Err(fault)
    }

    fn open(adapter: wgpu::Adapter) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let wanted = wgpu::Features::FLOAT32_FILTERABLE;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("orogen"),
            required_features: adapter.features() & wanted,
            required_limits: wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits()),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice(info.name.clone(), error.to_string()))?;
        let lost = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, why| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                tracing::error!("the graphics device is lost: {why}");
            }
            flag.store(true, Ordering::Release);
        });
        let flag = Arc::clone(&lost);
        let fault = Arc::new(Mutex::new(None));
        let first = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error| {
            tracing::error!("graphics: {error}");
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| error.to_string());
            // What the card had no memory for is not there when it is used: begin anew.
            if matches!(error, wgpu::Error::OutOfMemory { .. }) {
                flag.store(true, Ordering::Release);
            }
        }));
        Ok(Self {
            adapter,
            device,
            queue,
            info,
            generation: GENERATIONS.fetch_add(1, Ordering::Relaxed) + 1,
            lost,
            fault,
        })
    }

    /// The first thing the device refused since this was last asked. Each is logged as well; nothing panics.
    pub fn take_fault(&self) -> Option<String> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// True once the device is gone: nothing it holds can be used any more.
    pub fn lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// Nothing, while the device is there and has refused nothing since somebody asked.
    ///
    /// # Errors
    /// When it is lost, or the first thing that it refused.
    pub(crate) fn sound(&self) -> Result<(), GpuError> {
        if self.lost() {
            return Err(GpuError::Refused("the graphics device is lost".to_owned()));
        }
        self.take_fault()
            .map_or(Ok(()), |fault| Err(GpuError::Refused(fault)))
    }

    /// Nothing, where the device computes.
    ///
    /// # Errors
    /// When its adapter only draws, as those of old interfaces do.
    pub fn can_compute(&self) -> Result<(), GpuError> {
        let flags = self.adapter.get_downlevel_capabilities().flags;
        if computes(flags, &self.device.limits()) {
            return Ok(());
        }
        let name = &self.info.name;
        Err(GpuError::Refused(format!("{name} draws and does not compute")))
    }

    /// Which device of this process it is, from 1.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// True if there is no graphics card behind it, only processor cores.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }
}

/// True for what can run the compute shaders.
fn computes(flags: wgpu::DownlevelFlags, limits: &wgpu::Limits) -> bool {
    flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
        && limits.max_storage_buffers_per_shader_stage > program::INPUTS as u32
        && limits.max_compute_invocations_per_workgroup >= layout::SIDE * layout::SIDE
}

/// Cards first, then what sits beside the processor, software last.
fn rank(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_that_only_draw_are_recognised() {
        let all = wgpu::DownlevelFlags::all();
        assert!(computes(all, &wgpu::Limits::downlevel_defaults()));
        assert!(!computes(all, &wgpu::Limits::downlevel_webgl2_defaults()));
        let draws = all - wgpu::DownlevelFlags::COMPUTE_SHADERS;
        assert!(!computes(draws, &wgpu::Limits::downlevel_defaults()));
    }
}
