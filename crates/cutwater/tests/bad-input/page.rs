//! The page of the messages.

use std::fmt::Write;
use std::path::Path;

use crate::table::Table;

const BEGIN: &str = "<!-- messages -->\n";

/// Returns the tables of all sections.
fn tables(table: &Table) -> String {
    let mut text = String::new();
    let cell = |text: &str| text.trim_end_matches([':', ' ']).replace('|', "\\|").replace('<', "&lt;");
    for section in &table.section {
        let _ = write!(text, "\n## {}\n\n| mistake | message |\n|---|---|\n", section.title);
        for row in &section.row {
            let says: Vec<String> = row.says(table).iter().map(|part| cell(part)).collect();
            let _ = writeln!(text, "| {} | {} |", cell(&row.mistake), says.join(" … "));
        }
    }
    text
}

#[test]
fn the_page_has_the_messages_of_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/reference/messages.md");
    let found = std::fs::read_to_string(&path).expect("the page");
    let (head, _) = found.split_once(BEGIN).expect("the mark of the tables");
    let expected = [head, BEGIN, &tables(&Table::read())].concat();
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, expected).expect("a writable page");
    } else {
        assert!(
            found == expected,
            "the page is out of date; run UPDATE_PAGES=1 cargo test -p cutwater --test bad-input"
        );
    }
}
