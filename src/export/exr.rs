//! `height.exr`: 32-bit float channels by name.

use std::io::{self, Seek, Write};

use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, Text, Vec2, WritableImage,
};

use super::invalid;

/// Writes channels of `width × height` values each, rows from north to south, losslessly compressed (ZIP, 16 lines
/// a block, in increasing order so that equal input gives equal bytes).
///
/// # Errors
/// Where a channel has another number of values, its name is empty or given twice, or `out` fails.
pub fn write(
    out: impl Write + Seek,
    width: usize,
    height: usize,
    channels: &[(&str, &[f32])],
) -> io::Result<()> {
    if width == 0 || height == 0 || channels.is_empty() {
        return Err(invalid("EXR: no pixels or no channels"));
    }
    for (i, (name, values)) in channels.iter().enumerate() {
        if values.len() != width * height {
            return Err(invalid(format!(
                "EXR channel `{name}`: {} values for {width} × {height} pixels",
                values.len()
            )));
        }
        if name.is_empty() || channels[..i].iter().any(|(other, _)| other == name) {
            return Err(invalid(format!(
                "EXR channel `{name}`: names must be there and differ"
            )));
        }
    }
    let list = channels
        .iter()
        .map(|&(name, values)| {
            let name = Text::new_or_none(name)
                .filter(|_| name.is_ascii())
                .ok_or_else(|| invalid(format!("EXR channel `{name}`: the name must be ASCII")))?;
            Ok(AnyChannel::new(name, FlatSamples::F32(values.to_vec())))
        })
        .collect::<io::Result<_>>()?;
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(
        Vec2(width, height),
        LayerAttributes::named("surface"),
        encoding,
        AnyChannels::sort(list),
    );
    Image::from_layer(layer)
        .write()
        .to_buffered(out)
        .map_err(|error| match error {
            ::exr::error::Error::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
}
