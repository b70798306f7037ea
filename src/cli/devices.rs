//! `orogen devices`: the touch devices here, or what a HID descriptor means.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use super::DevicesArgs;
use super::console::Console;
use super::failure::Failure;
use crate::input::hid::hex::MAX_TEXT_BYTES;
use crate::input::hid::{Descriptor, Facts, Quirks, describe, descriptor_from_text};

/// Explains the descriptor of `args`, or lists what is plugged in.
pub(super) fn run(args: &DevicesArgs, console: Console) -> Result<(), Failure> {
    match &args.descriptor {
        Some(path) => explain(path, args.json),
        None => here::run(args, console),
    }
}

fn explain(path: &Path, json: bool) -> Result<(), Failure> {
    let name = path.display();
    let unreadable = |error: std::io::Error| Failure::input(format!("{name}: {error}"));
    let mut text = Vec::new();
    // (One byte more than is read tells that there is more.)
    File::open(path)
        .and_then(|file| file.take(MAX_TEXT_BYTES as u64 + 1).read_to_end(&mut text))
        .map_err(unreadable)?;
    let text = String::from_utf8_lossy(&text);
    let bytes = descriptor_from_text(&text).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let descriptor = Descriptor::parse(&bytes).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let max_contacts = descriptor.features.max_contacts(None);
    let facts = Facts::new(&descriptor, max_contacts);
    if json {
        return print_json(&facts);
    }
    let quirks = Quirks::choose(0, 0, &descriptor, max_contacts);
    Console::result(describe(&descriptor, quirks, &facts).trim_end());
    Ok(())
}

fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(value).map_err(Failure::other)?;
    Console::result(&text);
    Ok(())
}

/// Where devices cannot be opened: why, and what to use instead.
#[cfg(not(all(feature = "app", target_os = "linux")))]
mod here {
    use super::super::DevicesArgs;
    use super::super::console::Console;
    use super::super::failure::Failure;
    use super::print_json;
    use crate::input::hid::udev;

    const WHY: &str = if cfg!(windows) {
        "Windows opens touchscreens for itself alone and gives nobody their reports. Touches come through the window \
         without further ado; a table with software of its own can send TUIO."
    } else if cfg!(target_os = "macos") {
        "macOS has no driver for touchscreens. Use one that sends TUIO, such as Touch-Base UPDD."
    } else if cfg!(target_os = "linux") {
        "This orogen was built without the feature `app`, which opens devices. `--descriptor FILE` and `--udev` work."
    } else {
        "Raw HID is read on Linux only. Touches come through the window, or as TUIO."
    };

    pub(super) fn run(args: &DevicesArgs, console: Console) -> Result<(), Failure> {
        if args.udev {
            Console::result(udev::rules(&[]).trim_end());
        } else if args.json {
            print_json(&[(); 0])?;
            console.note(WHY);
        } else {
            Console::result(WHY);
        }
        Ok(())
    }
}

/// The touchscreens that are plugged in.
#[cfg(all(feature = "app", target_os = "linux"))]
mod here {
    use std::io::IsTerminal as _;
    use std::time::{Duration, Instant};

    use serde::Serialize;

    use super::super::DevicesArgs;
    use super::super::console::Console;
    use super::super::failure::Failure;
    use super::print_json;
    use crate::device::DeviceFrame;
    use crate::device::hid::{Bus, Found, HidListener, HidOptions, OpenError, introduce};
    use crate::device::hidraw::Hidraw;
    use crate::input::hid::udev::{self, RULES_FILE, RuleFor};
    use crate::input::hid::{Descriptor, Facts, Quirks, describe};

    /// How long it is listened for contacts.
    const LISTEN: Duration = Duration::from_millis(1500);

    /// One device for tools.
    #[derive(Serialize)]
    struct Here<'a> {
        path: &'a str,
        name: &'a str,
        vid: String,
        pid: String,
        /// Why it cannot be opened; then its facts are not known.
        problem: Option<String>,
        #[serde(flatten)]
        facts: Option<Facts>,
    }

    pub(super) fn run(args: &DevicesArgs, console: Console) -> Result<(), Failure> {
        let mut bus = Hidraw::new().map_err(Failure::other)?;
        let found = bus.list();
        if args.udev {
            let devices: Vec<RuleFor<'_>> = found.iter().map(rule_for).collect();
            Console::result(udev::rules(&devices).trim_end());
            return Ok(());
        }
        let met: Vec<_> = found.iter().map(|found| (found, meet(&mut bus, found))).collect();
        if args.json {
            let devices: Vec<Here<'_>> = met.iter().map(|(found, met)| here(found, met)).collect();
            return print_json(&devices);
        }
        if met.is_empty() {
            Console::result(
                "No HID touchscreen is plugged in. Touches may still come through the window, or as TUIO.",
            );
        }
        for (found, met) in &met {
            say(found, met);
        }
        let is_any_open = met.iter().any(|(_, met)| met.is_ok());
        if is_any_open && std::io::stdout().is_terminal() {
            console.note("Touch the table: contacts are counted for a moment.");
            count(bus)?;
        }
        Ok(())
    }

    type Met = Result<(Descriptor, u32), OpenError>;

    fn meet(bus: &mut Hidraw, found: &Found) -> Met {
        let mut wire = bus.open(found)?;
        let silent = || OpenError::Other("it does not say what it reports".to_owned());
        introduce(&mut *wire).ok_or_else(silent)
    }

    fn rule_for(found: &Found) -> RuleFor<'_> {
        RuleFor {
            name: &found.name,
            vid: found.vid,
            pid: found.pid,
            usb: found.usb,
        }
    }

    fn here<'a>(found: &'a Found, met: &Met) -> Here<'a> {
        Here {
            path: &found.path,
            name: &found.name,
            vid: format!("{:04x}", found.vid),
            pid: format!("{:04x}", found.pid),
            problem: met.as_ref().err().map(OpenError::to_string),
            facts: met
                .as_ref()
                .ok()
                .map(|(descriptor, max)| Facts::new(descriptor, *max)),
        }
    }

    fn say(found: &Found, met: &Met) {
        let Found {
            path, name, vid, pid, ..
        } = found;
        Console::result(&format!("{path}  {vid:04x}:{pid:04x}  {name}"));
        match met {
            Ok((descriptor, max_contacts)) => {
                let quirks = Quirks::choose(*vid, *pid, descriptor, *max_contacts);
                let facts = Facts::new(descriptor, *max_contacts);
                Console::result(&describe(descriptor, quirks, &facts));
            }
            Err(OpenError::Denied) => Console::result(&format!(
                "permission denied: `orogen devices --udev | sudo tee {RULES_FILE}` lets you, then plug it in anew\n"
            )),
            Err(OpenError::Other(problem)) => Console::result(&format!("cannot be opened: {problem}\n")),
        }
    }

    /// Says how many contacts were down at most while it was listened, and how many are now.
    fn count(bus: Hidraw) -> Result<(), Failure> {
        let listener = HidListener::start(Box::new(bus), HidOptions::default()).map_err(Failure::other)?;
        let mut devices: Vec<(u16, String, usize, usize)> = Vec::new();
        let mut frames = Vec::new();
        let end = Instant::now() + LISTEN;
        while Instant::now() < end {
            std::thread::sleep(Duration::from_millis(20));
            listener.drain(&mut frames);
            for frame in &frames {
                match frame {
                    DeviceFrame::Plugged { device, name, .. } => devices.push((*device, name.clone(), 0, 0)),
                    DeviceFrame::State { device, touching, .. } => {
                        for (_, _, now, most) in devices.iter_mut().filter(|known| known.0 == *device) {
                            *now = touching.len();
                            *most = touching.len().max(*most);
                        }
                    }
                    DeviceFrame::Unplugged { .. } | DeviceFrame::Denied { .. } => {}
                }
            }
        }
        for (_, name, now, most) in devices {
            Console::result(&format!("{name}: {now} contacts are down, {most} at most"));
        }
        Ok(())
    }
}
