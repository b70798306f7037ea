//! What comes from outside: recordings of other tools become contacts.

pub mod evemu;
