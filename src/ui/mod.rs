//! Ink, controls and staff menu on top of the land.
