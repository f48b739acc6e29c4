//! Thickness of the layers of cells in a film.

use mesh::{CellId, MAX_CELL_VERTICES, Point, SimplexMesh, Vector};

/// Returns the extent of points along a direction.
pub(crate) fn extent<const D: usize>(points: &[Point<D>], direction: &Vector<D>) -> f64 {
    let along = points.iter().map(|x| x.dot(direction));
    let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], a| [low.min(a), high.max(a)]);
    high - low
}

/// Thickness `d` of the layers of cells of a background in films.
///
/// A gradient of the pressure drives a flow whose velocity is a parabola across the film. Linear interpolation of the
/// parabola in a layer of thickness `d` lacks the flux `d²/12`, per thickness and gradient over viscosity. For cells of
/// any shape the missing flux is the mean of `|∇(q - I q)|²` with `q = s²/2` and the distance `s` across the film,
/// because the flux of a solution equals its Dirichlet integral. The thickness is the `d` for which `d²/12` is this
/// mean, taken over the cells around the vertices of a cell. For cells with faces along the film it is the extent of
/// the cell. For halves of squares that the film crosses at an angle it is 20 % less to 12 % more.
pub(crate) struct Layers<'m, const D: usize> {
    background: &'m SimplexMesh<D>,
    /// The cells around each vertex.
    around: Vec<Vec<CellId>>,
}

impl<'m, const D: usize> Layers<'m, D> {
    /// Collects the cells around all vertices.
    pub(crate) fn new(background: &'m SimplexMesh<D>) -> Self {
        let mut around = vec![Vec::new(); background.n_vertices()];
        for cell in background.cells() {
            background.cell(cell).iter().for_each(|vertex| around[vertex.index()].push(cell));
        }
        Self { background, around }
    }

    /// Returns the thickness of the layer of a cell in a film with a unit normal.
    ///
    /// In a cube of tetrahedra with faces along the film, single cells lack 0.6 or 1.2 times the flux that the layer
    /// lacks. The mean over the cells around a vertex is exact, also at walls along the film.
    pub(crate) fn thickness(&self, cell: CellId, normal: &Vector<D>) -> f64 {
        let around_vertex = |cells: &Vec<CellId>| {
            let volumes = cells.iter().map(|cell| (self.background.cell_volume(*cell), *cell));
            let errors =
                volumes.map(|(volume, cell)| [volume, volume * interpolation_error(self.background, cell, normal)]);
            let [volume, error] = errors.fold([0.0, 0.0], |[v, e], [volume, error]| [v + volume, e + error]);
            error / volume
        };
        let vertices = self.background.cell(cell).iter().map(|vertex| &self.around[vertex.index()]);
        (12.0 * vertices.map(around_vertex).sum::<f64>() / (D + 1) as f64).sqrt()
    }
}

/// Returns the mean of `|∇(q - I q)|²` in a cell, with `q = s²/2`, the distance `s` along a direction, and the linear
/// interpolation `I q` at the vertices.
///
/// `q - I q = -1/2 Σ_{i<j} s_ij² N_i N_j` with the distances `s_ij` between vertices, and its gradient is
/// `Σ_i N_i b_i` with `b_i = -1/2 Σ_j s_ij² ∇N_j`.
fn interpolation_error<const D: usize>(background: &SimplexMesh<D>, cell: CellId, direction: &Vector<D>) -> f64 {
    let simplex = background.simplex(cell);
    let Some(gradients) = simplex.barycentric_gradients() else { return 0.0 };
    let points = simplex.points();
    let squared = |i: usize, j: usize| (points[j] - points[i]).dot(direction).powi(2);
    let mut b = [Vector::<D>::zeros(); MAX_CELL_VERTICES];
    for (i, b) in b[..=D].iter_mut().enumerate() {
        *b = (0..=D).map(|j| gradients[j] * (-0.5 * squared(i, j))).sum();
    }
    // ∫ N_i N_j = V (1 + δ_ij)/((D + 1)(D + 2))
    let sum: Vector<D> = b[..=D].iter().sum();
    let squares: f64 = b[..=D].iter().map(Vector::norm_squared).sum();
    (sum.norm_squared() + squares) / ((D + 1) * (D + 2)) as f64
}

#[cfg(test)]
mod tests {
    use mesh::generate::structured_box;

    use super::*;

    #[test]
    fn the_layer_of_cells_along_a_film_has_their_extent() {
        let plane = structured_box::<2>([0.0; 2], [4.0, 1.0], [4, 4]).expect("a box");
        let layers = Layers::new(&plane);
        for cell in plane.cells() {
            let found = layers.thickness(cell, &Vector::from([0.0, 1.0]));
            assert!((found - 0.25).abs() < 1e-14, "{found}");
        }
    }

    #[test]
    fn layers_in_space_have_the_extent_of_their_cells_also_at_walls() {
        let space = structured_box::<3>([0.0; 3], [5.0, 5.0, 3.0], [5, 5, 3]).expect("a box");
        let layers = Layers::new(&space);
        let is_inside = |x: f64| x > 0.9 && x < 4.1;
        let mut n_checked = 0;
        for cell in space.cells() {
            // At the sides across the film some tetrahedra around a vertex are missing.
            if space.simplex(cell).points().iter().all(|x| is_inside(x[0]) && is_inside(x[1])) {
                let found = layers.thickness(cell, &Vector::from([0.0, 0.0, 1.0]));
                assert!((found - 1.0).abs() < 1e-13, "{found}");
                n_checked += 1;
            }
        }
        assert_eq!(n_checked, 6 * 9 * 3);
    }

    #[test]
    fn the_interpolation_error_is_that_of_a_fine_quadrature() {
        let plane = structured_box::<2>([0.0; 2], [1.0; 2], [1; 2]).expect("a box");
        let rule = mesh::SimplexRule::of_degree(2, 2);
        for angle in [-0.5_f64, 0.2, 0.8] {
            let n = Vector::from([-angle.sin(), angle.cos()]);
            for cell in plane.cells() {
                let simplex = plane.simplex(cell);
                let gradients = simplex.barycentric_gradients().expect("a triangle");
                let s = |x: &Point<2>| x.dot(&n);
                let of_linear: Vector<2> = (0..3).map(|i| gradients[i] * (0.5 * s(&simplex.points()[i]).powi(2))).sum();
                let mut exact = 0.0;
                rule.for_each_point(simplex.points(), |x, weight| {
                    exact += weight * (n * s(&x) - of_linear).norm_squared()
                });
                let found = interpolation_error(&plane, cell, &n) * simplex.volume();
                assert!((found - exact).abs() < 1e-14, "{found} for {exact}");
            }
        }
    }
}
