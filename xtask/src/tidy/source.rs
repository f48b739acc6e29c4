//! Source files: text, code without comments, strings and unit tests, and prose without code.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A file of the tree.
pub(crate) struct Source {
    /// Path relative to the root of the workspace, with `/`.
    pub(crate) path: String,
    /// The whole file.
    pub(crate) text: String,
    /// The same lines with comments and the contents of strings blanked, up to the unit tests.
    code: String,
    /// The same lines with everything but comments and strings blanked; the whole text if this is not a Rust file.
    prose: String,
}

impl Source {
    /// Creates a source from its text.
    pub(crate) fn new(path: &str, text: String) -> Self {
        let is_rust = path.ends_with(".rs");
        let mut code = if is_rust { without_comments_and_strings(&text) } else { String::new() };
        let prose_of = |(c, code): (char, char)| if c == code && c != '\n' { ' ' } else { c };
        let prose = if is_rust { text.chars().zip(code.chars()).map(prose_of).collect() } else { text.clone() };
        let is_test = path.contains("/tests/") || path.contains("/benches/");
        let end = if is_test { Some(0) } else { code.find("#[cfg(test)]\nmod ") };
        if let Some(end) = end {
            code.truncate(end);
        }
        Self { path: path.to_owned(), text, code, prose }
    }

    /// Returns the lines with their numbers.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().enumerate().map(|(k, line)| (k + 1, line))
    }

    /// Returns the lines of code outside of tests, with their numbers.
    pub(crate) fn code_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.code.lines().enumerate().map(|(k, line)| (k + 1, line))
    }

    /// Returns the lines of comments and strings, also of tests, with their numbers.
    pub(crate) fn prose_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.prose.lines().enumerate().map(|(k, line)| (k + 1, line))
    }

    /// Returns the code outside of tests.
    pub(crate) fn code(&self) -> &str {
        &self.code
    }

    /// Returns the number of the line at an offset of the code.
    pub(crate) fn line_at(&self, offset: usize) -> usize {
        self.code[..offset].matches('\n').count() + 1
    }

    /// Returns the folder of the crate: `crates/mesh`, `xtask`, ...
    pub(crate) fn package(&self) -> &str {
        let depth = if self.path.starts_with("crates/") { 2 } else { 1 };
        self.path.match_indices('/').nth(depth - 1).map_or("", |(end, _)| &self.path[..end])
    }

    /// Returns whether the file is in the folder `src` of a package.
    pub(crate) fn is_src(&self) -> bool {
        self.path.strip_prefix(self.package()).is_some_and(|rest| rest.starts_with("/src/"))
    }
}

/// Returns the files with the given endings below a folder, in the order of their paths.
///
/// # Errors
/// A folder or file cannot be read.
pub(crate) fn read(root: &Path, folder: &str, endings: &[&str]) -> io::Result<Vec<Source>> {
    let mut paths = Vec::new();
    collect(&root.join(folder), &mut paths)?;
    paths.sort();
    let matching = paths.iter().filter(|path| path.extension().is_some_and(|e| endings.iter().any(|end| e == *end)));
    matching
        .map(|path| {
            let relative = path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/");
            Ok(Source::new(&relative, fs::read_to_string(path)?))
        })
        .collect()
}

fn collect(folder: &Path, out: &mut Vec<PathBuf>) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden && !path.ends_with("target") {
            collect(&path, out)?;
        } else if path.is_file() {
            out.push(path);
        }
    }
    Ok(())
}

/// Returns whether `word` at `offset` is a whole word of `text`.
pub(crate) fn is_word(text: &str, offset: usize, word: &str) -> bool {
    let inside = |c: char| c.is_alphanumeric() || c == '_';
    !text[..offset].ends_with(inside) && !text[offset + word.len()..].starts_with(inside)
}

/// Returns the offsets of all occurrences of `word` as a whole word.
pub(crate) fn words<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    text.match_indices(word).map(|(offset, _)| offset).filter(move |&offset| is_word(text, offset, word))
}

/// Replaces comments, strings and characters by spaces; line numbers do not change.
fn without_comments_and_strings(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let (kept, blanked) = match c {
            '/' if rest.starts_with("//") => (0, rest.find('\n').unwrap_or(rest.len())),
            '/' if rest.starts_with("/*") => (0, rest.find("*/").map_or(rest.len(), |end| end + 2)),
            'r' if (rest.starts_with("r\"") || rest.starts_with("r#")) && !out.ends_with(char::is_alphanumeric) => {
                let hashes = rest[1..].chars().take_while(|&c| c == '#').count();
                let close = format!("\"{}", "#".repeat(hashes));
                match rest[1 + hashes..].strip_prefix('"').and_then(|inner| inner.find(&close)) {
                    Some(end) => (0, 1 + hashes + 1 + end + close.len()),
                    None => (1, 0),
                }
            }
            '"' => (0, end_of_string(rest)),
            '\'' => (usize::from(character_len(rest) == 0), character_len(rest)),
            _ => (c.len_utf8(), 0),
        };
        out.push_str(&rest[..kept]);
        out.extend(rest[kept..kept + blanked].chars().map(|c| if c == '\n' { c } else { ' ' }));
        rest = &rest[kept + blanked..];
    }
    out
}

fn end_of_string(text: &str) -> usize {
    let mut escaped = false;
    for (offset, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return offset + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// Returns the length of the character literal at the start of the text; zero for a lifetime.
fn character_len(text: &str) -> usize {
    let mut characters = text.char_indices().skip(1);
    match (characters.next(), characters.next()) {
        (Some((_, '\\')), _) => text[3..].find('\'').map_or(0, |end| end + 4),
        (Some(_), Some((offset, '\''))) => offset + 1,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_code_is_left() {
        let text =
            "let a = \"x // y\"; // z\nlet b: &'a str = r#\"q\"#; let c = '\\''; let d = '\"';\n#[cfg(test)]\nmod t {}";
        let source = Source::new("crates/mesh/src/a.rs", text.to_owned());
        assert_eq!(source.code().lines().count(), 2);
        assert!(!source.code().contains(['x', 'z', 'q', '"']), "{}", source.code());
        assert!(source.code().contains("&'a str"));
        assert_eq!((source.package(), source.is_src()), ("crates/mesh", true));
    }
}
