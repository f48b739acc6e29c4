//! Flux along a thin film.

use algebra::{LocalSystem, Term};
use mesh::Vector;

use super::ForceFunction;
use crate::FluidCell;

/// `(κ (∇p - f^f), ∇q)_{Ω^f} - (κ_s (∇p - f^f), ∇q)_Σ` with `κ = χ max(d, min(k, h))²/(12 μ^f)` and
/// `κ_s = χ s ℓ d²/(12 μ^f)`: the part of the flux along a film that linear velocities do not represent
///
/// Source: Reynolds' equation `∇·(δ³/(12 μ) ∇p) = ∂δ/∂t + ∇·(δ (v_1 + v_2)/2)` is the sum of this term and `(q, ∇·u)`
/// across the film. As there, the missing flux has no inertia.
/// Symbols: share `χ` of the missing flux that is added, thickness `d` of a layer of cells, height `k` of the
/// asperities, extent `h` of the cell across the film; share `s` and length `ℓ` of the slip on surfaces `Σ` of bodies,
/// see [`crate::FilmValues::subtract_slip`].
/// Couples: pressure × pressure.   Domain: fluid parts in films, and surfaces of bodies in them.
/// Units: volume/time (2D: per unit depth).
/// In the last part of a film that ends at an edge, `∇p`, `f` and `∇q` are those of [`crate::FilmPart::acting`].
/// With `g_i = ∇N_i`, `K = ∫_Ω κ - ∫_Σ κ_s`, `F = ∫_Ω κ f - ∫_Σ κ_s f`:   residual_i = g_i · (K ∇p - F),   tangent_ij =
/// K g_i · g_j.
pub struct Film<'a, const D: usize> {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
    /// Force per volume at a point and time; `None` for no force.
    pub force: Option<ForceFunction<'a, D>>,
    /// Time of the stage.
    pub time: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Film<'_, D> {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some(film) = cell.film else { return };
        let g = cell.gradients.map(|g| film.acting(g));
        let g = &g[..=D];
        let gradient: Vector<D> = g.iter().zip(&cell.pressures).map(|(g, p)| g * *p).sum();
        let (mut conductance, mut flux) = (0.0, Vector::zeros());
        for (x, weight) in &film.points {
            let weight = weight / self.viscosity;
            conductance += weight;
            flux += self.force.map_or_else(Vector::zeros, |force| film.acting(force(x, self.time)) * -weight);
        }
        flux += gradient * conductance;
        for (i, g_i) in g.iter().enumerate() {
            out.add(cell.pressure_row(i), g_i.dot(&flux));
            if !out.has_tangent() {
                continue;
            }
            for (j, g_j) in g.iter().enumerate() {
                out.add_tangent(cell.pressure_row(i), cell.pressure_row(j), conductance * g_i.dot(g_j));
            }
        }
    }
}
