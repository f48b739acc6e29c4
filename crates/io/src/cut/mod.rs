//! Cuts of a mesh of tetrahedra by closed surfaces from files, with checks of the cut: the command `cutwater cut`.
//!
//! ```no_run
//! use io::cut::{BackgroundSource, CutSettings, cut_files};
//! let settings = CutSettings::new(BackgroundSource::Grid(20));
//! let result = cut_files(&["bunny.stl"], &settings)?;
//! println!("{} of {} cells are cut", result.summary.cut_cells, result.summary.cells);
//! result.write_vtk("bunny".as_ref())?;
//! # Ok::<(), io::Error>(())
//! ```

mod background;
mod identities;
mod placement;
mod summary;

use std::path::{Path, PathBuf};

use cutcell::{CutMesh, Cutter, OverlayOptions};
use mesh::{Aabb, BodyId, Placed, SimplexMesh};

use crate::Error;
use crate::files::create_directory;
use crate::surface::Surface;
use crate::vtk::cut::{body_grid, fluid_grid, interface_grid};

pub use background::read_tetrahedra;
pub(crate) use background::{VtkMesh, read_vtk};
pub use identities::CutErrors;
pub use summary::{CutSeconds, CutSummary};

/// Extents of surfaces whose fourth powers are representable: the largest and smallest numbers in a cut.
const EXTENTS: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Largest coordinate, divided by the extent of a surface. The extent then has about six accurate digits.
const FARTHEST: f64 = 1e10;

/// Level of zlib in the field files.
const COMPRESSION: u32 = 4;

/// The mesh that the surfaces cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BackgroundSource {
    /// A box around the surfaces with this number of cubes along each axis, six tetrahedra each. The margin on every
    /// side is a tenth of the longest extent of the surfaces.
    Grid(usize),
    /// A mesh of tetrahedra, `.vtu` or `.vtk`.
    File(PathBuf),
}

/// Placement of surfaces over a background.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CutSettings {
    /// The background.
    pub background: BackgroundSource,
    /// Seed of a random rotation of all surfaces together about the centre of their box; all rotations are equally
    /// likely.
    pub rotate: Option<u64>,
    /// Seed of a random shift of all surfaces together, up to half a cell along each axis. They are shifted after the
    /// grid is built. On grids of less than six cubes they may then leave the grid, which is allowed.
    pub shift: Option<u64>,
    /// Whether surfaces that enclose a negative volume are turned inside out.
    pub flip: bool,
}

impl CutSettings {
    /// Creates settings that leave the surfaces as they are in their files.
    pub fn new(background: BackgroundSource) -> Self {
        Self { background, rotate: None, shift: None, flip: false }
    }
}

/// Surfaces, the background that they cut, and the cut.
#[derive(Clone, Debug)]
pub struct SurfaceCut {
    /// The surfaces at their final positions, one per body.
    pub surfaces: Vec<Surface>,
    /// The background.
    pub background: SimplexMesh<3>,
    /// The cut.
    pub cut: CutMesh<3>,
    /// Summary of the cut.
    pub summary: CutSummary,
}

/// Reads closed surfaces, one body each, and cuts a background by them.
///
/// # Errors
/// [`Error::Read`], [`Error::Surface`], [`Error::MeshFile`] for files that cannot be read; [`Error::Grid`] for an
/// invalid grid; [`Error::Cut`] for surfaces that are empty, open, non-manifold or turned inwards.
pub fn cut_files(paths: &[impl AsRef<Path>], settings: &CutSettings) -> Result<SurfaceCut, Error> {
    let refused = |source| Error::Cut { paths: paths.iter().map(|path| path.as_ref().to_owned()).collect(), source };
    let mut surfaces = Vec::with_capacity(paths.len());
    for (index, path) in paths.iter().enumerate() {
        let surface = Surface::read(path.as_ref())?;
        if surface.boundary().n_facets() == 0 {
            return Err(refused(cutcell::Error::Empty { body: BodyId::new(index) }));
        }
        let bounds = Aabb::of_points(surface.positions());
        let (extent, farthest) = (bounds.extent().amax(), bounds.low.amax().max(bounds.high.amax()));
        let refused_surface = |problem| Err(Error::Surface { path: path.as_ref().to_owned(), problem });
        if !EXTENTS.contains(&extent) {
            return refused_surface(format!(
                "its extent is {extent:e}, and volumes of that size have no accurate numbers; scale it to an extent from 1e-60 to 1e60"
            ));
        }
        if farthest > FARTHEST * extent {
            return refused_surface(format!(
                "its coordinates up to {farthest:e} have too few digits for its extent of {extent:e}; shift it to the origin"
            ));
        }
        let is_inward = settings.flip && surface.placed().enclosed().volume < 0.0;
        surfaces.push(if is_inward { surface.flipped() } else { surface });
    }
    if let Some(seed) = settings.rotate {
        placement::rotate(&mut surfaces, seed);
    }
    let background = match &settings.background {
        BackgroundSource::Grid(n) => placement::grid_around(&surfaces, *n)?,
        BackgroundSource::File(path) => read_tetrahedra(path)?,
    };
    if let Some(seed) = settings.shift {
        placement::shift(&mut surfaces, seed, &background);
    }
    let placed: Vec<Placed<'_, _>> = surfaces.iter().map(Surface::placed).collect();
    let mut cutter = Cutter::new();
    let cut = cutter.overlay(&background, &placed, &OverlayOptions::new()).map_err(refused)?;
    let summary = CutSummary::new(&background, &cut, cutter.times());
    Ok(SurfaceCut { surfaces, background, cut, summary })
}

impl SurfaceCut {
    /// Writes `fluid.vtu` (fluid parts), `body.vtu` (the covered region) and `interface.vtu` (interface pieces) into a
    /// directory, which is created; see [`crate::vtk::cut`] for the fields.
    ///
    /// # Errors
    /// [`Error::Write`], [`Error::Vtk`].
    pub fn write_vtk(&self, directory: &Path) -> Result<(), Error> {
        create_directory(directory)?;
        fluid_grid(&self.background, &self.cut).write(&directory.join("fluid.vtu"), COMPRESSION)?;
        body_grid(&self.background, &self.cut).write(&directory.join("body.vtu"), COMPRESSION)?;
        interface_grid(&self.cut).write(&directory.join("interface.vtu"), COMPRESSION)
    }
}
