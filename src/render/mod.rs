//! Surface → shaded land, in plan and in perspective, on the graphics card.
