//! What lies on top of the land: marks, halos, controls, figures, ghost hands, the warning, and the staff's panels.

use egui::{Context, Event, LayerId, PointerButton, Pos2, RawInput, Rect, Vec2};
use glam::DVec2;
use serde::Serialize;
use winit::event::KeyEvent;

use super::graphics::Overlay;
use super::keys;
use super::layers::Layers;
use super::listen::{Listeners, word};
use super::metrics::Health;
use super::sheets::Sheets;
use super::table::Table;
use super::told::Place;
use crate::gesture::command::Tool;
use crate::gesture::contact::{ContactKey, Phase as ContactPhase, Side};
use crate::instrument::Route;
use crate::kiosk::{DoorPhase, Phase};
use crate::render::plan_rect;
use crate::settings::Settings;
use crate::ui::globe::{self, GlobeChart};
use crate::ui::halo::Halos;
use crate::ui::ink::Chart;
use crate::ui::readouts::Readings;
use crate::ui::staff::{self, ContactHealth, StaffAction, StaffPanel, StaffView};
use crate::ui::{Sight, controls, folds, ghost, readouts, section, warning};

/// Time in which figures come and go, s.
const FIGURES_S: f64 = 0.25;

/// egui and what it remembers.
pub(super) struct Hud {
    context: Context,
    chart: Chart,
    globe: GlobeChart,
    halos: Halos,
    panel: StaffPanel,
    sheets: Sheets,
    layers: Layers,
    events: Vec<Event>,
    /// The contact that is egui's pointer.
    pointer: Option<ContactKey>,
    /// How much is seen of the figures of the north and south side, 0–1.
    figures: [f64; 2],
    now_s: f64,
    /// Tell where the panels' buttons are.
    tells: bool,
    told: Option<(bool, Vec<Place>)>,
    untold: Option<PanelLine>,
}

/// What the staff pressed in this frame.
pub(super) struct Run {
    pub(super) overlay: Overlay,
    pub(super) actions: Vec<StaffAction>,
}

/// Where the buttons of a panel are, as a line of metrics.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PanelLine {
    #[serde(skip_serializing_if = "Option::is_none")]
    keypad: Option<Vec<Place>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    menu: Option<Vec<Place>>,
}

impl Hud {
    /// `tells`: someone reads where the panels' buttons are.
    pub(super) fn new(tells: bool) -> Self {
        let context = Context::default();
        if tells {
            context.enable_accesskit();
        }
        Self {
            context,
            chart: Chart::default(),
            globe: GlobeChart::default(),
            halos: Halos::default(),
            panel: StaffPanel::default(),
            sheets: Sheets::default(),
            layers: Layers::default(),
            events: Vec::new(),
            pointer: None,
            figures: [0.0; 2],
            now_s: 0.0,
            tells,
            told: None,
            untold: None,
        }
    }

    /// The graphics card is another: egui's textures have to go to it anew.
    pub(super) fn forget_textures(&mut self) {
        *self = Self::new(self.tells);
    }

    /// A key, for whoever works the panels without touching. True when it was typed, and stands for nothing else.
    pub(super) fn key(&mut self, key: &KeyEvent) -> bool {
        if self.sheets.types(key) {
            return true;
        }
        self.events.extend(keys::panel(key));
        let typing = self.context.egui_wants_keyboard_input();
        if typing {
            self.events.extend(keys::typed(key));
        }
        typing && key.state.is_pressed()
    }

    /// Opens or closes the panel of rock layers.
    pub(super) fn toggle_layers(&mut self, table: &Table) {
        self.layers.toggle(table);
    }

    /// Where the buttons of the panel are, when that has changed since this was last asked.
    pub(super) fn panel_line(&mut self) -> Option<PanelLine> {
        self.untold.take()
    }

    /// Draws a frame of `size_px` pixels, one point each.
    pub(super) fn run(
        &mut self,
        table: &mut Table,
        settings: &Settings,
        (health, listeners): (&Health, &Listeners),
        size_px: [u32; 2],
        now_s: f64,
    ) -> Run {
        let dt_s = (now_s - self.now_s).clamp(0.0, 0.25);
        self.now_s = now_s;
        let viewport = DVec2::from(size_px.map(f64::from));
        let (corner, size) = plan_rect(table.map().extent(), viewport);
        let rect = Rect::from_min_size(point(corner), point(size).to_vec2());
        let per_mm = size.x / table.map().size_mm().x;
        self.follow(table, corner, per_mm, dt_s);
        self.sheets.follow(table, &Sight::flat(table.map(), rect));
        let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(size_px[0] as f32, size_px[1] as f32));
        let input = RawInput {
            screen_rect: Some(screen),
            time: Some(now_s),
            focused: true,
            events: std::mem::take(&mut self.events),
            ..RawInput::default()
        };
        let context = self.context.clone();
        let mut shown = staff::Shown::default();
        let mut layers = None;
        let mut output = context.run_pass(input, |context| {
            self.draw(context, table, settings, rect, screen);
            layers = self
                .layers
                .show(context, table, staff::scale_for(screen.size(), per_mm as f32));
            shown = self.panels(
                context,
                table,
                settings,
                (health, listeners),
                screen,
                per_mm as f32,
            );
        });
        let rects = layers.into_iter().chain(shown.rect).map(|rect| {
            let mm = |at: Pos2| (DVec2::new(f64::from(at.x), f64::from(at.y)) - corner) / per_mm;
            (mm(rect.min), mm(rect.max))
        });
        table.set_panels(rects.collect());
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            self.tell(table.door().phase(), &tree);
        }
        Run {
            overlay: Overlay {
                textures: output.textures_delta,
                shapes: context.tessellate(output.shapes, 1.0),
                pixels_per_point: 1.0,
            },
            actions: shown.actions,
        }
    }

    /// Takes over what contacts did, and what the session shows.
    fn follow(&mut self, table: &mut Table, corner: DVec2, per_mm: f64, dt_s: f64) {
        let now_s = self.now_s;
        for seen in table.take_seen() {
            let contact = seen.event.contact;
            match seen.event.phase {
                ContactPhase::Down | ContactPhase::Move => {
                    self.halos.touch(contact.key, contact.position, seen.route, now_s);
                }
                ContactPhase::Up => self.halos.lift(contact.key, now_s),
                ContactPhase::Cancel => self.halos.cancel(contact.key, now_s),
            }
            self.point(
                seen.event.phase,
                contact.key,
                seen.route,
                point(corner + contact.position * per_mm),
            );
        }
        self.halos.meet(table.worlds().hands(), now_s);
        self.halos.tick(now_s);
        if let Some(globe) = table.worlds().globe() {
            self.globe.follow(globe);
        }
        let frame = table.frame();
        self.chart
            .follow(&frame.surface.plates, &frame.surface.faults, now_s);
        for (side, figures) in [Side::North, Side::South].into_iter().zip(&mut self.figures) {
            let goal = f64::from(u8::from(table.instrument().readouts(side)));
            *figures += (goal - *figures) * (1.0 - (-3.0 * dt_s / FIGURES_S).exp());
            if (goal - *figures).abs() < 0.01 {
                *figures = goal;
            }
        }
    }

    /// egui understands one finger: the first that lands on a panel is its pointer until it lifts.
    fn point(&mut self, phase: ContactPhase, key: ContactKey, route: Route, at: Pos2) {
        let button = |pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::default(),
        };
        let owner = self.pointer == Some(key);
        match phase {
            ContactPhase::Down if route == Route::Panel && self.pointer.is_none() => {
                self.pointer = Some(key);
                self.events.extend([Event::PointerMoved(at), button(true)]);
            }
            ContactPhase::Move if owner => self.events.push(Event::PointerMoved(at)),
            ContactPhase::Up if owner => {
                self.pointer = None;
                self.events
                    .extend([Event::PointerMoved(at), button(false), Event::PointerGone]);
            }
            ContactPhase::Cancel if owner => {
                self.pointer = None;
                // Lifted where nothing is, it presses nothing.
                let nowhere = Pos2::new(-1e4, -1e4);
                self.events.extend([
                    Event::PointerMoved(nowhere),
                    Event::PointerButton {
                        pos: nowhere,
                        button: PointerButton::Primary,
                        pressed: false,
                        modifiers: egui::Modifiers::default(),
                    },
                    Event::PointerGone,
                ]);
            }
            _ => {}
        }
    }

    fn draw(&self, context: &Context, table: &Table, settings: &Settings, rect: Rect, screen: Rect) {
        let painter = context.layer_painter(LayerId::background());
        let now_s = self.now_s;
        let (map, aloft) = (table.map(), table.aloft());
        let flat = Sight::flat(map, rect);
        let instrument = table.instrument();
        match table.worlds().globe() {
            Some(planet) => {
                self.globe.draw(&painter, &flat, planet, table.eye().style().lamp);
                globe::draw_tethers(&painter, &flat, planet);
            }
            None => self.draw_mountain(&painter, table, rect),
        }
        if let Some(hint) = table.kiosk().hint() {
            if settings.view.reduced_motion {
                ghost::draw_still(&painter, &flat, &hint);
            } else {
                ghost::draw(&painter, &flat, &hint.hands(map.size_mm()));
            }
        }
        let quiet = (1.0 - aloft) as f32;
        for paper in instrument.papers().filter(|_| quiet > 0.0) {
            section::draw_sheet(&painter, &flat, &paper, &self.sheets.sheet(paper.side), quiet);
        }
        if quiet > 0.0 && table.kiosk().phase() != Phase::Attract {
            controls::draw(&painter, &flat, &instrument.controls(), quiet);
        }
        for (side, &figures) in [Side::North, Side::South].into_iter().zip(&self.figures) {
            let figures = figures as f32;
            if let Some(planet) = table.worlds().globe() {
                globe::draw_legend(&painter, &flat, planet, side, figures);
            } else {
                let exaggeration = table.eye().drawn_exaggeration();
                let clock = &table.frame().clock;
                readouts::draw(&painter, &flat, &Readings { clock, exaggeration }, side, figures);
            }
        }
        if let Phase::IdleWarning { left_ms } = table.kiosk().phase() {
            let whole_ms = (settings.kiosk.countdown_s * 1e3) as u64;
            warning::draw(&painter, &flat, screen, left_ms, whole_ms);
        }
        if let DoorPhase::Holding { progress } = table.door_phase() {
            let corner = settings.staff.corner.position(map.size_mm());
            staff::draw_hold(&painter, &flat, corner, progress);
        }
        if let Some(text) = table.notice() {
            notice(&painter, &flat, rect, text);
        }
        if let Some((at_mm, number, left_s)) = table.cross() {
            warning::cross(&painter, &flat, screen, at_mm, number, left_s);
        }
        if let Some(left_s) = table.cleaning_s() {
            warning::clean(&painter, &flat, screen, left_s);
        }
        self.halos.draw(&painter, &flat, now_s);
    }

    /// The ink on the mountain.
    fn draw_mountain(&self, painter: &egui::Painter, table: &Table, rect: Rect) {
        let now_s = self.now_s;
        let (map, aloft) = (table.map(), table.aloft());
        let flat = Sight::flat(map, rect);
        let frame = table.frame();
        let camera = *table.eye().camera();
        let exaggeration = table.eye().drawn_exaggeration();
        let project = |plan: DVec2, height: f64| {
            let at = camera.project(plan.extend(height * exaggeration))?;
            Some(point(at))
        };
        let draped = Sight::draped(map, rect, &frame.surface.height, &project);
        let on_land = if aloft > 0.0 { &draped } else { &flat };
        let edits = table.instrument().edits();
        let editing = [Side::North, Side::South]
            .iter()
            .any(|&side| table.instrument().tool(side) == Tool::Edit)
            || frame.clock.paused;
        let ink = (1.0 - aloft) as f32;
        let instrument = table.instrument();
        let folding = [Side::North, Side::South]
            .iter()
            .any(|&side| instrument.tool(side) == Tool::Fold);
        if folding {
            folds::draw_axes(painter, on_land, &frame.surface.folds, ink);
        }
        self.chart
            .draw(painter, on_land, ink, editing.then_some(&edits[..]), now_s);
        folds::draw_tool(
            painter,
            on_land,
            &instrument.strokes(),
            instrument.fold_handles(),
            ink,
        );
        section::draw_lines(painter, on_land, instrument.slices(), 1.0);
    }

    fn panels(
        &mut self,
        context: &Context,
        table: &mut Table,
        settings: &Settings,
        (health, listeners): (&Health, &Listeners),
        screen: Rect,
        per_mm: f32,
    ) -> staff::Shown {
        let contacts: Vec<ContactHealth> = table
            .contact_ages()
            .map(|(at_mm, age_s)| ContactHealth { at_mm, age_s })
            .collect();
        let devices: Vec<&str> = listeners.lines().collect();
        let door = table.door().phase();
        let frame = table.frame();
        let view = StaffView {
            door,
            settings,
            health: &staff::Health {
                version: env!("CARGO_PKG_VERSION"),
                adapter: &health.adapter,
                uptime_s: self.now_s,
                frame_ms: (health.frame_ms_p50, health.frame_ms_p99),
                touch_ms: (health.touch_ms_p50, health.touch_ms_p95),
                steps_per_s: health.steps_per_s,
                nodes: table.nodes(),
                stages: (table.stages.transport(), table.stages.folds()),
                contacts: &contacts,
                source: word(table.stream.heard()),
                devices: &devices,
                stats: frame.contacts,
                dead_touches: frame.counts.dead_touches,
                panics: frame.panics,
                quarantined: frame.quarantine.uplift_nodes + frame.quarantine.steps,
            },
            notice: table.notice(),
            final_done: table.final_done(),
            scale: staff::scale_for(screen.size(), per_mm),
        };
        self.panel.show(context, &view)
    }

    /// Notes where the buttons of the open panel are, from what egui tells assistive tools.
    fn tell(&mut self, door: DoorPhase, tree: &egui::accesskit::TreeUpdate) {
        let menu = match door {
            DoorPhase::Menu => true,
            DoorPhase::Keypad { .. } => false,
            DoorPhase::Shut | DoorPhase::Holding { .. } | DoorPhase::Locked { .. } => {
                self.told = None;
                return;
            }
        };
        let places: Vec<Place> = tree
            .nodes
            .iter()
            .filter(|(_, node)| node.role() == egui::accesskit::Role::Button)
            .filter_map(|(_, node)| {
                let bounds = node.bounds()?;
                Some(Place {
                    label: Some(node.label()?.to_owned()),
                    x_px: f64::midpoint(bounds.x0, bounds.x1),
                    y_px: f64::midpoint(bounds.y0, bounds.y1),
                })
            })
            .collect();
        let now = (menu, places);
        if self.told.as_ref() != Some(&now) {
            let (keypad, menu) = if menu {
                (None, Some(now.1.clone()))
            } else {
                (Some(now.1.clone()), None)
            };
            self.untold = Some(PanelLine { keypad, menu });
            self.told = Some(now);
        }
    }
}

/// A line of news in the middle of both long sides.
fn notice(painter: &egui::Painter, sight: &Sight<'_>, rect: Rect, text: &str) {
    use crate::ui::palette::{LAMP, ROOM, faded};
    let font = egui::FontId::proportional(sight.mm(9.0).max(13.0));
    for (at, angle) in [
        (rect.center_bottom() - Vec2::new(0.0, sight.mm(60.0)), 0.0),
        (
            rect.center_top() + Vec2::new(0.0, sight.mm(60.0)),
            std::f32::consts::PI,
        ),
    ] {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), LAMP);
        let half = galley.size() / 2.0;
        let back = Rect::from_center_size(at, galley.size() + Vec2::splat(sight.mm(6.0)));
        painter.rect_filled(back, sight.mm(3.0), faded(ROOM, 0.7));
        let turned = egui::emath::Rot2::from_angle(angle) * half;
        painter.add(egui::epaint::TextShape::new(at - turned, galley, LAMP).with_angle(angle));
    }
}

fn point(at: DVec2) -> Pos2 {
    Pos2::new(at.x as f32, at.y as f32)
}
