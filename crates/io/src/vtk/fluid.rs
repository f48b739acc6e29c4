//! The fluid: uncut cells, and the true fluid polygons of cut ones.

use cutcell::{CutMesh, PartId, Polytope};
use mesh::{CellId, Point, SimplexMesh, Vector};
use solver::FluidState;
use vtkio::model::CellType;

use super::cut::ring;
use super::{Grid, in_space, simplex_type};

/// Velocity, pressure and vorticity on the fluid domain of a state.
///
/// Cut cells appear as the convex pieces of their fluid parts, with values of the part's own dofs: points are shared only
/// where the dof is the same. Fields of a state live on the geometry at the start of its step.
pub fn fluid_grid<const D: usize>(background: &SimplexMesh<D>, fluid: &FluidState<D>) -> Grid {
    let mut output = FluidOutput {
        background,
        fluid,
        grid: Grid::default(),
        velocity: Vec::new(),
        pressure: Vec::new(),
        dof_to_point: vec![None; fluid.space.len()],
    };
    let mut cells: Vec<(PartId, CellId)> = Vec::new();
    for part in fluid.cut.all_parts() {
        let cell = fluid.cut.part_cell(part);
        let before = output.grid.n_cells();
        if fluid.cut.is_whole(part) {
            output.push_whole(part, cell);
        } else {
            fluid.cut.part_pieces(part).for_each(|piece| output.push_piece(part, cell, piece));
        }
        cells.extend((before..output.grid.n_cells()).map(|_| (part, cell)));
    }
    let FluidOutput { mut grid, velocity, pressure, .. } = output;
    grid.add_point_data("velocity", 3, velocity);
    grid.add_point_data("pressure", 1, pressure);
    let vorticity: Vec<[f64; 3]> = cells.iter().map(|&(part, cell)| curl(background, fluid, part, cell)).collect();
    if D == 2 {
        grid.add_cell_data("vorticity", 1, vorticity.iter().map(|w| w[2]).collect());
    } else {
        grid.add_cell_data("vorticity", 3, vorticity.into_iter().flatten().collect());
    }
    grid.add_cell_ids("part", cells.iter().map(|(part, _)| i64::from(part.0)).collect());
    grid.add_cell_ids("cut", cells.iter().map(|(part, _)| i64::from(!fluid.cut.is_whole(*part))).collect());
    grid
}

struct FluidOutput<'a, const D: usize> {
    background: &'a SimplexMesh<D>,
    fluid: &'a FluidState<D>,
    grid: Grid,
    velocity: Vec<f64>,
    pressure: Vec<f64>,
    /// Points of uncut cells.
    dof_to_point: Vec<Option<u64>>,
}

impl<const D: usize> FluidOutput<'_, D> {
    fn push_whole(&mut self, part: PartId, cell: CellId) {
        let mut points = [0; mesh::MAX_CELL_VERTICES];
        for (slot, &dof) in points.iter_mut().zip(self.fluid.space.dofs(part)) {
            *slot = match self.dof_to_point[dof as usize] {
                Some(point) => point,
                None => {
                    let x = self.background.vertex(self.fluid.space.vertex(dof));
                    let k = dof as usize;
                    let point = self.push_point(&x, self.fluid.velocity[k], self.fluid.pressure[k]);
                    self.dof_to_point[k] = Some(point);
                    point
                }
            };
        }
        debug_assert_eq!(self.background.cell(cell).len(), D + 1);
        self.grid.push_cell(simplex_type(D + 1), points[..=D].iter().copied());
    }

    fn push_piece(&mut self, part: PartId, cell: CellId, piece: Polytope<'_, D>) {
        if D == 2 {
            let points: Vec<u64> = ring(piece).iter().map(|x| self.push_interpolated(part, cell, x)).collect();
            self.grid.push_cell(CellType::Polygon, points);
        } else {
            piece.for_each_simplex(|corners| {
                let points: Vec<u64> = corners.iter().map(|x| self.push_interpolated(part, cell, x)).collect();
                self.grid.push_cell(simplex_type(corners.len()), points);
            });
        }
    }

    fn push_interpolated(&mut self, part: PartId, cell: CellId, x: &Point<D>) -> u64 {
        let shape = self.background.simplex(cell).barycentric(x).unwrap_or_default();
        let dofs = self.fluid.space.dofs(part);
        let velocity = dofs.iter().zip(shape).map(|(&k, n)| self.fluid.velocity[k as usize] * n).sum();
        let pressure = dofs.iter().zip(shape).map(|(&k, n)| self.fluid.pressure[k as usize] * n).sum();
        self.push_point(x, velocity, pressure)
    }

    fn push_point(&mut self, x: &Point<D>, velocity: Vector<D>, pressure: f64) -> u64 {
        self.velocity.extend(in_space(&velocity));
        self.pressure.push(pressure);
        self.grid.push_point(x)
    }
}

/// Curl of the velocity on a part; in 2D its third component.
pub fn curl<const D: usize>(
    background: &SimplexMesh<D>,
    fluid: &FluidState<D>,
    part: PartId,
    cell: CellId,
) -> [f64; 3] {
    let Some(gradients) = background.simplex(cell).barycentric_gradients() else { return [0.0; 3] };
    let mut curl = [0.0; 3];
    for (&dof, gradient) in fluid.space.dofs(part).iter().zip(&gradients) {
        let (u, g) = (in_space(&fluid.velocity[dof as usize]), in_space(gradient));
        for (k, component) in curl.iter_mut().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            *component += g[i] * u[j] - g[j] * u[i];
        }
    }
    curl
}

/// The polygons of the fluid in the plane: the corners of each uncut cell and of each convex piece of a cut one, with its
/// part.
pub fn fluid_polygons<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>) -> Vec<(PartId, Vec<Point<D>>)> {
    let mut polygons = Vec::new();
    for part in cut.all_parts() {
        if cut.is_whole(part) {
            polygons.push((part, background.simplex(cut.part_cell(part)).points().to_vec()));
        } else {
            polygons.extend(cut.part_pieces(part).map(|piece| (part, ring(piece))));
        }
    }
    polygons
}
