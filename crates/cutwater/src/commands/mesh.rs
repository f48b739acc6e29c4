//! `cutwater mesh`

use cutwater::io::Error;
use cutwater::io::gmsh::{GmshFormat, GmshVersion};
use cutwater::io::mesh_file::{MeshFile, MeshStatistics};

use super::print;
use crate::{ConvertArguments, MeshCommand, MeshVersion};

/// Prints statistics of a mesh, or converts it.
pub(crate) fn mesh(command: &MeshCommand) -> Result<(), Error> {
    match command {
        MeshCommand::Info { file } => {
            lines(&MeshFile::read(file)?.statistics()).iter().try_for_each(|line| print(line))
        }
        MeshCommand::Convert(ConvertArguments { from, to, version, binary }) => {
            let version = match version {
                MeshVersion::V22 => GmshVersion::V22,
                MeshVersion::V41 => GmshVersion::V41,
            };
            if from.canonicalize().is_ok_and(|from| to.canonicalize().is_ok_and(|to| to == from)) {
                let problem = "it is the mesh that is read; choose another name";
                return Err(Error::MeshOutput { path: to.clone(), problem });
            }
            let mesh = MeshFile::read(from)?;
            mesh.write(to, GmshFormat { version, is_binary: *binary })?;
            let MeshStatistics { order, cell_groups, boundary_groups, .. } = mesh.statistics();
            let has_groups = cell_groups.keys().chain(boundary_groups.keys()).any(Option::is_some);
            if to.extension().is_none_or(|extension| extension != "msh") && (order > 1 || has_groups) {
                print("note: only .msh files contain groups and nodes of order 2; they are left out")?;
            }
            Ok(())
        }
    }
}

/// Formats statistics.
fn lines(found: &MeshStatistics) -> Vec<String> {
    let (measure, side) = if found.dimension == 2 { ("area", "length") } else { ("volume", "area") };
    let MeshStatistics { elements, n_elements, n_vertices, n_parts, order, dimension, .. } = found;
    let mut lines = vec![
        format!("dimension   {dimension}"),
        format!("elements    {n_elements} {elements} of order {order}, in {n_parts} connected parts"),
        format!("vertices    {n_vertices}"),
        format!("{measure:<11} {:.6e}", found.volume),
    ];
    for (axis, [low, high]) in mesh::AXES.iter().zip(&found.extent) {
        lines.push(format!("{axis:<11} {low:.6e} to {high:.6e}"));
    }
    let [shortest, mean, longest] = found.edges;
    lines.push(format!("edges       {shortest:.3e} to {longest:.3e}, mean {mean:.3e}"));
    if let Some([smallest, mean]) = found.quality {
        lines.push(format!("quality     smallest {smallest:.3}, mean {mean:.3}; 1 for regular cells, 0 for flat ones"));
    }
    for (title, groups) in [("cells", &found.cell_groups), ("boundary", &found.boundary_groups)] {
        let measure = if title == "cells" { measure } else { side };
        for (name, (n, size)) in groups {
            let name = name.as_ref().map_or_else(|| "(no group)".to_owned(), |name| format!("`{name}`"));
            lines.push(format!("{title:<11} {name}: {n} elements, {measure} {size:.6e}"));
        }
    }
    let notes = [
        (found.n_open, "sides of the surface have not exactly one neighbour: it is open, or branches"),
        (found.n_turned, "cells had a negative volume; the order of their nodes was reversed"),
        (found.n_inside, "elements of groups lie inside, not on the boundary, and have no effect"),
        (found.n_ambiguous, "elements are repeated or in several groups; the first one is used"),
    ];
    lines.extend(notes.iter().filter(|(n, _)| *n > 0).map(|(n, note)| format!("note        {n} {note}")));
    if let Some(place) = &found.first_folded {
        lines.push(format!(
            "note        {} cells of order 2 are folded by their curved edges, the first one near {place:?}: such cells are an error for order 2; straighten the edges there",
            found.n_folded
        ));
    }
    lines
}
