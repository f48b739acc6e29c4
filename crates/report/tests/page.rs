//! Pages of short runs: complete without other files, and opened as a reader would open them where Chromium is
//! installed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use io::{ScenarioFile, Summary, run};
use report::{Frames, Recorder, write, write_picture};

const CYLINDER: &str = include_str!("../../../examples/oscillating-cylinder.toml");

fn fresh_directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("page").join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

/// Runs a scenario and returns the text of its page.
fn page(text: &str, sets: &[&str], directory: &Path) -> String {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let file = ScenarioFile::parse(Path::new("case.toml"), text, &sets).unwrap_or_else(|e| panic!("{e}"));
    let mut recorder = Recorder::default();
    run(&file, directory, &mut recorder).unwrap_or_else(|e| panic!("{e}"));
    recorder.write(directory).unwrap_or_else(|e| panic!("{e}"));
    let path = write(directory).unwrap_or_else(|e| panic!("{e}"));
    fs::read_to_string(path).expect("a page")
}

/// Returns the virtual barrier with coarse meshes. The ball starts just above the barrier, so that contact begins in
/// the first steps.
fn barrier(directory: &Path, extra: &[&str]) -> String {
    let text = include_str!("../../../validation/cases/virtual-barrier.toml");
    let sets = [
        "background.size=1.0",
        "body.0.shape.size=1.0",
        "body.0.shape.centre=[0.0, 7.02]",
        "body.0.initial_velocity=[0.0, -20.0]",
        "time.end=0.005",
        "output.vtk_every=0",
    ];
    page(text, &[&sets, extra].concat(), directory)
}

/// Checks that the page has no address outside of it and no NaN.
fn check(page: &str) {
    for sign in ["src=\"http", "href=\"http", "url(http", "@import", "src=\"/", "file:"] {
        assert!(!page.contains(sign), "the page refers to another file: {sign}");
    }
    let text = page.split("<script>").next().unwrap_or_default();
    for word in [">NaN", " NaN", ":NaN", ">inf<", ">-inf"] {
        assert!(!text.contains(word), "{word}");
    }
}

#[test]
fn the_page_has_all_sections_and_is_the_same_again() {
    let directory = fresh_directory("barrier");
    let first = barrier(&directory, &[]);
    check(&first);
    let guide = first.find("Look first at the smallest distance").expect("a guide");
    assert!(guide < first.find("id=\"energies\"").expect("energies") && first.contains("<em>Ghost penalty</em>"));
    for id in ["run", "moments", "histories", "contacts", "energies", "balances", "timings", "scenario"] {
        assert!(first.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
    for title in ["Start", "First contact", "Largest deformation", "End", "Energy in the first contact"] {
        assert!(first.contains(title), "{title}");
    }
    let frames = Frames::read(&directory).ok().flatten().expect("frames");
    assert_eq!((frames.frames.len(), frames.moments.len()), (6, 4));
    let path = write(&directory).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(fs::read_to_string(&path).expect("a page"), first);
    // Tables of earlier versions have no units.
    for table in ["history.csv", "diagnostics.csv"].map(|name| directory.join(name)) {
        let text = fs::read_to_string(&table).expect("a table");
        let (header, rows) = text.split_once('\n').expect("rows");
        let bare: Vec<&str> = header.split(',').map(|name| io::name_and_unit(name).0).collect();
        assert_ne!(bare.join(","), header);
        fs::write(&table, format!("{}\n{rows}", bare.join(","))).expect("a file");
    }
    let _ = write(&directory).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(fs::read_to_string(path).expect("a page"), first);
}

#[test]
fn the_page_of_a_run_that_stopped_says_so() {
    let directory = fresh_directory("stopped");
    assert!(!barrier(&directory, &[]).contains("stopped before its end"));
    let scenario = directory.join("scenario.toml");
    let text = fs::read_to_string(&scenario).expect("a scenario");
    let longer: Vec<&str> =
        text.lines().map(|line| if line.starts_with("end ") { "end = 0.05" } else { line }).collect();
    fs::write(&scenario, longer.join("\n")).expect("a file");
    let page = fs::read_to_string(write(&directory).unwrap_or_else(|e| panic!("{e}"))).expect("a page");
    assert!(page.contains("stopped before its planned end, 0.05 s; run.log has the reason"));
}

#[test]
fn names_are_escaped() {
    let directory = fresh_directory("names");
    barrier(&directory, &[]);
    let path = directory.join("summary.json");
    let mut summary = Summary::read(&path).unwrap_or_else(|e| panic!("{e}"));
    (summary.case, summary.bodies) = ("<b>&'".to_owned(), vec!["</script>".to_owned()]);
    summary.write(&path).unwrap_or_else(|e| panic!("{e}"));
    let page = fs::read_to_string(write(&directory).unwrap_or_else(|e| panic!("{e}"))).expect("a page");
    check(&page);
    assert!(page.contains("<h1>&lt;b&gt;&amp;&#39;</h1>") && !page.contains("<b>&"));
    // Only the elements of the page themselves end with it.
    assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
}

#[test]
fn prescribed_and_missing_bodies_have_pages_too() {
    let coarse =
        ["background.size=0.03", "body.0.shape.size=0.015", "background.boundary.left.ramp=0.1", "time.end=0.2"];
    let fixed = page(CYLINDER, &coarse, &fresh_directory("cylinder"));
    check(&fixed);
    assert!(fixed.contains("force of the fluid, x") && !fixed.contains("<section id=\"contacts\">"));
    let (begin, end) = (CYLINDER.find("[[body]]").expect("a body"), CYLINDER.find("[output]").expect("output"));
    let empty = CYLINDER[..begin].to_owned() + &CYLINDER[end..];
    let empty = page(&empty, &["background.size=0.1", "time.end=0.2"], &fresh_directory("empty"));
    check(&empty);
    assert!(empty.contains("<section id=\"moments\">") && empty.contains("<section id=\"energies\">"));
}

#[test]
fn the_picture_has_all_frames_of_both_halves() {
    let directory = fresh_directory("picture");
    barrier(&directory, &[]);
    let path = directory.join("run.png");
    write_picture(&directory, &path).unwrap_or_else(|e| panic!("{e}"));
    let mut reader = png::Decoder::new(fs::File::open(&path).expect("a file")).read_info().expect("a picture");
    let info = reader.info();
    assert_eq!(info.animation_control.map(|control| control.num_frames), Some(6));
    let (width, height) = (info.width as usize, info.height as usize);
    let mut bytes = vec![0; reader.output_buffer_size()];
    reader.next_frame(&mut bytes).expect("a frame");
    let pixel = |row: usize, column: usize| {
        let byte = bytes[row * width.div_ceil(2) + column / 2];
        if column.is_multiple_of(2) { byte >> 4 } else { byte & 15 }
    };
    let n_body = (0..width * height).filter(|k| pixel(k / width, k % width) >= 12).count();
    let area = n_body as f64 / (width * height) as f64 * 20.0 * 15.0;
    assert!((area / (std::f64::consts::PI * 16.0) - 1.0).abs() < 0.05, "the whole ball: {area}");
    let sides =
        (0..width / 2).all(|column| (pixel(height / 2, column) >= 12) == (pixel(height / 2, width - 1 - column) >= 12));
    assert!(sides, "one half is the mirror image of the other");
    fs::remove_file(directory.join("frames.json")).expect("frames");
    let message = write_picture(&directory, &path).expect_err("no frames").to_string();
    assert!(message.contains("--no-report"), "{message}");
}

/// Script that checks the page after loading and after a second of playing, and writes the defects that it found.
const READER: &str = r#"<script>
const problems = [];
window.addEventListener("error", (event) => problems.push(event.message || "a file is missing"), true);
window.addEventListener("load", () => {
  document.querySelectorAll("nav a").forEach((link) => {
    if (!document.getElementById(link.hash.slice(1))) problems.push("no target: " + link.hash);
  });
  const charts = document.querySelectorAll(".chart .uplot canvas").length;
  if (charts !== document.querySelectorAll(".chart").length || charts < 8) problems.push("charts: " + charts);
  document.querySelectorAll(".moment canvas").forEach((canvas) => {
    if (canvas.height < 50) problems.push("an empty field");
  });
  const canvas = document.querySelector(".animation canvas");
  const picture = () => canvas.dataset.frame + " " + canvas.toDataURL().length;
  document.querySelector(".animation input").value = 0;
  document.querySelector(".animation input").dispatchEvent(new Event("input"));
  const before = picture();
  document.querySelector(".animation button").click();
  setTimeout(() => {
    if (before === picture()) problems.push("the animation does not move: " + before);
    if (document.documentElement.scrollWidth > window.innerWidth + 1) {
      problems.push("wider than the window: " + document.documentElement.scrollWidth);
    }
    const seen = document.createElement("pre");
    seen.textContent = "seen " + charts + " charts; problems: " + JSON.stringify(problems) + ";";
    document.body.append(seen);
  }, 700);
});
</script>"#;

fn chromium() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success()))
}

/// Opens the page in a window of a size and returns what the reader noted.
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
fn the_page_opens_and_moves() {
    let directory = fresh_directory("opened");
    let page = barrier(&directory, &[]);
    let Some(browser) = chromium() else {
        eprintln!("no Chromium on this machine: the page was written, but not opened");
        return;
    };
    fs::write(directory.join("read.html"), page.replacen("<head>", &format!("<head>{READER}"), 1)).expect("a file");
    for size in ["1280,900", "500,900"] {
        let seen = read(browser, &directory, size);
        assert!(seen.contains("charts; problems: [];"), "at {size}: {seen}");
    }
}
