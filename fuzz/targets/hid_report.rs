#![no_main]

#[path = "../hid_checks.rs"]
#[allow(dead_code, reason = "each target runs one of the checks")]
mod hid_checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hid_checks::reports(bytes));
