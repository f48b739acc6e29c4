//! Cuts a box of tetrahedra by a surface from an STL (or OBJ) file and writes the pieces for ParaView:
//! `cargo run --release -p io --example cut_stl -- SURFACE [CUBES [DIRECTORY]]`.

// An example prints its results.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use io::cut::{BackgroundSource, CutSettings, cut_files};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let surface = arguments.next().ok_or("give a closed surface, .stl or .obj")?;
    let n_cubes = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let directory = PathBuf::from(arguments.next().unwrap_or_else(|| "cut".to_owned()));

    let settings = CutSettings { flip: true, ..CutSettings::new(BackgroundSource::Grid(n_cubes)) };
    let result = cut_files(&[&surface], &settings)?;
    result.write_vtk(&directory)?;

    let summary = &result.summary;
    println!("{surface}: volume {}, area {}", summary.solid_volume, summary.surface_area);
    println!("{} of {} cells are cut, {} covered", summary.cut_cells, summary.cells, summary.covered_cells);
    println!("smallest part {:.1e} of its cell", summary.smallest_fraction);
    println!("fluid.vtu, body.vtu and interface.vtu are in {}", directory.display());
    Ok(())
}
