//! The facets of a file as a closed surface.

use std::collections::HashMap;

use mesh::{BoundaryMesh, Point, VertexId};

use super::file::GmshFile;
use super::mesh::place;

impl GmshFile {
    /// Returns the surface formed by the lines (`D = 2`) or triangles (`D = 3`), with the positions of its vertices.
    /// All facets of a connected part have the orientation of its first one.
    ///
    /// # Errors
    /// A text with cause, place and remedy, if there are no facets, or the surface is open or branches.
    pub fn surface<const D: usize>(&self) -> Result<(BoundaryMesh<D>, Vec<Point<D>>), String> {
        let elements = &self.elements[D - 1];
        if elements.numbers.is_empty() {
            return Err(format!(
                "it has neither cells of dimension {D} nor a surface; make the mesh before it is saved"
            ));
        }
        let (positions, vertex_of) = self.corners::<D>(elements, D);
        let mut facets: Vec<Vec<VertexId>> =
            elements.nodes().map(|nodes| nodes[..D].iter().map(|node| vertex_of[*node]).collect()).collect();
        let mut at_ridge: HashMap<Vec<VertexId>, Vec<usize>> = HashMap::new();
        for (k, facet) in facets.iter().enumerate() {
            ridges(facet).for_each(|(ridge, _)| at_ridge.entry(ridge).or_default().push(k));
        }
        // In the order of the facets, so that the place in the message is the same for each run.
        for (ridge, _) in facets.iter().flat_map(|facet| ridges(facet)) {
            let n = at_ridge[&ridge].len();
            if n != 2 {
                let (problem, place) =
                    (if n < 2 { "is open" } else { "branches" }, place(&positions[ridge[0].index()]));
                return Err(format!("its surface {problem} at {place}; close it, or make a mesh of the inside"));
            }
        }
        let mut is_oriented = vec![false; facets.len()];
        for first in 0..facets.len() {
            let mut pending = vec![first];
            is_oriented[first] = true;
            while let Some(k) = pending.pop() {
                for (ridge, direction) in ridges(&facets[k]).collect::<Vec<_>>() {
                    for &other in at_ridge[&ridge].iter().filter(|other| **other != k) {
                        if std::mem::replace(&mut is_oriented[other], true) {
                            continue;
                        }
                        let same = ridges(&facets[other])
                            .any(|(found, found_direction)| found == ridge && found_direction == direction);
                        if same {
                            facets[other].swap(0, 1);
                        }
                        pending.push(other);
                    }
                }
            }
        }
        Ok((BoundaryMesh::from_facets(facets.concat()), positions))
    }
}

/// Returns the ends of a segment or the sides of a triangle, in ascending order of their vertices, each with its
/// direction in the facet.
fn ridges(facet: &[VertexId]) -> impl Iterator<Item = (Vec<VertexId>, bool)> {
    let n = facet.len();
    (0..n).map(move |k| match n {
        2 => (vec![facet[k]], k == 0),
        _ => {
            let (a, b) = (facet[k], facet[(k + 1) % n]);
            (vec![a.min(b), a.max(b)], a < b)
        }
    })
}
