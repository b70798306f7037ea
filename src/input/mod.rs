//! What comes from outside: maps, recordings of other tools that become contacts, and the touches of a window.

pub mod evemu;
pub mod maps;
pub mod window;
