//! Pressures of open sides and hydrostatic pressures, compared with the stiffness of elastic bodies.

use mesh::{Aabb, Point, Vector, facet_normal};
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

/// Pressure relative to Young's modulus from which on one of them is mostly in a wrong unit.
const IMPLAUSIBLE: f64 = 10.0;

/// Number of times at which the body force on the fluid is compared, for the largest one.
const FORCE_TIMES: usize = 20;

/// Largest component of the body force across a side that counts as along it, relative to the force.
const ACROSS: f64 = 0.1;

/// Smallest relative difference of given pressures from the weight of the fluid that is reported.
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
            if relative >= IMPLAUSIBLE {
                warn(
                    relative,
                    ", which crushes most bodies: check the units of both; if they are right, let it rise over several steps",
                );
            } else if pressure_lags(&case.setup) && relative >= LARGEST_LAGGING {
                let scheme = scenario.time.scheme.word();
                warn(
                    relative,
                    &format!(": with {scheme} it may turn the body, and throw it out; take generalised-alpha"),
                );
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

/// Returns warnings about open sides along the body force of the fluid, such as upright ones under gravity, whose
/// pressure differs from that of fluid at rest. Their highest and lowest facets along the force are compared, at the
/// time of the largest force; a force that is linear in space is exact.
pub(crate) fn unbalanced_sides<const D: usize>(scenario: &Scenario, setup: &Setup<D>) -> Vec<String> {
    let Some(FluidSetup { background, boundary, body_force: Some(force), .. }) = &setup.fluid else {
        return Vec::new();
    };
    let unit = scenario.units.label(Quantity::PRESSURE);
    let of_side = |(tag, condition): &(mesh::Tag, FluidBoundary<D>)| {
        let facets = background.facets().filter(|facet| background.facet_tag(*facet) == Some(*tag));
        let place = |facet| {
            let points = background.facet_points(facet);
            (mesh::mean(&points[..D]), facet_normal(&points[..D]))
        };
        let places: Vec<_> = facets.filter(|_| condition.is_open()).map(place).collect();
        let mean = |time: f64| places.iter().map(|(x, _)| force(x, time)).sum::<Vector<D>>() / places.len() as f64;
        let times = (0..=FORCE_TIMES).map(|k| scenario.time.end * k as f64 / FORCE_TIMES as f64);
        let time = times.max_by(|a, b| mean(*a).norm().total_cmp(&mean(*b).norm()))?;
        let along = mean(time);
        let is_along = |(_, normal): &(_, Vector<D>)| along.dot(normal).abs() <= ACROSS * along.norm();
        let by_height = |a: &&(Point<D>, _), b: &&(Point<D>, _)| along.dot(&a.0).total_cmp(&along.dot(&b.0));
        let ends = [places.iter().min_by(by_height)?, places.iter().max_by(by_height)?];
        let [above, below] =
            ends.map(|(x, normal)| condition.traction().map_or(0.0, |traction| -traction(x, normal, time).dot(normal)));
        let [high, low] = ends.map(|(x, _)| x);
        let weight = 0.5 * (force(high, time) + force(low, time)).dot(&(low - high));
        let is_unbalanced = (below - above - weight).abs() > UNBALANCED * weight;
        (weight > 0.0 && is_unbalanced && places.iter().all(is_along)).then(|| {
            format!(
                "warning: along side {} the pressure changes by {:e} {unit} in the direction of `fluid.body_force`, and that of fluid at rest by {:e} {unit}: the \
                 fluid flows in or out there; give the side a `pressure` that grows with the depth, or leave `body_force` out where nothing floats or sinks",
                background.tag_names()[tag.index()],
                rounded(below - above),
                rounded(weight)
            )
        })
    };
    boundary.iter().filter_map(of_side).collect()
}
