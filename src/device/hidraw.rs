//! The touchscreens of Linux, by way of hidraw.

use std::ffi::CString;
use std::fs::OpenOptions;
use std::io::ErrorKind;

use hidapi::{BusType, HidApi, HidDevice};

use super::hid::{Bus, Found, Gone, OpenError, Wire};

/// Page and number of the usage by which touchscreens are known.
const TOUCH_SCREEN: (u16, u16) = (0x0d, 0x04);

/// The hidraw devices of this machine.
pub struct Hidraw {
    api: HidApi,
}

impl std::fmt::Debug for Hidraw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Hidraw").finish_non_exhaustive()
    }
}

impl Hidraw {
    /// The bus.
    ///
    /// # Errors
    /// The system does not tell its devices; the message says why.
    pub fn new() -> Result<Self, String> {
        HidApi::new()
            .map(|api| Self { api })
            .map_err(|error| error.to_string())
    }
}

impl Bus for Hidraw {
    fn list(&mut self) -> Vec<Found> {
        let refreshed = self.api.reset_devices().and_then(|()| self.api.add_devices(0, 0));
        if refreshed.is_err() {
            return Vec::new();
        }
        let mut found: Vec<Found> = Vec::new();
        for device in self.api.device_list() {
            let Ok(path) = device.path().to_str() else {
                continue;
            };
            let is_known = found.iter().any(|found| found.path == path);
            if (device.usage_page(), device.usage()) != TOUCH_SCREEN || is_known {
                continue;
            }
            found.push(Found {
                path: path.to_owned(),
                name: device.product_string().unwrap_or_default().trim().to_owned(),
                vid: device.vendor_id(),
                pid: device.product_id(),
                usb: matches!(device.bus_type(), BusType::Usb),
            });
        }
        found.sort_by(|a, b| a.path.cmp(&b.path));
        found
    }

    fn open(&mut self, found: &Found) -> Result<Box<dyn Wire>, OpenError> {
        // The library turns the system's error into words; this tells whether it is a matter of rights.
        let tried = OpenOptions::new().read(true).write(true).open(&found.path);
        if let Err(error) = tried {
            return Err(match error.kind() {
                ErrorKind::PermissionDenied => OpenError::Denied,
                _ => OpenError::Other(error.to_string()),
            });
        }
        let path = CString::new(found.path.as_str()).map_err(|error| OpenError::Other(error.to_string()))?;
        let device = self.api.open_path(&path);
        match device {
            Ok(device) => Ok(Box::new(Open { device })),
            Err(error) => Err(OpenError::Other(error.to_string())),
        }
    }
}

struct Open {
    device: HidDevice,
}

impl Wire for Open {
    fn descriptor(&mut self, buffer: &mut [u8]) -> Result<usize, Gone> {
        self.device.get_report_descriptor(buffer).map_err(|_| Gone)
    }

    fn ask(&mut self, mut request: Vec<u8>) -> Option<Vec<u8>> {
        let length = self.device.get_feature_report(&mut request).ok()?;
        request.truncate(length);
        Some(request)
    }

    fn tell(&mut self, report: &[u8]) {
        // Devices that refuse are in the right mode already, or have no other.
        let _ = self.device.send_feature_report(report);
    }

    fn read(&mut self, buffer: &mut [u8], timeout_ms: i32) -> Result<usize, Gone> {
        self.device.read_timeout(buffer, timeout_ms).map_err(|_| Gone)
    }
}
