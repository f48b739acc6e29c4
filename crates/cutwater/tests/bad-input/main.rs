//! Every mistake in the table gets its message, with file, line, key and remedy, from the binary; and the page of the
//! messages is made of the table.
//!
//! `UPDATE_PAGES=1 cargo test -p cutwater --test bad-input` updates the page.

mod page;
mod table;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use table::{Row, Table};

/// Longest time of a command, which shares the machine with other tests.
const LONGEST: Duration = Duration::from_secs(10);

/// Number of commands at a time.
const AT_A_TIME: usize = 2;

fn start(directory: &Path, arguments: &[String]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cutwater"))
        .current_dir(directory)
        .args(arguments)
        .output()
        .expect("the binary starts")
}

fn write(path: PathBuf, content: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.parent().expect("a directory")).expect("a directory");
    std::fs::write(path, content).expect("a file");
}

/// Makes a mistake in an empty directory, and returns the faults of its message.
fn faults(row: &Row, table: &Table, directory: &Path) -> Vec<String> {
    let _ = std::fs::remove_dir_all(directory);
    std::fs::create_dir_all(directory).expect("a directory");
    write(directory.join("scenario.toml"), row.scenario(table));
    row.folders.iter().for_each(|name| std::fs::create_dir_all(directory.join(name)).expect("a directory"));
    for arguments in &row.before {
        let output = start(directory, arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    row.files.iter().for_each(|(name, text)| write(directory.join(name), text));
    for (name, text) in &row.bytes {
        let bytes: Vec<u8> = text.chars().map(|c| u8::try_from(c).expect("the number of a byte")).collect();
        write(directory.join(name), bytes);
    }
    let clock = Instant::now();
    let output = start(directory, &row.command());
    let seconds = clock.elapsed();
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut faults = Vec::new();
    if output.status.code() != Some(row.code) {
        faults.push(format!("exit code {:?}, not {}", output.status.code(), row.code));
    }
    if printed.contains("panicked") {
        faults.push("a panic".to_owned());
    }
    if seconds > LONGEST {
        faults.push(format!("it took {seconds:.1?}"));
    }
    let missing = row.says(table).into_iter().filter(|text| !printed.contains(text));
    faults.extend(missing.map(|text| format!("`{text}` is missing")));
    if !faults.is_empty() {
        faults.push(printed);
    }
    faults
}

#[test]
fn every_mistake_gets_its_message() {
    let table = Table::read();
    let rows: Vec<&Row> = table.section.iter().flat_map(|section| &section.row).collect();
    assert!(rows.len() >= 80, "{} rows", rows.len());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bad-input");
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    std::thread::scope(|scope| {
        let part = |first: usize| {
            let (rows, table, folder) = (&rows, &table, &folder);
            scope.spawn(move || {
                let of_part = rows.iter().enumerate().skip(first).step_by(AT_A_TIME);
                of_part
                    .map(|(k, row)| (row.mistake.as_str(), faults(row, table, &folder.join(k.to_string()))))
                    .collect::<Vec<_>>()
            })
        };
        let parts: Vec<_> = (0..AT_A_TIME).map(part).collect();
        found.extend(parts.into_iter().flat_map(|part| part.join().expect("a part of the table")));
    });
    found.retain(|_, faults| !faults.is_empty());
    let shown: Vec<String> =
        found.iter().map(|(mistake, faults)| format!("{mistake}\n  {}", faults.join("\n  "))).collect();
    assert!(found.is_empty(), "{} messages\n{}", found.len(), shown.join("\n"));
}
