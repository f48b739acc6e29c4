//! Vapour in a thin film.

use algebra::{LocalSystem, Term};

use crate::FluidCell;

/// `-Σ_i q_i C K |g_i|² [p_c - p_i]_+`: vapour appears where the pressure of a film would fall below the floor `p_c`, and vanishes where it rises
///
/// Source: the condition of Reynolds (Gümbel), as a penalty: `p ≥ p_c`, the volume of the film grows at least as fast as fluid enters, and one of the two
/// with equality. The mass of the fluid is not kept in a cavity.
/// Couples: pressure × pressure, each vertex by itself.   Domain: fluid parts in films ([`crate::FilmValues`]).
/// Units: volume/time (2D: per unit depth).
/// With `g_i = ∇N_i`, `K = ∫ κ` and `d_i = C K |g_i|²`:   residual_i = -d_i [p_c - p_i]_+,   tangent_ii = d_i where p_i < p_c.
pub struct Cavitation {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
    /// Lowest pressure `p_c`.
    pub floor: f64,
    /// The number `C`: volume that vapour takes at a vertex, over the flux along the film that its difference from the floor would drive. Pressures fall
    /// below the floor by about `1/C` of the differences in the film.
    pub stiffness: f64,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Cavitation {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some(film) = cell.film else { return };
        let conductance: f64 = film.points.iter().map(|(_, weight)| weight / self.viscosity).sum();
        for (i, g) in cell.gradients[..=D].iter().enumerate() {
            let (row, below) = (cell.pressure_row(i), self.floor - cell.pressures[i]);
            if below <= 0.0 {
                continue;
            }
            let vapour = self.stiffness * conductance * g.norm_squared();
            out.add(row, -vapour * below);
            if out.has_tangent() {
                out.add_tangent(row, row, vapour);
            }
        }
    }
}
