//! Pressures of open sides, compared with the stiffness of elastic bodies.

use mesh::facet_normal;
use solver::FluidBoundary;

use crate::scenario::{Case, Choose as _, MaterialChoice, Quantity, Scenario, rounded};

/// Largest number of values of the pressure of a side that are computed; at least at [`LEAST_TIMES`] times.
const MOST_VALUES: usize = 200_000;

/// Smallest number of intervals between the times at which pressures are evaluated.
const LEAST_TIMES: usize = 20;

/// Pressure in the first step, relative to Young's modulus, from which on a body may be thrown out of the domain.
const LARGEST_JUMP: f64 = 0.5;

/// Pressure relative to Young's modulus from which on bodies may turn or fail with implicit Euler.
const LARGEST_OF_EULER: f64 = 0.03;

/// Pressure relative to Young's modulus from which on Saint Venant-Kirchhoff bodies are unreliable.
const LARGEST_OF_SVK: f64 = 0.3;

/// Pressures on a side of the background: minus the normal component of its traction.
struct SidePressure {
    side: String,
    /// Largest absolute value at the end of the first step, with which the run begins.
    at_first: f64,
    /// Smallest and largest value in the run.
    range: [f64; 2],
}

impl SidePressure {
    fn largest(&self) -> f64 {
        self.range[0].abs().max(self.range[1].abs())
    }
}

/// Returns the sides with a traction that is not zero at all times. Pressures are evaluated at the ends of steps, or at
/// fewer times if a side has many facets.
fn side_pressures<const D: usize>(case: &Case<D>, end: f64) -> Vec<SidePressure> {
    let (setup, n_steps) = (&case.setup, case.n_steps);
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let background = &fluid.background;
    let of_side = |(tag, condition): &(mesh::Tag, FluidBoundary<D>)| {
        let FluidBoundary::Open { traction: Some(traction), .. } = condition else { return None };
        let side = background.tag_names()[tag.index()].clone();
        let mut pressure = SidePressure { side, at_first: 0.0, range: [f64::INFINITY, f64::NEG_INFINITY] };
        let facets = background.facets().filter(|facet| background.facet_tag(*facet) == Some(*tag));
        let facets: Vec<_> = facets.collect();
        let n_times = n_steps.min(MOST_VALUES / facets.len().max(1)).max(LEAST_TIMES);
        for facet in facets {
            let points = background.facet_points(facet);
            let (middle, normal) = (mesh::mean(&points[..D]), facet_normal(&points[..D]));
            let at = |time: f64| -traction(&middle, &normal, time).dot(&normal);
            pressure.at_first = pressure.at_first.max(at(setup.dt).abs());
            for value in (0..=n_times).map(|k| at(end * k as f64 / n_times as f64)) {
                pressure.range = [pressure.range[0].min(value), pressure.range[1].max(value)];
            }
        }
        (pressure.largest() > 0.0 && pressure.largest().is_finite()).then_some(pressure)
    };
    fluid.boundary.iter().filter_map(of_side).collect()
}

/// Returns the name of the elastic body with the smallest Young's modulus, and this modulus.
fn softest(scenario: &Scenario) -> Option<(&str, f64)> {
    let moduli = scenario.body.iter().filter_map(|body| Some((body.name.as_str(), body.young()?)));
    moduli.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Describes the pressures of the sides.
pub(crate) fn pressures<const D: usize>(scenario: &Scenario, case: &Case<D>) -> Vec<String> {
    let unit = scenario.units.label(Quantity::PRESSURE);
    let describe = |pressure: SidePressure| {
        let [low, high] = pressure.range.map(rounded);
        let relative = softest(scenario).map_or(String::new(), |(body, young)| {
            format!(", up to {} of Young's modulus of body {body}", rounded(pressure.largest() / young))
        });
        let range = if low == high { format!("{low:e}") } else { format!("{low:e} to {high:e}") };
        format!("side {}: pressure {range} {unit}{relative}", pressure.side)
    };
    side_pressures(case, scenario.time.end).into_iter().map(describe).collect()
}

/// Returns warnings about pressures that are large compared with the stiffness of a body.
pub(crate) fn large_pressures<const D: usize>(scenario: &Scenario, case: &Case<D>) -> Vec<String> {
    let mut lines = Vec::new();
    for body in &scenario.body {
        let Some((young, material)) = body.young().zip(body.material.as_ref()) else { continue };
        let is_svk = matches!(**material, MaterialChoice::SaintVenantKirchhoff(_));
        for pressure in side_pressures(case, scenario.time.end) {
            let [relative, at_first] = [pressure.largest(), pressure.at_first].map(|p| rounded(p / young));
            let of_side = format!(
                "warning: the pressure of side {} is {{}} of Young's modulus of body {}",
                pressure.side, *body.name
            );
            let mut warn = |fraction: f64, text: &str| lines.push(of_side.replace("{}", &fraction.to_string()) + text);
            if scenario.time.scheme.word() == "implicit-euler" && relative >= LARGEST_OF_EULER {
                warn(relative, ": with implicit-euler it may turn the body, and throw it out; take generalised-alpha");
            } else if at_first >= LARGEST_JUMP {
                warn(at_first, " in the first step: let it rise over several steps, such as \"1000*min(t/0.1, 1)\"");
            }
            if is_svk && relative >= LARGEST_OF_SVK {
                warn(relative, ": a Saint Venant-Kirchhoff body may collapse; take neo-hookean");
            }
        }
    }
    lines
}
