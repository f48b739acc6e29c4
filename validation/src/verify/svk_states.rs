//! Uniform states of a Saint Venant-Kirchhoff body: found from rest on a mesh, compared with their closed forms.
//!
//! Source: `P = F S`, `S = λ tr(E) I + 2 μ E`, `E = (FᵀF - I)/2` for a uniform `F`, in plane strain and in space.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::mesh::generate::{BallOptions, half_ball, structured_box};
use cutwater::mesh::nalgebra::Rotation3;
use cutwater::mesh::{Point, Tensor, Vector, VertexId, det};
use cutwater::solid_svk::energy::stresses;
use cutwater::solid_svk::{Load, SaintVenantKirchhoff, Support, SupportKind};

use super::dry::{Elastic, LAMBDA, LAME, MU, RADIUS, elastic, run};
use super::record::worse;
use super::signal::bisect;
use super::{Failure, Record, short};

/// Axial first Piola-Kirchhoff stress relative to the modulus of the state, for the stretches 0.8, 0.9, 1.05, 1.1 and
/// 1.2.
const LOADS: [f64; 5] = [-0.144, -0.0855, 0.053_812_5, 0.1155, 0.264];
/// Shears, relative to the height of the block.
const SHEARS: [f64; 2] = [0.1, 0.3];
/// Pressures on the disk, dyn/cm².
const PRESSURES: [f64; 3] = [1e4, 1e5, 1e6];
/// Angle of the rotation, rad.
const ANGLE: f64 = 2.1;
/// Number of steps of the rotation.
const TURNS: u32 = 60;
/// Largest deviation relative to the exact values.
const ROUND_OFF: f64 = 1e-9;

/// The sides of a box, by axis.
const SIDES: [&[[&str; 2]]; 2] =
    [&[["left", "right"], ["bottom", "top"]], &[["left", "right"], ["front", "back"], ["bottom", "top"]]];

/// Returns the root of an increasing function between 0.6 and 1.5. Stretches below the limit point of compression,
/// `1/√3`, are excluded.
fn root(function: impl Fn(f64) -> f64) -> f64 {
    bisect([0.6, 1.5], |s| function(s) > 0.0)
}

/// Returns the stretch at which `modulus * stretch (stretch² - 1)/2` is `load * modulus`.
fn stretch(load: f64) -> f64 {
    root(|s| 0.5 * s * (s * s - 1.0) - load)
}

/// Returns the factor by which lengths change under a pressure from all sides: `(D λ + 2 μ)(s² - 1)/2 s^(2-D) = -p`.
fn scale<const D: usize>(pressure: f64) -> f64 {
    root(|s| 0.5 * (D as f64 * LAMBDA + 2.0 * MU) * (s * s - 1.0) * s.powi(2 - D as i32) + pressure)
}

/// A uniform state of the unit square or cube.
struct Uniform<const D: usize> {
    name: String,
    gradient: Tensor<D>,
    /// First Piola-Kirchhoff stress in closed form.
    piola: Tensor<D>,
    /// For the low and the high side of each axis: whether its normal displacement is zero.
    planes: [[bool; 2]; D],
    /// The axis whose low side does not move at all.
    base: Option<usize>,
}

impl<const D: usize> Uniform<D> {
    /// Returns a bar under an axial load, its sides free.
    fn bar(load: f64) -> Self {
        let (modulus, ratio) = if D == 2 {
            (4.0 * MU * (LAMBDA + MU) / (LAMBDA + 2.0 * MU), LAMBDA / (LAMBDA + 2.0 * MU))
        } else {
            (MU * (3.0 * LAMBDA + 2.0 * MU) / (LAMBDA + MU), LAMBDA / (2.0 * (LAMBDA + MU)))
        };
        let axial = stretch(load);
        let lateral = (1.0 - ratio * (axial * axial - 1.0)).sqrt();
        let along = |a: usize, axial: f64, lateral: f64| if a == 0 { axial } else { lateral };
        Self {
            name: format!("bar, stretch {}", short(axial)),
            gradient: Tensor::from_diagonal(&Vector::from_fn(|a, _| along(a, axial, lateral))),
            piola: Tensor::from_diagonal(&Vector::from_fn(|a, _| along(a, load * modulus, 0.0))),
            planes: [[true, false]; D],
            base: None,
        }
    }

    /// Returns a bar under an axial load between smooth walls.
    fn confined(load: f64) -> Self {
        let axial = stretch(load);
        let mut gradient = Tensor::identity();
        gradient[(0, 0)] = axial;
        // Walls carry the lateral stress.
        let mut piola = Tensor::identity() * (0.5 * LAMBDA * (axial * axial - 1.0));
        piola[(0, 0)] = load * (LAMBDA + 2.0 * MU);
        let planes = std::array::from_fn(|axis| [true, axis != 0]);
        Self { name: format!("between walls, stretch {}", short(axial)), gradient, piola, planes, base: None }
    }

    /// Returns simple shear, with the base held and tractions on all other sides.
    fn sheared(shear: f64) -> Self {
        let mut gradient = Tensor::identity();
        gradient[(0, 1)] = shear;
        let squared = shear * shear;
        let mut piola = Tensor::identity() * (0.5 * LAMBDA * squared);
        piola[(0, 0)] += MU * squared;
        piola[(1, 1)] += MU * squared;
        piola[(1, 0)] = MU * shear;
        piola[(0, 1)] = MU * shear + (0.5 * LAMBDA + MU) * shear * squared;
        Self { name: format!("shear {shear}"), gradient, piola, planes: [[false; 2]; D], base: Some(1) }
    }

    /// Returns the body under the dead loads `P N` on all of its sides.
    fn body(&self) -> Result<Elastic<D>, Failure> {
        let mut body = block()?;
        for (axis, sides) in SIDES[D - 2].iter().enumerate() {
            for (k, side) in sides.iter().enumerate() {
                let traction = self.piola.column(axis) * if k == 0 { -1.0 } else { 1.0 };
                let facets = body.part(side)?;
                body.options.loads.push(Load::traction(facets, Arc::new(move |_, _| traction)));
                if self.planes[axis][k] {
                    body.hold(side, SupportKind::symmetry(axis))?;
                }
            }
        }
        if let Some(axis) = self.base {
            body.hold(SIDES[D - 2][axis][0], SupportKind::Clamped)?;
        }
        Ok(body)
    }

    /// Returns the Cauchy stress `P Fᵀ/det F`.
    fn cauchy(&self) -> Tensor<D> {
        self.piola * self.gradient.transpose() / det(&self.gradient)
    }
}

/// Returns the unit square or cube with cells of different shapes.
fn block<const D: usize>() -> Result<Elastic<D>, Failure> {
    let n = if D == 2 { 6 } else { 3 };
    let mesh = structured_box::<D>([0.0; D], [1.0; D], [n; D])?.mapped(|x| {
        // The sides stay where they are, bitwise.
        x + Vector::from_fn(|a, _| 0.3 * (1.0 + a as f64) * x.iter().map(|c| c * (1.0 - c)).product::<f64>())
    })?;
    elastic(mesh, 1.0, SaintVenantKirchhoff::new(LAME), Vector::zeros(), Arc::new(QuasiStatic))
}

/// Advances a body from rest to time one. Returns the larger of two deviations: that of the displacement, relative to
/// the largest one, and that of the Cauchy stress, relative to a unit of stress.
fn deviation<const D: usize>(
    body: Elastic<D>,
    steps: u32,
    displacement: impl Fn(&Point<D>) -> Vector<D>,
    cauchy: &Tensor<D>,
    unit: f64,
) -> Result<f64, Failure> {
    let (solid, form) = (body.solid.clone(), body.form.clone());
    let mut run = run(vec![body], None, f64::from(steps).recip(), 1e-12)?;
    run.advance_by(steps)?;
    let found = run.state.bodies[0].displacement();
    let exact: Vec<_> = solid.nodes().iter().map(displacement).collect();
    let largest = exact.iter().map(Vector::norm).fold(0.0, f64::max);
    let moved = exact.iter().zip(found).map(|(exact, found)| (exact - found).norm() / largest);
    let stressed = stresses(&solid, &form, found).into_iter().map(|stress| (stress.cauchy - cauchy).norm() / unit);
    Ok(moved.chain(stressed).fold(0.0, worse))
}

/// Records the deviation of a block in a uniform state.
fn uniform<const D: usize>(record: &mut Record, state: &Uniform<D>) -> Result<(), Failure> {
    let cauchy = state.cauchy();
    let displacement = |x: &Point<D>| state.gradient * x - x;
    let found = deviation(state.body()?, 1, displacement, &cauchy, cauchy.norm())?;
    record.at_most(format!("{D}D, {}", state.name), found, ROUND_OFF);
    Ok(())
}

/// Measures the deviation of a block from the rigid rotation of its bottom side.
fn turned<const D: usize>(rotation: impl Fn(f64) -> Tensor<D> + Copy + Send + Sync + 'static) -> Result<f64, Failure> {
    let mut body = block::<D>()?;
    let turned = move |x: &Point<D>, time: f64| (rotation(ANGLE * time) * x - x).map(Some).into();
    body.hold("bottom", SupportKind::Displacement(Arc::new(turned)))?;
    let end = rotation(ANGLE);
    deviation(body, TURNS, |x| end * x - x, &Tensor::zeros(), MU)
}

/// Measures the deviation of a body under a pressure from all sides, with symmetry planes through the origin.
fn pressed<const D: usize>(
    mut body: Elastic<D>,
    sides: &[&str],
    pressure: f64,
    fixed: &Point<D>,
) -> Result<f64, Failure> {
    for side in sides {
        let facets = body.part(side)?;
        body.options.loads.push(Load::pressure(facets, pressure));
    }
    let strain = scale::<D>(pressure) - 1.0;
    let cauchy = Tensor::identity() * -pressure;
    deviation(body, 1, |x| (x - fixed) * strain, &cauchy, cauchy.norm())
}

/// Measures half of a disk under a pressure from all sides. Its lowest vertex keeps its height.
fn disk(pressure: f64) -> Result<f64, Failure> {
    let mesh = half_ball::<2>([0.0, 0.0], RADIUS, 0.5, &BallOptions { area_preserving: false })?;
    let heights = mesh.vertices().iter().enumerate().map(|(v, x)| (VertexId::new(v), x[1]));
    let lowest = heights.min_by(|a, b| a.1.total_cmp(&b.1)).ok_or("a disk without vertices")?.0;
    let fixed = mesh.vertex(lowest);
    let mut body = elastic(mesh, 1.0, SaintVenantKirchhoff::new(LAME), Vector::zeros(), Arc::new(QuasiStatic))?;
    body.hold("left", SupportKind::symmetry(0))?;
    body.options.supports.push(Support { vertices: vec![lowest], kind: SupportKind::symmetry(1) });
    pressed(body, &["surface"], pressure, &fixed)
}

/// Measures an eighth of a cube under a pressure from all sides.
fn cube(pressure: f64) -> Result<f64, Failure> {
    let mut body = block::<3>()?;
    for (axis, [low, _]) in SIDES[1].iter().enumerate() {
        body.hold(low, SupportKind::symmetry(axis))?;
    }
    pressed(body, &["right", "back", "top"], pressure, &Point::<3>::zeros())
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    LOADS.iter().try_for_each(|load| uniform(record, &Uniform::<2>::bar(*load)))?;
    LOADS.iter().try_for_each(|load| uniform(record, &Uniform::<3>::bar(*load)))?;
    LOADS.iter().try_for_each(|load| uniform(record, &Uniform::<2>::confined(*load)))?;
    LOADS.iter().try_for_each(|load| uniform(record, &Uniform::<3>::confined(*load)))?;
    for shear in SHEARS {
        uniform(record, &Uniform::<2>::sheared(shear))?;
        uniform(record, &Uniform::<3>::sheared(shear))?;
    }
    let degrees = short(ANGLE * 180.0 / PI);
    let plane = |angle: f64| Tensor::<2>::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
    record.at_most(format!("2D, turned by {degrees} degrees"), turned(plane)?, ROUND_OFF);
    let space = |angle: f64| *Rotation3::new(Vector::<3>::new(0.48, -0.6, 0.64) * angle).matrix();
    record.at_most(format!("3D, turned by {degrees} degrees"), turned(space)?, ROUND_OFF);
    for pressure in PRESSURES {
        record.at_most(format!("disk under the pressure {}", short(pressure)), disk(pressure)?, ROUND_OFF);
    }
    for pressure in PRESSURES {
        record.at_most(format!("cube under the pressure {}", short(pressure)), cube(pressure)?, ROUND_OFF);
    }
    record.note(format!(
        "The larger of two deviations: that of displacement, relative to the largest displacement, and that of the Cauchy stress \
         of any cell, relative to the norm of the exact one (μ where this is zero). Every state is solved for from rest under \
         dead loads P N, or under a pressure that follows the surface; a rotation is forced upon one side, in {TURNS} steps. \
         λ = {}, μ = {} dyn/cm².",
        short(LAMBDA),
        short(MU),
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretch; lateral stretch, axial stress and axial Cauchy stress in plane strain; the same in space; stress
    /// between walls.
    const TABLE: [[f64; 8]; 5] = [
        [0.8, 1.113553, -9.600000e5, -8.621054e5, 1.069579, -8.064000e5, -7.048951e5, -1.728000e6],
        [0.9, 1.061446, -5.700000e5, -5.370035e5, 1.037304, -4.788000e5, -4.449814e5, -1.026000e6],
        [1.05, 0.965229, 3.587500e5, 3.716735e5, 0.979285, 3.013500e5, 3.142336e5, 6.457500e5],
        [1.1, 0.927362, 7.700000e5, 8.303124e5, 0.957079, 6.468000e5, 7.061135e5, 1.386000e6],
        [1.2, 0.840635, 1.760000e6, 2.093656e6, 0.907744, 1.478400e6, 1.794175e6, 3.168000e6],
    ];

    #[test]
    fn closed_forms_are_those_of_the_table() {
        for (load, [axial, lateral, p, sigma, lateral_3, p_3, sigma_3, confined]) in LOADS.into_iter().zip(TABLE) {
            let (plane, space, walls) =
                (Uniform::<2>::bar(load), Uniform::<3>::bar(load), Uniform::<2>::confined(load));
            for (found, printed) in [
                (plane.gradient[(0, 0)], axial),
                (plane.gradient[(1, 1)], lateral),
                (plane.piola[(0, 0)], p),
                (plane.cauchy()[(0, 0)], sigma),
                (space.gradient[(2, 2)], lateral_3),
                (space.piola[(0, 0)], p_3),
                (space.cauchy()[(0, 0)], sigma_3),
                (walls.piola[(0, 0)], confined),
            ] {
                assert!((found - printed).abs() < 6e-7 * printed.abs(), "{found} {printed}");
            }
        }
        let sheared = Uniform::<2>::sheared(0.1);
        assert!((sheared.piola - Tensor::<2>::new(6e4, 2.06e5, 2e5, 6e4)).norm() < 1e-6);
        assert!((sheared.cauchy() - Tensor::<2>::new(8.06e4, 2.06e5, 2.06e5, 6e4)).norm() < 1e-6);
        for (pressure, rim) in PRESSURES.into_iter().zip([-2.000500e-3, -2.0050252e-2, -0.20526681]) {
            assert!((RADIUS * (scale::<2>(pressure) - 1.0) - rim).abs() < 1e-6 * f64::abs(rim));
        }
    }
}
