//! Scenarios to start from are legal, run, and replace no file.

use std::fs;

use crate::setting::{cutwater, fresh, succeeded};

#[test]
fn templates_are_checked_and_run() {
    for (template, dimension, end) in
        [("fall", 2, "time.end=2e-3"), ("flow", 2, "time.end=1e-2"), ("impact", 3, "time.end=2e-3")]
    {
        let [file, out] = [format!("my-{template}.toml"), template.to_owned()].map(|name| fresh("templates", &name));
        let [shown, out] = [&file, &out].map(|path| path.display().to_string());
        // The extension may be left out.
        let printed = succeeded(&cutwater(&["new", shown.trim_end_matches(".toml"), "--template", template]));
        assert!(printed.contains(&shown), "{printed}");
        let text = fs::read_to_string(&file).expect("a scenario");
        assert!(text.contains(&format!("name      = \"my-{template}\"")) && !text.contains("NAME"), "{text}");
        assert!(succeeded(&cutwater(&["check", &shown])).contains(&format!("\nmy-{template}: dimension {dimension}")));
        succeeded(&cutwater(&["run", &shown, "--set", end, "--out", &out, "--overwrite"]));
        let again = cutwater(&["new", &shown, "--template", template]);
        assert!(!again.status.success() && String::from_utf8_lossy(&again.stderr).contains("it exists"));
        assert_eq!(fs::read_to_string(&file).expect("a scenario"), text);
    }
}
