//! Meshes of tetrahedra from VTK files.

use std::cell::Cell;
use std::panic::{self, UnwindSafe};
use std::path::Path;
use std::sync::Once;

use mesh::{Point, Simplex, SimplexMesh, VertexId};
use vtkio::model::{CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers};

use crate::Error;
use crate::files::{extension, read};

const CONTRADICTION: &str =
    "its points and cells contradict each other, or it is a legacy file after version 4.2; save it as .vtu";

/// Reads the tetrahedra of an unstructured grid, `.vtu` (plain or with zlib) or legacy `.vtk` (to version 4.2).
///
/// Points, lines, triangles and quadrilaterals are left out, which mesh generators write in addition to the tetrahedra;
/// tetrahedra that are inside out are turned.
///
/// # Errors
/// [`Error::Read`]; [`Error::MeshFile`] for files without one unstructured grid of tetrahedra.
pub fn read_tetrahedra(path: &Path) -> Result<SimplexMesh<3>, Error> {
    parse(path, &read(path)?).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
}

fn parse(path: &Path, bytes: &[u8]) -> Result<SimplexMesh<3>, String> {
    let parse = match extension(path).as_str() {
        "vtu" => |bytes: &[u8]| vtkio::Vtk::parse_xml(bytes),
        "vtk" => |bytes: &[u8]| vtkio::Vtk::parse_legacy_be(bytes),
        _ => return Err("its name must end in .vtu or .vtk".to_owned()),
    };
    // The parser does not check the lengths in compressed arrays, and panics where they are wrong.
    let parsed = quietly(|| parse(bytes)).ok_or(CONTRADICTION)?;
    let pieces = match parsed.map_err(|error| error.to_string())?.data {
        DataSet::UnstructuredGrid { pieces, .. } => pieces,
        _ => Vec::new(),
    };
    match <[Piece<UnstructuredGridPiece>; 1]>::try_from(pieces) {
        Ok([Piece::Inline(piece)]) => tetrahedra(&piece),
        _ => Err("it does not hold one unstructured grid".to_owned()),
    }
}

thread_local! {
    /// Whether the thread runs code of which a panic is an error of the input, and prints nothing.
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a function, and returns `None` if it panics. The panic prints nothing; those of other threads are shown as before.
fn quietly<T>(run: impl FnOnce() -> T + UnwindSafe) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let shown = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_QUIET.get() {
                shown(info);
            }
        }));
    });
    IS_QUIET.set(true);
    let done = panic::catch_unwind(run);
    IS_QUIET.set(false);
    done.ok()
}

fn tetrahedra(piece: &UnstructuredGridPiece) -> Result<SimplexMesh<3>, String> {
    let coordinates: Vec<f64> = piece.points.cast_into().ok_or(CONTRADICTION)?;
    let vertices: Vec<Point<3>> = coordinates.chunks_exact(3).map(Point::<3>::from_column_slice).collect();
    let cells = corners(&piece.cells.cell_verts).filter(|cells| cells.len() >= piece.cells.types.len());
    let mut cell_to_vertex = Vec::with_capacity(4 * piece.cells.types.len());
    for (cell, (kind, ids)) in piece.cells.types.iter().zip(cells.ok_or(CONTRADICTION)?).enumerate() {
        match kind {
            CellType::Tetra => cell_to_vertex.extend(outwards(&ids, &vertices).ok_or(CONTRADICTION)?),
            CellType::Vertex | CellType::PolyVertex | CellType::Line | CellType::PolyLine => {}
            CellType::Triangle | CellType::Quad => {}
            _ => {
                return Err(format!(
                    "cell {cell} is no tetrahedron but of type {kind:?}; save tetrahedra with 4 points"
                ));
            }
        }
    }
    SimplexMesh::new(vertices, cell_to_vertex).map_err(|error| error.to_string())
}

/// Returns the points of each cell; `None` if there are not enough numbers.
fn corners(numbers: &VertexNumbers) -> Option<Vec<Vec<u64>>> {
    let mut cells = Vec::new();
    match numbers {
        VertexNumbers::Legacy { vertices, .. } => {
            let mut rest = vertices.as_slice();
            while let Some((n, after)) = rest.split_first() {
                let (ids, next) = after.split_at_checked(*n as usize)?;
                cells.push(ids.iter().map(|id| u64::from(*id)).collect());
                rest = next;
            }
        }
        VertexNumbers::XML { connectivity, offsets } => {
            let mut start = 0;
            for offset in offsets {
                let end = usize::try_from(*offset).ok()?;
                cells.push(connectivity.get(start..end)?.to_vec());
                start = end;
            }
        }
    }
    Some(cells)
}

/// Returns four vertices in the order of a positive volume; `None` if they are not four, or not there.
fn outwards(ids: &[u64], vertices: &[Point<3>]) -> Option<[VertexId; 4]> {
    let numbers = ids.iter().map(|id| usize::try_from(*id).ok()).collect::<Option<Vec<usize>>>()?;
    let points = numbers.iter().map(|k| vertices.get(*k).copied()).collect::<Option<Vec<Point<3>>>>()?;
    let mut cell: [VertexId; 4] = <[usize; 4]>::try_from(numbers).ok()?.map(VertexId::new);
    if Simplex::new(&points).volume() < 0.0 {
        cell.swap(2, 3);
    }
    Some(cell)
}
