//! Probes of a scenario: quantities that it defines by name.

use mesh::search::SurfaceIndex;
use mesh::{FacetId, Placed, Point, Vector, diameter};
use solver::body::Body;
use solver::{FluidSetup, Setup};

use super::error::{ErrorKind, ScenarioError, sorted};
use super::key::Quantity;
use super::table::{At, Components, Named, choices};
use super::units::Units;
use crate::probes::{Measured, Probe, ProbeLine, Probes, section_points};

choices! {
    /// Quantity that is measured in each step, with columns in `probes.csv`.
    pub enum ProbeChoice ["kind"] {
        /// Velocity and pressure of the fluid at a point that stays in space; NaN while a body covers it.
        Point = "point" {
            /// Position.
            at: Components<f64> [unit(Quantity::LENGTH)],
        },
        /// Position and velocity of a point of a body, which moves with it.
        Marker = "marker" {
            /// Name of the body.
            body: At<String>,
            /// Position before any motion; the nearest point of the surface is followed.
            at: Components<f64> [unit(Quantity::LENGTH)],
        },
        /// Force of the fluid on a body, and its moment; in the plane per unit depth. In axisymmetric coordinates the
        /// force is that on the whole body, along the axis, and the moment is zero.
        Force = "force" {
            /// Name of the body.
            body: At<String>,
            /// Names of parts of its surface; all of it if left out.
            parts: Vec<At<String>>,
            /// Point about which the moment is taken; the origin if left out.
            about: Option<Components<f64>> [unit(Quantity::LENGTH)],
        },
        /// Force of the fluid on parts of the boundary of the background that are not open, and its moment: pressure and viscous stress, as the
        /// reaction of the velocities that are given there; in the plane per unit depth, in axisymmetric coordinates along the
        /// axis. In a closed domain the pressure has no level, and only the force on all of the closed boundary has a meaning.
        WallForce = "wall-force" {
            /// Names of the parts.
            parts: At<Vec<At<String>>>,
            /// Point about which the moment is taken; the origin if left out.
            about: Option<Components<f64>> [unit(Quantity::LENGTH)],
        },
        /// Volume of fluid per time through a segment (2D) or parallelogram (3D), and mean pressure on it, both of the points
        /// in the fluid; in the plane per unit depth. In axisymmetric coordinates the section is the surface that the segment sweeps about the axis: a
        /// disk, a ring, a cylinder or a cone.
        Flux = "flux" {
            /// A corner of the section.
            corner: Components<f64> [unit(Quantity::LENGTH)],
            /// Sides from the corner: one in 2D, to the right of which the flux is positive; two in 3D, by the right-hand rule.
            sides: At<Vec<Components<f64>>> [unit(Quantity::LENGTH)],
            /// Number of points along each side, in the middles of equal intervals.
            points: At<usize> [between(1.0, 100_000.0)] = 200,
        },
        /// Strain energy of an elastic body; in the plane per unit depth.
        StrainEnergy = "strain-energy" {
            /// Name of the body.
            body: At<String>,
        },
        /// Velocity and pressure along a segment, a file `lines/NAME_STEP.csv` with each set of field files.
        Line = "line" {
            /// One end.
            from: Components<f64> [unit(Quantity::LENGTH)],
            /// The other end.
            to: Components<f64> [unit(Quantity::LENGTH)],
            /// Number of points, including the ends.
            points: usize [between(2.0, 1_000_000.0)] = 101,
        },
    }
}

/// Largest number of points of a probe of the flux.
const MOST_FLUX_POINTS: f64 = 1e6;

/// Builds the probes of a run. Masses, forces, energies and flows are integrals over a domain of the given dimension.
///
/// # Errors
/// Bodies or parts that do not exist, quantities of a fluid or of elastic bodies without a fluid or elastic body.
pub(super) fn probes<const D: usize>(
    given: &Named<ProbeChoice>,
    setup: &Setup<D>,
    part_names: &[Vec<String>],
    units: &Units,
    dimension: usize,
) -> Result<Probes<D>, ScenarioError> {
    let mut found = Probes { line_header: ProbeLine::<D>::header(units), ..Probes::default() };
    let fluid = setup.fluid.as_ref();
    for (name, probe) in &given.0 {
        let find = |body: &At<String>| {
            let index = setup.bodies.iter().position(|other| other.name() == body.as_str());
            index.ok_or_else(|| body.at.unknown("body", body, setup.bodies.iter().map(|body| body.name())))
        };
        let inside = |points: &mut dyn ExactSizeIterator<Item = Point<D>>, warnings: &mut Vec<String>| {
            let Some(fluid) = fluid else { return Ok(()) };
            let n_points = points.len();
            let outside: Vec<_> = points.filter(|x| fluid.background.cell_index().locate(x).is_none()).collect();
            let Some(first) = outside.first().map(Point::as_slice) else { return Ok(()) };
            if outside.len() == n_points {
                return Err(probe.at.invalid(format!("the probe at {first:?} is outside the background; move it")));
            }
            // In space a pipe is measured on a parallelogram around its section.
            if !matches!(&**probe, ProbeChoice::Flux { sides, .. } if sides.len() > 1) {
                warnings.push(format!(
                "warning: {} of {n_points} points of probe {name} are outside the background, the first at {first:?}: it \
                 measures the others only",
                outside.len()
            ));
            }
            Ok(())
        };
        let no_fluid = || probe.at.error(ErrorKind::NoEffect("a scenario without a fluid"));
        let measured = match &**probe {
            ProbeChoice::Point { at } => {
                fluid.ok_or_else(no_fluid)?;
                inside(&mut [at.vector()].into_iter(), &mut found.warnings)?;
                Measured::Point { at: at.vector() }
            }
            ProbeChoice::Marker { body, at } => {
                let (marker, warning) = marker(name, &*setup.bodies[find(body)?], find(body)?, &at.vector())
                    .ok_or_else(|| probe.at.invalid("the surface of this body has no point; check its shape"))?;
                found.warnings.extend(warning);
                marker
            }
            ProbeChoice::Force { body, parts, about } => {
                fluid.ok_or_else(no_fluid)?;
                let index = find(body)?;
                let facets = facets(&*setup.bodies[index], &part_names[index], parts)?;
                Measured::Force {
                    body: index,
                    facets,
                    about: about.as_ref().map_or(Point::zeros(), Components::vector),
                }
            }
            ProbeChoice::WallForce { parts, about } => Measured::WallForce {
                sides: sides(fluid.ok_or_else(no_fluid)?, parts)?,
                about: about.as_ref().map_or(Point::zeros(), Components::vector),
            },
            ProbeChoice::Flux { corner, sides, points } => {
                fluid.ok_or_else(no_fluid)?;
                let vectors: Vec<Vector<D>> = sides.iter().map(Components::vector).collect();
                let normal = normal(&vectors).ok_or_else(|| {
                    sides.at.invalid(format!(
                        "a section in dimension {D} needs {} entries of `sides`, longer than zero and not parallel",
                        D - 1
                    ))
                })?;
                if (**points as f64).powi(D as i32 - 1) > MOST_FLUX_POINTS {
                    let most = MOST_FLUX_POINTS.powf(1.0 / (D as f64 - 1.0));
                    let message = format!("{} points along each side take too long in every step", **points);
                    return Err(points.at.invalid(format!("{message}; give at most {most:.0}")));
                }
                let corner: Point<D> = corner.vector();
                inside(&mut section_points(corner, &vectors, **points), &mut found.warnings)?;
                Measured::Flux { corner, sides: vectors, normal, n: **points }
            }
            ProbeChoice::StrainEnergy { body } => {
                let index = find(body)?;
                let is_elastic = setup.bodies[index].cells(&setup.bodies[index].initial()).is_some();
                if !is_elastic {
                    return Err(body
                        .at
                        .invalid(format!("body `{}` does not deform, and has no strain energy", **body)));
                }
                Measured::StrainEnergy { body: index }
            }
            ProbeChoice::Line { from, to, points } => {
                fluid.ok_or_else(no_fluid)?;
                if from.vector::<D>() == to.vector::<D>() {
                    return Err(probe
                        .at
                        .invalid("the ends of this line are one point; measure it by the kind `point`"));
                }
                let line = ProbeLine { name: name.clone(), ends: [from.vector(), to.vector()], n: *points };
                inside(&mut line.points(), &mut found.warnings)?;
                found.lines.push(line);
                continue;
            }
        };
        found.columns.push(Probe::new(name, measured, units, dimension));
    }
    Ok(found)
}

/// Returns the indices of the conditions on parts of the background, which must not be open.
fn sides<const D: usize>(fluid: &FluidSetup<D>, parts: &At<Vec<At<String>>>) -> Result<Vec<usize>, ScenarioError> {
    let names = fluid.background.tag_names();
    let side = |part: &At<String>| {
        let mut conditions = fluid.boundary.iter();
        let found = conditions.position(|(tag, _)| names[tag.index()] == **part);
        let known = || sorted(fluid.background.boundary_names());
        let k = found.ok_or_else(|| part.at.unknown("part of the background", part, known()))?;
        if fluid.boundary[k].1.is_open() {
            return Err(part.at.invalid(format!(
                "part `{}` is open, and has no wall on which a force could act; name other parts, or measure flux and pressure by the kind `flux`",
                **part
            )));
        }
        Ok(k)
    };
    let found: Vec<usize> = parts.iter().map(side).collect::<Result<_, _>>()?;
    match (1..found.len()).find(|&k| found[..k].contains(&found[k])) {
        _ if found.is_empty() => Err(parts.at.invalid("no part is named; name at least one part of the background")),
        Some(k) => Err(parts[k].at.invalid(format!("part `{}` is named twice; take one out", *parts[k]))),
        None => Ok(found),
    }
}

/// Returns the marker at the point of a surface nearest to a position, and a warning if the position is farther from it
/// than the facet is large: then it is not on the surface that the facets approximate.
fn marker<const D: usize>(
    name: &str,
    body: &dyn Body<D>,
    index: usize,
    at: &Point<D>,
) -> Option<(Measured<D>, Option<String>)> {
    let surface = Placed::new(body.surface(), body.reference());
    let nearest = SurfaceIndex::new(&surface).closest(at)?;
    let distance = (at - nearest.point).norm();
    let warning = (distance > diameter(&surface.facet_points(nearest.facet)[..D])).then(|| {
        format!(
            "warning: marker {name} is {distance:.3e} away from the surface of body {}: it follows the nearest point, {:?}",
            body.name(),
            nearest.point.as_slice()
        )
    });
    let weights = body.surface().facet(nearest.facet).iter().copied().zip(nearest.barycentric).collect();
    Some((Measured::Marker { body: index, weights }, warning))
}

/// Returns, for each facet of a body, whether it belongs to one of the parts. Without parts all facets do.
fn facets<const D: usize>(
    body: &dyn Body<D>,
    part_names: &[String],
    parts: &[At<String>],
) -> Result<Vec<bool>, ScenarioError> {
    let surface = body.surface();
    let name = |facet: FacetId| surface.tag(facet).and_then(|tag| part_names.get(tag.index()));
    for part in parts {
        if !surface.facets().any(|facet| name(facet) == Some(part)) {
            let unnamed = || part.at.invalid("no part of this surface has a name; leave `parts` out for all of it");
            let unknown = || part.at.unknown("part of the surface", part, part_names.iter().map(String::as_str));
            return Err(if part_names.is_empty() { unnamed() } else { unknown() });
        }
    }
    let is_in = |facet| parts.is_empty() || parts.iter().any(|part| name(facet) == Some(part));
    Ok(surface.facets().map(is_in).collect())
}

/// Returns the vector normal to a section whose length is the measure of the section; `None` if the sides span none.
fn normal<const D: usize>(sides: &[Vector<D>]) -> Option<Vector<D>> {
    let component = |axis: usize| match sides {
        [a] => [a[1], -a[0]].get(axis).copied().unwrap_or(0.0),
        [a, b] => {
            let (i, j) = ((axis + 1) % D, (axis + 2) % D);
            a[i] * b[j] - a[j] * b[i]
        }
        _ => 0.0,
    };
    let normal = Vector::<D>::from_fn(|axis, _| component(axis));
    (sides.len() == D - 1 && normal.norm() > 0.0).then_some(normal)
}
