//! Words of the code that may occur in few files or in none, and the shape of terms.

use super::source::Source;
use super::tree::{Finding, SourceTree};

/// Words with the files and folders in which they may occur, and advice. A line with the word after a
/// quotation mark is not a finding.
const WORDS: &[(&[&str], &[&str], &str)] = &[
    (&["todo!"], NOWHERE, "do it, or write it to the tracker"),
    (&["unimplemented!"], NOWHERE, "return an error"),
    (&["dbg!"], NOWHERE, "remove it"),
    (&["too_many_arguments"], NOWHERE, "collect arguments that belong together in a struct"),
    (&["downcast", "as_any"], NOWHERE, "add a method to the trait"),
    (&["BodyKind"], NOWHERE, "bodies are implementations of `body::Body`"),
    (&["#[ignore"], NOWHERE, "no test is ignored: make it fast, or move it to `cargo xtask verify`"),
];
const NOWHERE: &[&str] = &[];

/// The same for words of the code of libraries outside of unit tests.
const LIBRARY_WORDS: &[(&[&str], &[&str], &str)] = &[
    (
        &["ElasticBody", "RigidBody", "PrescribedBody"],
        &[
            "crates/body/",
            "crates/solid-svk/",
            "crates/solid-rigid/",
            "crates/io/src/scenario/body.rs",
            "crates/io/src/scenario/motion.rs",
        ],
        "a body is a `dyn body::Body` outside of its crate and of the scenario reader",
    ),
    (
        &["D * i", "D * j", "D * k", "D * node", "D * vertex"],
        &[
            "crates/contact/src/sites.rs",
            "crates/fluid-ns/src/cell.rs",
            "crates/fluid-ns/src/open_boundary.rs",
            "crates/interface-dg/src/moved_facet.rs",
            "crates/interface-dg/src/points.rs",
            "crates/io/",
            "crates/solid-svk/src/cell.rs",
            "crates/solid-svk/src/facet.rs",
        ],
        "use the layout, or the row function of the site",
    ),
    (
        &["/ dt", "/ self.dt", "/ setup.dt"],
        // Numbers of steps, and difference quotients of the force balance.
        &["crates/algebra/src/time/", "crates/solver/src/state.rs", "crates/solver/src/report.rs"],
        "take the weights of the time scheme",
    ),
    (
        &["/ time.length", "/ self.time.length", "/ step.time.length", "/ self.length"],
        // The difference quotient of a given velocity, the weight of a collision, and round-off of velocities.
        &["crates/body/src/prescribed.rs", "crates/solver/src/collision.rs", "crates/body/src/step_time.rs"],
        "take the weights of the time scheme",
    ),
    (
        &["Axisymmetric"],
        &["crates/mesh/src/coordinates.rs", "crates/io/src/scenario/"],
        "use the weight and the radial axis of `mesh::Coordinates`",
    ),
    (&["message() =="], NOWHERE, "match on the kind of the error"),
];

/// The only public trait whose name may end in `Term` or `Kind`.
const TERM: &str = "crates/algebra/src/integral.rs";

/// Applies the rules.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in &tree.rust {
        // The first list applies to tests too, hence to the whole text.
        let lines = source.lines().filter(|(_, line)| !line.trim_start().starts_with("//"));
        find(source, lines, WORDS, &mut findings);
        if source.is_src() && source.path.starts_with("crates/") {
            find(source, source.code_lines(), LIBRARY_WORDS, &mut findings);
            traits_and_terms(source, &mut findings);
        }
    }
    findings
}

fn find<'a>(
    source: &Source,
    lines: impl Iterator<Item = (usize, &'a str)>,
    rules: &[(&[&str], &[&str], &str)],
    findings: &mut Vec<Finding>,
) {
    let rules: Vec<_> =
        rules.iter().filter(|(_, places, _)| !places.iter().any(|place| source.path.starts_with(place))).collect();
    for (number, line) in lines {
        for (words, _, advice) in &rules {
            let is_found = |word: &&&str| line.contains(**word) && !line.contains(&format!("\"{word}"));
            if let Some(word) = words.iter().find(is_found) {
                findings.push(Finding::new(&source.path, number, format!("`{word}`: {advice}")));
            }
        }
    }
}

/// Checks that sites have one form of term, `algebra::Term`. Each struct in `terms/` implements it, or is the weight of
/// a product of shape functions that the sites evaluate themselves.
fn traits_and_terms(source: &Source, findings: &mut Vec<Finding>) {
    let declared = |line: &str, kind: &str| -> Option<String> {
        let name = line.strip_prefix("pub ")?.strip_prefix(kind)?.split(|c: char| !c.is_alphanumeric()).next()?;
        Some(name.to_owned())
    };
    for (number, line) in source.code_lines() {
        let name = declared(line, "trait ").filter(|name| name.ends_with("Term") || name.ends_with("Kind"));
        if name.is_some() && source.path != TERM {
            findings.push(Finding::new(
                &source.path,
                number,
                "implement `algebra::Term` instead of a new kind of term",
            ));
        }
        let Some(name) = declared(line, "struct ").filter(|_| source.path.contains("/terms/")) else { continue };
        let is_impl = |line: &str| line.starts_with("impl") && line.contains("Term<") && line.contains(&name);
        let has_weight = source.code().contains("fn weight") && source.code().contains(&format!("impl {name} "));
        if !has_weight && !source.code().lines().any(is_impl) {
            let advice =
                format!("`{name}` is no term: implement `Term`, or give it `fn weight`, or move it out of terms/");
            findings.push(Finding::new(&source.path, number, advice));
        }
    }
}
