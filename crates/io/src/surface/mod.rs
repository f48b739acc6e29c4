//! Triangulated surfaces from files: STL (ASCII and binary) and OBJ.

mod lines;
mod obj;
mod stl;

use std::collections::HashMap;
use std::path::Path;

use mesh::{BoundaryMesh, Placed, Point, VertexId};

use crate::Error;
use crate::files::{extension, read};

/// A surface without a volume mesh: vertices and oriented triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    positions: Vec<Point<3>>,
    boundary: BoundaryMesh<3>,
}

impl Surface {
    /// Reads a surface by the extension of its name, `stl` or `obj`.
    ///
    /// Vertices with bitwise equal coordinates become one, so that neighbouring triangles share them. Triangles with
    /// two equal vertices are left out. `cutcell` checks that the surface is closed.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Surface`] with the line (or byte) and the cause.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = read(path)?;
        let triangles = match extension(path).as_str() {
            "stl" => stl::parse(&bytes),
            "obj" => obj::parse(&bytes),
            _ => Err("its name must end in .stl or .obj".to_owned()),
        };
        let triangles = triangles.map_err(|problem| Error::Surface { path: path.to_owned(), problem })?;
        Ok(Self::weld(&triangles))
    }

    /// Creates a surface from the corners of its triangles, as [`Self::read`] does.
    pub fn weld(triangles: &[[[f64; 3]; 3]]) -> Self {
        let mut positions: Vec<Point<3>> = Vec::new();
        let mut facets: Vec<VertexId> = Vec::with_capacity(3 * triangles.len());
        let mut known: HashMap<[u64; 3], VertexId> = HashMap::new();
        for corners in triangles {
            let ids = corners.map(|x| {
                // Adding zero turns a negative zero into a positive one.
                *known.entry(x.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    positions.push(Point::<3>::from(x));
                    VertexId::new(positions.len() - 1)
                })
            });
            if ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0] {
                facets.extend(ids);
            }
        }
        Self { positions, boundary: BoundaryMesh::from_facets(facets) }
    }

    /// Returns the surface with all normals reversed.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let facets = self.boundary.facets().flat_map(|f| {
            let v = self.boundary.facet(f);
            [v[0], v[2], v[1]]
        });
        Self { positions: self.positions.clone(), boundary: BoundaryMesh::from_facets(facets.collect()) }
    }

    /// Returns the surface with every vertex moved.
    #[must_use]
    pub fn moved(&self, map: impl Fn(&Point<3>) -> Point<3>) -> Self {
        Self { positions: self.positions.iter().map(map).collect(), boundary: self.boundary.clone() }
    }

    /// Returns the positions of the vertices.
    pub fn positions(&self) -> &[Point<3>] {
        &self.positions
    }

    /// Returns the triangles.
    pub fn boundary(&self) -> &BoundaryMesh<3> {
        &self.boundary
    }

    /// Returns the triangles with their positions, the input of `cutcell`.
    pub fn placed(&self) -> Placed<'_, 3> {
        Placed::new(&self.boundary, &self.positions)
    }
}
