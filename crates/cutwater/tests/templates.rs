//! Scenarios to start from are legal, run, and replace no file.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

fn cutwater(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cutwater")).args(arguments).output().expect("the binary starts")
}

fn check_success(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn templates_are_checked_and_run() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("templates");
    fs::create_dir_all(&directory).expect("a directory");
    for (template, end) in [("fall", "time.end=2e-3"), ("flow", "time.end=1e-2")] {
        let file = directory.join(format!("my-{template}.toml"));
        let (shown, out) = (file.display().to_string(), directory.join(template).display().to_string());
        if file.exists() {
            fs::remove_file(&file).expect("a removable file");
        }
        // The extension may be left out.
        let printed = check_success(&cutwater(&["new", shown.trim_end_matches(".toml"), "--template", template]));
        assert!(printed.contains(&shown), "{printed}");
        let text = fs::read_to_string(&file).expect("a scenario");
        assert!(text.contains(&format!("name      = \"my-{template}\"")) && !text.contains("NAME"), "{text}");
        assert!(check_success(&cutwater(&["check", &shown])).contains(&format!("\nmy-{template}: dimension 2")));
        check_success(&cutwater(&["run", &shown, "--set", end, "--out", &out, "--overwrite"]));
        let again = cutwater(&["new", &shown, "--template", template]);
        assert!(!again.status.success() && String::from_utf8_lossy(&again.stderr).contains("it exists"));
        assert_eq!(fs::read_to_string(&file).expect("a scenario"), text);
    }
}
