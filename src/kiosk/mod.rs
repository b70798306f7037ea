//! The kiosk's circle: attract, invite, play, idle warning, reset; and the way in for staff.
