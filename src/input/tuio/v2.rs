//! Messages of TUIO 2.0 (Kaltenbrunner and Echtler, "The TUIO 2.0 Protocol", 2018): `frm` begins a frame, `ptr`, `tok`
//! and `bnd` tell of pointers, tokens and outlines, `alv` ends the frame with all that are alive. Messages of one
//! session id are about one thing. Symbols, outlines in detail, links and controls are let pass.

use glam::DVec2;

use super::TuioCounts;
use super::bundle::{Bundle, FrameHead, number, session_id};
use super::contacts::{Extent, Reading};
use super::osc::{Argument, Arguments};

/// All kinds share one list of those alive.
pub(super) const ALL: usize = 0;

/// Takes a message to `/tuio2/` and this kind; `None` where it is not as it should be.
pub(super) fn message(
    bundle: &mut Bundle,
    kind: &[u8],
    mut arguments: Arguments<'_>,
    counts: &mut TuioCounts,
) -> Option<()> {
    match kind {
        b"frm" => frame(bundle, arguments)?,
        b"alv" => bundle.alive[ALL].list(arguments, counts),
        b"ptr" | b"tok" | b"bnd" => {
            let id = session_id(arguments.next()?)?;
            if kind != b"bnd" {
                // Which user, which type, which component: a table asks only where.
                arguments.nth(1)?;
            }
            let mut next = || number(arguments.next()?);
            let at = DVec2::new(next()?, next()?);
            let _angle = next()?;
            let (mut touches, mut extent) = (true, None);
            if kind == b"ptr" {
                let _shear = next()?;
                extent = Some(Extent::Diameter(2.0 * next()?));
                // Below 0 it is the distance of a pointer that hovers.
                touches = next()? >= 0.0;
            } else if kind == b"bnd" {
                extent = Some(Extent::Sides(DVec2::new(next()?, next()?)));
            }
            let reading = Reading {
                id,
                at,
                extent,
                outline: kind == b"bnd",
                touches,
            };
            bundle.reading(ALL, reading, counts);
        }
        _ => return Some(()),
    }
    bundle.speaks_v2 = true;
    Some(())
}

/// `f_id time dim source`. What follows the id may be missing.
fn frame(bundle: &mut Bundle, mut arguments: Arguments<'_>) -> Option<()> {
    let id = session_id(arguments.next()?)?;
    let _time = arguments.next();
    let sensor = arguments.next().and_then(session_id).unwrap_or(0);
    if let Some(Argument::Text(name)) = arguments.next() {
        bundle.name(name);
    }
    bundle.head = Some(FrameHead {
        id,
        sensor: [(sensor >> 16) as u16, sensor as u16],
    });
    Some(())
}
