//! `slice.svg`: a drawn slice as scalable vector graphics (W3C 2018, SVG 2), UTF-8, to be opened in browsers and changed
//! in drawing programs: layers are groups with the names of what they show.

use std::fmt::Write as _;
use std::io::{self, Write};

use glam::DVec2;

use crate::rock::Colour;
use crate::slice::{Anchor, Band, Figure, Line, Role, Text};

/// Points that lie nearer than this to the line through their neighbours are left out, pixels: nobody sees them.
const STRAIGHT: f64 = 0.05;

/// Writes a figure. Positions are in its pixels, rounded to hundredths.
///
/// # Errors
/// Where `out` fails.
pub fn write(mut out: impl Write, figure: &Figure) -> io::Result<()> {
    let DVec2 { x, y } = figure.size;
    write!(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{x}\" height=\"{y}\" viewBox=\"0 0 {x} {y}\">\n"
    )?;
    if let Some(title) = figure.texts.first() {
        writeln!(out, "<title>{}</title>", escaped(&title.text))?;
    }
    writeln!(
        out,
        "<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>",
        hex(figure.paper)
    )?;
    for band in &figure.bands {
        write_band(&mut out, band)?;
    }
    writeln!(out, "<g fill=\"none\" stroke-linejoin=\"round\">")?;
    for line in &figure.lines {
        write_line(&mut out, line)?;
    }
    writeln!(
        out,
        "</g>\n<g font-family=\"Ubuntu Light, Ubuntu, Helvetica Neue, Arial, sans-serif\" font-weight=\"300\">"
    )?;
    for text in &figure.texts {
        write_text(&mut out, text)?;
    }
    out.write_all(b"</g>\n</svg>\n")
}

fn write_band(out: &mut impl Write, band: &Band) -> io::Result<()> {
    let class = match band.role {
        Role::Rock(layer) => format!("rock layer-{layer}"),
        Role::Eroded(layer) => format!("eroded layer-{layer}"),
        Role::Ground => "ground".to_owned(),
        Role::Sediment => "sediment".to_owned(),
        Role::Water => "water".to_owned(),
        Role::Deep => "deep".to_owned(),
        Role::Key => "key".to_owned(),
    };
    let outline: Vec<DVec2> = thinned(&band.top)
        .into_iter()
        .chain(thinned(&band.bottom).into_iter().rev())
        .collect();
    writeln!(
        out,
        "<path class=\"{class}\" fill=\"{}\" d=\"{}Z\"/>",
        hex(band.colour),
        path(&outline)
    )
}

fn write_line(out: &mut impl Write, line: &Line) -> io::Result<()> {
    let dash = line.dash.map_or(String::new(), |[dash, gap]| {
        format!(" stroke-dasharray=\"{} {}\"", rounded(dash), rounded(gap))
    });
    writeln!(
        out,
        "<path stroke=\"{}\" stroke-width=\"{}\"{dash} d=\"{}\"/>",
        hex(line.colour),
        rounded(line.width),
        path(&thinned(&line.points))
    )
}

fn write_text(out: &mut impl Write, text: &Text) -> io::Result<()> {
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\" xml:space=\"preserve\">{}</text>",
        rounded(text.at.x),
        rounded(text.at.y),
        rounded(text.size),
        hex(text.colour),
        escaped(&text.text)
    )
}

/// Path data of a polyline.
fn path(points: &[DVec2]) -> String {
    let mut data = String::with_capacity(14 * points.len());
    for (i, p) in points.iter().filter(|p| p.is_finite()).enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        // Writing into a string cannot fail.
        let _ = write!(data, "{command}{} {}", rounded(p.x), rounded(p.y));
    }
    data
}

/// The line without the points that nobody would miss: each span is as long as all its points stay near it.
fn thinned(points: &[DVec2]) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = points.first().copied().into_iter().collect();
    let mut from = 0;
    for to in 2..points.len() {
        let (a, b) = (points[from], points[to]);
        let way = (b - a).normalize_or_zero();
        let near = |p: &DVec2| way.perp_dot(*p - a).abs() <= STRAIGHT && (*p - a).dot(way) >= 0.0;
        if to - from > LONGEST || !points[from + 1..to].iter().all(near) {
            from = to - 1;
            kept.push(points[from]);
        }
    }
    kept.extend(points.get(1..).and_then(<[_]>::last));
    kept
}

/// Most points that one span replaces: bounds the work.
const LONGEST: usize = 64;

fn rounded(value: f64) -> f64 {
    // Adding zero turns −0 into 0.
    (value * 100.0).round() / 100.0 + 0.0
}

fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Text as XML holds it: marks escaped, characters that XML 1.0 has not left out.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_control_characters_are_left_out() {
        assert_eq!(
            escaped("a<b & \"c\">\u{1}\n—ö\u{ffff}"),
            "a&lt;b &amp; &quot;c&quot;&gt; —ö"
        );
    }

    #[test]
    fn points_on_a_straight_line_are_left_out_and_bends_stay() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let mut line: Vec<DVec2> = (0..10).map(|i| at(f64::from(i), 0.0)).collect();
        line.extend((1..10).map(|i| at(9.0, f64::from(i))));
        assert_eq!(thinned(&line), [at(0.0, 0.0), at(9.0, 0.0), at(9.0, 9.0)]);
        assert_eq!(thinned(&line[..1]), [at(0.0, 0.0)]);
        assert!(thinned(&[]).is_empty());
    }
}
