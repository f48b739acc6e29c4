//! Each term alone against a value computed by hand, on one or two triangles.

use algebra::{BlockLayout, Contributions, LocalSystem};
use fluid_ns::mesh::{Point, SimplexMesh, SimplexRule, Vector, VertexId};
use fluid_ns::terms::{
    Backflow, BodyForce, CipPressure, CipProfile, CipVelocity, Convection, GhostPenalty, Incompressibility, Inertia,
    Traction, Viscous,
};
use fluid_ns::xfem_space::cutcell::{CutMesh, OverlayOptions};
use fluid_ns::xfem_space::{BoundaryValues, FaceValues, PartValues, XfemSpace};
use fluid_ns::{
    CellTerm, FaceTerm, FluidCell, FluidFace, FluidFaces, FluidFields, FluidForm, FluidGeometry, OpenBoundary,
};

type V = Vector<2>;

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

fn mesh(points: &[[f64; 2]], cells: &[u32]) -> SimplexMesh<2> {
    let vertices = points.iter().map(|x| Point::<2>::new(x[0], x[1])).collect();
    SimplexMesh::new(vertices, cells.iter().map(|&v| VertexId(v)).collect()).expect("a mesh")
}

/// Residual of a cell term on the unit triangle: velocities (x, y of each node), then pressures.
fn residual(term: &dyn CellTerm<2>, u: [V; 3], p: [f64; 3], history: [V; 3]) -> Vec<f64> {
    let mesh = mesh(&TRIANGLE, &[0, 1, 2]);
    let cut = CutMesh::overlay(&mesh, &[], &OverlayOptions::new()).expect("no bodies");
    let parts = PartValues::new(&mesh, &cut, 2);
    let part = cut.all_parts().next().expect("one part");
    let mut cell = FluidCell {
        simplex: mesh.simplex(cut.part_cell(part)),
        gradients: parts.gradients(part),
        points: parts.points(part),
        velocities: [V::zeros(); 4],
        pressures: [0.0; 4],
        histories: [V::zeros(); 4],
    };
    cell.velocities[..3].copy_from_slice(&u);
    cell.pressures[..3].copy_from_slice(&p);
    cell.histories[..3].copy_from_slice(&history);
    let mut out = LocalSystem::new();
    out.reset(9);
    term.add(&cell, &mut out);
    out.residual().to_vec()
}

fn assert_close(computed: &[f64], expected: &[f64]) {
    assert_eq!(computed.len(), expected.len());
    for (a, b) in computed.iter().zip(expected) {
        assert!((a - b).abs() < 1e-13, "{computed:?} is not {expected:?}");
    }
}

fn nodal(u: impl Fn(f64, f64) -> [f64; 2]) -> [V; 3] {
    TRIANGLE.map(|x| V::from(u(x[0], x[1])))
}

#[test]
fn inertia() {
    let r = residual(&Inertia { density: 3.0, dt: 0.5 }, [V::new(2.0, -1.0); 3], [0.0; 3], [V::new(1.0, 1.0); 3]);
    // ρ/dt (u - u*) |K|/3 = 6 (1, -2) / 6 at each node.
    assert_close(&r, &[1.0, -2.0, 1.0, -2.0, 1.0, -2.0, 0.0, 0.0, 0.0]);
}

#[test]
fn viscous() {
    // u = (y, 0): ∇u + ∇uᵀ swaps the components of the gradients (-1, -1), (1, 0), (0, 1).
    let r = residual(&Viscous { viscosity: 4.0 }, nodal(|_, y| [y, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[-2.0, -2.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn incompressibility() {
    // p = 6: -p |K| ∇N_i. Divergence 1: |K|/3 in each pressure row.
    let r = residual(&Incompressibility, nodal(|x, _| [x, 0.0]), [6.0; 3], [V::zeros(); 3]);
    let third = 1.0 / 6.0;
    assert_close(&r, &[3.0, 3.0, -3.0, 0.0, 0.0, -3.0, third, third, third]);
}

#[test]
fn convection() {
    // u = (x, 0): u·∇u = (x, 0); ∫ x N_i = 1/24, 1/12, 1/24. The skew part adds half of it.
    let term = |skew| Convection { density: 24.0, skew };
    let r = residual(&term(false), nodal(|x, _| [x, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let r = residual(&term(true), nodal(|x, _| [x, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[1.5, 0.0, 3.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0]);
    // u = (0, x): u·∇u = 0 although nothing vanishes; u = (y, 0) likewise.
    let r = residual(&term(true), nodal(|_, y| [y, 0.0]), [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[0.0; 9]);
}

#[test]
fn body_force() {
    let force = |x: &Point<2>, t: f64| V::new(x[0] * t, 12.0);
    let r = residual(&BodyForce { force: Some(&force), time: 24.0 }, [V::zeros(); 3], [0.0; 3], [V::zeros(); 3]);
    assert_close(&r, &[-1.0, -2.0, -2.0, -2.0, -1.0, -2.0, 0.0, 0.0, 0.0]);
}

#[test]
fn weights_of_the_face_terms() {
    // The unit square in two triangles; their common face is the diagonal from (0, 0) to (1, 1).
    let mesh = mesh(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[0, 1, 2, 0, 2, 3]);
    let cut = CutMesh::overlay(&mesh, &[], &OverlayOptions::new()).expect("no bodies");
    let space = XfemSpace::new(&mesh, &cut);
    let parts = PartValues::new(&mesh, &cut, 2);
    let faces = FaceValues::new(&mesh, &cut, &space, &parts);
    let [value] = faces.as_slice() else { panic!("one interior face") };
    let h = 2.0_f64.sqrt();
    assert!((value.diameter - h).abs() < 1e-15 && (value.measure - h).abs() < 1e-15);
    // u* = (3, 1) at one end of the face, zero at the other; u*·n = ±2/√2 = √2.
    let history: Vec<V> =
        space.vertices().iter().map(|v| if *v == VertexId(2) { V::new(3.0, 1.0) } else { V::zeros() }).collect();
    let face = FluidFace::new(value, &history);
    assert!((face.normal_speed - h).abs() < 1e-14 && (face.speed - 10.0_f64.sqrt()).abs() < 1e-14);
    let consistent = CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.1 }, density: 2.0 };
    assert!((consistent.weight(&face) - 0.1 * 2.0 * 2.0 * h).abs() < 1e-14);
    let paper = CipVelocity { profile: CipProfile::Paper { gamma_1: 0.7 }, density: 2.0 };
    assert!((paper.weight(&face) - 0.7 * 2.0 * h * h).abs() < 1e-14);
    let pressure = CipPressure { gamma_pressure: 0.3, density: 2.0, viscosity: 4.0, rate: 5.0 };
    let tau = 1.0 / (10.0 + 2.0 * 10.0_f64.sqrt() / h + 2.0);
    assert!((pressure.weight(&face) - 0.3 * h * tau).abs() < 1e-14);
    let ghost = GhostPenalty { gamma_ghost: 0.5, viscosity: 4.0 };
    assert_eq!(ghost.weight(&face), 0.0);
    let mut near_cut = *value;
    near_cut.is_ghost = true;
    assert!((ghost.weight(&FluidFace::new(&near_cut, &history)) - 2.0 * h).abs() < 1e-14);
}

#[test]
fn a_face_penalises_the_jump_over_its_whole_length() {
    // The unit square in two triangles, field one at (1, 0) and zero elsewhere: its gradient (1, -1) lives below the
    // diagonal, its jump of the normal derivative is √2, and weight c_F |F| jump² = c_F 2 √2 lands on the vertex itself.
    let mesh = mesh(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[0, 1, 2, 0, 2, 3]);
    let cut = CutMesh::overlay(&mesh, &[], &OverlayOptions::new()).expect("no bodies");
    let space = XfemSpace::new(&mesh, &cut);
    let parts = PartValues::new(&mesh, &cut, 2);
    let faces = FaceValues::new(&mesh, &cut, &space, &parts);
    let history = vec![V::new(1.0, -1.0); 4];
    let geometry =
        FluidGeometry { background: &mesh, cut: &cut, space: &space, parts: &parts, faces: &faces, history: &history };
    let mut layout = BlockLayout::new();
    let (velocity, pressure) = (layout.push("velocity", 8), layout.push("pressure", 4));
    let fields = FluidFields { layout: &layout, velocity, pressure };
    let form = FluidForm {
        inertia: None,
        viscous: Viscous { viscosity: 4.0 },
        incompressibility: Incompressibility,
        convection: None,
        body_force: BodyForce { force: None, time: 0.0 },
        cip_velocity: CipVelocity { profile: CipProfile::Consistent { gamma_u: 0.1 }, density: 2.0 },
        cip_pressure: CipPressure { gamma_pressure: 0.3, density: 2.0, viscosity: 4.0, rate: 5.0 },
        ghost_penalty: GhostPenalty { gamma_ghost: 0.5, viscosity: 4.0 },
    };
    let faces = FluidFaces::new(&geometry, fields, &form);
    let at = |vertex: usize| space.vertices().iter().position(|v| v.index() == vertex).expect("a dof");
    // u* = (1, -1): |u*·n| = √2 = |u*|, h_F = √2.
    let length = 2.0_f64.sqrt();
    let c_velocity = 0.1 * 2.0 * 2.0 * length;
    let c_pressure = 0.3 * length / (10.0 + 2.0 + 2.0);
    for (row, c) in [(2 * at(1), c_velocity), (2 * at(1) + 1, c_velocity), (8 + at(1), c_pressure)] {
        let mut x = vec![0.0; 12];
        x[row] = 1.0;
        let (mut dofs, mut local, mut sum) = (Vec::new(), LocalSystem::new(), vec![0.0; 12]);
        for item in 0..faces.len() {
            dofs.clear();
            faces.dofs(item, &mut dofs);
            local.reset(dofs.len());
            faces.add(item, &x, &mut local);
            dofs.iter().zip(local.residual()).for_each(|(d, r)| sum[d.index()] += r);
        }
        assert!((sum[row] - c * length * 2.0).abs() < 1e-13, "{} {}", sum[row], c * length * 2.0);
        assert!(sum.iter().sum::<f64>().abs() < 1e-13, "constants have no jump");
    }
}

#[test]
fn open_boundary() {
    let mesh = mesh(&TRIANGLE, &[0, 1, 2]).with_boundary_tags(|x| x.iter().all(|x| x[1] == 0.0).then_some("bottom"));
    let cut = CutMesh::overlay(&mesh, &[], &OverlayOptions::new()).expect("no bodies");
    let space = XfemSpace::new(&mesh, &cut);
    let parts = PartValues::new(&mesh, &cut, 2);
    let faces = FaceValues::new(&mesh, &cut, &space, &parts);
    let mut layout = BlockLayout::new();
    let (velocity, pressure) = (layout.push("velocity", 6), layout.push("pressure", 3));
    let force = |inflow: f64, backflow: bool, traction: bool| {
        // The bottom's normal is (0, -1): a history that points up flows in.
        let history = vec![V::new(1.0, inflow); 3];
        let geometry = FluidGeometry {
            background: &mesh,
            cut: &cut,
            space: &space,
            parts: &parts,
            faces: &faces,
            history: &history,
        };
        let t = |_: &Point<2>, n: &V, time: f64| n * time;
        let open = OpenBoundary {
            geometry: &geometry,
            fields: FluidFields { layout: &layout, velocity, pressure },
            values: BoundaryValues::new(&mesh, &cut, mesh.tag("bottom").expect("tagged"), 3),
            traction: Traction { traction: if traction { Some(&t) } else { None }, time: 7.0 },
            backflow: backflow.then_some(Backflow { density: 3.0 }),
        };
        let mut x = vec![0.0; 9];
        x[..6].copy_from_slice(&[5.0, 1.0, 5.0, 1.0, 5.0, 1.0]);
        let (mut dofs, mut local) = (Vec::new(), LocalSystem::new());
        let mut sum = [0.0; 6];
        for item in 0..open.len() {
            dofs.clear();
            open.dofs(item, &mut dofs);
            local.reset(dofs.len());
            open.add(item, &x, &mut local);
            dofs.iter().zip(local.residual()).for_each(|(d, r)| sum[d.index()] += r);
        }
        // By vertex, whatever the numbering.
        (0..3)
            .map(|v| space.vertices().iter().position(|w| w.index() == v).expect("a dof"))
            .flat_map(|k| [sum[2 * k], sum[2 * k + 1]])
            .collect::<Vec<_>>()
    };
    // -ρ/2 (-2) (5, 1) on a unit length, half to either end.
    assert_close(&force(2.0, true, false), &[7.5, 1.5, 7.5, 1.5, 0.0, 0.0]);
    assert_close(&force(-2.0, true, false), &[0.0; 6]);
    assert_close(&force(2.0, false, false), &[0.0; 6]);
    // -(t, v) with t = 7 n = (0, -7).
    assert_close(&force(2.0, false, true), &[0.0, 3.5, 0.0, 3.5, 0.0, 0.0]);
    assert_eq!(SimplexRule::of_degree(1, 3).points().len(), 2);
}
