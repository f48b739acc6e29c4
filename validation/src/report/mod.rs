//! The report page: cases, comparisons of runs, bounds, studies, and the paper's open ends.

mod bounds;
mod steps;

use std::path::Path;

use cutwater::io::plot::{comparison_chart, draw_chart};
use cutwater::io::report::html::{chart, escape, gallery};
use cutwater::io::report::{CaseResult, Report, Section, Study};

use crate::case::{self, Reference};

type Failure = Box<dyn std::error::Error>;

/// What the paper leaves open or gets wrong, and how it was settled.
const SETTLED: &str = include_str!("settled.html");

/// Writes `report/index.html` beside the results of the named cases, or of all cases; those without results are left
/// out.
///
/// # Errors
/// Results are malformed, or a file cannot be written.
pub(crate) fn write(cases: &[String], is_quick: bool, out: &Path) -> Result<(), Failure> {
    let names = if cases.is_empty() { case::names()? } else { cases.to_vec() };
    let directory = out.join("report");
    let mut report = Report { title: "Three falling balls".to_owned(), lead: lead(is_quick), ..Report::default() };
    let mut scenarios: Vec<(String, Vec<usize>)> = Vec::new();
    let mut references = Vec::new();
    for name in &names {
        let reference = case::read(name)?;
        if !out.join(name).join("summary.json").is_file() {
            continue;
        }
        let mut result = CaseResult::read(&out.join(name), name, &reference.title)?;
        result.lead = case_lead(&reference);
        let index = report.cases.len();
        match scenarios.iter_mut().find(|(scenario, _)| *scenario == reference.scenario) {
            Some((_, members)) => members.push(index),
            None => scenarios.push((reference.scenario.clone(), vec![index])),
        }
        report.cases.push(result);
        references.push(reference);
    }
    report.sections.extend(comparisons(&report.cases, &references, &scenarios, &directory)?);
    report.sections.push(bounds::section(&report.cases, is_quick)?);
    report.sections.extend(studies()?);
    report.sections.push(section("settled", "What the paper leaves open", SETTLED.to_owned()));
    let page = directory.join("index.html");
    report.write(&page)?;
    println!("The report is {}", page.display());
    Ok(())
}

fn section(id: &str, title: &str, html: String) -> Section {
    Section { id: id.to_owned(), title: title.to_owned(), html }
}

fn lead(is_quick: bool) -> String {
    let warning = if is_quick {
        "<p><strong>Coarse meshes, compared with stored values of our own: this is regression, not \
         validation.</strong></p>"
    } else {
        ""
    };
    format!(
        "<p>An elastic ball falls through a fluid at rest, onto a barrier in the fluid, onto a rigid ground, and onto an \
         elastic one. The cases are those of L. Formaggia, F. Gatti and S. Zonca, <cite>An XFEM/DG approach for \
         fluid-structure interaction problems with contact</cite>, MOX-Report 44/2019, Section 4. This page shows what \
         was computed, sets it beside the numbers of the paper and beside bounds that do not depend on the method, and \
         says where they differ and why. The paper's numbers are a comparison, not a truth: its own contact time \
         moves by 8 % with the time step.</p>{warning}{}",
        commit().map_or(String::new(), |commit| format!("<p class=\"muted\">Version {}</p>", escape(&commit)))
    )
}

fn case_lead(reference: &Reference) -> String {
    let changes = reference.set.iter().map(|set| format!("<code>{}</code>", escape(set))).collect::<Vec<_>>();
    let changes = if changes.is_empty() { String::new() } else { format!(", with {}", changes.join(", ")) };
    format!("<p>{}. Scenario <code>{}</code>{changes}.</p>", escape(&reference.source), escape(&reference.scenario))
}

/// The version of the code, where git tells.
pub(crate) fn commit() -> Option<String> {
    let output = std::process::Command::new("git").args(["describe", "--always", "--dirty"]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|text| output.status.success() && !text.is_empty())
}

/// Runs of the same scenario beside each other: height of the ball (Figure 12 of the paper) and smallest distance.
fn comparisons(
    cases: &[CaseResult],
    references: &[Reference],
    scenarios: &[(String, Vec<usize>)],
    directory: &Path,
) -> Result<Option<Section>, Failure> {
    let mut html = String::new();
    for (scenario, members) in scenarios.iter().filter(|(_, members)| members.len() > 1) {
        let label = |case: &CaseResult| format!("{} (Δt = {} s, {})", case.name, case.summary.dt, case.summary.profile);
        let runs: Vec<_> = members.iter().map(|k| (label(&cases[*k]), cases[*k].history())).collect();
        let prefix = cases[members[0]].prefix();
        let mut figures = Vec::new();
        for (title, column, stem) in
            [("height of the body [cm]", "body_height", "height"), ("smallest distance [cm]", "d_min", "distance")]
        {
            let picture = comparison_chart(title, &format!("{prefix}{column}"), &runs);
            std::fs::create_dir_all(directory)?;
            draw_chart(&directory.join(format!("{scenario}-{stem}")), &picture)?;
            for panel in &picture.panels {
                figures.push(chart(panel, "")?);
            }
        }
        let same_profile = |k: &&usize| cases[**k].summary.profile == cases[members[0]].summary.profile;
        let compared: Vec<_> = members.iter().filter(same_profile).map(|&k| (&cases[k], &references[k])).collect();
        let steps = steps::table_of_steps(&compared).unwrap_or_default();
        html += &format!("<h3>{}</h3>{steps}{}", escape(scenario), gallery(&figures));
    }
    Ok((!html.is_empty()).then(|| section("side-by-side", "Side by side", html)))
}

/// The studies that were run on request.
fn studies() -> Result<Option<Section>, Failure> {
    let studies = Study::read_all(&Path::new(env!("CARGO_MANIFEST_DIR")).join("results"))?;
    let parts: Result<Vec<String>, _> = studies.iter().map(Study::html).collect();
    let parts = parts?;
    Ok((!parts.is_empty()).then(|| section("studies", "Studies", parts.concat())))
}
