//! What comes from outside: maps, and recordings of other tools that become contacts.

pub mod evemu;
pub mod maps;
