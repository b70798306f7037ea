//! The file of a pile of layers: what it may hold, what it refuses and how it says so.

use orogen::rock::{Stratigraphy, preset};
use proptest::prelude::*;

fn plain() -> &'static str {
    preset::file("plain").expect("a preset")
}

fn refused(text: &str) -> String {
    Stratigraphy::parse(text.as_bytes(), "my.toml")
        .expect_err("a fault")
        .to_string()
}

#[test]
fn what_is_written_reads_back() {
    for name in preset::names() {
        let pile = preset::by_name(name).unwrap();
        let again = Stratigraphy::parse(pile.to_toml().as_bytes(), name).unwrap();
        assert_eq!(*pile, again);
    }
}

#[test]
fn faults_name_file_line_key_and_what_was_expected() {
    let thin = plain().replacen("thickness_m = 700.0", "thickness_m = 7.0", 1);
    let line = thin
        .lines()
        .position(|l| l.contains("thickness_m = 7.0"))
        .unwrap()
        + 1;
    assert_eq!(
        refused(&thin),
        format!("my.toml:{line}: layer 1: thickness_m: expected 100.0 to 5000.0 m, found 7.0")
    );
    let unknown = plain().replacen("contrast", "contrst", 1);
    assert!(refused(&unknown).contains("unknown field `contrst`"));
    let colour = plain().replacen("#ffe619", "yellow", 1);
    assert!(refused(&colour).contains("layer 1: colour: expected \"#rrggbb\", found \"yellow\""));
    let none = plain().replacen("beds = 4", "beds = 0", 1);
    assert!(refused(&none).contains("layer 1: beds: expected 1 to 10, found 0"));
    let layer = &plain()[plain().find("\n[[layer]]").unwrap()..];
    assert!(refused(&format!("{}{}", plain(), layer.repeat(3))).contains("at most 10 layers"));
    assert!(refused("name = \"\"").starts_with("my.toml:1: "));
    assert!(refused("\u{0}").starts_with("my.toml:1: "));
}

proptest! {
    /// No bytes make the reader panic, and errors are one line.
    #[test]
    fn any_bytes_are_read_or_refused_in_one_line(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        if let Err(error) = Stratigraphy::parse(&bytes, "x") {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }

    /// The same for files in which one place is spoilt.
    #[test]
    fn a_spoilt_file_is_read_or_refused_in_one_line(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = plain().as_bytes().to_vec();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        match Stratigraphy::parse(&bytes, "x") {
            Ok(pile) => {
                let again = Stratigraphy::parse(pile.to_toml().as_bytes(), "x");
                prop_assert_eq!(again.as_ref(), Ok(&pile));
            }
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }
}
