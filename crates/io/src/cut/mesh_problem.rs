//! Defects of background meshes in files.

use vtkio::model::CellType;

/// Defects of a mesh file.
#[derive(Debug, thiserror::Error)]
pub enum MeshProblem {
    /// The format does not follow from the name of the file.
    #[error("its name must end in .vtu or .vtk")]
    Name,
    /// It is no VTK file, or not one that can be read.
    #[error("{0}")]
    Vtk(Box<vtkio::Error>),
    /// It holds a structured grid, a surface, or several pieces. Save one unstructured grid.
    #[error("it does not hold one unstructured grid")]
    DataSet,
    /// Arrays contradict each other: lengths, or numbers of points that are not there. Legacy files after version 4.2
    /// list their cells in another way, and look like this.
    #[error("its points and cells contradict each other, or it is a legacy file after version 4.2; save it as .vtu")]
    Arrays,
    /// A cell of three dimensions is no tetrahedron. Split it.
    #[error("cell {cell} is no tetrahedron but of type {kind:?}; save tetrahedra with 4 points")]
    CellType {
        /// Number of the cell in the file, from 0.
        cell: usize,
        /// Type of the cell.
        kind: CellType,
    },
    /// The tetrahedra are no mesh.
    #[error(transparent)]
    Mesh(#[from] mesh::Error),
}
