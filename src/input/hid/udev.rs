//! The rule by which Linux lets a user listen to a touchscreen.

use std::fmt::Write as _;

/// Where the rule belongs: a name that sorts before `73-seat-late.rules`, which acts on the tag `uaccess`.
pub const RULES_FILE: &str = "/etc/udev/rules.d/70-orogen.rules";

/// A device as a rule names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleFor<'a> {
    /// What it calls itself.
    pub name: &'a str,
    /// Number of its maker.
    pub vid: u16,
    /// Number of the product.
    pub pid: u16,
    /// Whether it is plugged in by USB; others (I²C, Bluetooth) are known by their name in the kernel.
    pub usb: bool,
}

/// The rules file for these devices; without any, with numbers to fill in.
pub fn rules(devices: &[RuleFor<'_>]) -> String {
    let mut text = format!(
        "# Orogen reads these touchscreens. Keep as {RULES_FILE}: the name must sort before 73-seat-late.rules.\n\
         # Then: sudo udevadm control --reload && sudo udevadm trigger, or plug the table in anew.\n\
         # Check with: getfacl /dev/hidraw*\n"
    );
    for device in devices {
        let plain = |c: char| !c.is_control();
        let name: String = device.name.chars().filter(|&c| plain(c)).take(80).collect();
        let _ = writeln!(text, "\n# {name}");
        rule(&mut text, &matches(device));
    }
    if devices.is_empty() {
        text.push_str("\n# No touchscreen is plugged in. Fill in the four digits of maker and product, in lower case (lsusb shows them).\n");
        rule(&mut text, "ATTRS{idVendor}==\"vvvv\", ATTRS{idProduct}==\"pppp\"");
    }
    text
}

fn matches(device: &RuleFor<'_>) -> String {
    let (vid, pid) = (device.vid, device.pid);
    if device.usb {
        format!("ATTRS{{idVendor}}==\"{vid:04x}\", ATTRS{{idProduct}}==\"{pid:04x}\"")
    } else {
        // The kernel writes these names in upper case.
        format!("KERNELS==\"*:{vid:04X}:{pid:04X}.*\"")
    }
}

fn rule(text: &mut String, matches: &str) {
    let _ = writeln!(text, "KERNEL==\"hidraw*\", {matches}, TAG+=\"uaccess\"");
    let _ = writeln!(
        text,
        "# A service without a seat takes a group instead:\n\
         # KERNEL==\"hidraw*\", {matches}, GROUP=\"touchkiosk\", MODE=\"0660\""
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_lower_case_and_the_name_cannot_break_the_file() {
        let usb = RuleFor {
            name: "Table\nKERNEL==\"*\"",
            vid: 0x0eef,
            pid: 0x72FA,
            usb: true,
        };
        let text = rules(&[
            usb,
            RuleFor {
                usb: false,
                name: "i2c",
                ..usb
            },
        ]);
        let expected =
            "KERNEL==\"hidraw*\", ATTRS{idVendor}==\"0eef\", ATTRS{idProduct}==\"72fa\", TAG+=\"uaccess\"";
        assert!(text.lines().any(|line| line == expected), "{text}");
        assert!(text.contains("KERNELS==\"*:0EEF:72FA.*\", TAG"));
        let active = text
            .lines()
            .filter(|line| !line.starts_with('#') && !line.is_empty());
        assert!(
            active
                .clone()
                .all(|line| line.starts_with("KERNEL==\"hidraw*\", ")),
            "{text}"
        );
        assert_eq!(active.count(), 2);
        assert!(RULES_FILE.rsplit('/').next() < Some("73-seat-late.rules"));
    }

    #[test]
    fn without_a_device_there_is_a_rule_to_fill_in() {
        assert!(rules(&[]).contains("vvvv"));
    }
}
