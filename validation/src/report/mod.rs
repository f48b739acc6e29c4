//! The page of the paper's cases: results, comparisons of runs, bounds, and questions that the paper leaves open.

mod bounds;
mod case_result;
mod steps;

use std::path::Path;

use cutwater::report::html::{duration, escape, gallery, table};
use cutwater::report::{Chart, Page, Section};

use self::case_result::CaseResult;
use crate::case;
use crate::outcome::Failure;
use crate::units::cgs;

/// Open questions and errors of the paper, and how they were settled.
const SETTLED: &str = include_str!("settled.html");

/// Writes `report/index.html` next to the results of the named cases, or of all cases. Cases without results are left
/// out.
pub(crate) fn write(cases: &[String], is_quick: bool, out: &Path) -> Result<(), Failure> {
    let names = if cases.is_empty() { case::names()? } else { cases.to_vec() };
    let mut results = Vec::new();
    for name in &names {
        let reference = case::read(name)?;
        let directory = out.join(name);
        if directory.join("summary.json").is_file() {
            results.push(CaseResult::read(name, reference, &directory)?);
        }
    }
    let mut sections = vec![Section::new("summary", "Summary", summary(&results))];
    for case in &results {
        sections.push(case.section()?);
    }
    sections.extend(comparisons(&results)?);
    sections.push(bounds::section(&results, is_quick)?);
    sections.push(Section::new("settled", "What the paper leaves open", SETTLED.to_owned()));
    let page = out.join("report/index.html");
    std::fs::create_dir_all(out.join("report"))?;
    Page { title: "Three falling balls".to_owned(), lead: lead(is_quick), sections }.write(&page)?;
    println!("The report is {}", page.display());
    Ok(())
}

fn summary(cases: &[CaseResult]) -> String {
    let rows: Vec<Vec<String>> = cases.iter().map(CaseResult::row).collect();
    let head = ["case", "contact [s]", "release [s]", &cgs("highest [<length>]"), "at [s]", "wall time", "verdict"];
    let seconds: f64 = cases.iter().map(|case| case.results.summary.wall_seconds).sum();
    let machine = escape(&machine());
    table("", &head, &rows) + &format!("<p class=\"muted\">{} in all. {machine}</p>", duration(seconds))
}

fn lead(is_quick: bool) -> String {
    let warning = if is_quick {
        "<p><strong>Coarse meshes, compared with stored values of this code: a regression test, not a \
         validation.</strong></p>"
    } else {
        ""
    };
    format!(
        "<p>An elastic ball falls through a fluid at rest, onto a barrier in the fluid, onto a rigid ground, and onto an \
         elastic one. The cases are those of L. Formaggia, F. Gatti and S. Zonca, <cite>An XFEM/DG approach for \
         fluid-structure interaction problems with contact</cite>, MOX-Report 44/2019, Section 4. This page compares the \
         computed results with the numbers of the paper and with bounds that do not depend on the method, and explains \
         differences. The numbers of the paper are not exact: its contact time changes by 8 % with the time \
         step.</p>{warning}{}",
        commit().map_or(String::new(), |commit| format!("<p class=\"muted\">Version {}</p>", escape(&commit)))
    )
}

/// Returns the output of a command of git in the root of the workspace; `None` if it fails.
pub(crate) fn git(arguments: &[&str]) -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let output = std::process::Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|_| output.status.success())
}

/// Returns the version of the code, if git has one.
pub(crate) fn commit() -> Option<String> {
    git(&["describe", "--always", "--dirty"])
}

/// Returns the machine, where the operating system describes it: processor, number of threads, memory.
pub(crate) fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let field = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let processor = field(&read("/proc/cpuinfo"), "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let memory = field(&read("/proc/meminfo"), "MemTotal")
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(String::new(), |kilobytes| format!(", {:.0} GB of memory", kilobytes / 1e6));
    format!("{processor}, {threads} threads{memory}, {}.", std::env::consts::OS)
}

/// Returns the section with common charts of runs of the same scenario: height of the ball (Figure 12 of the paper) and
/// smallest distance. `None` if no scenario was run twice.
fn comparisons(cases: &[CaseResult]) -> Result<Option<Section>, Failure> {
    let mut scenarios: Vec<&str> = cases.iter().map(|case| case.reference.scenario.as_str()).collect();
    scenarios.sort_unstable();
    scenarios.dedup();
    let mut html = String::new();
    for scenario in scenarios {
        let members: Vec<_> = cases.iter().filter(|case| case.reference.scenario == scenario).collect();
        if members.len() < 2 {
            continue;
        }
        let chart = |title: &str, column: &str| {
            let curve = |case: &&CaseResult| {
                let summary = &case.results.summary;
                let label = format!("{} (Δt = {} s, {})", case.name, summary.dt, summary.stabilisation);
                let column = format!("{}{column}", case.results.leading_prefix());
                case.results.curve(&label, &case.results.history, &column)
            };
            Chart::new(title, "time [s]", members.iter().map(curve).collect()).html()
        };
        let figures = [
            chart(&cgs("height of the body [<length>]"), "body_height")?,
            chart(&cgs("smallest distance [<length>]"), "d_min")?,
        ];
        let profile = &members[0].results.summary.stabilisation;
        let compared: Vec<_> =
            members.iter().filter(|case| case.results.summary.stabilisation == *profile).copied().collect();
        let steps = steps::table_of_steps(&compared).unwrap_or_default();
        html += &format!("<h3>{}</h3>{steps}{}", escape(scenario), gallery(&figures));
    }
    Ok((!html.is_empty()).then(|| Section::new("runs", "Runs of one scenario", html)))
}
