//! HTML elements of a page, and the page that contains them.

use std::fmt::Write;
use std::path::Path;

use crate::Error;

const STYLE: &str = include_str!("../assets/page.css");
const SCRIPT: &str = include_str!("../assets/page.js");
const CHART_STYLE: &str = include_str!("../assets/uPlot.min.css");
const CHART_SCRIPT: &str = include_str!("../assets/uPlot.min.js");

/// A page of sections: one file, which needs no other and no network.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Title, as plain text.
    pub title: String,
    /// Introduction under the title, as HTML.
    pub lead: String,
    /// The sections, in order.
    pub sections: Vec<Section>,
}

/// A section of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Identifier, unique on the page: the target of its link in the navigation.
    pub id: String,
    /// Title, as plain text.
    pub title: String,
    /// Content, as HTML.
    pub html: String,
}

impl Section {
    /// Creates a section from its identifier, title and content.
    pub fn new(id: &str, title: &str, html: String) -> Self {
        Self { id: id.to_owned(), title: title.to_owned(), html }
    }
}

impl Page {
    /// Writes the page to a temporary file, which is then renamed, so that an incomplete page is never visible.
    ///
    /// # Errors
    /// [`Error::Results`]: the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        Ok(io::write_whole(path, self.html().as_bytes())?)
    }

    /// Returns the text of the page.
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let mut page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n\
             <title>{title}</title>\n<style>\n{CHART_STYLE}\n{STYLE}</style>\n</head>\n<body>\n\
             <header><h1>{title}</h1>{}</header>\n<nav aria-label=\"Contents\"><ul>",
            self.lead
        );
        // Writing to a string cannot fail.
        for Section { id, title, .. } in &self.sections {
            let _ = write!(page, "<li><a href=\"#{}\">{}</a></li>", escape(id), escape(title));
        }
        page += "</ul></nav>\n<main>\n";
        for Section { id, title, html } in &self.sections {
            let _ = writeln!(page, "<section id=\"{}\"><h2>{}</h2>{html}</section>", escape(id), escape(title));
        }
        let _ =
            write!(page, "</main>\n<script>\n{CHART_SCRIPT}</script>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n");
        page
    }
}

/// Replaces the characters `& < > " '` of a text by HTML entities.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

/// Returns a value as JSON in a `<script type="application/json">` element, from which the script of the page reads it.
///
/// # Errors
/// [`Error::Json`].
pub fn data(value: &impl serde::Serialize) -> Result<String, Error> {
    // Only "</" could end the element before its end.
    let text = serde_json::to_string(value)?.replace("</", "<\\/");
    Ok(format!("<script type=\"application/json\">{text}</script>"))
}

/// Formats a number. From 1e-4 to 1e7 it has at least four significant digits, no trailing zeros and no exponent;
/// otherwise it has three digits and an exponent. A dash stands for a number that is not finite.
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

/// Formats a number as [`number`] does; a dash for `None`.
pub fn optional(x: Option<f64>) -> String {
    number(x.unwrap_or(f64::NAN))
}

/// Formats a wall-clock time.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Returns the word `pass` or `fail`, coloured.
pub fn verdict(passes: bool) -> String {
    let word = if passes { "pass" } else { "fail" };
    format!("<span class=\"verdict {word}\">{word}</span>")
}

/// Returns a table. Caption, head and cells are HTML. An empty caption is left out, and a head of empty cells. The
/// first cell of a row is its heading.
pub fn table(caption: &str, head: &[&str], rows: &[Vec<String>]) -> String {
    let mut html = String::from("<div class=\"scroll\"><table>");
    if !caption.is_empty() {
        let _ = write!(html, "<caption>{caption}</caption>");
    }
    if head.iter().any(|cell| !cell.is_empty()) {
        html += "<thead><tr>";
        head.iter().for_each(|cell| html += &format!("<th scope=\"col\">{cell}</th>"));
        html += "</tr></thead>";
    }
    html += "<tbody>";
    for row in rows {
        html += "<tr>";
        for (k, cell) in row.iter().enumerate() {
            html += &if k == 0 { format!("<th scope=\"row\">{cell}</th>") } else { format!("<td>{cell}</td>") };
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

/// Returns figures next to each other where there is room.
pub fn gallery(figures: &[String]) -> String {
    if figures.is_empty() { String::new() } else { format!("<div class=\"gallery\">{}</div>", figures.concat()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_numbers_are_readable() {
        assert_eq!(escape("a < b & \"c\" 'd'"), "a &lt; b &amp; &quot;c&quot; &#39;d&#39;");
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

    #[test]
    fn data_cannot_end_its_element() {
        let html = data(&"</script><b>").unwrap_or_default();
        assert_eq!(html, r#"<script type="application/json">"<\/script><b>"</script>"#);
    }
}
