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
/// Points, lines, triangles and quadrilaterals, which mesh generators write in addition to the tetrahedra, are ignored.
/// Corners of tetrahedra with negative volume are reordered.
///
/// # Errors
/// [`Error::Read`]; [`Error::MeshFile`] for files without one unstructured grid of tetrahedra.
pub fn read_tetrahedra(path: &Path) -> Result<SimplexMesh<3>, Error> {
    match read_vtk(path)? {
        VtkMesh::Space(mesh) => Ok(mesh),
        VtkMesh::Plane(_) => {
            let problem = "its triangles lie in a plane, and there are no tetrahedra; save tetrahedra".to_owned();
            Err(Error::MeshFile { path: path.to_owned(), problem })
        }
    }
}

/// Mesh of a VTK file.
pub(crate) enum VtkMesh {
    /// Triangles in a plane of constant `z`.
    Plane(SimplexMesh<2>),
    /// Tetrahedra.
    Space(SimplexMesh<3>),
}

/// Reads the tetrahedra of a VTK file as [`read_tetrahedra`] does, or the triangles if there are no tetrahedra.
pub(crate) fn read_vtk(path: &Path) -> Result<VtkMesh, Error> {
    parse(path, &read(path)?).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
}

fn parse(path: &Path, bytes: &[u8]) -> Result<VtkMesh, String> {
    let parse = match extension(path).as_str() {
        "vtu" => |bytes: &[u8]| vtkio::Vtk::parse_xml(bytes),
        "vtk" => |bytes: &[u8]| vtkio::Vtk::parse_legacy_be(bytes),
        _ => return Err("its name must end in .vtu or .vtk".to_owned()),
    };
    // The parser does not check the lengths in compressed arrays, and panics if they are wrong.
    let parsed = quietly(|| parse(bytes)).ok_or(CONTRADICTION)?;
    let pieces = match parsed.map_err(|error| error.to_string())?.data {
        DataSet::UnstructuredGrid { pieces, .. } => pieces,
        _ => Vec::new(),
    };
    match <[Piece<UnstructuredGridPiece>; 1]>::try_from(pieces) {
        Ok([Piece::Inline(piece)]) => simplices(&piece),
        _ => Err("it does not hold one unstructured grid".to_owned()),
    }
}

thread_local! {
    /// Whether the thread runs code whose panics are errors of the input and are not printed.
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a function, and returns `None` if it panics. The panic is not printed; panics of other threads are.
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

fn simplices(piece: &UnstructuredGridPiece) -> Result<VtkMesh, String> {
    let coordinates: Vec<f64> = piece.points.cast_into().ok_or(CONTRADICTION)?;
    let vertices: Vec<Point<3>> = coordinates.chunks_exact(3).map(Point::<3>::from_column_slice).collect();
    let flat: Vec<Point<2>> = vertices.iter().map(|x| Point::<2>::new(x[0], x[1])).collect();
    let cells = corners(&piece.cells.cell_verts).filter(|cells| cells.len() >= piece.cells.types.len());
    let (mut tetrahedra, mut triangles) = (Vec::new(), Vec::new());
    let mut level = None;
    let mut is_plane = true;
    for (cell, (kind, ids)) in piece.cells.types.iter().zip(cells.ok_or(CONTRADICTION)?).enumerate() {
        match kind {
            CellType::Tetra => tetrahedra.extend(outwards(&ids, &vertices).ok_or(CONTRADICTION)?),
            CellType::Triangle => {
                let Some(corners) = outwards(&ids, &flat) else {
                    is_plane = false;
                    continue;
                };
                let level = *level.get_or_insert(vertices[corners[0].index()][2]);
                is_plane &= corners.iter().all(|v| vertices[v.index()][2] == level);
                triangles.extend(corners);
            }
            CellType::Vertex | CellType::PolyVertex | CellType::Line | CellType::PolyLine | CellType::Quad => {}
            _ => {
                return Err(format!(
                    "cell {cell} is no tetrahedron but of type {kind:?}; save tetrahedra with 4 points"
                ));
            }
        }
    }
    if tetrahedra.is_empty() && !triangles.is_empty() {
        if !is_plane {
            return Err("it has triangles in space and no tetrahedra; save a surface as .stl, or tetrahedra".to_owned());
        }
        return SimplexMesh::new(flat, triangles).map(VtkMesh::Plane).map_err(|error| error.to_string());
    }
    SimplexMesh::new(vertices, tetrahedra).map(VtkMesh::Space).map_err(|error| error.to_string())
}

/// Returns the indices of the points of each cell; `None` if the lists are too short.
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

/// Returns the corners of a cell in the order of a positive volume; `None` if there are not `D + 1`, or one is missing.
fn outwards<const D: usize>(ids: &[u64], vertices: &[Point<D>]) -> Option<Vec<VertexId>> {
    let numbers = ids.iter().map(|id| usize::try_from(*id).ok()).collect::<Option<Vec<usize>>>()?;
    let points = numbers.iter().map(|k| vertices.get(*k).copied()).collect::<Option<Vec<Point<D>>>>()?;
    if numbers.len() != D + 1 {
        return None;
    }
    let mut cell: Vec<VertexId> = numbers.into_iter().map(VertexId::new).collect();
    if Simplex::new(&points).volume() < 0.0 {
        cell.swap(D - 1, D);
    }
    Some(cell)
}
