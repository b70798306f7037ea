//! Whose contact is it: the land's, a tool's or a control's; and the controls of each side of the table.
//!
//! * [`Instrument::feed`] takes each contact event and says where it goes ([`Route`]). A contact keeps its owner until
//!   it lifts, whatever it slides over; several people do different things at once.
//! * Controls act when the contact lifts on them, and not when it has slid off (WCAG 2.5.2); what cannot be taken
//!   back by undo is held. They stand in a row along each long side, turned towards it, within reach of a seated
//!   visitor (610 mm), and belong to that side: its tool, its undo.
//! * What has been done comes out of [`Instrument::drain`] as [`Deed`]s, of which the [`Command`]s are what a gesture
//!   file records.
//!
//! [`Command`]: crate::gesture::command::Command

mod control;
mod deed;
mod edit;
mod fold;
mod history;
mod layout;
mod operate;
mod owner;
mod press;
mod slice;
mod speed;
mod table;

pub use control::{ControlId, ControlKind, ControlView, Paper};
pub use deed::{Deed, EditView, Editing, FoldHandle, Key, Route, Scene, SliceView};
pub use table::{Instrument, InstrumentParams};
