//! What tools draw, looked at as shapes; and the panel of rock layers, pressed by what is written on it.

#![cfg(feature = "app")]

use std::sync::Arc;

use crate::ui_common::{SCREEN, SIZE_MM, map, shapes};
use egui::{Pos2, Rect, Shape, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use orogen::gesture::contact::Side;
use orogen::instrument::{FoldHandle, Paper, SliceView};
use orogen::rock::{Stratigraphy, preset};
use orogen::slice::{Figure, FigureOptions, Slice};
use orogen::surface::{FoldLine, Raster, Surface};
use orogen::ui::layers::{LayersAction, LayersPanel, LayersView};
use orogen::ui::section::{self, NoteDraft, Sheet};
use orogen::ui::{Sight, folds};
use orogen::units::KM;

fn paper(side: Side) -> Paper {
    let south = DVec2::new(250.0, 560.0);
    Paper {
        side,
        centre_mm: if side == Side::South {
            south
        } else {
            SIZE_MM - south
        },
        half_size_mm: DVec2::new(180.0, 100.0),
        strip_mm: 42.0,
        rotation: if side == Side::South {
            0.0
        } else {
            std::f64::consts::PI
        },
    }
}

/// A ridge, cut from west to east.
fn figure(sight: &Sight<'_>) -> Figure {
    let extent = map().extent();
    let raster = |value: fn(DVec2) -> f32| Raster::from_fn(128, 72, extent, value);
    let surface = Surface {
        height: raster(|p| 2000.0 - (p.x / 50.0 - 1800.0).abs() as f32),
        lake_depth: raster(|_| 0.0),
        drainage: raster(|_| 0.0),
        spacing: 500.0,
        rivers: Vec::new(),
        plates: Vec::new(),
        faults: Vec::new(),
        folds: Vec::new(),
        strata: None,
        elapsed_yr: 3e6,
    };
    let ends = [DVec2::new(20.0, 50.0), DVec2::new(150.0, 50.0)].map(|end| end * KM);
    let slice = Slice::cut(&surface, ends, 200).expect("a slice");
    let options = FigureOptions {
        crust: false,
        ..FigureOptions::default()
    };
    slice.figure(section::figure_size(sight, &paper(Side::South)), &options)
}

#[test]
fn a_sheet_is_read_from_its_side_and_nothing_runs_off_it() {
    let sight = Sight::flat(map(), SCREEN);
    let figure = figure(&sight);
    let letters = |side| {
        let paper = paper(side);
        let shown = Sheet {
            figure: Some(&figure),
            facts: "A–A'  130 km   heights × 5",
            draft: None,
        };
        let drawn = shapes(|painter, sight| section::draw_sheet(painter, sight, &paper, &shown, 1.0));
        let corners = [-1.0, 1.0].map(|end| {
            let at = sight.of_table(paper.centre_mm + paper.half_size_mm * end);
            at.expect("on the table")
        });
        let sheet = Rect::from_two_pos(corners[0], corners[1]).expand(0.5);
        let mut texts = Vec::new();
        for shape in &drawn {
            match shape {
                Shape::Text(text) => {
                    assert!(
                        sheet.contains_rect(text.visual_bounding_rect()),
                        "{:?}",
                        text.galley.text()
                    );
                    assert!(text.galley.size().y >= 11.0, "letters that can be read");
                    texts.push((text.galley.text().to_owned(), text.angle));
                }
                Shape::Mesh(mesh) => assert!(mesh.vertices.iter().all(|v| sheet.contains(v.pos))),
                _ => {}
            }
        }
        texts
    };
    let (south, north) = (letters(Side::South), letters(Side::North));
    assert!(south.iter().any(|(text, _)| text.starts_with('A')), "{south:?}");
    assert!(
        south
            .iter()
            .any(|(text, _)| text.contains("heights ×") || text.contains("true scale")),
        "{south:?}"
    );
    assert_eq!(south.len(), north.len());
    for ((a, upright), (b, turned)) in south.iter().zip(&north) {
        assert_eq!((a, *upright), (b, 0.0));
        assert!((turned - std::f32::consts::PI).abs() < 1e-6);
    }
}

#[test]
fn a_tap_on_the_section_is_a_part_of_its_length() {
    let sight = Sight::flat(map(), SCREEN);
    let (figure, paper) = (figure(&sight), paper(Side::North));
    let part = |x| section::part_of_length(&sight, &paper, &figure, DVec2::new(x, 0.5));
    let parts: Vec<f64> = (0..=100).filter_map(|i| part(f64::from(i) / 100.0)).collect();
    assert!(parts.len() > 60 && parts.is_sorted(), "{parts:?}");
    assert!(parts[0] < 0.05 && parts[parts.len() - 1] > 0.95);
    assert_eq!(part(0.001), None, "beside the section");
    let draft = NoteDraft {
        at: 0.5,
        text: "summit".to_owned(),
    };
    let shown = Sheet {
        figure: Some(&figure),
        facts: "",
        draft: Some(&draft),
    };
    let drawn = shapes(|painter, sight| section::draw_sheet(painter, sight, &paper, &shown, 1.0));
    let typed = |shape: &Shape| matches!(shape, Shape::Text(text) if text.galley.text() == "summit|");
    assert!(drawn.iter().any(typed));
}

#[test]
fn a_cross_section_has_its_letters_and_an_open_one_only_the_first() {
    let view = SliceView {
        side: Side::North,
        ends: [DVec2::new(300.0, 300.0), DVec2::new(900.0, 320.0)],
        whole: true,
        held: [true, false],
        handles: true,
        frozen: false,
    };
    let letters = |view: SliceView| -> Vec<String> {
        let drawn = shapes(|painter, sight| section::draw_lines(painter, sight, [view].into_iter(), 1.0));
        let texts = drawn.iter().filter_map(|shape| match shape {
            Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        });
        texts.collect()
    };
    assert_eq!(letters(view), ["B", "B'"]);
    let open = SliceView {
        ends: [view.ends[0]; 2],
        whole: false,
        ..view
    };
    assert_eq!(letters(open), ["B"]);
    let wild = SliceView {
        ends: [DVec2::NAN, DVec2::splat(f64::INFINITY)],
        ..view
    };
    assert_eq!(letters(wild), Vec::<String>::new());
}

#[test]
fn crests_and_troughs_differ_in_line_and_arrows_not_only_in_colour() {
    let axis = |crest| FoldLine {
        layer: 0,
        wavelength_m: 8e3,
        points: vec![DVec2::new(40.0, 50.0) * KM, DVec2::new(80.0, 50.0) * KM],
        crest,
    };
    let heads = |crest| -> Vec<(Pos2, f32)> {
        let drawn = shapes(|painter, sight| folds::draw_axes(painter, sight, &[axis(crest)], 1.0));
        let y = Sight::flat(map(), SCREEN)
            .of_plan(DVec2::new(40.0, 50.0) * KM)
            .expect("on the table")
            .y;
        let filled = drawn.iter().filter_map(|shape| match shape {
            Shape::Path(path) if path.fill.a() > 0 => Some((path.points[0], y)),
            _ => None,
        });
        filled.collect()
    };
    let (crest, trough) = (heads(true), heads(false));
    assert_eq!(crest.len(), trough.len());
    assert!(crest.len() >= 2 && crest.len().is_multiple_of(2));
    let reach = |heads: &[(Pos2, f32)]| heads.iter().map(|(tip, y)| (tip.y - y).abs()).sum::<f32>();
    assert!(
        reach(&crest) > 4.0 * reach(&trough),
        "away from the axis, and towards it"
    );
    let lines = |crest| shapes(|painter, sight| folds::draw_axes(painter, sight, &[axis(crest)], 1.0)).len();
    assert!(lines(false) > lines(true), "a trough is dashed");
}

#[test]
fn what_a_finger_draws_is_there_at_once_and_wild_places_are_not() {
    let path = [DVec2::new(300.0, 300.0), DVec2::new(500.0, 320.0)];
    let handle = FoldHandle {
        side: Side::South,
        path: &path,
        middle: DVec2::new(400.0, 310.0),
        at: DVec2::new(400.0, 280.0),
        lowest: DVec2::new(400.0, 350.0),
        highest: DVec2::new(400.0, 230.0),
        by: 1.75,
        held: true,
    };
    let drawn = |strokes: &[Vec<DVec2>], handles: &[FoldHandle<'_>]| {
        shapes(|painter, sight| folds::draw_tool(painter, sight, strokes, handles.iter().copied(), 1.0))
    };
    assert_eq!(drawn(&[], &[]), []);
    assert!(!drawn(&[path.to_vec()], &[]).is_empty());
    assert!(!drawn(&[], &[handle]).is_empty());
    let wild = FoldHandle {
        at: DVec2::NAN,
        path: &[DVec2::NAN],
        ..handle
    };
    assert_eq!(drawn(&[vec![DVec2::NAN; 3], vec![path[0]], vec![]], &[wild]), []);
}

struct Desk {
    panel: LayersPanel,
    pile: Arc<Stratigraphy>,
    saved: Vec<String>,
    actions: Vec<LayersAction>,
}

fn desk() -> Harness<'static, Desk> {
    let desk = Desk {
        panel: LayersPanel::default(),
        pile: preset::default(),
        saved: vec!["mine".to_owned()],
        actions: Vec::new(),
    };
    let run = |ui: &mut egui::Ui, desk: &mut Desk| {
        let view = LayersView {
            pile: &desk.pile,
            saved: &desk.saved,
            wavelength: |stiff, _, _| 7.0 * stiff,
            notice: None,
            scale: 0.93,
        };
        let shown = desk.panel.show(&ui.ctx().clone(), &view);
        desk.actions.extend(shown.actions);
    };
    let mut harness = Harness::builder()
        .with_size(Vec2::new(1280.0, 720.0))
        .build_ui_state(run, desk);
    harness.run_steps(3);
    harness
}

fn press(harness: &mut Harness<'_, Desk>, label: &str) -> Vec<LayersAction> {
    harness.get_by_label(label).click();
    harness.run_steps(3);
    std::mem::take(&mut harness.state_mut().actions)
}

#[test]
fn a_preset_is_laid_and_a_changed_one_is_another_pile() {
    let mut harness = desk();
    assert_eq!(press(&mut harness, "Lay it"), [], "it is there already");
    assert_eq!(press(&mut harness, "Jura"), []);
    let jura = preset::by_name("jura").expect("a preset");
    assert_eq!(press(&mut harness, "Lay it"), [LayersAction::Lay(jura.clone())]);
    assert_eq!(press(&mut harness, "Malm limestone"), []);
    press(&mut harness, "Remove");
    let laid = press(&mut harness, "Lay it");
    let [LayersAction::Lay(changed)] = &laid[..] else {
        panic!("{laid:?}");
    };
    assert_eq!(changed.layers().len(), jura.layers().len() - 1);
    assert!(
        changed
            .layers()
            .iter()
            .all(|layer| layer.name != "Malm limestone")
    );
    assert_eq!(changed.name(), "my_jura");
    let kept = press(&mut harness, "Keep");
    assert!(
        matches!(&kept[..], [LayersAction::Save(name, _)] if name == "jura"),
        "{kept:?}"
    );
    assert_eq!(
        press(&mut harness, "mine"),
        [LayersAction::Load("mine".to_owned())]
    );
    assert_eq!(press(&mut harness, "Close"), [LayersAction::Close]);
}

#[test]
fn layers_come_up_to_the_most_there_may_be_and_all_can_go() {
    let mut harness = desk();
    for _ in 0..20 {
        press(&mut harness, "Add");
    }
    press(&mut harness, "Up");
    for laid in press(&mut harness, "Lay it") {
        let LayersAction::Lay(pile) = laid else {
            panic!("{laid:?}")
        };
        assert_eq!(pile.layers().len(), orogen::rock::MAX_LAYERS);
    }
    for _ in 0..20 {
        press(&mut harness, "Remove");
    }
    let laid = press(&mut harness, "Lay it");
    assert!(
        matches!(&laid[..], [LayersAction::Lay(pile)] if pile.layers().is_empty()),
        "{laid:?}"
    );
}
