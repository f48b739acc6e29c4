//! Pressures of open sides, compared with the stiffness of elastic bodies.

use mesh::facet_normal;
use solver::{FluidBoundary, Setup};

use crate::scenario::{Choose as _, MaterialChoice, Quantity, Scenario, rounded};

/// Number of intervals between the times of a run at which pressures are evaluated.
const INTERVALS: usize = 20;

/// Pressure at the start, relative to Young's modulus, from which on a body may be thrown out of the domain.
const LARGEST_JUMP: f64 = 0.5;

/// Pressure relative to Young's modulus from which on bodies fail whose pressure acts where the step starts.
const LARGEST_AT_START: f64 = 0.15;

/// Pressure relative to Young's modulus from which on Saint Venant-Kirchhoff bodies are unreliable.
const LARGEST_OF_SVK: f64 = 0.3;

/// Pressures on a side of the background: minus the normal component of its traction.
struct SidePressure {
    side: String,
    /// Largest absolute value at the start.
    at_start: f64,
    /// Smallest and largest value in the run.
    range: [f64; 2],
}

impl SidePressure {
    fn largest(&self) -> f64 {
        self.range[0].abs().max(self.range[1].abs())
    }
}

/// Returns the sides with a traction that is not zero at all times.
fn side_pressures<const D: usize>(setup: &Setup<D>, end: f64) -> Vec<SidePressure> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let background = &fluid.background;
    let of_side = |(tag, condition): &(mesh::Tag, FluidBoundary<D>)| {
        let FluidBoundary::Open { traction: Some(traction), .. } = condition else { return None };
        let mut pressure =
            SidePressure { side: background.tag_names()[tag.index()].clone(), at_start: 0.0, range: [0.0; 2] };
        let facets = background.facets().filter(|facet| background.facet_tag(*facet) == Some(*tag));
        for (facet, k) in facets.flat_map(|facet| (0..=INTERVALS).map(move |k| (facet, k))) {
            let points = background.facet_points(facet);
            let normal = facet_normal(&points[..D]);
            let value = -traction(&mesh::mean(&points[..D]), &normal, end * k as f64 / INTERVALS as f64).dot(&normal);
            pressure.range = [pressure.range[0].min(value), pressure.range[1].max(value)];
            if k == 0 {
                pressure.at_start = pressure.at_start.max(value.abs());
            }
        }
        (pressure.largest() > 0.0).then_some(pressure)
    };
    fluid.boundary.iter().filter_map(of_side).collect()
}

/// Returns the name of the elastic body with the smallest Young's modulus, and this modulus.
fn softest(scenario: &Scenario) -> Option<(&str, f64)> {
    let moduli = scenario.body.iter().filter_map(|body| Some((body.name.as_str(), body.young()?)));
    moduli.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Describes the pressures of the sides.
pub(crate) fn pressures<const D: usize>(scenario: &Scenario, setup: &Setup<D>) -> Vec<String> {
    let unit = scenario.units.label(Quantity::PRESSURE);
    let describe = |pressure: SidePressure| {
        let [low, high] = pressure.range.map(rounded);
        let relative = softest(scenario).map_or(String::new(), |(body, young)| {
            format!(", at most {} of Young's modulus of body {body}", rounded(pressure.largest() / young))
        });
        format!("side {}: pressure {low:e} to {high:e} {unit}{relative}", pressure.side)
    };
    side_pressures(setup, scenario.time.end).into_iter().map(describe).collect()
}

/// Returns warnings about pressures that are large compared with the stiffness of a body.
pub(crate) fn large_pressures<const D: usize>(scenario: &Scenario, setup: &Setup<D>) -> Vec<String> {
    let mut lines = Vec::new();
    for body in &scenario.body {
        let Some((young, material)) = body.young().zip(body.material.as_ref()) else { continue };
        let is_svk = matches!(**material, MaterialChoice::SaintVenantKirchhoff(_));
        for pressure in side_pressures(setup, scenario.time.end) {
            let [relative, at_start] = [pressure.largest(), pressure.at_start].map(|p| rounded(p / young));
            let of_side = format!(
                "warning: the pressure of side {} is {{}} of Young's modulus of body {}",
                pressure.side, *body.name
            );
            let mut warn = |fraction: f64, text: &str| lines.push(of_side.replace("{}", &fraction.to_string()) + text);
            if scenario.time.scheme.word() == "implicit-euler" && relative >= LARGEST_AT_START {
                warn(relative, ": with implicit-euler bodies fail from about 0.2 on; take generalised-alpha");
            } else if at_start >= LARGEST_JUMP {
                warn(at_start, " at the start: let it rise over several steps, such as \"1000*min(t/0.1, 1)\"");
            }
            if is_svk && relative >= LARGEST_OF_SVK {
                warn(relative, ": a Saint Venant-Kirchhoff body may collapse; take neo-hookean");
            }
        }
    }
    lines
}
