//! `cutwater check`

use cutwater::io::scenario::Quantity;
use cutwater::io::{Error, ScenarioFile, Sizes, sizes};

use super::print;
use crate::ScenarioArguments;

/// Reads a scenario, builds its meshes and prints sizes.
pub(crate) fn check(arguments: &ScenarioArguments) -> Result<(), Error> {
    let file = ScenarioFile::read(&arguments.file, &arguments.sets)?;
    let scenario = file.scenario();
    let Sizes { background_cells, background_vertices, bodies, cut_cells, dofs, n_steps, half_domain, linear } =
        sizes(&file)?;
    let half = if half_domain { ", half of a symmetric problem" } else { "" };
    let unit = |quantity| scenario.units.label(quantity);
    let (length, mass, time) = (unit(Quantity::LENGTH), unit(Quantity::MASS), unit(Quantity::TIME));
    print(&format!("{}: dimension {}, units {length}, {mass}, {time}{half}", *scenario.name, scenario.dimension))?;
    if scenario.fluid.is_some() {
        print(&format!(
            "background: {background_cells} cells, {background_vertices} vertices, {cut_cells} cells cut at the start"
        ))?;
    }
    for (name, cells, vertices) in bodies {
        match cells {
            0 => print(&format!("body {name}: does not deform, {vertices} vertices on its surface"))?,
            _ => print(&format!("body {name}: {cells} cells, {vertices} vertices"))?,
        }
    }
    print(&format!("unknowns in the first step: {dofs}"))?;
    print(&format!("linear solver: {linear}"))?;
    print(&format!("steps: {n_steps} of {} {time}, to {} {time}", *scenario.time.step, scenario.time.end))?;
    Ok(())
}
