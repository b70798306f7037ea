//! Recordings of several devices: the touchscreen counts, and of several the one that was touched most.

use super::ImportFault;

/// Most devices that an error or warning names.
const MAX_NAMED: usize = 4;

/// One of the devices.
pub(super) struct Candidate {
    /// What it is and how it is called.
    pub(super) name: String,
    /// How often it was touched, if it is a touchscreen.
    pub(super) touched: Option<usize>,
}

/// Which device counts, and a warning that says so where there are several.
///
/// # Errors
/// No device is a touchscreen.
pub(super) fn choose(devices: &[Candidate]) -> Result<(usize, Option<String>), ImportFault> {
    let touchscreens = devices.iter().enumerate();
    let touchscreens = touchscreens.filter_map(|(i, device)| Some((i, device.touched?)));
    // (The first of equals.)
    let most = touchscreens.rev().max_by_key(|(_, touched)| *touched);
    let Some((chosen, _)) = most else {
        return Err(ImportFault::NoTouchscreen {
            found: listed(devices, None),
        });
    };
    let warning = (devices.len() > 1).then(|| {
        let others = listed(devices, Some(chosen));
        format!("taken: {}; left out: {others}", devices[chosen].name)
    });
    Ok((chosen, warning))
}

/// The devices in words, without one of them.
fn listed(devices: &[Candidate], but: Option<usize>) -> String {
    let others = devices.iter().enumerate().filter(|(i, _)| Some(*i) != but);
    let others: Vec<&str> = others.map(|(_, device)| device.name.as_str()).collect();
    match others.len() {
        0 => "nothing".to_owned(),
        n if n > MAX_NAMED => format!("{} and {} more", others[..MAX_NAMED].join(", "), n - MAX_NAMED),
        _ => others.join(", "),
    }
}
