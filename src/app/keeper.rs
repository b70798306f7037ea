//! Word to whoever keeps the program running: systemd, where it asks for it (`Type=notify`, `WatchdogSec=`).

/// The loop that draws is alive: to be called about once a second, from there and nowhere else.
#[cfg(target_os = "linux")]
pub(super) fn alive() {
    use sd_notify::NotifyState;
    // Ready is said each time: systemd takes the first and lets the others pass.
    if let Err(error) = sd_notify::notify(&[NotifyState::Ready, NotifyState::Watchdog]) {
        tracing::warn!("systemd does not hear: {error}");
    }
}

/// Elsewhere nobody asks.
#[cfg(not(target_os = "linux"))]
pub(super) fn alive() {}
