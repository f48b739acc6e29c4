//! Charts of histories: a bouncing body, its contact, two runs beside each other, the thickness of a plate.

use super::chart::{Chart, Curve, Event, Panel};
use crate::history::HistoryTable;
use crate::scenario::schema::Mark;
use crate::summary::Summary;

/// Title and column of the graphs of a body, in the arrangement of the paper's Figure 8, row by row.
const BODY: [(&str, &str); 4] = [
    ("smallest distance [cm]", "d_min"),
    ("velocity of the lowest point [cm/s]", "lowest_velocity"),
    ("height of the body [cm]", "body_height"),
    ("acceleration of the lowest point [cm/s²]", "lowest_acceleration"),
];

/// A column over time; empty if there is none of that name.
pub fn column_curve(table: &HistoryTable, column: &str) -> Vec<(f64, f64)> {
    let times = table.column("time").unwrap_or_default();
    times.into_iter().zip(table.column(column).unwrap_or_default()).collect()
}

/// Smallest distance, height of the body, velocity and acceleration of its lowest point over time, with known events
/// marked. `prefix` is that of the columns of the body, empty if there is only one.
pub fn body_chart(table: &HistoryTable, prefix: &str, marks: &[Mark]) -> Chart {
    let panels = BODY.map(|(title, column)| {
        let curve = Curve::plain(column_curve(table, &format!("{prefix}{column}")));
        let mut panel = Panel::over_time(title, vec![curve]);
        panel.events = events(marks, column == "d_min");
        panel
    });
    Chart { columns: 2, panels: panels.into() }
}

fn events(marks: &[Mark], with_values: bool) -> Vec<Event> {
    let event = |(k, mark): (usize, &Mark)| {
        let label = match mark.d_min {
            Some(d) => format!("{}  {} s, {d} cm", mark.label, mark.time),
            None => format!("{}  {} s", mark.label, mark.time),
        };
        Event { label, colour: k + 1, x: mark.time, y: mark.d_min.filter(|_| with_values) }
    };
    marks.iter().enumerate().map(event).collect()
}

/// Smallest distance and contact force from just before the first contact to just after it (paper, Figure 10, top
/// right); `offset` is the distance at which contact begins. None if there was no contact.
pub fn contact_chart(
    table: &HistoryTable,
    summary: &Summary,
    prefix: &str,
    marks: &[Mark],
    offset: Option<f64>,
) -> Option<Chart> {
    let &(begin, end) = summary.contact_intervals.first()?;
    let last = table.column("time")?.last().copied()?;
    let end = end.unwrap_or(last);
    let margin = (0.4 * (end - begin)).min(0.01).max(5.0 * summary.dt);
    let window = (begin - margin, (end + margin).min(last));
    let panel = |title: &str, column: &str| {
        let curve = Curve::plain(column_curve(table, &format!("{prefix}{column}")));
        let shown = marks.iter().filter(|mark| window.0 <= mark.time && mark.time <= window.1).cloned();
        let events = events(&shown.collect::<Vec<_>>(), false);
        Panel { x_range: Some(window), events, ..Panel::over_time(title, vec![curve]) }
    };
    let mut distance = panel("smallest distance in contact [cm]", "d_min");
    distance.levels = offset.into_iter().collect();
    Some(Chart { columns: 2, panels: vec![distance, panel("contact force [dyn/cm]", "contact_force")] })
}

/// Forces and torque of the fluid on bodies over time, a row of graphs for each: of the mortar's traction, and of the
/// fluid's alone. Bodies are given by their names and the prefixes of their columns; none if there are no bodies.
pub fn force_chart(table: &HistoryTable, bodies: &[(String, String)]) -> Option<Chart> {
    let of_body = |(name, prefix): &(String, String)| {
        let curve = |label: &str, colour: usize, column: String| Curve {
            label: label.to_owned(),
            colour,
            points: column_curve(table, &format!("{prefix}{column}")),
            dots: false,
        };
        let force = |axis: &str| {
            let curves = vec![
                curve("mortar", 0, format!("force_{axis}")),
                curve("traction alone", 1, format!("traction_force_{axis}")),
            ];
            Panel::over_time(format!("{name}: force of the fluid, {axis} [dyn/cm]"), curves)
        };
        let torque = vec![curve("", 0, "torque".to_owned())];
        [force("x"), force("y"), Panel::over_time(format!("{name}: torque of the fluid [dyn]"), torque)]
    };
    let panels: Vec<Panel> = bodies.iter().flat_map(of_body).collect();
    (!panels.is_empty()).then_some(Chart { columns: 3, panels })
}

/// One column of several runs, each with its name (paper, Figure 12: height of the body for two time steps).
pub fn comparison_chart(title: &str, column: &str, runs: &[(String, &HistoryTable)]) -> Chart {
    let curve = |(k, (label, table)): (usize, &(String, &HistoryTable))| Curve {
        label: label.clone(),
        colour: k,
        points: column_curve(table, column),
        dots: false,
    };
    let curves = runs.iter().enumerate().map(curve).collect();
    Chart { columns: 1, panels: vec![Panel::over_time(title, curves)] }
}

/// The smallest thickness of plates over time (paper, Figure 16, right), from the columns of `diagnostics.csv`; none if
/// no body is a plate.
pub fn thickness_chart(diagnostics: &HistoryTable, marks: &[Mark]) -> Option<Chart> {
    let plates = diagnostics.names().iter().filter_map(|name| name.strip_suffix("min_thickness"));
    let panels: Vec<Panel> = plates
        .map(|prefix| {
            let name = prefix.trim_end_matches('_');
            let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
            let curve = Curve::plain(column_curve(diagnostics, &format!("{prefix}min_thickness")));
            let mut panel = Panel::over_time(format!("smallest thickness{of} [cm]"), vec![curve]);
            panel.events = events(marks, false);
            panel
        })
        .collect();
    (!panels.is_empty()).then_some(Chart { columns: 2, panels })
}
