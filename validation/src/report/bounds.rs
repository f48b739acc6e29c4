//! The part of the page about bounds that do not depend on the method.

use cutwater::io::plot::{Curve, Panel, column_curve};
use cutwater::io::report::html::{chart, escape, gallery, number, table, verdict};
use cutwater::io::report::{CaseResult, Section};
use cutwater::solid_svk::TimeScheme;

use super::Failure;
use crate::bounds::impact::{Impact, impact};
use crate::bounds::potential::{added_mass, arrival, fall, gaps};

/// Falls whose times and speeds are listed.
const FALLS: [(f64, f64); 5] = [(6.0, 3.0), (6.0, 0.1), (3.0, 0.1), (1.0, 0.1), (1.0, 0.05)];
/// Speed of the dry impact, cm/s: that of the ball at the virtual barrier.
const SPEED: f64 = 52.45;
/// Size of cells and time steps of the dry impact.
const SIZE: f64 = 0.4;
const STEPS: [f64; 5] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5];

/// Bounds and limits; the short version takes fewer time steps.
pub(super) fn section(cases: &[CaseResult], is_quick: bool) -> Result<Section, Failure> {
    let mut html = "<p>Two limits of the problem can be had without cut meshes, stabilisation or coupling. Neither is \
                    a solution of it, but a result that contradicts them is wrong.</p>"
        .to_owned();
    html += &potential_flow(cases)?;
    html += &dry_impact(is_quick)?;
    Ok(super::section("bounds", "Independent bounds", html))
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
    html += &table("", &["start gap [cm]", "reaches [cm]", "at [s]", "speed [cm/s]"], &rows);
    let rows: Vec<Vec<String>> = cases
        .iter()
        .filter_map(|case| {
            let (start, offset) = gaps(case.scenario())?;
            let contact = case.summary.contact_time?;
            let bound = arrival(start, offset).time;
            let delay = format!("{} %", number((1e3 * (contact / bound - 1.0)).round() / 10.0));
            // A contact is known to a time step.
            let holds = contact + case.summary.dt >= bound;
            Some(vec![escape(&case.title), format!("{bound:.4}"), number(contact), delay, verdict(holds)])
        })
        .collect();
    if !rows.is_empty() {
        html += &table("", &["case", "bound [s]", "contact [s]", "later by", "bound holds"], &rows);
    }
    let gaps_of_curve = (1..=120).map(|k| 0.05 * f64::from(k));
    let mass = Curve::plain(gaps_of_curve.map(|gap| (gap, added_mass(gap))).collect());
    let mut figures = vec![chart(
        &Panel {
            x_title: "gap [cm]".to_owned(),
            ..Panel::over_time("added mass over the mass of the disk", vec![mass])
        },
        "Added mass of the disk in the box of the paper, with no pressure on its open sides.",
    )?];
    let mut starts: Vec<f64> = Vec::new();
    for (start, _) in cases.iter().filter_map(|case| gaps(case.scenario())) {
        if !starts.contains(&start) {
            starts.push(start);
        }
    }
    for start in starts {
        let bound = fall(start, 0.05).into_iter().map(|at| (at.time, at.gap)).collect();
        let mut curves = vec![Curve { label: "ideal fluid".to_owned(), colour: 4, points: bound, dots: false }];
        for case in cases.iter().filter(|case| gaps(case.scenario()).is_some_and(|(gap, _)| gap == start)) {
            let points = column_curve(case.history(), &format!("{}d_min", case.prefix()));
            curves.push(Curve { label: case.name.clone(), colour: curves.len() - 1, points, dots: false });
        }
        let title = format!("smallest distance [cm], start at {}", number(start));
        figures.push(chart(&Panel::over_time(title, curves), "No computed fall may be faster than the ideal one.")?);
    }
    Ok(html + &gallery(&figures))
}

fn dry_impact(is_quick: bool) -> Result<String, Failure> {
    let steps = if is_quick { &STEPS[..3] } else { &STEPS[..] };
    let impacts = steps
        .iter()
        .map(|&dt| impact(SIZE, SPEED, dt, TimeScheme::ImplicitEuler))
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
        "smallest height [cm]",
        "largest elastic energy",
        "energy lost",
    ];
    let curve = |value: &dyn Fn(&Impact) -> f64| Curve {
        points: impacts.iter().map(|i| (i.dt, value(i))).collect(),
        dots: true,
        ..Curve::default()
    };
    let panel = |title: &str, curve: Curve, level: f64| Panel {
        x_title: "Δt [s]".to_owned(),
        x_is_log: true,
        levels: vec![level],
        ..Panel::over_time(title, vec![curve])
    };
    let figures = [
        chart(
            &panel("restitution", curve(&|i| i.restitution), 0.982),
            "Velocity of the centre after over before the impact; dashed: the explicit computation.",
        )?,
        chart(
            &panel("contact lasts [ms]", curve(&|i| 1e3 * i.duration), 11.1),
            "From the first to the last step in contact.",
        )?,
    ];
    let text = format!(
        "<h3>The same disk without a fluid</h3>\
         <p>The disk of the paper's material hits a rigid plane at {SPEED} cm/s, the speed at the virtual barrier, with the \
         contact penalty of the cases, implicit Euler and cells of {SIZE} cm. Nothing but the time scheme can take \
         energy; what is missing after the impact is what implicit Euler costs. The last row is an independent explicit \
         computation that keeps the energy to 2·10⁻⁴. With fluid, contact lasts longer by about the square root of one \
         plus the added mass over the mass, and the fluid takes its share of the rebound.</p>"
    );
    Ok(text + &table("", &head, &rows) + &gallery(&figures))
}
