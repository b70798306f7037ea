//! Messages of TUIO 1.1 (Kaltenbrunner et al., "TUIO: A Protocol for Table-Top Tangible User Interfaces", 2005, and
//! the specification 1.1): `source name`, `alive s_id...`, `set s_id ...` and `fseq n` of each profile.

use glam::DVec2;

use super::TuioCounts;
use super::bundle::{Bundle, number, session_id};
use super::contacts::{Extent, Reading};
use super::osc::{Argument, Arguments};

/// Index of the profile of cursors: fingers.
pub(super) const CURSORS: usize = 0;
/// Index of the profile of objects: what carries a marker.
pub(super) const OBJECTS: usize = 1;
/// Index of the profile of blobs: anything that has an outline.
pub(super) const BLOBS: usize = 2;

/// Takes a message to `/tuio/` and this profile. Other profiles are let pass; `None` where it is not as it should be.
pub(super) fn message(
    bundle: &mut Bundle,
    profile: &[u8],
    mut arguments: Arguments<'_>,
    counts: &mut TuioCounts,
) -> Option<()> {
    let profile = match profile {
        b"2Dcur" => CURSORS,
        b"2Dobj" => OBJECTS,
        b"2Dblb" => BLOBS,
        _ => return Some(()),
    };
    let Argument::Text(command) = arguments.next()? else {
        return None;
    };
    match command {
        b"source" => {
            let Argument::Text(name) = arguments.next()? else {
                return None;
            };
            bundle.name(name);
        }
        b"alive" => bundle.alive[profile].list(arguments, counts),
        b"set" => {
            let reading = set(profile, arguments)?;
            bundle.reading(profile, reading, counts);
        }
        b"fseq" => {
            let frame = number(arguments.next()?).filter(|frame| frame.fract() == 0.0)?;
            bundle.number[profile] = Some(frame as i32);
        }
        _ => return None,
    }
    bundle.speaks_v1 = true;
    Some(())
}

/// Cursors: `s_id x y X Y m`. Objects: `s_id i_id x y a ...`. Blobs: `s_id x y a w h f ...`. What follows the place and
/// the size may be missing; nobody needs it here.
fn set(profile: usize, mut arguments: Arguments<'_>) -> Option<Reading> {
    let id = session_id(arguments.next()?)?;
    if profile == OBJECTS {
        arguments.next()?;
    }
    let mut next = || number(arguments.next()?);
    let at = DVec2::new(next()?, next()?);
    let extent = if profile == BLOBS {
        let _angle = next()?;
        Some(Extent::Sides(DVec2::new(next()?, next()?)))
    } else {
        None
    };
    Some(Reading {
        id,
        at,
        extent,
        outline: false,
        touches: true,
    })
}
