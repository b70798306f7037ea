//! The graphics card: adapter, device, and what happens when it is lost.
//!
//! A [`Gpu`] is one device from the day it was found to the day it is lost. Nothing repairs a lost device: everything
//! on it is made anew, and each new one has a higher [`Gpu::generation`].

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Interfaces that are asked first (Vulkan or the system's own), and the one that is asked if they have nothing. Each
/// has an instance of its own: GL is not even woken where it is not needed.
pub const INTERFACES: [wgpu::Backends; 2] = [wgpu::Backends::PRIMARY, wgpu::Backends::GL];

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

/// An entry to some interfaces of this machine, one of [`INTERFACES`], as far as `WGPU_BACKEND` allows them. GL can show
/// pictures only on the `display` that is named here.
pub fn instance(
    interfaces: wgpu::Backends,
    display: Option<Box<dyn wgpu::wgt::WgpuHasDisplayHandle>>,
) -> wgpu::Instance {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: descriptor.backends & interfaces,
        display,
        ..descriptor
    })
}

impl Gpu {
    /// The best device that needs no window: a graphics card if there is one, else a software adapter.
    ///
    /// # Errors
    /// When no adapter gives a device.
    pub fn offscreen() -> Result<Self, GpuError> {
        let mut found = Err(GpuError::NoAdapter("none was asked".to_owned()));
        for interfaces in INTERFACES {
            found = Self::find(&instance(interfaces, None), None);
            if found.is_ok() {
                break;
            }
        }
        found
    }

    /// The best device that can draw into `surface`.
    ///
    /// # Errors
    /// When no adapter can.
    pub fn for_window(instance: &wgpu::Instance, surface: &wgpu::Surface<'_>) -> Result<Self, GpuError> {
        Self::find(instance, Some(surface))
    }

    fn find(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        if let Some(surface) = surface {
            adapters.retain(|adapter| adapter.is_surface_supported(surface));
        }
        adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
        let mut fault = GpuError::NoAdapter("none answers".to_owned());
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

    /// Which device of this process it is, from 1.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// True if there is no graphics card behind it, only processor cores.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }
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
