//! The part of the page about bounds that do not depend on the method.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::report::html::{escape, gallery, number, table, verdict};
use cutwater::report::{Chart, Curve, Section};

use super::case_result::CaseResult;
use crate::bounds::impact::{Impact, SPEED, impact};
use crate::bounds::potential::{added_mass, arrival, fall, gaps};
use crate::outcome::Failure;
use crate::units::cgs;

/// Falls whose times and speeds are listed.
const FALLS: [(f64, f64); 5] = [(6.0, 3.0), (6.0, 0.1), (3.0, 0.1), (1.0, 0.1), (1.0, 0.05)];
// Size of cells and time steps of the dry impact.
const SIZE: f64 = 0.4;
const STEPS: [f64; 5] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5];

/// Returns the bounds and limits; the short version takes fewer time steps.
pub(super) fn section(cases: &[CaseResult], is_quick: bool) -> Result<Section, Failure> {
    let mut html = "<p>Two limits of the problem can be had without cut meshes, stabilisation or coupling. Neither is \
                    a solution of it, but a result that contradicts them is wrong.</p>"
        .to_owned();
    html += &potential_flow(cases)?;
    html += &dry_impact(is_quick)?;
    Ok(Section::new("bounds", "Independent bounds", html))
}

fn potential_flow(cases: &[CaseResult]) -> Result<String, Failure> {
    let mut html = "<h3>A rigid disk in an ideal fluid</h3>\
        <p>A disk of the ball's size and mass falls through a fluid without viscosity towards a wall. The fluid acts as \
        an added mass <i>M</i> that grows as the gap closes, and <i>(m + M) y″ + ½ M′ y′² = −m g</i> keeps its energy, so \
        that the speed follows from the gap. Drag, numerical viscosity and the cushion in the gap only delay: these times \
        are lower bounds of all contact times.</p>"
        .to_owned();
    let rows: Vec<Vec<String>> = FALLS
        .iter()
        .map(|&(start, end)| {
            let at = arrival(start, end);
            vec![number(start), number(end), format!("{:.4}", at.time), format!("{:.1}", at.speed)]
        })
        .collect();
    html += &table(
        "",
        &[&cgs("start gap [<length>]"), &cgs("reaches [<length>]"), "at [s]", &cgs("speed [<velocity>]")],
        &rows,
    );
    let rows: Vec<Vec<String>> = cases
        .iter()
        .filter_map(|case| {
            let (start, offset) = gaps(&case.results.scenario)?;
            let contact = case.results.summary.contact_time?;
            let bound = arrival(start, offset).time;
            let delay = format!("{} %", number((1e3 * (contact / bound - 1.0)).round() / 10.0));
            // A contact is known to a time step.
            let holds = contact + case.results.summary.dt >= bound;
            Some(vec![escape(&case.reference.title), format!("{bound:.4}"), number(contact), delay, verdict(holds)])
        })
        .collect();
    if !rows.is_empty() {
        html += &table("", &["case", "bound [s]", "contact [s]", "later by", "bound holds"], &rows);
    }
    let gaps_of_curve = (1..=120).map(|k| 0.05 * f64::from(k));
    let mass = Curve::new("added mass", gaps_of_curve.map(|gap| (gap, added_mass(gap))).collect());
    let chart = |title: String, x_label: &str, curves: Vec<Curve>, caption: &str| {
        Chart { caption: caption.to_owned(), ..Chart::new(title, x_label, curves) }.html()
    };
    let mut figures = vec![chart(
        "added mass, relative to the mass of the disk".to_owned(),
        &cgs("gap [<length>]"),
        vec![mass],
        "In the box of the paper, with no pressure on its open sides.",
    )?];
    let started = || cases.iter().filter_map(|case| Some((case, gaps(&case.results.scenario)?.0)));
    let mut starts: Vec<f64> = started().map(|(_, start)| start).collect();
    starts.sort_by(f64::total_cmp);
    starts.dedup();
    for start in starts {
        let bound = fall(start, 0.05).into_iter().map(|at| (at.time, at.gap)).collect();
        let mut curves = vec![Curve::new("ideal fluid", bound)];
        curves.extend(started().filter(|(_, gap)| *gap == start).map(|(case, _)| {
            let column = format!("{}d_min", case.results.leading_prefix());
            case.results.curve(&case.name, &case.results.history, &column)
        }));
        let title = cgs(&format!("smallest distance [<length>], start at {}", number(start)));
        figures.push(chart(title, "time [s]", curves, "No computed fall may be faster than the ideal one.")?);
    }
    Ok(html + &gallery(&figures))
}

fn dry_impact(is_quick: bool) -> Result<String, Failure> {
    let steps = if is_quick { &STEPS[..3] } else { &STEPS[..] };
    let impacts = steps
        .iter()
        .map(|&dt| impact(SIZE, SPEED, dt, Arc::new(ImplicitEuler)))
        .collect::<Result<Vec<Impact>, Failure>>()?;
    let row = |i: &Impact| {
        vec![
            number(i.dt),
            format!("{:.1}", 1e3 * i.duration),
            format!("{:.3}", i.restitution),
            format!("{:.3}", i.smallest_height),
            format!("{:.3}", i.elastic_peak),
            format!("{:.1} %", 1e2 * i.loss),
        ]
    };
    let mut rows: Vec<Vec<String>> = impacts.iter().map(row).collect();
    rows.push(["explicit, finer", "11.1", "0.982", "7.771", "0.99", "–"].map(str::to_owned).into());
    let head = [
        "Δt [s]",
        "contact lasts [ms]",
        "restitution",
        &cgs("smallest height [<length>]"),
        "largest elastic energy",
        "energy lost",
    ];
    let chart = |title: &str, value: fn(&Impact) -> f64, level: f64, caption: &str| {
        let curve = Curve::new(title, impacts.iter().map(|i| (i.dt, value(i))).collect());
        let (levels, caption) = (vec![level], caption.to_owned());
        Chart { x_is_log: true, levels, caption, ..Chart::new(title, "Δt [s]", vec![curve]) }.html()
    };
    let after = "Velocity of the centre after the impact, relative to that before; dashed: the explicit computation.";
    let figures = [
        chart("restitution", |i| i.restitution, 0.982, after)?,
        chart("contact lasts [ms]", |i| 1e3 * i.duration, 11.1, "From the first to the last step in contact.")?,
    ];
    let text = format!(
        "<h3>The same disk without a fluid</h3>\
         <p>The disk of the paper's material hits a rigid plane at {SPEED} cm/s, the speed at the virtual barrier, with the \
         contact penalty of the cases, implicit Euler and cells of {SIZE} cm. Only the time scheme can take \
         energy; the loss in the impact is that of implicit Euler. The last row is an independent explicit \
         computation that keeps the energy to 2·10⁻⁴. With fluid, contact lasts longer by about the square root of one \
         plus the added mass over the mass, and the fluid takes its share of the rebound.</p>"
    );
    Ok(text + &table("", &head, &rows) + &gallery(&figures))
}
