//! What comes from outside: maps.

pub mod maps;
