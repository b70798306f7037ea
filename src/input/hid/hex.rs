//! Report descriptors as text: hexadecimal in the forms in which they are passed on.

use super::prepare::MAX_DESCRIPTOR_BYTES;

/// Most bytes of such a text; one byte of the descriptor takes about five, and people add remarks.
pub const MAX_TEXT_BYTES: usize = 256 * 1024;

/// Why a text is no descriptor: line, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct HexError {
    /// The line, from 1.
    pub line: usize,
    /// What was expected, and what is there.
    pub problem: String,
}

/// The bytes of a descriptor: hexadecimal digits in pairs, with or without `0x`, spaces, commas and line breaks
/// between them, remarks behind `#` or `//`; or a recording of hid-recorder, whose first `R:` line counts.
///
/// # Errors
/// [`HexError`] names the first line that holds anything else.
pub fn descriptor_from_text(text: &str) -> Result<Vec<u8>, HexError> {
    if text.len() > MAX_TEXT_BYTES {
        let problem = format!("{} bytes; expected at most {MAX_TEXT_BYTES}", text.len());
        return Err(HexError { line: 1, problem });
    }
    let numbered = || text.lines().zip(1..);
    if let Some((line, number)) = numbered().find(|(line, _)| line.starts_with("R:")) {
        return recorded(&line[2..], number);
    }
    let mut bytes = Vec::new();
    for (line, number) in numbered() {
        let end = [line.find('#'), line.find("//")].into_iter().flatten().min();
        add(&line[..end.unwrap_or(line.len())], number, &mut bytes)?;
    }
    Ok(bytes)
}

/// `R: LENGTH BYTES`.
fn recorded(text: &str, line: usize) -> Result<Vec<u8>, HexError> {
    let wrong = |problem: String| HexError { line, problem };
    let (length, rest) = text.trim_start().split_once(' ').unwrap_or((text.trim(), ""));
    let length: usize = length
        .parse()
        .map_err(|_| wrong("expected the length of the descriptor behind R:".to_owned()))?;
    let mut bytes = Vec::new();
    add(rest, line, &mut bytes)?;
    if bytes.len() != length {
        return Err(wrong(format!("expected {length} bytes, found {}", bytes.len())));
    }
    Ok(bytes)
}

fn add(text: &str, line: usize, bytes: &mut Vec<u8>) -> Result<(), HexError> {
    let wrong = |problem: String| HexError { line, problem };
    let separates = |c: char| c.is_whitespace() || ",;{}".contains(c);
    for word in text.split(separates).filter(|word| !word.is_empty()) {
        let digits = word
            .strip_prefix("0x")
            .or(word.strip_prefix("0X"))
            .unwrap_or(word);
        let is_one = digits.len() == 1;
        if digits.is_empty()
            || !(is_one || digits.len().is_multiple_of(2))
            || !digits.bytes().all(|b| b.is_ascii_hexdigit())
        {
            let shown: String = word.chars().take(20).collect();
            return Err(wrong(format!("expected hexadecimal bytes, found {shown:?}")));
        }
        for at in (0..digits.len()).step_by(2) {
            let pair = &digits[at..digits.len().min(at + 2)];
            let byte = u8::from_str_radix(pair, 16).map_err(|error| wrong(error.to_string()))?;
            bytes.push(byte);
        }
        if bytes.len() > MAX_DESCRIPTOR_BYTES {
            return Err(wrong(format!("expected at most {MAX_DESCRIPTOR_BYTES} bytes")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        for text in [
            "050d0904a101",
            "05 0d 09 04\na1 01\n",
            "0x05, 0x0D, 0x09, 0x04, // a touchscreen\n0xA1, 0x01",
            "{5, d, 9, 4, a1, 1};\r\n",
            "# hid-recorder\nD: 0\nR: 6 05 0d 09 04 a1 01\nN: Table\nE: 0.0 1 00\n",
        ] {
            let bytes = descriptor_from_text(text).unwrap();
            assert_eq!(bytes, [0x05, 0x0d, 0x09, 0x04, 0xa1, 0x01], "{text}");
        }
        assert!(descriptor_from_text("").unwrap().is_empty());
    }

    #[test]
    fn the_line_that_is_wrong_is_named() {
        for (text, problem) in [
            ("05\nxy", "line 2: expected hexadecimal bytes, found \"xy\""),
            ("123", "line 1: expected hexadecimal bytes, found \"123\""),
            ("0x", "line 1: expected hexadecimal bytes, found \"0x\""),
            ("ä", "line 1: expected hexadecimal bytes, found \"ä\""),
            ("N: x\nR: 3 05 0d", "line 2: expected 3 bytes, found 2"),
            ("R: 05 0d", "line 1: expected 5 bytes, found 1"),
            ("R: x", "line 1: expected the length of the descriptor behind R:"),
        ] {
            assert_eq!(descriptor_from_text(text).unwrap_err().to_string(), problem);
        }
        let long = "00 ".repeat(MAX_DESCRIPTOR_BYTES + 1);
        assert!(descriptor_from_text(&long).unwrap_err().problem.contains("8192"));
        let longer = " ".repeat(MAX_TEXT_BYTES + 1);
        assert!(
            descriptor_from_text(&longer)
                .unwrap_err()
                .problem
                .contains("at most")
        );
    }
}
