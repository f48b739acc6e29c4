//! Pressures of open sides and hydrostatic pressures, compared with the stiffness of elastic bodies.

use mesh::{Aabb, facet_normal};
use solver::{FluidBoundary, FluidSetup, Setup};

use crate::scenario::{Case, Choose as _, MaterialChoice, Quantity, Scenario, rounded};

/// Largest number of values of each pressure that are computed; at least at [`LEAST_TIMES`] times.
const MOST_VALUES: usize = 200_000;

/// Smallest number of intervals between the times at which pressures are evaluated.
const LEAST_TIMES: usize = 20;

/// Pressure in the first step, relative to Young's modulus, from which on a body may be thrown out of the domain.
const LARGEST_JUMP: f64 = 0.5;

/// Pressure relative to Young's modulus from which on bodies may turn or fail if [`pressure_lags`], as with implicit
/// Euler.
const LARGEST_LAGGING: f64 = 0.03;

/// Pressure relative to Young's modulus from which on Saint Venant-Kirchhoff bodies are unreliable.
const LARGEST_OF_SVK: f64 = 0.3;

/// Pressure in the first step, relative to Young's modulus, from which on one of them is mostly in a wrong unit.
const IMPLAUSIBLE: f64 = 10.0;

/// Smallest weight of the fluid along a side that is compared with the pressures there, relative to the weight along
/// the extent of the background; and smallest relative difference that is reported.
const SMALL_WEIGHT: f64 = 0.05;
const UNBALANCED: f64 = 0.5;

/// A pressure that acts in fluid at rest: given on a side, or hydrostatic.
struct Pressure {
    /// The side and the quantity, such as "side top: pressure".
    source: String,
    /// The same within a sentence.
    subject: String,
    /// Largest absolute value at the end of the first step, with which the run begins.
    at_first: f64,
    /// Smallest and largest value in the run.
    range: [f64; 2],
}

impl Pressure {
    fn new(source: String, subject: String) -> Self {
        Self { source, subject, at_first: 0.0, range: [f64::INFINITY, f64::NEG_INFINITY] }
    }

    /// Takes the values of a function of time at `n_times` intervals of the run and at the end of the first step.
    fn cover(&mut self, value: impl Fn(f64) -> f64, dt: f64, end: f64, n_times: usize) {
        self.at_first = self.at_first.max(value(dt).abs());
        for value in (0..=n_times).map(|k| value(end * k as f64 / n_times as f64)) {
            self.range = [self.range[0].min(value), self.range[1].max(value)];
        }
    }

    fn largest(&self) -> f64 {
        self.range[0].abs().max(self.range[1].abs())
    }
}

/// Returns the pressures of sides and the hydrostatic pressure, without those that are zero at all times. They are
/// evaluated at equal intervals: at most one per step, but at least 20.
fn all_pressures<const D: usize>(case: &Case<D>, end: f64) -> Vec<Pressure> {
    let Some(fluid) = &case.setup.fluid else { return Vec::new() };
    let mut all = side_pressures(fluid, case, end);
    all.extend(hydrostatic_pressure(fluid, case, end));
    all.retain(|pressure| pressure.largest() > 0.0 && pressure.largest().is_finite());
    all
}

/// Returns the number of intervals of time for a number of places.
fn n_times<const D: usize>(case: &Case<D>, n_places: usize) -> usize {
    case.n_steps.min(MOST_VALUES / n_places.max(1)).max(LEAST_TIMES)
}

/// Returns the pressure of each side with a traction: minus its normal component.
fn side_pressures<const D: usize>(fluid: &FluidSetup<D>, case: &Case<D>, end: f64) -> Vec<Pressure> {
    let background = &fluid.background;
    let of_side = |(tag, condition): &(mesh::Tag, FluidBoundary<D>)| {
        let traction = condition.traction()?;
        let side = &background.tag_names()[tag.index()];
        let mut pressure = Pressure::new(format!("side {side}: pressure"), format!("pressure of side {side}"));
        let facets: Vec<_> = background.facets().filter(|facet| background.facet_tag(*facet) == Some(*tag)).collect();
        let n_times = n_times(case, facets.len());
        for facet in facets {
            let points = background.facet_points(facet);
            let (middle, normal) = (mesh::mean(&points[..D]), facet_normal(&points[..D]));
            let at = |time: f64| -traction(&middle, &normal, time).dot(&normal);
            pressure.cover(at, case.setup.dt, end, n_times);
        }
        Some(pressure)
    };
    fluid.boundary.iter().filter_map(of_side).collect()
}

/// Returns the largest difference of the pressure that the body force causes in fluid at rest: the sum over the axes of
/// its components times the extents of the background. The force is evaluated at two corners and the centre.
fn hydrostatic_pressure<const D: usize>(fluid: &FluidSetup<D>, case: &Case<D>, end: f64) -> Option<Pressure> {
    let force = fluid.body_force.as_ref()?;
    let bounds = Aabb::of_points(fluid.background.vertices());
    let (extent, points) = (bounds.extent(), [bounds.low, bounds.centre(), bounds.high]);
    let mut pressure = Pressure::new(
        "fluid.body_force: hydrostatic pressure".to_owned(),
        "hydrostatic pressure of `fluid.body_force`".to_owned(),
    );
    let n_times = n_times(case, points.len());
    for x in &points {
        pressure.cover(|time| force(x, time).abs().dot(&extent), case.setup.dt, end, n_times);
    }
    Some(pressure)
}

/// Returns the name of the elastic body with the smallest Young's modulus, and this modulus.
fn softest(scenario: &Scenario) -> Option<(&str, f64)> {
    let moduli = scenario.body.iter().filter_map(|body| Some((body.name.as_str(), body.young()?)));
    moduli.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Describes the pressures of the sides and the hydrostatic pressure.
pub(crate) fn pressures<const D: usize>(scenario: &Scenario, case: &Case<D>) -> Vec<String> {
    let unit = scenario.units.label(Quantity::PRESSURE);
    let describe = |pressure: Pressure| {
        let [low, high] = pressure.range.map(rounded);
        let relative = softest(scenario).map_or(String::new(), |(body, young)| {
            format!(", up to {} of Young's modulus of body {body}", rounded(pressure.largest() / young))
        });
        let range = if low == high { format!("{low:e}") } else { format!("{low:e} to {high:e}") };
        format!("{} {range} {unit}{relative}", pressure.source)
    };
    all_pressures(case, scenario.time.end).into_iter().map(describe).collect()
}

/// Returns whether the pressure of a step acts on the surfaces as they are cut, and not on those at the stage of the
/// step.
pub(crate) fn pressure_lags<const D: usize>(setup: &Setup<D>) -> bool {
    !setup.scheme.weights(setup.dt, false).pressure_at_stage
}

/// Returns warnings about pressures that are large compared with the stiffness of a body.
pub(crate) fn large_pressures<const D: usize>(scenario: &Scenario, case: &Case<D>) -> Vec<String> {
    let mut lines = Vec::new();
    for body in &scenario.body {
        let Some((young, material)) = body.young().zip(body.material.as_ref()) else { continue };
        let is_svk = matches!(**material, MaterialChoice::SaintVenantKirchhoff(_));
        for pressure in all_pressures(case, scenario.time.end) {
            let [relative, at_first] = [pressure.largest(), pressure.at_first].map(|p| rounded(p / young));
            let of_side =
                format!("warning: the {} is {{}} of Young's modulus of body {}", pressure.subject, *body.name);
            let mut warn = |fraction: f64, text: &str| lines.push(of_side.replace("{}", &fraction.to_string()) + text);
            if pressure_lags(&case.setup) && relative >= LARGEST_LAGGING {
                let scheme = scenario.time.scheme.word();
                warn(
                    relative,
                    &format!(": with {scheme} it may turn the body, and throw it out; take generalised-alpha"),
                );
            } else if at_first >= IMPLAUSIBLE {
                warn(at_first, " in the first step, which would crush the body: check the units of both");
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

/// Returns warnings about open sides along which the fluid has a weight that the pressure at the end of the run does
/// not balance. They are found from the facets of the side that are lowest and highest along the body force.
pub(crate) fn unbalanced_sides<const D: usize>(setup: &Setup<D>, end: f64) -> Vec<String> {
    let Some(FluidSetup { background, boundary, body_force: Some(force), .. }) = &setup.fluid else {
        return Vec::new();
    };
    let extent = Aabb::of_points(background.vertices()).extent().max();
    let of_side = |(tag, condition): &(mesh::Tag, FluidBoundary<D>)| {
        if !matches!(condition, FluidBoundary::Open { .. } | FluidBoundary::Parallel { .. }) {
            return None;
        }
        let facets = background.facets().filter(|facet| background.facet_tag(*facet) == Some(*tag));
        let of_facet = |facet| {
            let points = background.facet_points(facet);
            let (middle, normal) = (mesh::mean(&points[..D]), facet_normal(&points[..D]));
            let pressure = condition.traction().map_or(0.0, |traction| -traction(&middle, &normal, end).dot(&normal));
            (middle, pressure)
        };
        let facets: Vec<_> = facets.map(of_facet).collect();
        let along = force(&facets.first()?.0, end);
        let by_height = |a: &&(_, f64), b: &&(_, f64)| along.dot(&a.0).total_cmp(&along.dot(&b.0));
        let (above, below) = (facets.iter().min_by(by_height)?, facets.iter().max_by(by_height)?);
        let (weight, pressure) = (along.dot(&(below.0 - above.0)), below.1 - above.1);
        let is_unbalanced = (weight - pressure).abs() > UNBALANCED * weight;
        (weight > SMALL_WEIGHT * along.norm() * extent && is_unbalanced).then(|| {
            format!(
                "warning: side {}: its pressure changes by {:e} along `fluid.body_force`, and that of fluid at rest by {:e}, so that the fluid falls out; give it a \
                 `pressure` that grows along the force, or leave `body_force` out where nothing floats or sinks",
                background.tag_names()[tag.index()],
                rounded(pressure),
                rounded(weight)
            )
        })
    };
    boundary.iter().filter_map(of_side).collect()
}
