//! Weak forms: terms summed over the sites where they are evaluated.

use crate::{Contributions, DofId, LocalSystem};

/// One line of a weak form: residual and tangent at one site, next to each other.
pub trait Term<Site>: Sync {
    /// Adds residual and tangent at a site. The sign is that of the left side of the equation.
    fn add(&self, site: &Site, out: &mut LocalSystem);
}

/// Places where a weak form is evaluated: cells, facets, interface points, contact points.
///
/// An item has one set of dofs and one site, or several (quadrature points).
pub trait Sites: Sync {
    /// State and geometry that a term reads at one place.
    type Site;

    /// Returns the number of items.
    fn len(&self) -> usize;

    /// Returns whether there are no items.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends the dofs of an item to `out`. They are distinct, and the same in every call.
    fn dofs(&self, item: usize, out: &mut Vec<DofId>);

    /// Calls `visit` with each site of an item at the state `x` (the global vector).
    fn visit(&self, item: usize, x: &[f64], visit: impl FnMut(&Self::Site));

    /// Returns a hash of the non-smooth state of an item at `x`; see [`Contributions::regime`].
    fn regime(&self, _item: usize, _x: &[f64]) -> Option<u64> {
        None
    }
}

/// Terms summed over sites: the [`Contributions`] of a weak form.
pub struct Integral<'a, S: Sites> {
    name: &'static str,
    pub(crate) sites: S,
    pub(crate) terms: Vec<&'a dyn Term<S::Site>>,
    is_linear: bool,
}

impl<'a, S: Sites> Integral<'a, S> {
    /// Creates an integral whose tangent depends on the state.
    pub fn new(name: &'static str, sites: S, terms: Vec<&'a dyn Term<S::Site>>) -> Self {
        Self { name, sites, terms, is_linear: false }
    }

    /// Creates an integral with a constant tangent.
    pub fn linear(name: &'static str, sites: S, terms: Vec<&'a dyn Term<S::Site>>) -> Self {
        Self { name, sites, terms, is_linear: true }
    }

    /// Appends a term, if there is one.
    pub fn extend(&mut self, term: Option<&'a impl Term<S::Site>>) {
        self.terms.extend(term.map(|term| term as &dyn Term<S::Site>));
    }
}

impl<S: Sites> Contributions for Integral<'_, S> {
    fn len(&self) -> usize {
        if self.terms.is_empty() { 0 } else { self.sites.len() }
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        self.sites.dofs(item, out);
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        self.sites.visit(item, x, |site| self.terms.iter().for_each(|term| term.add(site, out)));
    }

    fn is_linear(&self) -> bool {
        self.is_linear
    }

    fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
        self.sites.regime(item, x)
    }

    fn name(&self) -> &'static str {
        self.name
    }
}
