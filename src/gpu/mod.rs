//! The graphics card: adapter, device, and what happens when it is lost.
