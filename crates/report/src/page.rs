//! The sections of the page of one run.

use serde_json::json;

use crate::balances::Balances;
use crate::html::{data, duration, escape, gallery, number, optional, table};
use crate::{Chart, Error, Frames, Results, Section, Snapshot};

/// Returns the introduction of the page: number of steps, end time, wall-clock time, the first contact, and whether the
/// run stopped before its end.
pub(crate) fn lead(results: &Results) -> String {
    let summary = &results.summary;
    let time = &results.summary.units.time;
    let end = results.history.column("time").and_then(|times| times.last().copied()).unwrap_or(0.0);
    let contact = match (summary.contact_time, summary.release_time) {
        (Some(begin), Some(end)) => format!("First contact at {} {time}, until {} {time}.", number(begin), number(end)),
        (Some(begin), None) => format!("Contact from {} {time} to the end.", number(begin)),
        (None, _) => "No contact.".to_owned(),
    };
    let planned = results.planned_end.filter(|planned| end < planned - 0.5 * summary.dt);
    let stopped = planned.map_or(String::new(), |planned| {
        format!(
            " <strong>The run stopped before its planned end, {} {time}; run.log has the reason.</strong>",
            number(planned)
        )
    });
    format!(
        "<p>{} steps to {} {time}, computed in {}. {contact}{stopped}</p>",
        summary.steps,
        number(end),
        duration(summary.wall_seconds)
    )
}

/// Returns all sections of the page of a run, in order.
///
/// # Errors
/// [`Error::Json`].
pub(crate) fn page_sections(results: &Results) -> Result<Vec<Section>, Error> {
    let mut sections = result_sections(results, &[])?;
    // The first line of the guide explains the charts; the others are left out without a fluid.
    let guide = include_str!("../assets/guide.html");
    let end = if results.summary.stabilisation.is_empty() { guide.find('\n') } else { None };
    let guide = &guide[..end.unwrap_or(guide.len())];
    sections.iter_mut().filter(|section| section.id == "histories").for_each(|found| found.html.insert_str(0, guide));
    sections.push(Section::new("timings", "Timings", timings(results)?));
    sections.push(Section::new("scenario", "Scenario", format!("<pre>{}</pre>", escape(&results.scenario))));
    Ok(sections)
}

/// Returns the HTML of a run for a page about several runs: the sections about results, with `<h3>` titles. `marks` are
/// labels and times that are marked in the histories, in the unit of time of the run.
///
/// # Errors
/// [`Error::Json`].
pub fn run_as_html(results: &Results, marks: &[(String, f64)]) -> Result<String, Error> {
    let text = |section: Section| match section.id.as_str() {
        "run" => section.html,
        _ => format!("<h3>{}</h3>{}", section.title, section.html),
    };
    Ok(result_sections(results, marks)?.into_iter().map(text).collect())
}

/// Returns the sections about the results of a run, without empty ones.
fn result_sections(results: &Results, marks: &[(String, f64)]) -> Result<Vec<Section>, Error> {
    let balances = Balances { results };
    let all = [
        Section::new("run", "The run", overview(results)?),
        Section::new("moments", "Fields", moments(results)?),
        Section::new("histories", "Histories", histories(results, marks)?),
        Section::new("contacts", "Contacts", contacts(results, marks)?),
        Section::new(
            "energies",
            "Energies",
            balances.energies()? + &balances.contact().unwrap_or_default() + &balances.losses()?,
        ),
        Section::new("balances", "Forces and volumes", balances.balances()?),
    ];
    Ok(all.into_iter().filter(|section| !section.html.is_empty()).collect())
}

/// Returns the animation, and a table of the sizes and results of a run.
fn overview(results: &Results) -> Result<String, Error> {
    let summary = &results.summary;
    let (length, time) = (&summary.units.length, &summary.units.time);
    let half =
        if summary.half_domain { "; half of a symmetric problem, with its forces, masses and energies" } else { "" };
    let bodies: Vec<String> = summary.bodies.iter().map(|name| escape(name)).collect();
    let has_fluid = !summary.stabilisation.is_empty();
    let leading = summary.leading.as_ref().filter(|_| bodies.len() > 1);
    let in_length = |value: f64| format!("{} {length}", number(value));
    let rows = [
        Some(("bodies", if bodies.is_empty() { "none".to_owned() } else { bodies.join(", ") })),
        has_fluid.then(|| ("background", format!("{} cells{half}", summary.cells))),
        Some(("unknowns, at most", summary.dofs.to_string())),
        Some(("time step", format!("{} {time}, {} steps", number(summary.dt), summary.steps))),
        has_fluid.then(|| ("stabilisation", escape(&summary.stabilisation))),
        leading.map(|leading| ("leading body", escape(leading))),
        summary.contact_offset.map(|offset| ("contact begins at a distance of", in_length(offset))),
        summary.contact_offset.map(|_| ("largest penetration below that distance", in_length(summary.max_penetration))),
        Some(("smallest distance", in_length(summary.min_distance.unwrap_or(f64::NAN)))),
        Some(("divided steps", summary.divided_steps.to_string())),
        Some(("steps that generated energy", if summary.energy_monotone { "none" } else { "some" }.to_owned())),
        summary
            .energy_generated
            .map(|sum| ("sum of such energies, relative to the largest energy or line of the ledger", number(sum))),
    ];
    let rows: Vec<_> = rows.into_iter().flatten().map(|(what, value)| vec![what.to_owned(), value]).collect();
    let facts = format!("<div>{}</div>", table("", &["", ""], &rows));
    Ok(gallery(&[animation(results)?, facts]))
}

/// Returns the animation; empty without frames.
fn animation(results: &Results) -> Result<String, Error> {
    let Some(frames) = results.frames.as_ref().filter(|frames| !frames.frames.is_empty()) else {
        return Ok(String::new());
    };
    let data = drawing(results, frames, frames.frames.iter())?;
    let label = escape(&format!("Animation: bodies and speed of the fluid, {}", results.summary.case));
    Ok(format!(
        "<figure class=\"animation\"><canvas role=\"img\" aria-label=\"{label}\"></canvas>\
         <div class=\"controls\"><button type=\"button\" aria-label=\"Play or pause\">Play</button>\
         <input type=\"range\" min=\"0\" value=\"0\" aria-label=\"Time of the animation\"><output></output></div>\
         <figcaption>Bodies, and speed of the fluid on a coarse raster.</figcaption>{data}</figure>"
    ))
}

/// Returns the fields at chosen moments; empty without frames.
fn moments(results: &Results) -> Result<String, Error> {
    let Some(frames) = &results.frames else { return Ok(String::new()) };
    let mut moments: Vec<_> = frames.moments.iter().collect();
    moments.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
    let figure = |(title, frame): (&String, &Snapshot)| {
        let title = escape(title);
        let data = drawing(results, frames, [frame].into_iter())?;
        Ok(format!(
            "<figure class=\"moment\"><h4>{title}</h4><canvas role=\"img\" aria-label=\"Speed of the fluid: {title}\">\
             </canvas><output></output>{data}</figure>"
        ))
    };
    let figures = moments.into_iter().map(figure).collect::<Result<Vec<_>, Error>>()?;
    Ok(if figures.is_empty() { String::new() } else { format!("<div class=\"moments\">{}</div>", figures.concat()) })
}

/// Returns the data of frames for the script that draws them.
fn drawing<'a>(results: &Results, frames: &Frames, shown: impl Iterator<Item = &'a Snapshot>) -> Result<String, Error> {
    let Frames { low, high, mirror, unit, .. } = frames;
    data(&json!({
        "low": low, "high": high, "mirror": mirror, "unit": unit,
        "units": results.summary.units,
        "frames": shown.collect::<Vec<_>>(),
    }))
}

/// Returns the histories of all bodies, with marked times.
fn histories(results: &Results, marks: &[(String, f64)]) -> Result<String, Error> {
    let Results { history, summary, .. } = results;
    let units = &summary.units;
    let vertical = mesh::AXES[summary.dimension.saturating_sub(1).min(2)];
    let chart = |title: &str, unit: &str, column: &str| {
        let curve = |name: &String| results.curve(name, history, &format!("{}{column}", results.prefix(name)));
        let curves = summary.bodies.iter().map(curve).collect();
        Chart { marks: marks.to_vec(), ..results.over_time(title, unit, curves) }.html()
    };
    let torque = if summary.dimension == 2 { "torque" } else { "torque_z" };
    Ok(gallery(&[
        chart("smallest distance", &units.length, "d_min")?,
        chart("velocity of the centre, vertical", &units.velocity, "centre_velocity")?,
        chart("height of the body", &units.length, "body_height")?,
        chart("velocity of the lowest point", &units.velocity, "lowest_velocity")?,
        chart("acceleration of the lowest point", &units.acceleration, "lowest_acceleration")?,
        chart("position of the centre, x", &units.length, "centre_x")?,
        chart("force of the fluid, x", &units.force, "force_x")?,
        chart(&format!("force of the fluid, {vertical}"), &units.force, &format!("force_{vertical}"))?,
        chart("torque of the fluid", if units.moment.is_empty() { &units.energy } else { &units.moment }, torque)?,
        chart("angle", "rad", "angle")?,
    ]))
}

/// Returns the table of the contacts, and the first one in detail; empty without a contact.
fn contacts(results: &Results, marks: &[(String, f64)]) -> Result<String, Error> {
    let Results { summary, history, .. } = results;
    let units = &summary.units;
    let Some(&(begin, end)) = summary.contact_intervals.first() else { return Ok(String::new()) };
    let row = |(k, (begin, end)): (usize, &(f64, Option<f64>))| {
        let lasts = end.map_or("to the end".to_owned(), |end| number(end - begin));
        vec![(k + 1).to_string(), number(*begin), optional(*end), lasts]
    };
    // A body that vibrates on an obstacle may have hundreds of contacts.
    let shown = summary.contact_intervals.iter().take(12).enumerate();
    let rows: Vec<_> = shown.map(row).collect();
    let time = &units.time;
    let head = ["", &format!("begin [{time}]"), &format!("end [{time}]"), &format!("lasts [{time}]")];
    let (n, n_listed) = (summary.contact_intervals.len(), rows.len());
    let listed = if n_listed < n { format!("the first {n_listed} of ") } else { String::new() };
    let caption = format!("Contacts: {listed}{n}.");
    let last = history.column("time").and_then(|times| times.last().copied()).unwrap_or(begin);
    let end = end.unwrap_or(last);
    let margin = (0.4 * (end - begin)).max(5.0 * summary.dt);
    let window = Some((begin - margin, (end + margin).min(last)));
    let prefix = results.leading_prefix();
    let chart = |title: &str, unit: &str, column: &str| {
        let curve = results.curve(title, history, &format!("{prefix}{column}"));
        Chart { window, marks: marks.to_vec(), ..results.over_time(title, unit, vec![curve]) }
    };
    let mut distance = chart("smallest distance, first contact", &units.length, "d_min");
    distance.levels = summary.contact_offset.into_iter().collect();
    let force = chart("contact force, vertical", &units.force, "contact_force");
    Ok(table(&caption, &head, &rows) + &gallery(&[distance.html()?, force.html()?]))
}

/// Returns the wall-clock times, and the work of the solver over time.
fn timings(results: &Results) -> Result<String, Error> {
    let Results { summary, history, .. } = results;
    let steps = summary.steps.max(1) as f64;
    let tasks = summary.timings.iter().filter(|timing| timing.contribution.is_none());
    let all: f64 = tasks.clone().map(|timing| timing.seconds).sum();
    let mut rows = Vec::new();
    for task in tasks {
        for timing in summary.timings.iter().filter(|timing| timing.task == task.task) {
            let name = timing.contribution.as_ref().map_or_else(
                || escape(&timing.task),
                |contribution| format!("<span class=\"part\">{}</span>", escape(contribution)),
            );
            let share = 100.0 * timing.seconds / all.max(f64::MIN_POSITIVE);
            let (seconds, per_step) = (timing.seconds, 1e3 * timing.seconds / steps);
            let numbers = [format!("{seconds:.3}"), format!("{per_step:.2}"), format!("{share:.1} %")];
            rows.push([vec![name, timing.calls.to_string()], numbers.to_vec()].concat());
        }
    }
    let memory = summary.peak_rss_bytes.map_or(String::new(), |bytes| format!(", {} MB of memory", bytes / 1_000_000));
    let caption = format!(
        "{} Newton iterations and {} factorisations in {}{memory}.",
        summary.newton_iterations,
        summary.factorizations,
        duration(summary.wall_seconds)
    );
    let times = table(&caption, &["", "calls", "seconds", "ms per step", "share"], &rows);
    let work = ["newton", "linear_iterations", "factorizations"].map(|name| results.curve(name, history, name));
    let tasks = ["cut", "space", "assembly", "linear", "output"];
    let seconds = tasks.map(|name| results.curve(name, history, &format!("seconds_{name}")));
    let figures = [
        Chart { title: "iterations per step".to_owned(), ..results.over_time("", "", work.into()) }.html()?,
        results.over_time("wall-clock time per step", "s", seconds.into()).html()?,
    ];
    Ok(times + &gallery(&figures))
}
