//! Extension of velocity and acceleration of the fluid to uncovered dofs.

use algebra::{
    BlockLayout, Constraints, Contributions, DofId, Equations, FieldId, LocalSystem, NewtonError, NewtonSettings,
    Workspace, newton,
};
use cutcell::CutMesh;
use interface_dg::PieceValues;
use mesh::{MAX_CELL_VERTICES, MAX_FACET_NODES, Tensor, Vector};
use xfem_space::{FaceValue, Sources, XfemSpace};

/// Weight of the velocity of the body at each uncovered vertex of a cut cell, relative to its weight on the surface. It
/// makes the values unique where those on the surface do not determine them, such as in a pocket inside one cell.
const AT_VERTICES: f64 = 1e-10;
/// Relative tolerance of the solution.
const TOLERANCE: f64 = 1e-10;

/// The cut of a step with the values that an extension needs.
#[derive(Clone, Copy)]
pub(crate) struct Extension<'a, const D: usize> {
    pub(crate) cut: &'a CutMesh<D>,
    pub(crate) space: &'a XfemSpace<D>,
    pub(crate) faces: &'a [FaceValue<D>],
    pub(crate) pieces: &'a PieceValues<D>,
    pub(crate) sources: &'a Sources,
}

impl<const D: usize> Extension<'_, D> {
    /// Replaces the values of uncovered dofs by those that minimise
    ///
    /// `Σ_F h_F |F| |[∇u] n|² + Σ_Σ 1/h_K ∫ |u - v|²`,
    ///
    /// where `F` are the faces that touch an uncovered dof. `on_piece` returns two lists for the nodes of the body on
    /// the facet of a piece: the values `v`, and the points at which they hold. `u` is evaluated at these
    /// points by the affine function of its part. Affine fields that are equal to `v` are
    /// extended without error, over any distance.
    ///
    /// # Errors
    /// The linear solver fails.
    pub(crate) fn fill(
        &self,
        values: &mut [Vector<D>],
        on_piece: impl Fn(usize) -> [[Vector<D>; MAX_FACET_NODES]; 2] + Sync,
    ) -> Result<(), NewtonError> {
        let mut nodes = vec![None; values.len()];
        let mut uncovered = Vec::new();
        for (dof, source) in self.sources.earlier_dofs().iter().enumerate() {
            if source.is_none() {
                nodes[dof] = Some(uncovered.len());
                uncovered.push(dof);
            }
        }
        if uncovered.is_empty() {
            return Ok(());
        }
        let mut layout = BlockLayout::new();
        let field = layout.push("uncovered velocity", uncovered.len(), D);
        let unknowns = Unknowns { layout: &layout, field, nodes: &nodes, known: values };
        let faces = self.faces.iter().filter(|face| unknowns.touch(face.dofs())).collect();
        let pieces = self.cut.interface().iter().enumerate();
        let pieces = pieces.filter(|(_, piece)| unknowns.touch(self.space.dofs(piece.part))).map(|(item, _)| item);
        let jumps = Jumps { unknowns, faces };
        let surface = SurfaceFit { unknowns, extension: *self, pieces: pieces.collect(), on_piece: &on_piece };
        let constraints = Constraints::new();
        let contributions: Vec<Box<dyn Contributions + '_>> = vec![Box::new(jumps), Box::new(surface)];
        let equations = Equations { layout: &layout, contributions, constraints: &constraints };
        let mut x = vec![0.0; layout.len()];
        newton(&equations, &mut x, &mut Workspace::new(), &NewtonSettings::new(TOLERANCE))?;
        drop(equations);
        uncovered.iter().zip(layout.values(field, &x)).for_each(|(dof, value)| values[*dof] = value.into());
        Ok(())
    }
}

/// Values at dofs, some of which are unknown.
#[derive(Clone, Copy)]
struct Unknowns<'a, const D: usize> {
    layout: &'a BlockLayout,
    field: FieldId,
    /// Number of each dof among the unknown ones.
    nodes: &'a [Option<usize>],
    known: &'a [Vector<D>],
}

impl<const D: usize> Unknowns<'_, D> {
    /// Returns whether one of the dofs is unknown.
    fn touch(&self, dofs: &[u32]) -> bool {
        dofs.iter().any(|dof| self.nodes[*dof as usize].is_some())
    }

    fn of(&self, dofs: &[u32], out: &mut Vec<DofId>) {
        for node in dofs.iter().filter_map(|dof| self.nodes[*dof as usize]) {
            out.extend(self.layout.node(self.field, node));
        }
    }

    fn value(&self, dof: u32, x: &[f64]) -> Vector<D> {
        match self.nodes[dof as usize] {
            Some(node) => self.layout.at(self.field, node, x).into(),
            None => self.known[dof as usize],
        }
    }

    /// Adds the derivatives of `1/2 e · weight e` with `e = Σ_k factors_k u_k - target`.
    fn add_square(
        &self,
        dofs: &[u32],
        factors: &[f64],
        target: &Vector<D>,
        weight: &Tensor<D>,
        x: &[f64],
        out: &mut LocalSystem,
    ) {
        let sum: Vector<D> = dofs.iter().zip(factors).map(|(dof, factor)| self.value(*dof, x) * *factor).sum();
        let residual = weight * (sum - target);
        let unknown = || dofs.iter().zip(factors).filter(|(dof, _)| self.nodes[**dof as usize].is_some());
        let rows = || (0..).step_by(D).zip(unknown());
        for (row, (_, test)) in rows() {
            out.add_vector::<D>(row, residual * *test);
            for (column, (_, trial)) in rows() {
                out.add_block::<D, D>(row, column, weight * (test * trial));
            }
        }
    }
}

/// `Σ_F h_F ([∇u] n, [∇v] n)_F`.
struct Jumps<'a, const D: usize> {
    unknowns: Unknowns<'a, D>,
    faces: Vec<&'a FaceValue<D>>,
}

impl<const D: usize> Contributions for Jumps<'_, D> {
    fn len(&self) -> usize {
        self.faces.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.unknowns.of(self.faces[item].dofs(), out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let face = self.faces[item];
        let weight = face.along_plane() * (face.share * face.weight * face.diameter);
        self.unknowns.add_square(face.dofs(), face.jumps(), &Vector::zeros(), &weight, x, out);
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "least jumps"
    }
}

/// `Σ_Σ 1/h_K (u - v, w)`, and the same at the vertices with the factor [`AT_VERTICES`].
struct SurfaceFit<'a, const D: usize> {
    unknowns: Unknowns<'a, D>,
    extension: Extension<'a, D>,
    pieces: Vec<usize>,
    on_piece: &'a (dyn Fn(usize) -> [[Vector<D>; MAX_FACET_NODES]; 2] + Sync),
}

impl<const D: usize> Contributions for SurfaceFit<'_, D> {
    fn len(&self) -> usize {
        self.pieces.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let piece = &self.extension.cut.interface()[self.pieces[item]];
        self.unknowns.of(self.extension.space.dofs(piece.part), out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let Extension { cut, space, pieces, .. } = self.extension;
        let piece = &cut.interface()[self.pieces[item]];
        let dofs = space.dofs(piece.part);
        let [values, places] = (self.on_piece)(self.pieces[item]);
        for at in pieces.points(self.pieces[item]) {
            let on_facet = |of_nodes: &[Vector<D>]| of_nodes.iter().zip(&at.solid).map(|(v, n)| v * *n).sum();
            let (of_body, offset): (Vector<D>, Vector<D>) = (on_facet(&values), on_facet(&places) - at.point);
            let mut shape = at.fluid;
            shape.iter_mut().zip(pieces.gradients(self.pieces[item])).for_each(|(n, g)| *n += g.dot(&offset));
            let weight = Tensor::identity() * (at.weight / pieces.cell_size(self.pieces[item]));
            self.unknowns.add_square(dofs, &shape[..=D], &of_body, &weight, x, out);
            for k in 0..=D {
                let mut vertex = [0.0; MAX_CELL_VERTICES];
                vertex[k] = 1.0;
                self.unknowns.add_square(dofs, &vertex[..=D], &of_body, &(weight * AT_VERTICES), x, out);
            }
        }
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn name(&self) -> &'static str {
        "velocity of the bodies"
    }
}
