//! A fingerprint of the land.

use sha2::{Digest as _, Sha256};

/// SHA-256 of raw heights as little-endian f64, in lower-case hexadecimal: equal exactly when every bit is.
pub fn digest(heights: &[f64]) -> String {
    use std::fmt::Write as _;
    let mut hasher = Sha256::new();
    for height in heights {
        hasher.update(height.to_le_bytes());
    }
    hasher
        .finalize()
        .iter()
        .fold(String::with_capacity(64), |mut hex, byte| {
            // Writing into a string cannot fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digest_is_sha256_of_the_bytes() {
        // Eight zero bytes, by `sha256sum`.
        assert_eq!(
            digest(&[0.0]),
            "af5570f5a1810b7af78caf4bc70a660f0df51e42baf91d4de5b2328de0e83dfc"
        );
        assert_ne!(digest(&[0.0]), digest(&[-0.0]), "bits count, not values");
    }
}
