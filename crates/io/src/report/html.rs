//! Pieces of the page: text, tables, figures.

use std::fmt::Write;
use std::path::Path;

use crate::Error;
use crate::files::base64;
use crate::plot::{Panel, panel_svg};

/// Text with the characters that HTML gives a meaning replaced.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A number with four significant digits, without an exponent where that is readable.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return "–".to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let magnitude = x.abs().log10().floor();
    let text = if (-4.0..7.0).contains(&magnitude) {
        let text = format!("{x:.*}", (3.0 - magnitude).max(0.0) as usize);
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x:.2e}")
    };
    text.replace('-', "−")
}

/// A number if there is one, else a dash.
pub fn optional(x: Option<f64>) -> String {
    number(x.unwrap_or(f64::NAN))
}

/// Whether what was asked came out, as a coloured word.
pub fn verdict(passes: bool) -> String {
    let (class, word) = if passes { ("pass", "pass") } else { ("fail", "fail") };
    format!("<span class=\"verdict {class}\">{word}</span>")
}

/// A table. Cells are HTML; the first column is a heading of its row.
pub fn table(caption: &str, head: &[&str], rows: &[Vec<String>]) -> String {
    let mut html = String::from("<div class=\"scroll\"><table>");
    if !caption.is_empty() {
        let _ = write!(html, "<caption>{caption}</caption>");
    }
    html += "<thead><tr>";
    for cell in head {
        let _ = write!(html, "<th scope=\"col\">{cell}</th>");
    }
    html += "</tr></thead><tbody>";
    for row in rows {
        html += "<tr>";
        for (k, cell) in row.iter().enumerate() {
            html += &if k == 0 { format!("<th scope=\"row\">{cell}</th>") } else { format!("<td>{cell}</td>") };
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

/// A figure around a picture, with a caption unless that is empty.
pub fn figure(picture: &str, caption: &str) -> String {
    let caption = if caption.is_empty() { String::new() } else { format!("<figcaption>{caption}</figcaption>") };
    format!("<figure>{picture}{caption}</figure>")
}

/// Figures beside each other where there is room.
pub fn gallery(figures: &[String]) -> String {
    if figures.is_empty() { String::new() } else { format!("<div class=\"gallery\">{}</div>", figures.concat()) }
}

/// A graph with a caption. Names of curves and events make a legend under it.
///
/// # Errors
/// [`Error::Plot`].
pub fn chart(panel: &Panel, caption: &str) -> Result<String, Error> {
    let svg = panel_svg(panel)?;
    // The description goes where readers of screens look for it.
    let open = format!("<svg class=\"chart\" role=\"img\" aria-label=\"{}\"", escape(&panel.title));
    let svg = svg.replacen("<svg", &open, 1);
    Ok(figure(&svg, caption))
}

/// A PNG file as a picture inside the page; none if there is no such file.
///
/// # Errors
/// [`Error::Read`].
pub fn image(path: &Path, description: &str) -> Result<Option<String>, Error> {
    if !path.is_file() {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let size = png_size(&bytes).map_or(String::new(), |(w, h)| format!(" width=\"{w}\" height=\"{h}\""));
    let (data, description) = (base64(&bytes), escape(description));
    Ok(Some(format!("<img alt=\"{description}\"{size} src=\"data:image/png;base64,{data}\">")))
}

/// Width and height in the header of a PNG file.
fn png_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let word = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (bytes.get(12..16)? == b"IHDR").then_some((word(16)?, word(20)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_numbers_are_readable() {
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
        for (x, text) in [(0.1110, "0.111"), (-573.21, "−573.2"), (0.0, "0"), (1e-9, "1.00e−9"), (f64::NAN, "–")]
        {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn the_first_cell_of_a_row_is_its_heading() {
        let html = table("", &["a", "b"], &[vec!["1".to_owned(), "2".to_owned()]]);
        assert!(html.contains("<th scope=\"row\">1</th><td>2</td>"));
    }
}
