//! `cutwater cut`

use cutwater::io::Error;
use cutwater::io::cut::{BackgroundSource, CutSeconds, CutSettings, CutSummary, cut_files};

use super::print;
use crate::CutArguments;

/// Cuts a mesh by surfaces and prints the results.
pub(crate) fn cut(arguments: &CutArguments) -> Result<(), Error> {
    let background = match &arguments.background {
        Some(path) => BackgroundSource::File(path.clone()),
        // The command line has one of the two; a grid of zero cubes is an error.
        None => BackgroundSource::Grid(arguments.grid.unwrap_or(0)),
    };
    let CutArguments { rotate, shift, flip, .. } = *arguments;
    let settings = CutSettings { background, rotate, shift, flip };
    let result = cut_files(&arguments.surfaces, &settings)?;
    if let Some(directory) = &arguments.out {
        result.write_vtk(directory)?;
    }
    if arguments.json {
        print(&result.summary.to_json()?)?;
    } else {
        print_table(&result.summary)?;
    }
    result.summary.max_relative_error.check()
}

fn print_table(summary: &CutSummary) -> Result<(), Error> {
    let CutSummary { cells, cut_cells, covered_cells, parts_max, seconds, max_relative_error, .. } = summary;
    print(&format!(
        "cells         {cells}: {cut_cells} cut, {covered_cells} covered, at most {parts_max} parts in one"
    ))?;
    print(&format!("volume        domain {}, fluid {}", summary.domain_volume, summary.fluid_volume))?;
    print(&format!("              solid {}, wet area {}", summary.solid_volume, summary.surface_area))?;
    print(&format!("smallest part {:.3e} of its cell", summary.smallest_fraction))?;
    let CutSeconds { classify, clip, quadrature, .. } = *seconds;
    print(&format!("time          classify {classify:.3} s, cut {clip:.3} s, quadrature {quadrature:.3} s"))?;
    print("errors        relative, largest")?;
    for (name, error, meaning) in [
        ("partition", max_relative_error.partition, "parts and covered pieces make up each cell"),
        ("normals", max_relative_error.normals, "the interface is closed"),
        ("divergence", max_relative_error.divergence, "interface and volume belong together"),
        ("adjacency", max_relative_error.adjacency, "both cells of a face have the same fluid on it"),
    ] {
        print(&format!("  {name:<11} {error:8.1e}  {meaning}"))?;
    }
    Ok(())
}
