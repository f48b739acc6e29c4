//! Output, files and exit codes of `cutwater compare`, `plot`, `resume` and `schema`.

use std::path::Path;

use crate::setting::{cutwater, file, fresh, succeeded, text};

/// An elastic block in free fall.
const FALL: &str = r#"
name      = "fall"
dimension = 2
units     = "si"

[time]
step = 0.01
end  = 0.1

[[body]]
name     = "block"
shape    = { kind = "box", min = [0, 0], max = [1, 1], n = [2, 2] }
material = { kind = "linear", young = 1e4, poisson = 0.3 }
density  = 1.0
gravity  = [0, -10]

[output]
vtk_every        = 0
checkpoint_every = 5

[output.probes]
corner = { kind = "marker", body = "block", at = [0, 0] }
"#;

/// Returns the path of a new file or directory of these tests.
fn path(name: &str) -> String {
    fresh("compare", name).display().to_string()
}

/// Writes a table of results.
fn write(directory: &str, name: &str, text: String) {
    std::fs::create_dir_all(directory).expect("a directory");
    std::fs::write(Path::new(directory).join(name), text).expect("a file");
}

/// Runs [`FALL`] with changes by `--set` in a new directory, and returns the directory.
fn run(name: &str, sets: &[&str]) -> String {
    let (scenario, directory) = (file("compare", &format!("{name}.toml"), FALL), path(name));
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> =
        ["run", &scenario, "--out", &directory, "--quiet", "--no-report"].into_iter().chain(sets).collect();
    succeeded(&cutwater(&arguments));
    directory
}

/// Compares results. Checks the exit code, and returns what is printed on the output and as errors.
fn compared(arguments: &[&str], code: i32) -> [String; 2] {
    let output = cutwater(&[&["compare"], arguments].concat());
    let printed = [&output.stdout, &output.stderr].map(|bytes| text(bytes).to_owned());
    assert_eq!(output.status.code(), Some(code), "{printed:?}");
    printed
}

/// Returns the numbers of a column in a printed comparison, without its unit.
fn numbers<'p>(printed: &'p str, column: &str) -> Vec<&'p str> {
    let line = printed.lines().find(|line| line.split(' ').next() == Some(column)).expect("the column");
    line.split_whitespace().skip(1).filter(|word| !word.starts_with('[')).collect()
}

#[test]
fn runs_are_compared_column_by_column() {
    let [first, same, other] = [run("first", &[]), run("same", &[]), run("other", &["body.0.gravity=[0, -11]"])];
    let [printed, _] = compared(&[&first, &same, "--tolerance", "0"], 0);
    assert!(printed.contains(" columns are equal, 0 differ"), "{printed}");
    let [printed, errors] = compared(&[&first, &other, "--tolerance", "0.05"], 1);
    // After 0.1 s the speed is 1.0 m/s with a gravity of 10 m/s², and 1.1 m/s with 11 m/s².
    assert_eq!(numbers(&printed, "centre_velocity"), ["1.000e-1", "1.100e0", "9.091e-2"]);
    assert!(printed.contains("centre_velocity [m/s]") && printed.contains("corner_velocity_y [m/s]"), "{printed}");
    assert!(errors.contains("the tolerance is 5e-2"), "{errors}");
}

#[test]
fn losses_of_energy_are_compared_with_the_energies() {
    let [first, second] = [path("ledger-first"), path("ledger-second")];
    // Tables of earlier versions have no units.
    let tables = |directory: &str, lost: &str, newton: &str, [s, m, j]: [&str; 3]| {
        write(directory, "history.csv", format!("time{s},centre_y{m},newton\n0.1,2,{newton}\n"));
        let energies = format!("energy_contact{j},a_energy_gravity{j},lost_open_boundary{j}");
        write(directory, "diagnostics.csv", format!("time{s},{energies}\n0.1,4,-9e6,{lost}\n"));
    };
    tables(&first, "1e-14", "3", ["", "", ""]);
    tables(&second, "2e-14", "5", [" [s]", " [m]", " [J/m]"]);
    let [printed, _] = compared(&[&second, &first, "--tolerance", "1e-12"], 0);
    assert!(printed.contains("lost_open_boundary [J/m] "), "{printed}");
    assert!(!printed.contains("newton") && printed.contains("3 columns are equal, 1 differ"), "{printed}");
    let [printed, _] = compared(&[&first, &second, "--tolerance", "1e-12"], 0);
    assert_eq!(numbers(&printed, "lost_open_boundary"), ["1.000e-14", "4.000e0", "2.500e-15"]);
    // Counts of work are compared on request only.
    assert!(!printed.contains("newton") && printed.contains("3 columns are equal, 1 differ"), "{printed}");
    let [printed, _] = compared(&[&first, &second, "--tolerance", "0.1", "--column", "newton"], 1);
    assert!(printed.contains("0 columns are equal, 1 differ"), "{printed}");
    let [printed, _] = compared(&[&first, &second, "--column", "centre_y"], 0);
    assert!(printed.contains("1 columns are equal, 0 differ"), "{printed}");
    let [_, errors] = compared(&[&first, &second, "--column", "centre_z"], 2);
    assert!(errors.contains("has no column `centre_z`; did you mean `centre_y`?"), "{errors}");
}

#[test]
fn remainders_and_components_are_compared_with_the_forces_and_vectors() {
    let directories = [("1e-14", path("balance-first")), ("-1e-14", path("balance-second"))];
    for (remainder, directory) in &directories {
        let names = ["a_force_gravity", "a_force_remainder", "b_force_gravity"].join(" [N/m],");
        let head = format!("time [s],{names} [N/m],centre_x [m],centre_y [m]");
        write(directory, "history.csv", format!("{head}\n0.1,-5,{remainder},90,{remainder},4\n"));
    }
    let [first, second] = directories.map(|(_, directory)| directory);
    let [printed, _] = compared(&[&first, &second], 0);
    assert_eq!(numbers(&printed, "a_force_remainder"), ["2.000e-14", "5.000e0", "4.000e-15"]);
    assert_eq!(numbers(&printed, "centre_x"), ["2.000e-14", "4.000e0", "5.000e-15"]);
}

#[test]
fn columns_are_plotted() {
    let (first, page) = (run("plotted", &[]), path("plot.html"));
    let output =
        cutwater(&["plot", &first, &first, "--column", "corner_y", "--column", "energy_elastic", "--out", &page]);
    succeeded(&output);
    let html = std::fs::read_to_string(&page).expect("a page");
    assert!(html.matches("<figure class=\"chart\"").count() == 2 && html.contains("<h4>energy_elastic [J/m]</h4>"));
    assert!(html.contains("<h4>corner_y [m]</h4>") && html.matches("\"x_label\":\"time [s]\"").count() == 2);
}

#[test]
fn a_resumed_run_is_compared_with_a_whole_one() {
    let (short, whole) = (run("short", &["time.end=0.05"]), run("whole", &[]));
    let [printed, errors] = compared(&[&short, &whole, "--tolerance", "1e-12"], 1);
    assert!(printed.contains("compared until 5e-2: the runs end at 5e-2 and 1e-1"), "{printed}");
    assert!(errors.contains("they must end at the same time"), "{errors}");
    compared(&[&short, &whole], 0);
    // An invalid change leaves the run as it is.
    for change in ["output.probes.corner.at=[1, 1]", "output.probes={}"] {
        let output = cutwater(&["resume", &short, "--set", change, "--set", "time.end=0.1", "--quiet"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("the probes are not those of the run"), "{}", text(&output.stderr));
    }
    let output = cutwater(&["resume", &short, "--set", "time.end=0.1", "--quiet"]);
    succeeded(&output);
    compared(&[&short, &whole, "--tolerance", "1e-12"], 0);
}

#[test]
fn the_schema_is_json() {
    let output = cutwater(&["schema"]);
    let printed = text(&output.stdout);
    assert!(output.status.success() && printed.trim_start().starts_with('{') && printed.trim_end().ends_with('}'));
    assert!(
        printed.contains("http://json-schema.org/draft-07/schema#") && printed.contains("\"saint-venant-kirchhoff\"")
    );
}
