//! Quantities that a scenario defines by name: `probes.csv`, and values along lines.

use mesh::{AXES, Coordinates, Point, SimplexMesh, Vector, VertexId};
use solver::{FluidState, StepView};

use crate::measures::pieces;
use crate::scenario::{Quantity, Units};

/// Tolerance: a point is inside a simplex if no barycentric coordinate is below `-INSIDE`.
const INSIDE: f64 = 1e-9;

/// Probes of a run.
#[derive(Clone, Debug, Default)]
pub struct Probes<const D: usize> {
    /// Probes with columns in `probes.csv`.
    pub(crate) columns: Vec<Probe<D>>,
    /// Probes with files of their own.
    pub(crate) lines: Vec<ProbeLine<D>>,
    /// Names of the columns of the files of `lines`.
    pub(crate) line_header: Vec<String>,
    /// Warnings about points outside of the background, and markers far from their bodies.
    pub(crate) warnings: Vec<String>,
}

/// A probe with columns.
#[derive(Clone, Debug)]
pub(crate) struct Probe<const D: usize> {
    /// Names with units, such as `tip_x [m]`.
    pub(crate) names: Vec<String>,
    measured: Measured<D>,
}

/// Quantity of a probe.
#[derive(Clone, Debug)]
pub(crate) enum Measured<const D: usize> {
    /// Velocity and pressure at a point.
    Point { at: Point<D> },
    /// Position and velocity of a point of a body, the weighted mean of some of its vertices.
    Marker { body: usize, weights: Vec<(VertexId, f64)> },
    /// Force of the fluid on some facets of a body, with its moment about a point.
    Force { body: usize, facets: Vec<bool>, about: Point<D> },
    /// Force of the fluid on parts of the boundary of the background, with its moment about a point. `sides` are
    /// indices of boundary conditions.
    WallForce { sides: Vec<usize>, about: Point<D> },
    /// Flux and mean pressure on a section, from the midpoints of `n` intervals along each of its `sides`. The length
    /// of `normal` is the measure of the section.
    Flux { corner: Point<D>, sides: Vec<Vector<D>>, normal: Vector<D>, n: usize },
    /// Strain energy of a body.
    StrainEnergy { body: usize },
}

/// A segment along which velocity and pressure are written.
#[derive(Clone, Debug)]
pub(crate) struct ProbeLine<const D: usize> {
    pub(crate) name: String,
    pub(crate) ends: [Point<D>; 2],
    /// Number of points.
    pub(crate) n: usize,
}

impl<const D: usize> Probes<D> {
    /// Returns the names of the columns of `probes.csv` after the time, with units, such as `tip_x [m]`.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().flat_map(|probe| &probe.names).map(String::as_str)
    }

    /// Returns the values of these columns after a step, or at the start. Values outside of the fluid are NaN.
    pub fn values(&self, view: &StepView<'_, D>) -> Vec<f64> {
        self.columns.iter().flat_map(|probe| probe.values(view)).collect()
    }
}

impl<const D: usize> Probe<D> {
    /// Creates a probe. Units are those of integrals over a domain of `dimension` (3 in axisymmetric coordinates).
    pub(crate) fn new(name: &str, measured: Measured<D>, units: &Units, dimension: usize) -> Self {
        let (length, velocity) = (units.label(Quantity::LENGTH), units.label(Quantity::VELOCITY));
        let total = |quantity| units.total_label(quantity, dimension);
        let axes = |quantity: &'static str, unit: String| {
            AXES[..D].iter().map(move |axis| (format!("{quantity}{axis}"), unit.clone()))
        };
        let quantities: Vec<(String, String)> = match &measured {
            Measured::Point { .. } => {
                let pressure = ("pressure".to_owned(), units.label(Quantity::PRESSURE));
                axes("velocity_", velocity).chain([pressure]).collect()
            }
            Measured::Marker { .. } => axes("", length).chain(axes("velocity_", velocity)).collect(),
            Measured::Force { .. } | Measured::WallForce { .. } => {
                let moments = if D < AXES.len() { &AXES[AXES.len() - 1..] } else { &AXES };
                let moments = moments.iter().map(|axis| (format!("moment_{axis}"), units.moment_label(dimension)));
                axes("", total(Quantity::FORCE)).chain(moments).collect()
            }
            Measured::Flux { .. } => vec![
                ("flux".to_owned(), total(Quantity::FLUX)),
                ("pressure".to_owned(), units.label(Quantity::PRESSURE)),
            ],
            Measured::StrainEnergy { .. } => vec![("energy".to_owned(), total(Quantity::ENERGY))],
        };
        let names = quantities.iter().map(|(quantity, unit)| format!("{name}_{quantity} [{unit}]")).collect();
        Self { names, measured }
    }

    /// Returns the values after a step, one per name.
    pub(crate) fn values(&self, view: &StepView<'_, D>) -> Vec<f64> {
        let fluid = view.setup.fluid.as_ref().zip(view.state.fluid.as_ref());
        let at = |x: &Point<D>| fluid.and_then(|(setup, fluid)| values_at(&setup.background, fluid, x));
        match &self.measured {
            Measured::Point { at: x } => match at(x) {
                Some((velocity, pressure)) => velocity.iter().copied().chain([pressure]).collect(),
                None => vec![f64::NAN; D + 1],
            },
            Measured::Marker { body, weights } => {
                let state = &view.state.bodies[*body];
                let positions = state.positions(view.setup.bodies[*body].reference());
                let mean =
                    |of: &[Vector<D>]| -> Vector<D> { weights.iter().map(|(v, weight)| of[v.index()] * *weight).sum() };
                [mean(&positions), mean(state.velocity())].iter().flat_map(|x| x.iter().copied()).collect()
            }
            Measured::Force { body, facets, about } => {
                let (mut force, mut moment) = (Vector::<D>::zeros(), [0.0; 3]);
                if let Some(report) = view.report {
                    for (_, traction) in pieces(view, report, *body).filter(|(piece, _)| facets[piece.facet.index()]) {
                        force += traction.total() * traction.measure;
                        let of_piece = traction.moment(about);
                        moment.iter_mut().zip(of_piece).for_each(|(sum, moment)| *sum += moment * traction.measure);
                    }
                }
                with_moment(view.setup.bodies[*body].surface().coordinates(), force, moment)
            }
            Measured::WallForce { sides, about } => {
                let (mut force, mut moment) = (Vector::<D>::zeros(), [0.0; 3]);
                let report = view.report.and_then(|report| report.fluid.as_ref());
                for side in report.iter().flat_map(|report| sides.iter().map(|side| &report.side_forces[*side])) {
                    force += side.force;
                    moment.iter_mut().zip(side.moment(about)).for_each(|(sum, moment)| *sum += moment);
                }
                let coordinates = fluid.map(|(setup, _)| setup.background.coordinates()).unwrap_or_default();
                with_moment(coordinates, force, moment)
            }
            Measured::Flux { corner, sides, normal, n } => {
                let coordinates = fluid.map(|(setup, _)| setup.background.coordinates()).unwrap_or_default();
                let (mut flux, mut pressure, mut wet) = (0.0, 0.0, 0.0);
                let points = section_points(*corner, sides, *n);
                let n_points = points.len();
                for x in points {
                    if let Some((velocity, p)) = at(&x) {
                        let weight = coordinates.weight(&x);
                        flux += velocity.dot(normal) * weight;
                        pressure += p * weight;
                        wet += weight;
                    }
                }
                vec![flux / n_points as f64, pressure / wet]
            }
            Measured::StrainEnergy { body } => {
                let balance = view.setup.bodies[*body].balance(&view.state.bodies[*body]);
                vec![balance.map_or(f64::NAN, |balance| balance.elastic_energy)]
            }
        }
    }
}

/// Returns the middles of `n` intervals along each side of a section.
pub(crate) fn section_points<const D: usize>(
    corner: Point<D>,
    sides: &[Vector<D>],
    n: usize,
) -> impl ExactSizeIterator<Item = Point<D>> {
    (0..n.pow(sides.len() as u32)).map(move |k| {
        let place = |side: usize| ((k / n.pow(side as u32) % n) as f64 + 0.5) / n as f64;
        sides.iter().enumerate().fold(corner, |x, (side, along)| x + along * place(side))
    })
}

/// Returns a force and its moment as values of the columns.
fn with_moment<const D: usize>(coordinates: Coordinates, force: Vector<D>, moment: [f64; 3]) -> Vec<f64> {
    let (force, moment) = (coordinates.resultant(force), coordinates.moment(moment));
    let moments = if D < AXES.len() { &moment[AXES.len() - 1..] } else { &moment };
    force.iter().chain(moments).copied().collect()
}

impl<const D: usize> ProbeLine<D> {
    /// Returns the names of the columns.
    pub(crate) fn header(units: &Units) -> Vec<String> {
        let axes = |quantity: &'static str, unit: String| {
            AXES[..D].iter().map(move |axis| format!("{quantity}{axis} [{unit}]"))
        };
        let velocity = axes("velocity_", units.label(Quantity::VELOCITY));
        let pressure = format!("pressure [{}]", units.label(Quantity::PRESSURE));
        axes("", units.label(Quantity::LENGTH)).chain(velocity).chain([pressure]).collect()
    }

    /// Returns the rows: position, velocity and pressure; NaN outside the fluid.
    pub(crate) fn rows(&self, view: &StepView<'_, D>) -> Vec<Vec<f64>> {
        let fluid = view.setup.fluid.as_ref().zip(view.state.fluid.as_ref());
        let row = |x: Point<D>| {
            let found = fluid.and_then(|(setup, fluid)| values_at(&setup.background, fluid, &x));
            let (velocity, pressure) = found.unwrap_or((Vector::repeat(f64::NAN), f64::NAN));
            x.iter().chain(&velocity).copied().chain([pressure]).collect()
        };
        self.points().map(row).collect()
    }

    /// Returns the points.
    pub(crate) fn points(&self) -> impl ExactSizeIterator<Item = Point<D>> {
        let ([from, to], n) = (self.ends, self.n);
        (0..n).map(move |k| from + (to - from) * (k as f64 / (n - 1) as f64))
    }
}

/// Returns velocity and pressure of the fluid at a point; `None` outside the fluid.
fn values_at<const D: usize>(
    background: &SimplexMesh<D>,
    fluid: &FluidState<D>,
    x: &Point<D>,
) -> Option<(Vector<D>, f64)> {
    let (cell, shape) = background.cell_index().locate(x)?;
    let contains = |corners: &[Point<D>]| {
        let inside = mesh::Simplex::new(corners).barycentric(x);
        inside.is_some_and(|shares| shares[..=D].iter().all(|share| *share >= -INSIDE))
    };
    let part = fluid.cut.parts(cell).find(|part| {
        let mut is_inside = fluid.cut.is_whole(*part);
        if !is_inside {
            fluid.cut.for_each_simplex(background, *part, |corners| is_inside |= contains(corners));
        }
        is_inside
    })?;
    Some(fluid.at(part, &shape))
}
