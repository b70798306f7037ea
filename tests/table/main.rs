//! The table without its window: tools, live sessions, the show, staff, settings.

mod instrument;
mod instrument_edit;
mod instrument_final;
mod instrument_support;
mod instrument_tools;
mod kiosk;
mod kiosk_door;
mod kiosk_show;
mod live;
mod live_globe;
mod settings;
mod ui_common;
mod ui_drawing;
mod ui_staff;
mod ui_tools;
