//! The surfaces of all bodies with tractions and contact pressures.

use mesh::{FacetId, Vector};
use solver::StepView;

use super::{Grid, in_space, simplex_type};

/// Returns the grid of the facets of all bodies, at their positions at the end of a step; `None` without a body.
///
/// Fields of cells: `traction` is the traction of the fluid on the body with the penalty of the mortar, a mean over the
/// wet part of the facet, zero on dry facets. `contact_pressure` is a mean over the facet. Both are zero before the
/// first step. `body` and `facet` are indices.
pub fn surface_grid<const D: usize>(view: &StepView<'_, D>) -> Option<Grid> {
    let (setup, state) = (view.setup, view.state);
    let mut grid = Grid::default();
    // Index of the first facet of each body in the grid.
    let (mut first, mut bodies, mut facets) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (body, now)) in setup.bodies.iter().zip(&state.bodies).enumerate() {
        first.push(grid.n_cells());
        let n_points = grid.n_points() as u64;
        for x in now.positions(body.reference()) {
            grid.push_point(&x);
        }
        let boundary = body.surface();
        for facet in boundary.facets() {
            grid.push_cell(simplex_type(D), boundary.facet(facet).iter().map(|v| n_points + u64::from(v.0)));
            facets.push(facet.index() as i64);
        }
        bodies.resize(grid.n_cells(), index as i64);
    }
    if bodies.is_empty() {
        return None;
    }
    let (mut force, mut area) = (vec![Vector::<D>::zeros(); grid.n_cells()], vec![0.0; grid.n_cells()]);
    let mut pressure = vec![0.0; grid.n_cells()];
    if let Some(report) = view.report {
        let fluid = state.fluid.as_ref().zip(report.fluid.as_ref());
        for (piece, traction) in
            fluid.iter().flat_map(|(fluid, report)| fluid.cut.interface().iter().zip(&report.tractions))
        {
            let cell = first[piece.body.index()] + piece.facet.index();
            force[cell] += traction.total() * piece.measure;
            area[cell] += piece.measure;
        }
        for (contact, report) in setup.contacts.iter().zip(&report.contacts) {
            let of_master = contact.master().map(|master| (master, &report.master_pressures));
            for (body, pressures) in [(contact.body(), &report.slave_pressures)].into_iter().chain(of_master) {
                let add = |(facet, value): &(FacetId, f64)| pressure[first[body.index()] + facet.index()] += value;
                pressures.iter().for_each(add);
            }
        }
    }
    let mean = |(force, area): (&Vector<D>, &f64)| if *area > 0.0 { force / *area } else { Vector::zeros() };
    grid.add_cell_data("traction", 3, force.iter().zip(&area).map(mean).flat_map(|mean| in_space(&mean)).collect());
    grid.add_cell_data("contact_pressure", 1, pressure);
    grid.add_cell_ids("body", bodies);
    grid.add_cell_ids("facet", facets);
    Some(grid)
}
