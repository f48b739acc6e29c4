//! Meshes of tetrahedra from VTK files.

use std::path::Path;

use mesh::{Point, Simplex, SimplexMesh, VertexId};
use vtkio::model::{CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers};

use super::MeshProblem;
use crate::Error;

/// Reads the tetrahedra of an unstructured grid, `.vtu` (plain or with zlib) or legacy `.vtk` (to version 4.2). Points, lines, triangles and quadrilaterals are
/// left out, which mesh generators write in addition to the tetrahedra; tetrahedra that are inside out are turned.
///
/// # Errors
/// [`Error::Read`]; [`Error::MeshFile`] for files without one unstructured grid of tetrahedra.
pub fn read_tetrahedra(path: &Path) -> Result<SimplexMesh<3>, Error> {
    let refused = |problem| Error::MeshFile { path: path.to_owned(), problem };
    let bytes = std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let parse = match extension.as_deref() {
        Some("vtu") => |bytes: &[u8]| vtkio::Vtk::parse_xml(bytes),
        Some("vtk") => |bytes: &[u8]| vtkio::Vtk::parse_legacy_be(bytes),
        _ => return Err(refused(MeshProblem::Name)),
    };
    // The parser takes the lengths in compressed arrays at their word, and panics where they are wrong.
    let parsed = std::panic::catch_unwind(|| parse(&bytes)).map_err(|_| refused(MeshProblem::Arrays))?;
    let vtk = parsed.map_err(|source| refused(MeshProblem::Vtk(Box::new(source))))?;
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { return Err(refused(MeshProblem::DataSet)) };
    let Ok([Piece::Inline(piece)]) = <[Piece<UnstructuredGridPiece>; 1]>::try_from(pieces) else {
        return Err(refused(MeshProblem::DataSet));
    };
    tetrahedra(&piece).map_err(refused)
}

fn tetrahedra(piece: &UnstructuredGridPiece) -> Result<SimplexMesh<3>, MeshProblem> {
    let coordinates: Vec<f64> = piece.points.cast_into().ok_or(MeshProblem::Arrays)?;
    let vertices: Vec<Point<3>> = coordinates.chunks_exact(3).map(Point::<3>::from_column_slice).collect();
    let mut cell_to_vertex = Vec::with_capacity(4 * piece.cells.types.len());
    let mut corners = Corners::new(&piece.cells.cell_verts);
    for (cell, &kind) in piece.cells.types.iter().enumerate() {
        let ids = corners.next().ok_or(MeshProblem::Arrays)?;
        match kind {
            CellType::Tetra => cell_to_vertex.extend(outwards(&ids, &vertices).ok_or(MeshProblem::Arrays)?),
            CellType::Vertex | CellType::PolyVertex | CellType::Line | CellType::PolyLine => {}
            CellType::Triangle | CellType::Quad => {}
            _ => return Err(MeshProblem::CellType { cell, kind }),
        }
    }
    Ok(SimplexMesh::new(vertices, cell_to_vertex)?)
}

/// Four vertices in the order of a positive volume; `None` if they are not four, or not there.
fn outwards(ids: &[u64], vertices: &[Point<3>]) -> Option<[VertexId; 4]> {
    let mut corners = [Point::<3>::zeros(); 4];
    let mut cell = [VertexId(0); 4];
    if ids.len() != cell.len() {
        return None;
    }
    for ((corner, vertex), &id) in corners.iter_mut().zip(&mut cell).zip(ids) {
        let index = usize::try_from(id).ok()?;
        *corner = *vertices.get(index)?;
        *vertex = VertexId::new(index);
    }
    if Simplex::new(&corners).volume() < 0.0 {
        cell.swap(2, 3);
    }
    Some(cell)
}

/// The points of one cell after the other, in either way of listing them.
struct Corners<'a> {
    numbers: &'a VertexNumbers,
    /// Cells seen.
    cell: usize,
    /// Numbers seen.
    at: usize,
}

impl<'a> Corners<'a> {
    fn new(numbers: &'a VertexNumbers) -> Self {
        Self { numbers, cell: 0, at: 0 }
    }

    /// Points of the next cell; `None` if there are not enough numbers.
    fn next(&mut self) -> Option<Vec<u64>> {
        let start = self.at;
        let ids: Option<Vec<u64>> = match self.numbers {
            VertexNumbers::Legacy { vertices, .. } => {
                let count = *vertices.get(start)? as usize;
                self.at = start.checked_add(1 + count)?;
                vertices.get(start + 1..self.at).map(|ids| ids.iter().map(|&id| u64::from(id)).collect())
            }
            VertexNumbers::XML { connectivity, offsets } => {
                self.at = usize::try_from(*offsets.get(self.cell)?).ok()?;
                connectivity.get(start..self.at).map(<[u64]>::to_vec)
            }
        };
        self.cell += 1;
        ids
    }
}
