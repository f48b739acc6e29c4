//! `cargo xtask same`: compares two folders of results column by column.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use crate::process::Outcome;

/// Names of the files that are compared, in all folders below OLD.
const FILES: [&str; 3] = ["history.csv", "diagnostics.csv", "probes.csv"];
/// Columns of wall-clock times begin with this prefix. They are not compared.
const SECONDS: &str = "seconds_";
/// Number of columns that are printed, largest deviation first.
const PRINTED: usize = 30;

/// Arguments of the task.
#[derive(clap::Args)]
#[command(
    after_help = "Compares every history.csv, diagnostics.csv and probes.csv below OLD with the file at the same relative path \
    below NEW. Columns are matched by name, without units if one of the files does not state them; columns of \
    wall-clock times (seconds_*) are not compared. Fails if a value or unit differs, or if a file, column or row is \
    missing or added."
)]
pub(crate) struct Arguments {
    /// Folder with the reference results.
    old: PathBuf,
    /// Folder with the results to check.
    new: PathBuf,
    /// Accepts deviations up to X times the largest absolute value of the column; without it, values must have equal
    /// text, hence equal bits.
    #[arg(long, value_name = "X")]
    relative: Option<f64>,
    /// Does not compare the column NAME. May be repeated.
    #[arg(long, value_name = "NAME")]
    except: Vec<String>,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let (mut old_files, mut new_files) = (Vec::new(), Vec::new());
    find(&arguments.old, Path::new(""), &mut old_files)?;
    find(&arguments.new, Path::new(""), &mut new_files)?;
    let mut failures: Vec<String> = Vec::new();
    if old_files.is_empty() {
        failures.push(format!("no {} below {}", FILES.join(" or "), arguments.old.display()));
    }
    let added = new_files.iter().filter(|file| !old_files.contains(file));
    failures.extend(added.map(|file| format!("{}: missing below {}", file.display(), arguments.old.display())));
    let mut deviations = Vec::new();
    for file in &old_files {
        let name = file.display();
        if !new_files.contains(file) {
            failures.push(format!("{name}: missing below {}", arguments.new.display()));
            continue;
        }
        let tables = [&arguments.old, &arguments.new].map(|folder| std::fs::read_to_string(folder.join(file)));
        let [old, new] = tables;
        match compare(&old?, &new?, &arguments.except) {
            Ok(columns) => deviations.extend(columns.into_iter().map(|column| (name.to_string(), column))),
            Err(reasons) => failures.extend(reasons.into_iter().map(|reason| format!("{name}: {reason}"))),
        }
    }
    let n_columns = deviations.len();
    deviations.retain(|(_, column)| column.n_different > 0);
    deviations.sort_by(|(_, a), (_, b)| b.relative.total_cmp(&a.relative));
    if !deviations.is_empty() {
        println!("{:>10} {:>7} {:>7}  column", "deviation", "rows", "first");
    }
    for (file, column) in deviations.iter().take(PRINTED) {
        let Deviation { name, relative, n_different, first } = column;
        println!("{relative:>10.1e} {n_different:>7} {first:>7}  {name}  {file}");
    }
    if deviations.len() > PRINTED {
        println!("and {} more columns", deviations.len() - PRINTED);
    }
    let n_rejected = deviations.iter().filter(|(_, column)| !column.is_accepted(arguments.relative)).count();
    failures.iter().for_each(|failure| println!("failed: {failure}"));
    let (n_files, n_different) = (old_files.len(), deviations.len());
    println!("{n_columns} columns of {n_files} files: {n_different} differ, {n_rejected} rejected");
    Ok(n_rejected == 0 && failures.is_empty())
}

/// Appends the relative paths of all compared files below `folder`, in alphabetical order.
fn find(root: &Path, folder: &Path, out: &mut Vec<PathBuf>) -> io::Result<()> {
    let absolute = root.join(folder);
    let entries = std::fs::read_dir(&absolute);
    let entries = entries.map_err(|e| io::Error::new(e.kind(), format!("{}: {e}", absolute.display())))?;
    let mut entries = entries.collect::<io::Result<Vec<_>>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = folder.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            find(root, &path, out)?;
        } else if FILES.iter().any(|file| entry.file_name() == *file) {
            out.push(path);
        }
    }
    Ok(())
}

/// Returns the columns of a CSV file by name, as text, with their units where the file states them.
fn columns(text: &str) -> BTreeMap<&str, (Option<&str>, Vec<&str>)> {
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap_or_default();
    let rows: Vec<_> = rows.collect();
    let column = |k: usize| rows.iter().map(|row| row.get(k).copied().unwrap_or_default()).collect();
    let mut columns = BTreeMap::new();
    for (k, header) in names.into_iter().enumerate() {
        let (name, unit) = header.split_once(" [").map_or((header, None), |(name, unit)| (name, Some(unit)));
        columns.insert(name, (unit, column(k)));
    }
    columns
}

/// Difference between two versions of a column.
#[derive(Debug, PartialEq)]
struct Deviation {
    name: String,
    /// Largest difference relative to the largest absolute value of the column; infinite if only one of two values is a
    /// finite number.
    relative: f64,
    /// Number of rows whose texts differ.
    n_different: usize,
    /// First row with different texts, from one; zero if no row differs.
    first: usize,
}

impl Deviation {
    fn new(name: &str, old: &[&str], new: &[&str]) -> Self {
        let number = |text: &&str| text.parse::<f64>().unwrap_or(f64::NAN);
        let largest = old.iter().map(number).filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
        let pairs = || old.iter().zip(new).enumerate().filter(|(_, (a, b))| a != b);
        let relative = pairs().map(|(_, (a, b))| {
            let difference = (number(a) - number(b)).abs();
            if difference == 0.0 { 0.0 } else { difference / largest }
        });
        Self {
            name: name.to_owned(),
            // Not `max`, which drops NaN.
            relative: relative.fold(0.0, |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) }),
            n_different: pairs().count(),
            first: pairs().next().map_or(0, |(row, _)| row + 1),
        }
    }

    fn is_accepted(&self, limit: Option<f64>) -> bool {
        limit.map_or(self.n_different == 0, |limit| self.relative <= limit)
    }
}

/// Compares all columns of two files except times and `except`.
///
/// # Errors
/// Differences of columns, units and numbers of rows.
fn compare(old: &str, new: &str, except: &[String]) -> Result<Vec<Deviation>, Vec<String>> {
    let [old, new] = [old, new].map(|text| {
        let mut columns = columns(text);
        columns.retain(|name, _| !name.starts_with(SECONDS) && !except.iter().any(|n| n == name));
        columns
    });
    let mut reasons: Vec<String> =
        new.keys().filter(|name| !old.contains_key(*name)).map(|name| format!("added column {name}")).collect();
    let mut deviations = Vec::new();
    for (name, (old_unit, old)) in &old {
        match new.get(name) {
            Some((unit, _)) if unit.is_some() && old_unit.is_some() && unit != old_unit => {
                reasons.push(format!("column {name} has another unit"));
            }
            Some((_, new)) if new.len() == old.len() => deviations.push(Deviation::new(name, old, new)),
            Some((_, new)) => reasons.push(format!("column {name} has {} rows instead of {}", new.len(), old.len())),
            None => reasons.push(format!("missing column {name}")),
        }
    }
    if reasons.is_empty() { Ok(deviations) } else { Err(reasons) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = "time,y,seconds_cut\n0.1,-4,1\n0.2,NaN,2\n0.3,2,3\n";

    fn deviations(new: &str) -> Vec<Deviation> {
        compare(OLD, new, &[]).unwrap()
    }

    #[test]
    fn equal_text_is_accepted_in_any_order_of_columns_and_with_other_times() {
        let found = deviations("seconds_cut,y,time\n7,-4,0.1\n8,NaN,0.2\n9,2,0.3\n");
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|column| column.is_accepted(None) && column.n_different == 0));
    }

    #[test]
    fn units_are_compared_where_both_files_state_them() {
        let with_units = "time [s],y [m],seconds_cut [s]\n0.1,-4,1\n0.2,NaN,2\n0.3,2,3\n";
        for (old, new) in [(OLD, with_units), (with_units, OLD), (with_units, with_units)] {
            let found = compare(old, new, &[]).unwrap();
            assert!(found.len() == 2 && found.iter().all(|column| column.is_accepted(None)), "{found:?}");
        }
        let other = with_units.replace("y [m]", "y [cm]");
        assert_eq!(compare(with_units, &other, &[]).unwrap_err(), ["column y has another unit"]);
        assert_eq!(compare(with_units, &other, &["y".to_owned()]).unwrap().len(), 1);
    }

    #[test]
    fn deviations_are_relative_to_the_largest_value_and_nan_is_not_a_number() {
        let found = deviations("time,y,seconds_cut\n0.1,-4,1\n0.2,NaN,2\n0.3,3,3\n");
        assert_eq!(found[1], Deviation { name: "y".to_owned(), relative: 0.25, n_different: 1, first: 3 });
        assert!(found[1].is_accepted(Some(0.25)) && !found[1].is_accepted(Some(0.2)) && !found[1].is_accepted(None));
        assert!(found[0].is_accepted(None));
        for new in ["time,y\n0.1,-4\n0.2,1\n0.3,2\n", "time,y\n0.1\n0.2,NaN\n0.3,2\n"] {
            assert_eq!(deviations(new)[1].relative, f64::INFINITY);
            assert!(!deviations(new)[1].is_accepted(Some(1.0)));
        }
    }

    #[test]
    fn missing_and_added_columns_and_rows_are_failures() {
        let reasons = |new: &str, except: &[&str]| {
            compare(OLD, new, &except.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>()).unwrap_err()
        };
        assert_eq!(reasons("time,z\n0.1,1\n0.2,2\n0.3,3\n", &[]), ["added column z", "missing column y"]);
        assert_eq!(reasons("time,z\n0.1,-4\n", &["y", "z"]), ["column time has 1 rows instead of 3"]);
    }

    #[test]
    fn a_folder_is_the_same_as_itself_and_differs_from_an_empty_one() {
        let root = crate::process::target().join("xtask-same");
        let _ = std::fs::remove_dir_all(&root);
        let [old, empty] = ["old", "empty"].map(|name| root.join(name));
        std::fs::create_dir_all(old.join("case")).unwrap();
        std::fs::create_dir_all(&empty).unwrap();
        std::fs::write(old.join("case/history.csv"), OLD).unwrap();
        let same = |old: &Path, new: &Path| {
            run(&Arguments { old: old.to_owned(), new: new.to_owned(), relative: None, except: Vec::new() })
        };
        assert!(same(&old, &old).unwrap());
        assert!(!same(&old, &empty).unwrap());
        assert!(!same(&empty, &old).unwrap());
        assert!(!same(&empty, &empty).unwrap());
        assert!(same(&old, &root.join("missing")).is_err());
    }
}
