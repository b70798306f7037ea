//! The window and its events: what winit tells, handed to the table as plain data.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::event::{DeviceId, ElementState, MouseButton, TouchPhase, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy, OwnedDisplayHandle};
use winit::keyboard::ModifiersState;
use winit::window::{Fullscreen, Window, WindowId};

use super::governor::Governor;
use super::graphics::{Graphics, Scene, Shown};
use super::hud::Hud;
use super::keeper;
use super::keys;
use super::listen::Listeners;
use super::metrics::Metrics;
use super::screen::attributes;
use super::table::{Raw, Table};
use super::watch::{Heartbeat, Watch};
use super::{AppError, Options};
use crate::input::window::TouchPhase as Touched;
use crate::rock::Stratigraphy;
use crate::settings::Settings;
use crate::ui::staff::StaffAction;

/// Longest time between two looks at the table while nothing moves, so that clocks and idle times go on.
const IDLE_LOOK: Duration = Duration::from_millis(100);
/// Frame time aimed at on a graphics card: 60 Hz.
const HARDWARE_MS: f64 = 1000.0 / 60.0;
/// Frame time aimed at on a software adapter: 20 Hz, above the 15 Hz that sculpting needs.
const SOFTWARE_MS: f64 = 50.0;
/// Frame rate on monitors that do not tell theirs, Hz.
const REFRESH_HZ: f64 = 60.0;
/// How often a lost graphics card is looked for before the program gives up and is started anew by its keeper.
const MOST_REVIVALS: u32 = 20;

/// The program: settings, table, and the window once there is one.
pub(super) struct Program {
    options: Options,
    settings: Settings,
    layers: Arc<Stratigraphy>,
    metrics: Metrics,
    display: OwnedDisplayHandle,
    listeners: Listeners,
    began: Instant,
    heart: Heartbeat,
    open: Option<Open>,
    failure: Option<AppError>,
}

/// What exists while the window does.
struct Open {
    window: Arc<Window>,
    graphics: Graphics,
    table: Table,
    hud: Hud,
    governor: Governor,
    /// Part of the window's resolution at which the land is drawn.
    scale: f32,
    touch_devices: BTreeMap<DeviceId, u16>,
    modifiers: ModifiersState,
    /// When the next frame is due, s since the program began.
    next_frame_s: f64,
    last_frame_s: f64,
    revivals: u32,
    _watch: Watch,
}

impl Program {
    pub(super) fn new(
        options: Options,
        settings: Settings,
        layers: Arc<Stratigraphy>,
        metrics: Metrics,
        (display, proxy): (OwnedDisplayHandle, EventLoopProxy<()>),
    ) -> Self {
        Self {
            listeners: Listeners::start(&settings.input, proxy),
            options,
            settings,
            layers,
            metrics,
            display,
            began: Instant::now(),
            heart: Heartbeat::default(),
            open: None,
            failure: None,
        }
    }

    /// How it ended.
    pub(super) fn end(self) -> Result<(), AppError> {
        self.failure.map_or(Ok(()), Err)
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<Open, AppError> {
        let window = events
            .create_window(attributes(&self.options, events))
            .map_err(|error| AppError::NoDisplay(format!("no window: {error}")))?;
        let window = Arc::new(window);
        if self.options.kiosk {
            window.set_cursor_visible(false);
        }
        let graphics = Graphics::new(&window, &self.display)
            .map_err(|error| AppError::NoGraphics(format!("no usable graphics: {error}")))?;
        let software = graphics.gpu().is_software();
        let size = graphics.size_px();
        let table = Table::new(
            &self.options,
            &self.settings,
            size,
            software,
            Arc::clone(&self.layers),
        )?;
        let (window_heart, sessions) = (self.heart.clone(), table.worlds().pulse());
        let watch = Watch::over(vec![
            ("the window", Box::new(move || window_heart.beats())),
            ("the session", Box::new(sessions)),
        ])
        .map_err(|error| AppError::Other(format!("no thread for the watch: {error}")))?;
        let hud = Hud::new(self.metrics.writes());
        let mut open = Open {
            window,
            graphics,
            table,
            hud,
            governor: if software {
                Governor::low(SOFTWARE_MS)
            } else {
                Governor::new(HARDWARE_MS)
            },
            scale: 1.0,
            touch_devices: BTreeMap::new(),
            modifiers: ModifiersState::default(),
            next_frame_s: 0.0,
            last_frame_s: 0.0,
            revivals: 0,
            _watch: watch,
        };
        open.apply_scale(&self.settings);
        Ok(open)
    }

    fn now_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: AppError) {
        self.failure.get_or_insert(error);
        events.exit();
    }

    /// Hands over what touch devices have said.
    fn hear_devices(&mut self) {
        let now_s = self.now_s();
        let Some(open) = &mut self.open else { return };
        let metrics = &mut self.metrics;
        self.listeners.drain(|source, frame| {
            if open.table.device(source, frame, micros(now_s)) {
                metrics.touched(now_s);
            }
        });
    }

    fn frame(&mut self, events: &ActiveEventLoop) {
        let now_s = self.now_s();
        self.heart.beat();
        self.hear_devices();
        let Some(open) = &mut self.open else { return };
        match open.frame(
            &mut self.metrics,
            &mut self.settings,
            (&self.options, &mut self.listeners),
            now_s,
            self.began,
        ) {
            Drawn::Yes => {}
            Drawn::DeviceLost => {
                if let Err(error) = open.revive(&self.display) {
                    let error = AppError::NoGraphics(format!("the graphics card was lost: {error}"));
                    self.fail(events, error);
                }
            }
            Drawn::Ended => events.exit(),
        }
    }
}

/// What became of a turn of the loop.
enum Drawn {
    Yes,
    DeviceLost,
    Ended,
}

impl Open {
    fn apply_scale(&mut self, settings: &Settings) {
        let fixed = settings.quality.scale.map(|scale| scale as f32);
        self.scale = fixed.unwrap_or_else(|| self.governor.scale());
        self.graphics.set_scale(self.scale);
    }

    fn frame(
        &mut self,
        metrics: &mut Metrics,
        settings: &mut Settings,
        (options, listeners): (&Options, &mut Listeners),
        now_s: f64,
        began: Instant,
    ) -> Drawn {
        let now_us = micros(now_s);
        let dt_s = (now_s - self.last_frame_s).clamp(0.0, 0.25);
        self.table.step(settings, now_us, dt_s);
        let size_px = self.graphics.size_px();
        self.graphics.follow(self.table.worlds(), now_s);
        let run = self.hud.run(
            &mut self.table,
            settings,
            (metrics.health(), listeners),
            size_px,
            now_s,
        );
        for action in run.actions {
            if self.act(action, settings, options, now_us) {
                return Drawn::Ended;
            }
        }
        if self.table.end_calibration(settings, now_us) {
            self.table.save_settings(settings, options.settings.as_deref());
        }
        if listeners.apply(&settings.input) {
            self.table.forget_devices(now_us);
        }
        let shown = self.graphics.draw(
            &Scene {
                camera: self.table.eye().camera(),
                style: self.table.eye().style(),
                disc: self.table.disc(),
                dt_s: dt_s as f32,
            },
            run.overlay,
        );
        let done_s = began.elapsed().as_secs_f64();
        match shown {
            Shown::Presented => {
                metrics.presented(done_s);
                if self.table.lively() {
                    let judged = self.governor.frame((now_s - self.last_frame_s) * 1e3);
                    if judged.is_some() && settings.quality.scale.is_none() {
                        self.apply_scale(settings);
                    }
                }
            }
            Shown::Skipped => metrics.paused(),
            Shown::DeviceLost => return Drawn::DeviceLost,
        }
        self.last_frame_s = now_s;
        if let Some(layout) = self.table.layout_line() {
            metrics.write(&layout);
        }
        if let Some(panel) = self.hud.panel_line() {
            metrics.write(&panel);
        }
        if metrics.due(done_s) {
            let facts = self
                .table
                .facts(&self.graphics, listeners, self.scale, self.revivals);
            metrics.close(done_s, &facts);
            keeper::alive();
        }
        self.next_frame_s = now_s + self.period_s(settings);
        Drawn::Yes
    }

    /// Does what staff have pressed. True when the program is to end.
    fn act(&mut self, action: StaffAction, settings: &mut Settings, options: &Options, now_us: u64) -> bool {
        let now_ms = now_us / 1000;
        let door = self.table.door();
        match action {
            StaffAction::Digit(digit) => door.digit(digit, now_ms),
            StaffAction::Enter => door.enter(now_ms),
            StaffAction::Erase => door.erase(now_ms),
            StaffAction::Leave => door.close(),
            StaffAction::Quit => return true,
            StaffAction::RestartLand => {
                door.close();
                self.table.start_afresh(now_us);
            }
            StaffAction::Layers => {
                door.close();
                self.hud.toggle_layers(&self.table);
            }
            StaffAction::SaveContacts => self.table.save_contacts(),
            StaffAction::SaveLand => self.table.save(),
            StaffAction::FinalLand => self.table.save_final(),
            StaffAction::CancelFinal => self.table.cancel_final(),
            StaffAction::Clean => {
                door.close();
                self.table.clean(now_us);
            }
            StaffAction::Calibrate => {
                door.close();
                self.table.calibrate(now_us);
            }
            StaffAction::Apply(changed) => {
                *settings = *changed;
                self.table.apply(settings, now_us);
                self.apply_scale(settings);
                self.table.save_settings(settings, options.settings.as_deref());
            }
        }
        false
    }

    /// Time from one frame to the next, s: the monitor's, or a slower one while the show plays for nobody.
    fn period_s(&self, settings: &Settings) -> f64 {
        let monitor = self.window.current_monitor();
        let refresh = monitor
            .and_then(|monitor| monitor.refresh_rate_millihertz())
            .map_or(REFRESH_HZ, |millihertz| f64::from(millihertz) / 1e3);
        // A frame that comes a little early waits for the monitor, one that comes late has missed it.
        let full = 0.9 / refresh.max(1.0);
        if self.table.lively() {
            return full;
        }
        let shown = if self.graphics.gpu().is_software() {
            settings.quality.attract_software_hz
        } else {
            settings.quality.attract_hz
        };
        full.max(1.0 / shown.max(1.0))
    }

    /// Makes everything on the graphics card anew; the world knows nothing of it.
    fn revive(&mut self, display: &OwnedDisplayHandle) -> Result<(), crate::gpu::GpuError> {
        self.revivals += 1;
        tracing::error!("the graphics card was lost ({} times now)", self.revivals);
        let graphics = Graphics::new(&self.window, display);
        if graphics.is_err() && self.revivals < MOST_REVIVALS {
            std::thread::sleep(Duration::from_millis(500));
            return Ok(());
        }
        self.graphics = graphics?;
        self.hud.forget_textures();
        Ok(())
    }

    fn raw(&mut self, metrics: &mut Metrics, now_s: f64, raw: Raw) {
        metrics.touched(now_s);
        self.table.raw(raw, micros(now_s));
    }

    /// A small number for a touch device: winit's own ids are opaque.
    fn device(&mut self, id: DeviceId) -> u16 {
        let next = self.touch_devices.len() as u16;
        *self.touch_devices.entry(id).or_insert(next)
    }
}

/// Seconds since the program began as table time.
fn micros(now_s: f64) -> u64 {
    (now_s * 1e6) as u64
}

impl ApplicationHandler for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(events) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => self.fail(events, error),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let now_s = self.now_s();
        let Some(open) = &mut self.open else { return };
        let metrics = &mut self.metrics;
        match event {
            WindowEvent::Touch(touch) => {
                let device = open.device(touch.device_id);
                let phase = match touch.phase {
                    TouchPhase::Started => Touched::Started,
                    TouchPhase::Moved => Touched::Moved,
                    TouchPhase::Ended => Touched::Ended,
                    TouchPhase::Cancelled => Touched::Cancelled,
                };
                let at_px = DVec2::new(touch.location.x, touch.location.y);
                let id = touch.id;
                open.raw(
                    metrics,
                    now_s,
                    Raw::Touch {
                        device,
                        id,
                        phase,
                        at_px,
                    },
                );
            }
            WindowEvent::CursorMoved { position, .. } => {
                let at_px = DVec2::new(position.x, position.y);
                open.raw(metrics, now_s, Raw::PointerMoved { at_px });
            }
            WindowEvent::MouseInput {
                state,
                button: MouseButton::Left,
                ..
            } => {
                let raw = Raw::PointerButton {
                    pressed: state == ElementState::Pressed,
                    shift: open.modifiers.shift_key(),
                };
                open.raw(metrics, now_s, raw);
            }
            WindowEvent::ModifiersChanged(modifiers) => open.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput {
                event: key,
                is_synthetic: false,
                ..
            } => {
                if open.hud.key(&key) {
                    return;
                }
                let ends = !self.options.kiosk && keys::closes(&key);
                if ends && !open.table.lift_planted(micros(now_s)) {
                    events.exit();
                }
                if !self.options.kiosk
                    && keys::toggles_layers(&key)
                    && open.table.offers_layers(&self.settings)
                {
                    open.hud.toggle_layers(&open.table);
                }
                if !self.options.kiosk && keys::toggles_full_screen(&key) {
                    let full = open.window.fullscreen().is_none();
                    open.window
                        .set_fullscreen(full.then_some(Fullscreen::Borderless(None)));
                }
                if let Some((key, pressed)) = keys::control(&key, open.modifiers) {
                    open.table.key(key, pressed, micros(now_s));
                }
            }
            WindowEvent::Focused(false) | WindowEvent::ScaleFactorChanged { .. } => {
                open.table.cancel_all(micros(now_s));
            }
            WindowEvent::Resized(size) => {
                open.graphics.resize(size.width, size.height);
                let size_px = open.graphics.size_px();
                open.table.resize(&self.settings, size_px, micros(now_s));
            }
            WindowEvent::CloseRequested if !self.options.kiosk => events.exit(),
            WindowEvent::RedrawRequested => self.frame(events),
            _ => {}
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, (): ()) {
        self.hear_devices();
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let now_s = self.now_s();
        let Some(open) = &mut self.open else { return };
        if now_s >= open.next_frame_s {
            open.window.request_redraw();
        }
        let wait = Duration::from_secs_f64((open.next_frame_s - now_s).clamp(0.0, IDLE_LOOK.as_secs_f64()));
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + wait));
    }
}
