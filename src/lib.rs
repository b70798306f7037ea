//! Orogen: a multi-touch sculpting table. Each hand is a tectonic plate; between hands the crust thickens and rises,
//! and rivers cut it while it grows.
//!
//! # The way of the data
//!
//! contact → stroke → hand → plate → transport → compression → uplift → TIN erosion → surface → picture.
//! The modules stand in that order; read from top to bottom, they are the program.
//!
//! | module | what it does | what it must not know |
//! |---|---|---|
//! | [`units`] | frames and quantities; converts table mm ↔ plan m, and ↔ places on the globe | anything |
//! | [`sphere`] | samples on the sphere that never move, their neighbours, the nearest one | anything |
//! | [`rock`] | layers of rock, their column at a place, named piles | anything |
//! | [`gesture`] | contacts → strokes → hands → rigid fit; the gesture file | worlds, window, clock, files |
//! | [`mountain`] | plates, transport, compression, fault, uplift, strata of the flat world | window, files, who owns it |
//! | [`terrain`] | TIN, flow routing with lakes, stream power, landslides | plates, gestures, window |
//! | [`isostasy`] | the crust floats: root, rebound and foreland by flexure on a coarse grid | plates, gestures, window |
//! | [`globe`] | plates on the sphere: subduction, collision, sea floor, rifts | the flat world, gestures, window |
//! | [`sim`] | owns the world: tick, parameters, undo, roll-back, quarantine; [`sim::globe`] owns the planet | window, clock, files |
//! | [`surface`] | what a tick yields for eyes and files: plain data | who made it |
//! | [`mod@slice`] | surface → what a vertical cut meets, and the shapes that draw it | who made it, who paints it |
//! | [`survey`] | a land on its nodes → surface | plates, gestures, window |
//! | [`live`] | the session's thread: input in without loss, the newest surface out, panics survived | window, clock |
//! | [`instrument`] | whose contact is it: land, tool or control; the controls of each side | worlds, window, clock |
//! | [`kiosk`] | attract, invite, play, idle, reset; staff access | worlds, window, clock, files |
//! | [`settings`] | the one settings file, validated | window |
//! | [`picture`] | surface → relief map | worlds |
//! | `gpu`, `render` | the graphics card; surface → shaded land in plan and in perspective, or the globe (feature `app`) | gestures, worlds |
//! | `ui` | ink, controls and staff menu on top of the land (feature `app`) | worlds, window |
//! | `app` | window, event loop, threads, metrics (feature `app`) | |
//! | [`export`] | rasters, meshes, rivers → files, whole or not at all | worlds |
//! | [`input`] | touch devices' bytes, TUIO, recordings of other tools → contacts; maps from files | worlds |
//! | `device` | opens touch devices, each on a thread of its own (feature `app`) | window, worlds |
//! | [`report`] | the facts of a run | clock, files |
//! | [`cli`] | the commands; beside `app` and `device` the only place with a clock, and the only one with a terminal | |
//!
//! # What is absent
//!
//! * The core (all but `gpu`, `render`, `ui`, `app`, `device` and [`cli`]) never names a window, a graphics card, the clock
//!   or the environment. The same input gives the same bits, for any number of threads; the one seed is in the world.
//! * [`gesture`], [`mountain`], [`terrain`], [`isostasy`] and [`sim`] read and write no files.
//! * Parameters are passed in and never stored in the world, so a snapshot is a clone of plain data.
//! * The table's y axis points down and is in millimetres; the plan's points north and is in metres. Only [`units`]
//!   knows both.
//!
//! `tests/layers.rs` reads the sources and fails where one of these is broken.
//!
//! # Where to step in
//!
//! * A stage on another device implements [`mountain::transport::TransportStage`] or [`mountain::fold::FoldStage`], whose
//!   CPU versions are the truth, and reaches a session in [`mountain::Stages`]. Those of `gpu` are twins in shaders of the
//!   same name.
//! * A device hands its contacts to [`sim::Sim::feed`] as [`gesture::contact::InputFrame`]s, as a gesture file does; on
//!   the live table to [`live::Session::send`].
//! * Another solver of the land works on [`terrain::Tin`] and [`terrain::Forcing`].

pub mod units;

pub mod sphere;

pub mod rock;

pub mod gesture;

pub mod mountain;

pub mod terrain;

pub mod isostasy;

pub mod globe;

pub mod sim;

pub mod surface;

pub mod slice;

pub mod survey;

pub mod live;

pub mod instrument;

pub mod kiosk;

pub mod settings;

pub mod picture;

#[cfg(feature = "app")]
pub mod gpu;

#[cfg(feature = "app")]
pub mod render;

#[cfg(feature = "app")]
pub mod ui;

#[cfg(feature = "app")]
pub mod app;

pub mod export;

pub mod input;

#[cfg(feature = "app")]
pub mod device;

pub mod report;

pub mod cli;
