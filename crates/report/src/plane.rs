//! Geometry of pictures in the plane of the first two axes.

use mesh::Point;
use solver::body::Body;
use solver::{FluidBoundary, Setup};

/// Returns the position of the left or right side if it is a plane of symmetry. Pictures then include the mirror image.
pub fn mirror<const D: usize>(setup: &Setup<D>) -> Option<f64> {
    let fluid = setup.fluid.as_ref()?;
    let (tag, _) = fluid
        .boundary
        .iter()
        .find(|(_, c)| matches!(c, FluidBoundary::Symmetry { normal } if normal[0].abs() == 1.0))?;
    let facet = fluid.background.facets().find(|f| fluid.background.facet_tag(*f) == Some(*tag))?;
    Some(fluid.background.vertex(fluid.background.facet(facet)[0])[0])
}

/// Returns the edges of a planar body, without those on the plane of symmetry.
pub fn outline<const D: usize>(body: &dyn Body<D>, positions: &[Point<D>], mirror: Option<f64>) -> Vec<[[f64; 2]; 2]> {
    let on_plane = |x: &[f64; 2]| mirror.is_some_and(|plane| (x[0] - plane).abs() < 1e-9);
    let boundary = body.surface();
    let edges = boundary.facets().map(|facet| {
        let ends = boundary.facet(facet);
        [0, 1].map(|k| [positions[ends[k].index()][0], positions[ends[k].index()][1]])
    });
    edges.filter(|ends| !ends.iter().all(on_plane)).collect()
}
