//! Contributions made of functions, and a flow-like problem on a structured triangulation with three fields.
#![allow(dead_code)]

use std::sync::Arc;

use algebra::{BlockLayout, Constraints, Contributions, DofId, Equations, FieldId, LocalSystem};

/// Residual and tangent of an item at a state.
type Add<'a> = Arc<dyn Fn(usize, &[f64], &mut LocalSystem) + Send + Sync + 'a>;

/// A contribution made of functions.
#[derive(Clone)]
pub(crate) struct Part<'a> {
    pub(crate) name: &'static str,
    pub(crate) is_linear: bool,
    pub(crate) regime: fn(&[f64]) -> u64,
    n_items: usize,
    dofs: Arc<dyn Fn(usize) -> Vec<usize> + Send + Sync + 'a>,
    add: Add<'a>,
}

impl<'a> Part<'a> {
    pub(crate) fn new(
        name: &'static str,
        n_items: usize,
        dofs: impl Fn(usize) -> Vec<usize> + Send + Sync + 'a,
        add: impl Fn(usize, &[f64], &mut LocalSystem) + Send + Sync + 'a,
    ) -> Self {
        Self { name, is_linear: false, regime: |_| 0, n_items, dofs: Arc::new(dofs), add: Arc::new(add) }
    }

    pub(crate) fn linear(self) -> Self {
        Self { is_linear: true, ..self }
    }
}

impl Contributions for Part<'_> {
    fn len(&self) -> usize {
        self.n_items
    }
    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend((self.dofs)(item).into_iter().map(DofId::new));
    }
    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        (self.add)(item, x, out);
    }
    fn is_linear(&self) -> bool {
        self.is_linear
    }
    fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
        Some((self.regime)(x).wrapping_add(item as u64))
    }
    fn name(&self) -> &'static str {
        self.name
    }
}

/// Returns references to the parts.
pub(crate) fn refs<'p>(parts: &'p [Part<'_>]) -> Vec<&'p dyn Contributions> {
    parts.iter().map(|part| part as _).collect()
}

/// Returns a layout with one field of `n` scalar unknowns.
pub(crate) fn scalar_field(n: usize) -> BlockLayout {
    let mut layout = BlockLayout::new();
    layout.push("x", n, 1);
    layout
}

/// Returns springs with the force `e + e³` at elongation `e` between the neighbours in a row of points.
pub(crate) fn springs(points: usize) -> Part<'static> {
    let add = |item: usize, x: &[f64], out: &mut LocalSystem| {
        let e = x[item + 1] - x[item];
        let (force, stiffness) = (e + e.powi(3), 1.0 + 3.0 * e.powi(2));
        out.add_vector(0, [-force, force]);
        out.add_block(0, 0, [[stiffness, -stiffness], [-stiffness, stiffness]]);
    };
    Part::new("springs", points - 1, |item| vec![item, item + 1], add)
}

/// Triangles of the unit square with `m` × `m` squares, and their interior faces.
struct Grid {
    m: usize,
    cells: Vec<[usize; 3]>,
    /// The four vertices of the two cells beside each interior face.
    faces: Vec<[usize; 4]>,
}

impl Grid {
    fn new(m: usize) -> Self {
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

    fn n_vertices(&self) -> usize {
        (self.m + 1) * (self.m + 1)
    }

    fn on_boundary(&self, vertex: usize) -> bool {
        let (i, j) = (vertex % (self.m + 1), vertex / (self.m + 1));
        i == 0 || j == 0 || i == self.m || j == self.m
    }

    /// Returns the area and gradients of the hat functions.
    fn geometry(&self, cell: usize) -> (f64, [[f64; 2]; 3]) {
        let n = self.m + 1;
        let corner = |vertex: usize| [vertex % n, vertex / n].map(|k| k as f64 / self.m as f64);
        let [a, b, c] = self.cells[cell].map(corner);
        let det = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let grad = |p: [f64; 2], q: [f64; 2]| [(p[1] - q[1]) / det, (q[0] - p[0]) / det];
        (det / 2.0, [grad(b, c), grad(c, a), grad(a, b)])
    }
}

/// Velocity and pressure on a grid: mass, viscosity, incompressibility, convection, and jumps of the pressure.
pub(crate) struct Flow {
    grid: Grid,
    pub(crate) layout: BlockLayout,
    pub(crate) constraints: Constraints,
    convection: f64,
}

impl Flow {
    const MASS: f64 = 1.0;
    const VISCOSITY: f64 = 0.01;

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
        Self { grid, layout, constraints, convection }
    }

    fn dof(&self, field: usize, vertex: usize) -> usize {
        self.layout.dof(FieldId::new(field), vertex, 0).index()
    }

    /// Returns all parts; convection only if it is not zero.
    pub(crate) fn parts(&self) -> Vec<Part<'_>> {
        let convection = (self.convection != 0.0).then(|| self.convection());
        [self.linear()].into_iter().chain(convection).chain([self.jumps(2)]).collect()
    }

    pub(crate) fn equations(&self) -> Equations<'_> {
        let contributions = self.parts().into_iter().map(|part| Box::new(part) as Box<dyn Contributions>).collect();
        Equations { layout: &self.layout, contributions, constraints: &self.constraints }
    }

    /// Returns a part over the cells with the dofs u, v and p of each vertex. `add` takes area, gradients and local
    /// values.
    fn cells(
        &self,
        name: &'static str,
        add: impl Fn(f64, [[f64; 2]; 3], [[f64; 3]; 3], &mut LocalSystem) + Send + Sync + 'static,
    ) -> Part<'_> {
        let dofs = |cell: usize| self.grid.cells[cell].map(|vertex| [0, 1, 2].map(|field| self.dof(field, vertex)));
        let add = move |cell: usize, x: &[f64], out: &mut LocalSystem| {
            let (area, gradients) = self.grid.geometry(cell);
            add(area, gradients, dofs(cell).map(|of_vertex| of_vertex.map(|dof| x[dof])), out);
        };
        Part::new(name, self.grid.cells.len(), move |cell| dofs(cell).concat(), add)
    }

    /// Returns the linear terms of the cells: mass, viscosity and incompressibility.
    fn linear(&self) -> Part<'_> {
        let cells = self.cells("linear cells", |area, g, local, out| {
            for i in 0..3 {
                for j in 0..3 {
                    let stiffness = area * (g[i][0] * g[j][0] + g[i][1] * g[j][1]);
                    let mass = Self::MASS * area / if i == j { 6.0 } else { 12.0 };
                    for c in 0..2 {
                        let k = Self::VISCOSITY * stiffness + mass;
                        let (b, bt) = (-area / 3.0 * g[i][c], area / 3.0 * g[j][c]);
                        out.add_tangent(3 * i + c, 3 * j + c, k);
                        out.add(3 * i + c, k * local[j][c]);
                        out.add_tangent(3 * i + c, 3 * j + 2, b);
                        out.add(3 * i + c, b * local[j][2]);
                        out.add_tangent(3 * i + 2, 3 * j + c, bt);
                        out.add(3 * i + 2, bt * local[j][c]);
                    }
                }
                out.add(3 * i, -area / 3.0 * Self::MASS);
            }
        });
        cells.linear()
    }

    /// Returns `(u · ∇ u, v)` with the mean velocity of the cell.
    fn convection(&self) -> Part<'_> {
        let convection = self.convection;
        self.cells("convection cells", move |area, g, u, out| {
            let mean = [0, 1].map(|a| (u[0][a] + u[1][a] + u[2][a]) / 3.0);
            let weight = convection * area / 3.0;
            for i in 0..3 {
                for c in [0, 1] {
                    let slope = [0, 1].map(|a| (0..3).map(|k| u[k][c] * g[k][a]).sum::<f64>());
                    out.add(3 * i + c, weight * (mean[0] * slope[0] + mean[1] * slope[1]));
                    if out.has_tangent() {
                        for (j, g_j) in g.iter().enumerate() {
                            out.add_tangent(3 * i + c, 3 * j + c, weight * (mean[0] * g_j[0] + mean[1] * g_j[1]));
                            out.add_tangent(3 * i + c, 3 * j, weight * slope[0] / 3.0);
                            out.add_tangent(3 * i + c, 3 * j + 1, weight * slope[1] / 3.0);
                        }
                    }
                }
            }
        })
    }

    /// Returns a stabilisation by jumps between the two cells of a face, for one field.
    pub(crate) fn jumps(&self, field: usize) -> Part<'_> {
        let dofs = move |face: usize| self.grid.faces[face].map(|vertex| self.dof(field, vertex));
        let add = move |face: usize, x: &[f64], out: &mut LocalSystem| {
            let weights = [1.0, 1.0, -1.0, -1.0];
            let size = if field == 2 { 0.01 } else { 0.001 };
            let jump: f64 = dofs(face).iter().zip(weights).map(|(dof, w)| w * x[*dof]).sum();
            for i in 0..4 {
                out.add(i, size * weights[i] * jump);
                for j in 0..4 {
                    out.add_tangent(i, j, size * weights[i] * weights[j]);
                }
            }
        };
        Part::new("face jumps", self.grid.faces.len(), move |face| dofs(face).to_vec(), add).linear()
    }
}

/// Returns a state without structure.
pub(crate) fn state(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 * 0.37).sin()).collect()
}

/// Returns the largest absolute entry.
pub(crate) fn max_norm(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |max, v| v.abs().max(max))
}
