//! Field files for ParaView: one `.vtu` per series and output time, and a `.pvd` index per series.

#[cfg(feature = "simulation")]
pub mod bodies;
pub mod cut;
#[cfg(feature = "simulation")]
pub mod fluid;
#[cfg(feature = "simulation")]
pub mod interface;
pub mod series;
#[cfg(feature = "simulation")]
pub mod surface;

use std::path::Path;

use cutcell::Polytope;
use mesh::{Point, Vector};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

use crate::Error;
use crate::files::{write_whole, write_with};

/// An unstructured grid to be written.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    points: Vec<f64>,
    connectivity: Vec<u64>,
    offsets: Vec<u64>,
    types: Vec<CellType>,
    point_data: Vec<Attribute>,
    cell_data: Vec<Attribute>,
}

impl Grid {
    /// Appends a point; returns its index.
    pub fn push_point<const D: usize>(&mut self, x: &Point<D>) -> u64 {
        let index = self.n_points() as u64;
        self.points.extend(in_space(x));
        index
    }

    /// Appends a cell; `points` are the indices of its corners.
    pub fn push_cell(&mut self, kind: CellType, points: impl IntoIterator<Item = u64>) {
        self.connectivity.extend(points);
        self.offsets.push(self.connectivity.len() as u64);
        self.types.push(kind);
    }

    /// Appends a convex piece: a polygon in 2D, tetrahedra in 3D. `point` appends a corner and returns its index.
    pub(crate) fn push_piece<const D: usize>(
        &mut self,
        piece: Polytope<'_, D>,
        mut point: impl FnMut(&mut Self, &Point<D>) -> u64,
    ) {
        let mut push = |kind, corners: &[Point<D>]| {
            let points: Vec<u64> = corners.iter().map(|x| point(self, x)).collect();
            self.push_cell(kind, points);
        };
        if D == 2 {
            push(CellType::Polygon, &ring(piece));
        } else {
            piece.for_each_simplex(|corners| push(CellType::Tetra, corners));
        }
    }

    /// Returns the number of points.
    pub fn n_points(&self) -> usize {
        self.points.len() / 3
    }

    /// Returns the number of cells.
    pub fn n_cells(&self) -> usize {
        self.types.len()
    }

    /// Adds a field with one value of `components` numbers per point.
    pub fn add_point_data(&mut self, name: &str, components: u32, values: Vec<f64>) {
        debug_assert_eq!(values.len(), self.n_points() * components as usize);
        self.point_data.push(attribute(name, components, values));
    }

    /// Adds a field with one value of `components` numbers per cell.
    pub fn add_cell_data(&mut self, name: &str, components: u32, values: Vec<f64>) {
        debug_assert_eq!(values.len(), self.n_cells() * components as usize);
        self.cell_data.push(attribute(name, components, values));
    }

    /// Adds a whole number per cell.
    pub fn add_cell_ids(&mut self, name: &str, values: Vec<i64>) {
        debug_assert_eq!(values.len(), self.n_cells());
        self.cell_data.push(Attribute::DataArray(DataArray::scalars(name, 1).with_data(values)));
    }

    /// Removes the fields whose names do not satisfy a condition; fields of whole numbers are kept. Returns `None` if
    /// no other field is left.
    #[cfg(feature = "simulation")]
    pub(crate) fn retain(mut self, is_kept: impl Fn(&str) -> bool) -> Option<Self> {
        let is_id = |attribute: &Attribute| matches!(attribute, Attribute::DataArray(array) if matches!(array.data, IOBuffer::I64(_)));
        let is_kept = |attribute: &Attribute| match attribute {
            Attribute::DataArray(array) => is_kept(&array.name),
            Attribute::Field { .. } => false,
        };
        self.point_data.retain(is_kept);
        self.cell_data.retain(|attribute| is_id(attribute) || is_kept(attribute));
        let is_empty = self.point_data.is_empty() && self.cell_data.iter().all(is_id);
        (!is_empty).then_some(self)
    }

    /// Writes the grid as `.vtu`, compressed by zlib of the given level (0: none).
    ///
    /// # Errors
    /// [`Error::Vtk`].
    pub fn write(self, path: &Path, compression: u32) -> Result<(), Error> {
        if self.n_cells() == 0 {
            return write_whole(path, self.empty().as_bytes());
        }
        let piece = UnstructuredGridPiece {
            points: self.points.into(),
            cells: Cells {
                cell_verts: VertexNumbers::XML { connectivity: self.connectivity, offsets: self.offsets },
                types: self.types,
            },
            data: Attributes { point: self.point_data, cell: self.cell_data },
        };
        let vtk = Vtk {
            version: Version::Auto,
            title: String::new(),
            byte_order: ByteOrder::LittleEndian,
            data: DataSet::inline(piece),
            file_path: None,
        };
        let written = vtk
            .try_into_xml_format(Compressor::ZLib, compression)
            .map_err(vtkio::Error::from)
            .and_then(|file| write_with(path, |out| file.write(out).map_err(vtkio::Error::from)));
        written.map_err(|source| Error::Vtk { path: path.to_owned(), source: Box::new(source) })
    }
}

impl Grid {
    /// Returns the text of a file without points and cells, with the names of the fields. Readers of VTK need the
    /// numbers of points and cells, zero, which vtkio does not write.
    fn empty(&self) -> String {
        let array = |attribute: &Attribute| match attribute {
            Attribute::DataArray(array) => {
                let kind = if matches!(array.data, IOBuffer::I64(_)) { "Int64" } else { "Float64" };
                let n = match array.elem {
                    ElementType::Scalars { num_comp, .. } => num_comp,
                    ElementType::Vectors => 3,
                    ElementType::Tensors => 9,
                    _ => 1,
                };
                format!(
                    "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{n}\" format=\"ascii\"/>",
                    array.name
                )
            }
            Attribute::Field { .. } => String::new(),
        };
        let arrays = |data: &[Attribute]| data.iter().map(array).collect::<String>();
        let (point_data, cell_data) = (arrays(&self.point_data), arrays(&self.cell_data));
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"0\" NumberOfCells=\"0\">\n<PointData>{point_data}</PointData>\n<CellData>{cell_data}</CellData>\n\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\"/></Points>\n\
             <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\"/><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\"/>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\"/></Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
        )
    }
}

fn attribute(name: &str, components: u32, values: Vec<f64>) -> Attribute {
    let array = match components {
        1 => DataArray::scalars(name, 1),
        3 => DataArray::vectors(name),
        9 => DataArray::tensors(name),
        n => DataArray::new(name, n),
    };
    Attribute::DataArray(array.with_data(values))
}

/// Returns a vector with three components.
fn in_space<const D: usize>(v: &Vector<D>) -> [f64; 3] {
    std::array::from_fn(|a| if a < D { v[a] } else { 0.0 })
}

/// Returns the type of a simplex with `n_points` points.
pub(crate) fn simplex_type(n_points: usize) -> CellType {
    match n_points {
        2 => CellType::Line,
        3 => CellType::Triangle,
        _ => CellType::Tetra,
    }
}

/// Returns the corners of a convex polygon, counter-clockwise.
fn ring<const D: usize>(piece: Polytope<'_, D>) -> Vec<Point<D>> {
    let edges: Vec<(u32, u32)> = piece.faces().map(|(_, corners)| (corners[0], corners[1])).collect();
    let mut at = edges.first().map_or(0, |edge| edge.0);
    let corner = |_| {
        let corner = piece.points()[at as usize];
        at = edges.iter().find(|edge| edge.0 == at).map_or(at, |edge| edge.1);
        corner
    };
    (0..edges.len()).map(corner).collect()
}
