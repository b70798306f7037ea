//! What comes from outside: maps, piles of rock, recordings of other tools that become contacts, and the touches of a window.

pub mod evemu;
pub mod maps;
pub mod pile;
pub mod window;
