//! The report page of a tiny run, opened as a reader would open it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use io::report::{CaseResult, Report, Section, Study, StudyRun, StudySeries};
use io::{RunOptions, ScenarioFile, run};

/// Looks at the page after it was loaded and played for a while, and writes down what it saw.
const READER: &str = r#"<script>
const problems = [];
window.addEventListener("error", (event) => problems.push(event.message || "a file is missing"), true);
window.addEventListener("load", () => {
  const images = [...document.images];
  images.filter((image) => !image.complete || image.naturalWidth === 0).forEach((i) => problems.push("no image: " + i.alt));
  images.filter((image) => !image.alt).forEach(() => problems.push("an image without words"));
  document.querySelectorAll("nav a").forEach((link) => {
    if (!document.getElementById(link.hash.slice(1))) problems.push("no target: " + link.hash);
  });
  const canvas = document.querySelector(".animation canvas");
  const picture = () => canvas.dataset.frame + " " + canvas.toDataURL().length;
  document.querySelector(".animation input").value = 0;
  document.querySelector(".animation input").dispatchEvent(new Event("input"));
  const before = picture();
  document.querySelector(".animation button").click();
  setTimeout(() => {
    const after = picture();
    if (before === after) problems.push("the animation does not move: " + before);
    if (document.documentElement.scrollWidth > window.innerWidth + 1) {
      problems.push("wider than the window: " + document.documentElement.scrollWidth);
    }
    const seen = document.createElement("pre");
    seen.textContent = "seen " + images.length + " images; problems: " + JSON.stringify(problems) + ";";
    document.body.append(seen);
  }, 700);
});
</script>"#;

fn page() -> (PathBuf, String) {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("report-page");
    let _ = fs::remove_dir_all(&directory);
    let sets = [
        "background.size=1.0",
        "body.0.shape.size=1.0",
        "body.0.shape.centre=[0.0, 7.02]",
        "body.0.initial_velocity=[0.0, -20.0]",
        "time.end=0.005",
        "output.vtk_every=0",
    ];
    let sets: Vec<String> = sets.map(str::to_owned).into();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/cases/virtual-barrier.toml");
    let file = ScenarioFile::read(&path, &sets).unwrap_or_else(|e| panic!("{e}"));
    run(&file, RunOptions::into_directory(directory.join("tiny"))).unwrap_or_else(|e| panic!("{e}"));
    let case = CaseResult::read(&directory.join("tiny"), "tiny", "A tiny run").unwrap_or_else(|e| panic!("{e}"));
    let runs =
        [1e-3, 2e-3].map(|value| StudyRun { series: "a".into(), value, contact_time: Some(0.1), ..<_>::default() });
    let series = vec![StudySeries { name: "a".into(), parameter: "Δt [s]".into(), ..<_>::default() }];
    let study = Study { title: "A study".into(), series, runs: runs.into(), ..<_>::default() };
    let html = study.html().unwrap_or_else(|e| panic!("{e}"));
    let studies = Section { id: "studies".into(), title: "Studies".into(), html };
    let report = Report { title: "A page".into(), cases: vec![case], sections: vec![studies], ..Report::default() };
    let path = directory.join("index.html");
    report.write(&path).unwrap_or_else(|e| panic!("{e}"));
    let html = fs::read_to_string(&path).expect("a page");
    (directory, html)
}

fn chromium() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success()))
}

/// Opens the page in a window of a size; what the reader wrote down.
fn read(browser: &str, directory: &Path, size: &str) -> String {
    let profile = directory.join(format!("profile-{size}"));
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage"])
        .args(["--enable-logging=stderr", "--virtual-time-budget=4000", "--dump-dom"])
        .arg(format!("--window-size={size}"))
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", directory.join("read.html").display()))
        .output()
        .expect("a browser that starts");
    let _ = fs::remove_dir_all(profile);
    let log = String::from_utf8_lossy(&output.stderr);
    let complaints: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    assert!(complaints.is_empty(), "{complaints:?}");
    let dom = String::from_utf8_lossy(&output.stdout);
    let seen = dom.rsplit("<pre>seen ").next().unwrap_or_default();
    seen.lines().next().unwrap_or_default().to_owned()
}

#[test]
fn the_page_stands_alone_and_moves() {
    let (directory, html) = page();
    for sign in ["src=\"http", "href=\"http", "url(http", "@import", "src=\"/", "file:"] {
        assert!(!html.contains(sign), "the page asks for another file: {sign}");
    }
    assert_eq!(html.matches("<img").count(), html.matches("src=\"data:image/png;base64,").count());
    assert!(html.matches("<img").count() >= 3 && html.contains("A tiny run") && html.contains("Energy ledger"));
    let Some(browser) = chromium() else {
        eprintln!("no Chromium on this machine: the page was written, but not opened");
        return;
    };
    fs::write(directory.join("read.html"), html.replacen("<head>", &format!("<head>{READER}"), 1)).expect("a file");
    for size in ["1280,900", "500,900"] {
        let seen = read(browser, &directory, size);
        assert!(seen.contains("images; problems: [];"), "at {size}: {seen}");
    }
}
