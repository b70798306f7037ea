//! Reads the bytes of an Open Sound Control packet where they lie ("The Open Sound Control 1.0 Specification", 2002).
//!
//! A packet is a message, or a bundle of messages and bundles. A message is an address, a text of type tags and the
//! arguments they announce; everything is big-endian and padded to four bytes. Nothing is copied, and bundles within
//! bundles are followed to [`MAX_DEPTH`] only: a packet from the network must not choose how deep the stack grows.

/// Bundles within bundles that are followed. TUIO has none; hubs that pass on several senders have one.
const MAX_DEPTH: usize = 4;

/// Bytes before the first element of a bundle: its tag and its time.
const BUNDLE_HEAD: usize = 16;

/// What a packet holds, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Element<'a> {
    /// A message of the bundle.
    Message(Message<'a>),
    /// The innermost open bundle ends; also after what was torn.
    EndOfBundle,
}

/// The packet ends before it should, is nested too deep, or was never one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

/// A message: where it goes and what it says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Message<'a> {
    /// Such as `/tuio/2Dcur`.
    pub(super) address: &'a [u8],
    tags: &'a [u8],
    data: &'a [u8],
}

/// One argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Argument<'a> {
    /// A whole number.
    Int(i64),
    /// A number, as sent.
    Float(f64),
    /// A text, in any encoding.
    Text(&'a [u8]),
    /// Anything else.
    Other,
}

impl<'a> Message<'a> {
    /// The arguments up to the first that is torn or of a type nobody knows; arrays are read through.
    pub(super) fn arguments(self) -> Arguments<'a> {
        Arguments {
            tags: self.tags,
            data: self.data,
        }
    }

    fn read(mut bytes: &'a [u8]) -> Result<Self, Malformed> {
        let address = take_text(&mut bytes).ok_or(Malformed)?;
        // Senders from before type tags say nothing that could be read.
        let tags = take_text(&mut bytes).ok_or(Malformed)?;
        if address.first() != Some(&b'/') || tags.first() != Some(&b',') {
            return Err(Malformed);
        }
        Ok(Self {
            address,
            tags: &tags[1..],
            data: bytes,
        })
    }
}

/// The arguments of a message, one after another.
#[derive(Clone, Debug)]
pub(super) struct Arguments<'a> {
    tags: &'a [u8],
    data: &'a [u8],
}

impl<'a> Iterator for Arguments<'a> {
    type Item = Argument<'a>;

    fn next(&mut self) -> Option<Argument<'a>> {
        loop {
            let (&tag, rest) = self.tags.split_first()?;
            self.tags = rest;
            if !matches!(tag, b'[' | b']') {
                let argument = self.argument(tag);
                if argument.is_none() {
                    self.tags = &[];
                }
                return argument;
            }
        }
    }
}

impl<'a> Arguments<'a> {
    fn argument(&mut self, tag: u8) -> Option<Argument<'a>> {
        let data = &mut self.data;
        Some(match tag {
            b'i' => Argument::Int(i32::from_be_bytes(take(data)?).into()),
            b'h' => Argument::Int(i64::from_be_bytes(take(data)?)),
            b'f' => Argument::Float(f32::from_be_bytes(take(data)?).into()),
            b'd' => Argument::Float(f64::from_be_bytes(take(data)?)),
            b's' | b'S' => Argument::Text(take_text(data)?),
            b'b' => {
                let length = u32::from_be_bytes(take(data)?) as usize;
                *data = data.get(length.checked_next_multiple_of(4)?..)?;
                Argument::Other
            }
            b't' => {
                take::<8>(data)?;
                Argument::Other
            }
            b'c' | b'r' | b'm' => {
                take::<4>(data)?;
                Argument::Other
            }
            b'T' | b'F' | b'N' | b'I' => Argument::Other,
            _ => return None,
        })
    }
}

/// Shows `visit` what a packet holds. What stands before a fault is shown all the same.
pub(super) fn read(packet: &[u8], visit: &mut impl FnMut(Element<'_>)) -> Result<(), Malformed> {
    element(packet, 0, visit)
}

fn element(bytes: &[u8], depth: usize, visit: &mut impl FnMut(Element<'_>)) -> Result<(), Malformed> {
    if !bytes.starts_with(b"#bundle\0") {
        visit(Element::Message(Message::read(bytes)?));
        return Ok(());
    }
    let mut rest = bytes.get(BUNDLE_HEAD..).ok_or(Malformed)?;
    if depth == MAX_DEPTH {
        return Err(Malformed);
    }
    let mut outcome = Ok(());
    while !rest.is_empty() {
        let within =
            take(&mut rest).and_then(|length| rest.split_at_checked(u32::from_be_bytes(length) as usize));
        let Some((inner, after)) = within else {
            outcome = Err(Malformed);
            break;
        };
        rest = after;
        outcome = outcome.and(element(inner, depth + 1, visit));
    }
    visit(Element::EndOfBundle);
    outcome
}

fn take<const N: usize>(data: &mut &[u8]) -> Option<[u8; N]> {
    let (head, rest) = data.split_first_chunk()?;
    *data = rest;
    Some(*head)
}

/// A text ends with a zero and is filled up with zeros to four bytes.
fn take_text<'a>(data: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = data.iter().position(|&byte| byte == 0)?;
    let text = &data[..length];
    *data = data.get((length + 1).next_multiple_of(4)..)?;
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rosc::{OscBundle, OscMessage, OscPacket, OscTime, OscType, encoder};

    fn argument() -> impl Strategy<Value = OscType> {
        let leaf = prop_oneof![
            any::<i32>().prop_map(OscType::Int),
            any::<i64>().prop_map(OscType::Long),
            any::<f32>().prop_map(OscType::Float),
            any::<f64>().prop_map(OscType::Double),
            "[a-z@:.]{0,9}".prop_map(OscType::String),
            prop::collection::vec(any::<u8>(), 0..9).prop_map(OscType::Blob),
            Just(OscType::Char('x')),
            Just(OscType::Bool(true)),
            Just(OscType::Bool(false)),
            Just(OscType::Nil),
            Just(OscType::Inf),
            any::<(u32, u32)>().prop_map(|time| OscType::Time(time.into())),
        ];
        leaf.prop_recursive(2, 8, 4, |inner| {
            prop::collection::vec(inner, 0..4).prop_map(|content| OscType::Array(rosc::OscArray { content }))
        })
    }

    fn packet() -> impl Strategy<Value = OscPacket> {
        let args = prop::collection::vec(argument(), 0..9);
        let message = ("/[a-zA-Z0-9/]{0,12}", args)
            .prop_map(|(addr, args)| OscPacket::Message(OscMessage { addr, args }));
        message.prop_recursive(MAX_DEPTH as u32, 24, 6, |inner| {
            prop::collection::vec(inner, 0..6).prop_map(|content| {
                let timetag = OscTime::from((0, 1));
                OscPacket::Bundle(OscBundle { timetag, content })
            })
        })
    }

    /// What [`read`] shows of a packet, one line each.
    fn lines(bytes: &[u8]) -> (Vec<String>, Result<(), Malformed>) {
        let mut lines = Vec::new();
        let outcome = read(bytes, &mut |element| match element {
            Element::Message(message) => {
                let arguments: Vec<_> = message.arguments().collect();
                lines.push(format!("{:?} {arguments:?}", message.address));
            }
            Element::EndOfBundle => lines.push("end".to_owned()),
        });
        (lines, outcome)
    }

    /// The same of what `rosc` reads.
    fn expected(packet: &OscPacket, lines: &mut Vec<String>) {
        fn push<'a>(args: &'a [OscType], out: &mut Vec<Argument<'a>>) {
            for arg in args {
                match arg {
                    OscType::Int(v) => out.push(Argument::Int((*v).into())),
                    OscType::Long(v) => out.push(Argument::Int(*v)),
                    OscType::Float(v) => out.push(Argument::Float((*v).into())),
                    OscType::Double(v) => out.push(Argument::Float(*v)),
                    OscType::String(text) => out.push(Argument::Text(text.as_bytes())),
                    OscType::Array(array) => push(&array.content, out),
                    _ => out.push(Argument::Other),
                }
            }
        }
        match packet {
            OscPacket::Message(message) => {
                let mut arguments = Vec::new();
                push(&message.args, &mut arguments);
                lines.push(format!("{:?} {arguments:?}", message.addr.as_bytes()));
            }
            OscPacket::Bundle(bundle) => {
                bundle.content.iter().for_each(|inner| expected(inner, lines));
                lines.push("end".to_owned());
            }
        }
    }

    proptest! {
        #[test]
        fn what_rosc_writes_is_read_as_rosc_reads_it(packet in packet()) {
            let bytes = encoder::encode(&packet).expect("a packet");
            let (_, again) = rosc::decoder::decode_udp(&bytes).expect("what was written");
            let mut wanted = Vec::new();
            expected(&again, &mut wanted);
            prop_assert_eq!(lines(&bytes), (wanted, Ok(())));
        }

        #[test]
        fn what_stands_before_a_tear_is_read(packet in packet(), keep in 0.0..1.0) {
            let bytes = encoder::encode(&packet).expect("a packet");
            let torn = &bytes[..(bytes.len() as f64 * keep) as usize];
            let (whole, _) = lines(&bytes);
            let (part, _) = lines(torn);
            let messages = part.iter().filter(|line| *line != "end").count();
            prop_assert!(messages <= whole.iter().filter(|line| *line != "end").count());
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            for head in [&b""[..], b"#bundle\0\0\0\0\0\0\0\0\x01", b"/tuio/2Dcur\0"] {
                let (lines, _) = lines(&[head, &bytes].concat());
                prop_assert!(lines.len() <= head.len() + bytes.len());
            }
        }
    }

    /// Bundles in bundles, as deep as a datagram has room for.
    #[test]
    fn depth_is_bounded() {
        let nested = |depth: usize| {
            let mut bytes = b"/a\0\0,\0\0\0".to_vec();
            for _ in 0..depth {
                let length = (bytes.len() as u32).to_be_bytes();
                bytes = [b"#bundle\0\0\0\0\0\0\0\0\x01", &length[..], &bytes].concat();
            }
            bytes
        };
        assert_eq!(lines(&nested(MAX_DEPTH)).1, Ok(()));
        assert_eq!(lines(&nested(MAX_DEPTH)).0.len(), MAX_DEPTH + 1);
        assert_eq!(lines(&nested(MAX_DEPTH + 1)).1, Err(Malformed));
        assert_eq!(lines(&nested(3000)).1, Err(Malformed));
    }

    #[test]
    fn an_array_takes_no_depth() {
        let mut bytes = b"/a\0\0,".to_vec();
        bytes.extend(std::iter::repeat_n(b'[', 30_000));
        bytes.extend(std::iter::repeat_n(b']', 30_002));
        bytes.push(0);
        assert_eq!(lines(&bytes), (vec!["[47, 97] []".to_owned()], Ok(())));
    }
}
