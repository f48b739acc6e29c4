//! Phrases that comments, messages and pages must not contain, and the first words of the comments of functions.

use super::source::Source;
use super::tree::{Finding, SourceTree};

/// This file contains the list.
const LIST: &str = "xtask/src/tidy/prose.rs";

/// Phrases with better ones. `^` is the start of a sentence that is not a question; alternatives are separated by `|`.
const PHRASES: &[(&str, &str)] = &[
    ("^what", "begin with a verb (functions) or a noun phrase (types)"),
    ("is what|are what|was what", "name the thing"),
    ("told|tell|tells|wants|owes|speaks|asks|begs", "code is not a person: is given, determines, requires"),
    ("has to say|have to say|nothing to say|says how|says what|says whether|says where", "states, contains, returns"),
    ("nobody|somebody|is asked|are asked|asked for|asked to", "if needed, requested, is evaluated"),
    (
        "that is none|which is none|that are none|that is no|that are no|which is no|which are no",
        "missing, invalid, NaN, not a",
    ),
    ("comes to nothing|come to nothing|came to nothing|comes down to|come down to", "fails, has no effect, amounts to"),
    ("gives way|give way", "yields, moves"),
    (
        "beside a|beside the|beside its|beside one|beside known|beside it|beside that|beside those",
        "relative to, compared with, in addition to",
    ),
    ("for ever|again and again|over and over|in one go|to and fro|by and by", "repeatedly, at once, periodically"),
    (
        "all the same|of no more use|is of no use|to be had|at hand",
        "nevertheless, no longer needed, available, current",
    ),
    ("to be trusted|not to be trusted|mend|mended", "reliable, repair"),
    ("in the place of|in the way of", "instead of"),
    ("make up for|makes up for|made up for", "compensate, balance"),
    ("all that it takes|whatever it takes", "the data that ... depends on"),
    ("a little|a bit|a hair|about as good as", "slightly, within round-off; give the number"),
    ("talks|talk|feel|feels|hopes|wishes|thinks|believes", "code is not a person"),
    ("ask for|asks for|say nothing|says nothing", "require, do not depend on"),
    ("make sense|makes sense|made sense|make no sense|makes no sense|senseless", "valid, invalid"),
    ("matter of", "depends on"),
    ("refuses|ignores it", "returns an error for, does not use"),
    ("tell apart|told apart|knows none|knows nothing", "distinguish, does not depend on"),
];

/// Looks for the phrases, across line breaks.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let sources = tree.rust.iter().chain(&tree.other).filter(|source| source.path != LIST);
    sources.flat_map(|source| of_file(source).into_iter().chain(verbs(source)).chain(fragments(source))).collect()
}

/// Finds functions outside of tests whose comment does not begin with a verb in the third person.
fn verbs(source: &Source) -> Vec<Finding> {
    let is_skipped = |line: &str| line.starts_with("///") || line.starts_with("#[");
    let lines: Vec<&str> = source.text.lines().take(source.code_lines().count()).map(str::trim_start).collect();
    let mut findings = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let Some(comment) = line.strip_prefix("/// ").filter(|_| k == 0 || !lines[k - 1].starts_with("///")) else {
            continue;
        };
        let declaration = lines[k..].iter().find(|line| !is_skipped(line)).copied().unwrap_or_default();
        let head = declaration.split(['(', '=']).next().unwrap_or_default();
        let is_function = head.starts_with("fn ") || head.contains(" fn ");
        let first = comment.split(' ').next().unwrap_or_default();
        let is_verb = first.trim_end_matches(',').ends_with('s') && first.starts_with(char::is_uppercase);
        if is_function && !is_verb {
            let advice = format!("\"{first} ...\": begin the comment of a function with a verb, such as Returns");
            findings.push(Finding::new(&source.path, k + 1, advice));
        }
    }
    findings
}

/// Finds comments and headings that begin with "Why" or "How".
fn fragments(source: &Source) -> Vec<Finding> {
    let marker = if source.path.ends_with(".rs") { "//" } else { "#" };
    let (mut findings, mut before) = (Vec::new(), "");
    for (k, line) in source.text.lines().map(str::trim).enumerate().filter(|_| !source.path.ends_with(".toml")) {
        let text = line.trim_start_matches(['/', '!', '#']).trim_start();
        let is_begin = line.starts_with(marker) && !before.starts_with("//") && !line.ends_with('?');
        if is_begin && matches!(text.split([' ', '.']).next(), Some("Why" | "How")) {
            findings.push(Finding::new(&source.path, k + 1, "\"Why\" or \"How\": begin with a noun phrase"));
        }
        before = line;
    }
    findings
}

/// A word of a text, in lower case and without punctuation.
struct Word {
    text: String,
    line: usize,
    begins_sentence: bool,
    ends_question: bool,
}

fn of_file(source: &Source) -> Vec<Finding> {
    let words = prose(source);
    let mut findings = Vec::new();
    for (phrases, better) in PHRASES {
        for phrase in phrases.split('|') {
            let wanted: Vec<&str> = phrase.trim_start_matches('^').split(' ').collect();
            for window in (0..words.len()).filter_map(|k| words.get(k..k + wanted.len())) {
                let is_found = window.iter().zip(&wanted).all(|(word, wanted)| word.text == *wanted)
                    && window[1..].iter().all(|word| !word.begins_sentence);
                let is_statement = !phrase.starts_with('^') || (window[0].begins_sentence && !window[0].ends_question);
                if is_found && is_statement {
                    findings.push(Finding::new(&source.path, window[0].line, format!("\"{phrase}\": {better}")));
                }
            }
        }
    }
    findings
}

/// Returns the words of the comments and strings of a Rust file, or of all lines of another file.
fn prose(source: &Source) -> Vec<Word> {
    let mut words: Vec<Word> = Vec::new();
    let mut begins_sentence = true;
    let mut first_of_sentence = 0;
    for (line, text) in source.prose_lines() {
        let text = text.trim_start().trim_start_matches(['/', '!']).trim_start();
        // A list item, a heading or an empty line ends a sentence.
        begins_sentence |= text.is_empty() || text.starts_with(['-', '*', '#', '|']);
        for token in text.split_whitespace() {
            let trimmed = token.trim_matches(|c: char| ".,;:!?()[]\"*".contains(c));
            if trimmed.chars().any(char::is_alphanumeric) {
                if begins_sentence {
                    first_of_sentence = words.len();
                }
                words.push(Word { text: trimmed.to_lowercase(), line, begins_sentence, ends_question: false });
                begins_sentence = false;
            }
            begins_sentence |= token.ends_with(['.', '!', '?', ':']);
            if token.ends_with('?')
                && let Some(word) = words.get_mut(first_of_sentence)
            {
                word.ends_question = true;
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        of_file(&Source::new(path, text.to_owned())).iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn phrases_are_found_in_comments_and_strings_and_across_lines() {
        assert_eq!(
            lines("a.rs", "//! What a mesh is.\n/// A solve that comes\n/// to nothing.\nfn tell() {}\n"),
            [1, 2]
        );
        assert_eq!(lines("a.rs", "fn a() { b(\"the step that is\n none\"); }\n"), [1]);
        assert_eq!(lines("a.md", "It has to\nsay this, a matter\nof it.\n"), [1, 2]);
    }

    #[test]
    fn comments_of_functions_begin_with_verbs() {
        let lines = |text: &str| -> Vec<usize> {
            let findings = verbs(&Source::new("crates/mesh/src/a.rs", text.to_owned()));
            findings.iter().map(|finding| finding.line).collect()
        };
        assert_eq!(lines("/// Number of cells.\n///\n/// More.\n#[inline]\npub fn n_cells() {}\n"), [1]);
        assert!(lines("/// Returns it.\n/// More.\nfn n() {}\n/// A mesh.\npub struct Mesh(fn(u8));\n").is_empty());
    }

    #[test]
    fn comments_and_headings_are_no_fragments() {
        let lines = |path: &str, text: &str| -> Vec<usize> {
            fragments(&Source::new(path, text.to_owned())).iter().map(|finding| finding.line).collect()
        };
        assert_eq!(lines("a.rs", "//! How it ends.\n\n    /// Why.\n    /// Why it stopped.\n/// However.\n"), [1, 3]);
        assert_eq!(lines("a.md", "## How to run\n\nHow well it runs is measured.\n\n## Why a rule?\n"), [1]);
    }

    #[test]
    fn questions_code_and_other_words_are_not() {
        assert!(lines("a.rs", "// What is a part?\nlet tell = wants(nobody);\n").is_empty());
        assert!(lines("a.rs", "/// The value that is `None`. Retold, it asked.\n").is_empty());
        assert!(lines("a.md", "a number that is\n\nnone\n").is_empty());
    }
}
