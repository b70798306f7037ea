//! Where the window is: full screen on a monitor, or in a size.

use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::monitor::MonitorHandle;
use winit::window::{Fullscreen, Window, WindowAttributes};

use super::Options;

/// Size of the window where nobody says, pixels.
const WINDOW_SIZE: [u32; 2] = [1280, 720];

/// The window that the options ask for.
pub(super) fn attributes(options: &Options, events: &ActiveEventLoop) -> WindowAttributes {
    let attributes = Window::default_attributes().with_title("Orogen");
    if options.windowed {
        let [width, height] = options.size.unwrap_or(WINDOW_SIZE);
        return attributes.with_inner_size(PhysicalSize::new(width, height));
    }
    let monitors: Vec<MonitorHandle> = events.available_monitors().collect();
    let wanted = options
        .monitor
        .and_then(|number| monitors.get(number - 1).cloned());
    if wanted.is_none() && options.monitor.is_some() {
        tracing::warn!("there are {} monitors; using the primary one", monitors.len());
    }
    let monitor = wanted
        .or_else(|| events.primary_monitor())
        .or_else(|| monitors.into_iter().next());
    if let Some(monitor) = &monitor {
        // Without a window manager nobody resizes a full-screen window.
        let attributes = attributes.with_inner_size(monitor.size());
        return attributes.with_fullscreen(Some(Fullscreen::Borderless(Some(monitor.clone()))));
    }
    attributes.with_fullscreen(Some(Fullscreen::Borderless(None)))
}
