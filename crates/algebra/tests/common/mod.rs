//! A flow-like problem on a structured triangulation: three fields, cells of 9 dofs, faces of 4 dofs per field.
#![allow(dead_code)]

use algebra::{BlockLayout, Constraints, Contributions, DofId, Equations, FieldId, LocalSystem};

/// Triangles of the unit square with `m` × `m` squares, and their interior faces.
pub(crate) struct Grid {
    pub(crate) m: usize,
    pub(crate) cells: Vec<[usize; 3]>,
    /// The four vertices of the two cells beside each interior face.
    pub(crate) faces: Vec<[usize; 4]>,
}

impl Grid {
    pub(crate) fn new(m: usize) -> Self {
        let at = |i: usize, j: usize| j * (m + 1) + i;
        let (mut cells, mut faces) = (Vec::new(), Vec::new());
        for j in 0..m {
            for i in 0..m {
                cells.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                cells.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)]);
                if i + 1 < m {
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 2, j + 1)]);
                }
                if j + 1 < m {
                    faces.push([at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 2)]);
                }
            }
        }
        Self { m, cells, faces }
    }

    pub(crate) fn n_vertices(&self) -> usize {
        (self.m + 1) * (self.m + 1)
    }

    pub(crate) fn on_boundary(&self, vertex: usize) -> bool {
        let (i, j) = (vertex % (self.m + 1), vertex / (self.m + 1));
        i == 0 || j == 0 || i == self.m || j == self.m
    }

    fn corner(&self, vertex: usize) -> [f64; 2] {
        let n = self.m + 1;
        [(vertex % n) as f64 / self.m as f64, (vertex / n) as f64 / self.m as f64]
    }

    /// Area and gradients of the hat functions.
    fn geometry(&self, cell: usize) -> (f64, [[f64; 2]; 3]) {
        let [a, b, c] = self.cells[cell].map(|v| self.corner(v));
        let det = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let grad = |p: [f64; 2], q: [f64; 2]| [(p[1] - q[1]) / det, (q[0] - p[0]) / det];
        (det / 2.0, [grad(b, c), grad(c, a), grad(a, b)])
    }
}

/// Fields of the flow-like problem.
pub(crate) struct Flow {
    pub(crate) grid: Grid,
    pub(crate) layout: BlockLayout,
    pub(crate) constraints: Constraints,
    pub(crate) mass: f64,
    pub(crate) viscosity: f64,
    pub(crate) convection: f64,
}

impl Flow {
    pub(crate) fn new(m: usize, convection: f64) -> Self {
        let grid = Grid::new(m);
        let mut layout = BlockLayout::new();
        let u = layout.push("u", grid.n_vertices(), 1);
        layout.push_on(u, "v", 1);
        layout.push_on(u, "p", 1);
        let mut constraints = Constraints::new();
        for vertex in (0..grid.n_vertices()).filter(|v| grid.on_boundary(*v)) {
            let lid = vertex >= m * (m + 1);
            constraints.set(layout.dof(FieldId::new(0), vertex, 0), if lid { 1.0 } else { 0.0 });
            constraints.set(layout.dof(FieldId::new(1), vertex, 0), 0.0);
        }
        constraints.set(layout.dof(FieldId::new(2), 0, 0), 0.0);
        Self { grid, layout, constraints, mass: 1.0, viscosity: 0.01, convection }
    }

    fn cell_dofs(&self, cell: usize) -> impl Iterator<Item = DofId> + '_ {
        self.grid.cells[cell].into_iter().flat_map(move |v| (0..3).map(move |f| self.layout.dof(FieldId::new(f), v, 0)))
    }

    /// Mass, diffusion, incompressibility, convection and jumps of the pressure.
    pub(crate) fn equations(&self) -> Equations<'_> {
        let (linear, convection, jumps) = self.parts();
        let mut contributions: Vec<Box<dyn Contributions + '_>> = vec![Box::new(linear), Box::new(jumps[2])];
        if self.convection != 0.0 {
            contributions.insert(1, Box::new(convection));
        }
        Equations { layout: &self.layout, contributions, constraints: &self.constraints }
    }

    pub(crate) fn parts(&self) -> (LinearCells<'_>, ConvectionCells<'_>, [FaceJumps<'_>; 3]) {
        (LinearCells(self), ConvectionCells(self), [0, 1, 2].map(|field| FaceJumps { flow: self, field }))
    }
}

/// Mass, diffusion and incompressibility.
#[derive(Clone, Copy)]
pub(crate) struct LinearCells<'a>(&'a Flow);

impl Contributions for LinearCells<'_> {
    fn len(&self) -> usize {
        self.0.grid.cells.len()
    }
    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend(self.0.cell_dofs(item));
    }
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let (area, g) = self.0.grid.geometry(item);
        let mut local = [0.0; 9];
        for (value, dof) in local.iter_mut().zip(self.0.cell_dofs(item)) {
            *value = x[dof.index()];
        }
        for i in 0..3 {
            for j in 0..3 {
                let stiffness = area * (g[i][0] * g[j][0] + g[i][1] * g[j][1]);
                let mass = self.0.mass * area / if i == j { 6.0 } else { 12.0 };
                for c in 0..2 {
                    let k = self.0.viscosity * stiffness + mass;
                    let (b, bt) = (-area / 3.0 * g[i][c], area / 3.0 * g[j][c]);
                    out.add_tangent(3 * i + c, 3 * j + c, k);
                    out.add(3 * i + c, k * local[3 * j + c]);
                    out.add_tangent(3 * i + c, 3 * j + 2, b);
                    out.add(3 * i + c, b * local[3 * j + 2]);
                    out.add_tangent(3 * i + 2, 3 * j + c, bt);
                    out.add(3 * i + 2, bt * local[3 * j + c]);
                }
            }
            out.add(3 * i, -area / 3.0 * self.0.mass);
        }
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn name(&self) -> &'static str {
        "linear cells"
    }
}

/// `(u · ∇ u, v)` with the mean velocity of the cell.
#[derive(Clone, Copy)]
pub(crate) struct ConvectionCells<'a>(&'a Flow);

impl Contributions for ConvectionCells<'_> {
    fn len(&self) -> usize {
        self.0.grid.cells.len()
    }
    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend(self.0.cell_dofs(item));
    }
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let (area, g) = self.0.grid.geometry(item);
        let mut u = [[0.0; 3]; 3];
        for (k, dof) in self.0.cell_dofs(item).enumerate() {
            u[k / 3][k % 3] = x[dof.index()];
        }
        let mean = [0, 1].map(|a| (u[0][a] + u[1][a] + u[2][a]) / 3.0);
        let weight = self.0.convection * area / 3.0;
        for i in 0..3 {
            for c in [0, 1] {
                let slope = [0, 1].map(|a| (0..3).map(|k| u[k][c] * g[k][a]).sum::<f64>());
                out.add(3 * i + c, weight * (mean[0] * slope[0] + mean[1] * slope[1]));
                if out.wants_tangent() {
                    for (j, g_j) in g.iter().enumerate() {
                        out.add_tangent(3 * i + c, 3 * j + c, weight * (mean[0] * g_j[0] + mean[1] * g_j[1]));
                        out.add_tangent(3 * i + c, 3 * j, weight * slope[0] / 3.0);
                        out.add_tangent(3 * i + c, 3 * j + 1, weight * slope[1] / 3.0);
                    }
                }
            }
        }
    }
    fn name(&self) -> &'static str {
        "convection cells"
    }
}

/// A stabilisation by jumps between the two cells of a face, for one field.
#[derive(Clone, Copy)]
pub(crate) struct FaceJumps<'a> {
    flow: &'a Flow,
    field: usize,
}

impl Contributions for FaceJumps<'_> {
    fn len(&self) -> usize {
        self.flow.grid.faces.len()
    }
    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend(self.flow.grid.faces[item].map(|v| self.flow.layout.dof(FieldId::new(self.field), v, 0)));
    }
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let weights = [1.0, 1.0, -1.0, -1.0];
        let dofs = self.flow.grid.faces[item].map(|v| self.flow.layout.dof(FieldId::new(self.field), v, 0));
        let size = if self.field == 2 { 0.01 } else { 0.001 };
        let jump: f64 = dofs.iter().zip(weights).map(|(d, w)| w * x[d.index()]).sum();
        for i in 0..4 {
            out.add(i, size * weights[i] * jump);
            for j in 0..4 {
                out.add_tangent(i, j, size * weights[i] * weights[j]);
            }
        }
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn name(&self) -> &'static str {
        "face jumps"
    }
}

/// A state without structure.
pub(crate) fn state(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 * 0.37).sin()).collect()
}

/// Largest absolute entry.
pub(crate) fn max_norm(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |max, v| v.abs().max(max))
}
