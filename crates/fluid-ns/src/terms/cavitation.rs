//! Vapour in a thin film.

use algebra::{LocalSystem, Term};
use cutcell::PartId;

use crate::FluidCell;

/// `-Σ_i q_i C K |g_i|² [p_c - p_i]_+`: the volume of vapour that appears per time at vertices where the pressure of a
/// film is below the floor `p_c`
///
/// Source: the condition of Reynolds (Gümbel), as a penalty. The pressure is at least `p_c`, the volume of the film
/// grows at least as fast as fluid enters, and one of the two holds with equality. The mass of the fluid is not
/// conserved in a cavity.
/// Couples: pressure × pressure, each vertex by itself.   Domain: fluid parts in films ([`crate::FilmValues`]).
/// Units: volume/time (2D: per unit depth).
/// With `g_i = ∇N_i`, `K = ∫_Ω κ - ∫_Σ κ_s` of [`super::Film`] and `d_i = C K |g_i|²`:
///   residual_i = -d_i [p_c - p_i]_+,   tangent_ii = d_i where p_i < p_c.
pub struct Cavitation {
    /// Dynamic viscosity `μ^f`.
    pub viscosity: f64,
    /// Lowest pressure `p_c`.
    pub floor: f64,
    /// The number `C`: rate of the volume of vapour at a vertex, relative to the flux along the film that the same
    /// difference of pressure drives. Pressures fall below the floor by about `1/C` of the differences of pressure in
    /// the film.
    pub stiffness: f64,
    /// Parts of enclosed regions, sorted. No vapour appears there, because the fluid that it displaces has no outlet.
    pub enclosed: Vec<PartId>,
}

impl<const D: usize> Term<FluidCell<'_, D>> for Cavitation {
    fn add(&self, cell: &FluidCell<'_, D>, out: &mut LocalSystem) {
        let Some(film) = cell.film.filter(|_| self.enclosed.binary_search(&cell.part).is_err()) else { return };
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
