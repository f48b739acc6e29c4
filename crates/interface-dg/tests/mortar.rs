//! The mortar on one cut cell: values by hand, action and reaction, leak and traction.

use algebra::{BlockLayout, Contributions, LocalSystem};
use fluid_ns::mesh::generate::structured_box;
use fluid_ns::mesh::{Placed, Point, SimplexMesh, Vector};
use fluid_ns::xfem_space::cutcell::{CutMesh, OverlayOptions};
use fluid_ns::xfem_space::{FaceValues, PartValues, XfemSpace};
use fluid_ns::{FluidFields, FluidGeometry, NewtonianFluid};
use interface_dg::{BodySide, InterfacePieces, MortarForm, PieceValues, fluid_ns, interface_flow, interface_tractions};

type V = Vector<2>;

/// A background of squares of side 1 with a body below y = 0.4, whose top is the only wet side.
struct Fixture {
    background: SimplexMesh<2>,
    body: SimplexMesh<2>,
    cut: CutMesh<2>,
    space: XfemSpace<2>,
}

impl Fixture {
    fn new() -> Self {
        let background = structured_box::<2>([0.0, 0.0], [2.0, 2.0], [2, 2]).expect("a box");
        let body = structured_box::<2>([0.0, 0.0], [2.0, 0.4], [3, 1]).expect("a box");
        let boundary = body.boundary();
        let placed = [Placed::new(&boundary, body.vertices())];
        let cut = CutMesh::overlay(&background, &placed, &OverlayOptions::new()).expect("a cut");
        let space = XfemSpace::new(&background, &cut);
        Self { background, body, cut, space }
    }

    /// Residual sums: force on the fluid, flux in the pressure rows, force on the body; and the largest row sums.
    fn with_pieces<R>(
        &self,
        gamma_sigma: f64,
        u: impl Fn(&Point<2>) -> V,
        p: f64,
        v: V,
        elastic: bool,
        visit: impl FnOnce(&InterfacePieces<'_, 2>, &[f64], [V; 2], f64) -> R,
    ) -> R {
        let parts = PartValues::new(&self.background, &self.cut, 2);
        let faces = FaceValues::new(&self.background, &self.cut, &self.space, &parts);
        let pieces = PieceValues::new(&self.background, &self.cut, &parts, 2);
        let history = vec![V::zeros(); self.space.len()];
        let mut layout = BlockLayout::new();
        let velocity = layout.push("velocity", 2 * self.space.len());
        let pressure = layout.push("pressure", self.space.len());
        let field = layout.push("body", 2 * self.body.n_vertices());
        let geometry = FluidGeometry {
            background: &self.background,
            cut: &self.cut,
            space: &self.space,
            parts: &parts,
            faces: &faces,
            history: &history,
        };
        let boundary = self.body.boundary();
        let given = move |_: &Point<2>, _: [f64; 2]| v;
        let side = if elastic {
            BodySide::Unknown { field, boundary: &boundary }
        } else {
            BodySide::Prescribed { velocity: &given, times: [0.0; 2] }
        };
        let interface = InterfacePieces {
            geometry: &geometry,
            fields: FluidFields { layout: &layout, velocity, pressure },
            values: &pieces,
            bodies: &[side],
            form: &MortarForm::new(NewtonianFluid { density: 1.0, viscosity: 0.5 }, gamma_sigma),
        };
        let mut x = vec![0.0; layout.len()];
        for (k, &vertex) in self.space.vertices().iter().enumerate() {
            x[2 * k..2 * k + 2].copy_from_slice(u(&self.background.vertex(vertex)).as_slice());
            x[layout.dof(pressure, k).index()] = p;
        }
        x[layout.range(field)].chunks_exact_mut(2).for_each(|slot| slot.copy_from_slice(v.as_slice()));
        let (mut dofs, mut local) = (Vec::new(), LocalSystem::new());
        let (mut force, mut flux) = ([V::zeros(); 2], 0.0);
        for item in 0..interface.len() {
            dofs.clear();
            interface.dofs(item, &mut dofs);
            local.reset(dofs.len());
            interface.add(item, &x, &mut local);
            for (dof, r) in dofs.iter().zip(local.residual()) {
                let k = dof.index();
                if layout.range(pressure).contains(&k) {
                    flux += r;
                } else {
                    let of_body = layout.range(field).contains(&k);
                    let first = if of_body { layout.range(field).start } else { 0 };
                    force[usize::from(of_body)][(k - first) % 2] += r;
                }
            }
        }
        visit(&interface, &x, force, flux)
    }
}

#[test]
fn pressure_pushes_fluid_and_body_apart() {
    // u = v: no jump. -(T n^f, v - w) with T n^f = -p n^f, n^f = (0, -1), on a length of 2.
    Fixture::new().with_pieces(
        1e3,
        |_| V::new(1.0, 0.5),
        3.0,
        V::new(1.0, 0.5),
        true,
        |pieces, x, force, flux| {
            assert!((force[0] - V::new(0.0, -6.0)).norm() < 1e-12, "{}", force[0]);
            assert!((force[0] + force[1]).norm() < 1e-12, "action and reaction");
            assert!(flux.abs() < 1e-12);
            for t in interface_tractions(pieces, x) {
                // The body feels -p n with n = (0, 1).
                assert!((t.total() - V::new(0.0, -3.0)).norm() < 1e-12 && t.jump.norm() < 1e-12);
            }
        },
    );
}

#[test]
fn shear_drags_the_body_along() {
    // u = (y - 0.4, 0): no jump on the interface; viscous traction on the body μ (1, 0).
    Fixture::new().with_pieces(
        1e3,
        |x| V::new(x[1] - 0.4, 0.0),
        0.0,
        V::zeros(),
        true,
        |pieces, x, force, _| {
            assert!((force[1] - V::new(-1.0, 0.0)).norm() < 1e-12, "{}", force[1]);
            assert!((force[0] + force[1]).norm() < 1e-12);
            assert!(interface_tractions(pieces, x).iter().all(|t| (t.fluid - V::new(0.5, 0.0)).norm() < 1e-12));
        },
    );
}

#[test]
fn a_jump_is_penalised_and_counted_as_leak() {
    for elastic in [true, false] {
        // Fluid at rest, body moving up with 2: jump (0, -2); every cell has h_K = √(0.5 · 4/√3).
        Fixture::new().with_pieces(
            100.0,
            |_| V::zeros(),
            0.0,
            V::new(0.0, 2.0),
            elastic,
            |pieces, x, force, flux| {
                let h = (0.5 * 4.0 / 3.0_f64.sqrt()).sqrt();
                let penalty = 100.0 * 0.5 / h * -2.0 * 2.0;
                assert!((force[0] - V::new(0.0, penalty)).norm() < 1e-10, "{}", force[0]);
                let reaction = if elastic { -force[0] } else { V::zeros() };
                assert!((force[1] - reaction).norm() < 1e-10);
                // -(u - v_s)·n^f q: jump·n^f = 2 on a length of 2.
                assert!((flux + 4.0).abs() < 1e-12, "{flux}");
                let flow = interface_flow(pieces, x);
                assert!((flow.leak_net + 4.0).abs() < 1e-12 && (flow.leak_absolute - 4.0).abs() < 1e-12);
                assert!((flow.swept - 4.0).abs() < 1e-12);
            },
        );
    }
}
