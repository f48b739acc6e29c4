//! The fused kernel against the sum of the named terms, on whole and on cut parts.

use algebra::{BlockLayout, Contributions, LocalSystem};
use fluid_ns::mesh::generate::structured_box;
use fluid_ns::mesh::{Placed, Point, Vector};
use fluid_ns::terms::{
    BodyForce, CipPressure, CipProfile, CipVelocity, Convection, GhostPenalty, Incompressibility, Inertia, Viscous,
};
use fluid_ns::xfem_space::cutcell::{CutMesh, OverlayOptions, PartId};
use fluid_ns::xfem_space::{FaceValues, PartValues, XfemSpace};
use fluid_ns::{CellTerm, FluidCells, FluidConvection, FluidFields, FluidForm, FluidGeometry};

/// Numbers between -1 and 1 that look random.
fn noise(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// All combinations of the terms that may be left out.
fn forms<'a, const D: usize>(force: &'a (dyn Fn(&Point<D>, f64) -> Vector<D> + Send + Sync)) -> Vec<FluidForm<'a, D>> {
    let combination = |k: usize| FluidForm {
        inertia: (k & 1 == 1).then_some(Inertia { density: 1.3, dt: 0.2 }),
        viscous: Viscous { viscosity: 0.7 },
        incompressibility: Incompressibility,
        convection: Some(Convection { density: 1.3, skew: k & 2 == 2 }),
        body_force: BodyForce { force: (k & 4 == 4).then_some(force), time: 0.3 },
        cip_velocity: CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.1 }, density: 1.3 },
        cip_pressure: CipPressure { gamma_pressure: 0.1, density: 1.3, viscosity: 0.7, rate: 5.0 },
        ghost_penalty: GhostPenalty { gamma_ghost: 1.0, viscosity: 0.7 },
    };
    (0..8).map(combination).collect()
}

/// Largest deviation of residual and tangent, relative to the largest entry.
fn deviation(fused: &LocalSystem, terms: &LocalSystem) -> f64 {
    let relative = |a: &[f64], b: &[f64]| {
        let largest = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest
    };
    relative(fused.residual(), terms.residual()).max(relative(fused.tangent(), terms.tangent()))
}

fn kernel_is_the_sum_of_the_terms<const D: usize>() {
    let background = structured_box::<D>([0.0; D], [1.0; D], [4; D]).expect("a box");
    let body = structured_box::<D>([0.28; D], [0.69; D], [1; D]).expect("a box");
    let boundary = body.boundary();
    let surface = [Placed::new(&boundary, body.vertices())];
    let cut = CutMesh::overlay(&background, &surface, &OverlayOptions::new()).expect("a closed surface");
    let space = XfemSpace::new(&background, &cut);
    let parts = PartValues::new(&background, &cut, 2);
    let faces = FaceValues::new(&background, &cut, &space, &parts);
    let history: Vec<Vector<D>> = (0..space.len()).map(|k| Vector::from_fn(|a, _| noise(5 * k + a))).collect();
    let geometry = FluidGeometry {
        background: &background,
        cut: &cut,
        space: &space,
        parts: &parts,
        faces: &faces,
        history: &history,
    };
    let mut layout = BlockLayout::new();
    let (velocity, pressure) = (layout.push("velocity", D * space.len()), layout.push("pressure", space.len()));
    let fields = FluidFields { layout: &layout, velocity, pressure };
    let x: Vec<f64> = (0..layout.len()).map(|k| noise(3 * k + 1)).collect();
    let force = |x: &Point<D>, t: f64| x * (3.0 + t) + Vector::repeat(1.0);
    let (mut fused, mut terms, mut n_cut) = (LocalSystem::new(), LocalSystem::new(), 0);
    for form in forms(&force) {
        let cells = FluidCells { geometry: &geometry, fields, form: &form };
        let convection = FluidConvection { geometry: &geometry, fields, form: &form };
        for part in 0..cut.n_parts() {
            n_cut += usize::from(!cut.is_whole(PartId(part as u32)));
            let cell = geometry.cell(&fields, PartId(part as u32), &x);
            fused.reset((D + 1) * (D + 1));
            cells.add(part, &x, &mut fused);
            terms.reset((D + 1) * (D + 1));
            form.linear_cell_terms().into_iter().flatten().for_each(|term| term.add(&cell, &mut terms));
            assert!(deviation(&fused, &terms) < 1e-13, "linear, part {part}: {:e}", deviation(&fused, &terms));
            fused.reset(D * (D + 1));
            convection.add(part, &x, &mut fused);
            terms.reset(D * (D + 1));
            form.convection.iter().for_each(|term| term.add(&cell, &mut terms));
            assert!(deviation(&fused, &terms) < 1e-13, "convection, part {part}: {:e}", deviation(&fused, &terms));
        }
    }
    assert!(n_cut >= 64, "{n_cut} cut parts");
}

#[test]
fn kernel_is_the_sum_of_the_terms_in_2d() {
    kernel_is_the_sum_of_the_terms::<2>();
}

#[test]
fn kernel_is_the_sum_of_the_terms_in_3d() {
    kernel_is_the_sum_of_the_terms::<3>();
}
