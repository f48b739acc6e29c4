//! A tiny run from scenario to files, and what is in the files.

use std::fs;
use std::path::Path;

use crate::setting::*;
use io::scenario::Case;
use io::vtk::bodies::{Shown, bodies_grid};
use io::vtk::fluid::fluid_grid;
use io::{Progress, ScenarioFile, StepProgress, Summary, Watch, run};
use solver::algebra::Workspace;
use solver::mesh::SimplexMesh;
use solver::{FluidSetup, Observer, ObserverError, State, StepView, Substep, advance};
use vtkio::model::{Attribute, UnstructuredGridPiece, VertexNumbers};

const HEADER: &str = "time [s],d_min [cm],d_max [cm],body_height [cm],lowest_velocity [cm/s],\
lowest_acceleration [cm/s²],centre_y [cm],centre_velocity [cm/s],\
contact_force [dyn/cm],contact_power [erg/(s cm)],max_penetration [cm],active_points,energy_kinetic_solid [erg/cm],\
energy_elastic [erg/cm],energy_gravity [erg/cm],\
centre_x [cm],centre_velocity_x [cm/s],angle [rad],angular_velocity [rad/s],contact_force_x [dyn/cm],force_x [dyn/cm],\
force_y [dyn/cm],traction_force_x [dyn/cm],traction_force_y [dyn/cm],torque [dyn cm/cm],\
energy_kinetic_fluid [erg/cm],energy_contact [erg/cm],leak_net [cm²/s],leak_absolute [cm²/s],newton,linear_iterations,\
factorizations,smallest_fraction,dofs,\
seconds_cut [s],seconds_space [s],seconds_assembly [s],seconds_linear [s],seconds_output [s]";
/// First columns of `diagnostics.csv`.
const DIAGNOSTICS: &str = "time [s],volume [cm²],force_inertia [dyn/cm],force_gravity [dyn/cm],force_pressure [dyn/cm],\
force_viscous [dyn/cm],force_penalty [dyn/cm],force_exchange [dyn/cm],force_contact [dyn/cm],force_remainder [dyn/cm],\
fluid_power [erg/(s cm)],smallest_volume_ratio,fluid_volume [cm²],total_energy [erg/cm],lost_";

/// Returns the virtual barrier with coarse meshes. The ball starts just above the barrier, so that contact begins in
/// the first steps.
fn coarse(extra: &[&str]) -> ScenarioFile {
    let sets = [
        "background.size=1.0",
        "body.0.shape.size=1.0",
        "body.0.shape.centre=[0.0, 7.02]",
        "body.0.initial_velocity=[0.0, -20.0]",
        "time.end=0.005",
        "output.vtk_every=2",
    ];
    legal(BARRIER, &[&sets, extra])
}

fn background(fluid: &Option<FluidSetup<2>>) -> &SimplexMesh<2> {
    &fluid.as_ref().expect("a fluid").background
}

fn names(attributes: &[Attribute]) -> Vec<&str> {
    attributes.iter().map(|a| if let Attribute::DataArray(array) = a { array.name.as_str() } else { "" }).collect()
}

/// Returns the sum of the areas of all polygons.
fn area(grid: &UnstructuredGridPiece) -> f64 {
    let points: Vec<f64> = grid.points.cast_into().expect("numbers");
    let VertexNumbers::XML { connectivity, offsets } = &grid.cells.cell_verts else { panic!("not XML") };
    let mut begin = 0;
    let mut area = 0.0;
    for end in offsets {
        let corners = &connectivity[begin..*end as usize];
        let at = |k: usize| {
            let p = corners[k % corners.len()] as usize;
            (points[3 * p], points[3 * p + 1])
        };
        area += (0..corners.len()).map(|k| 0.5 * (at(k).0 * at(k + 1).1 - at(k + 1).0 * at(k).1)).sum::<f64>();
        begin = *end as usize;
    }
    area
}

/// Checks that the files that must be readable during a run are complete.
fn check_directory(directory: &Path, steps: usize) {
    let text = fs::read_to_string(directory.join("history.csv")).expect("a history");
    assert_eq!(text.lines().next(), Some(HEADER));
    let diagnostics = fs::read_to_string(directory.join("diagnostics.csv")).expect("diagnostics");
    let header = diagnostics.lines().next().unwrap_or_default();
    let (first, lost) = header.split_at(DIAGNOSTICS.len());
    assert!(first == DIAGNOSTICS && lost.split(',').all(|name| name.ends_with(" [erg/cm]")), "{header}");
    assert!(text.ends_with('\n'));
    let table = history(directory);
    assert_eq!(table.n_rows(), steps);
    assert!(table.column("d_min").expect("a column").iter().all(|d| d.is_finite()));
    let summary = Summary::read(&directory.join("summary.json")).expect("a summary");
    assert!(summary.steps <= steps);
    for series in ["fluid", "solid", "interface"] {
        let index = fs::read_to_string(directory.join(format!("{series}.pvd"))).expect("an index");
        assert!(index.ends_with("</VTKFile>\n"));
        for file in index.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            let grid = read_grid(&directory.join(file));
            assert!(grid.num_points() > 0 && !grid.cells.types.is_empty());
        }
    }
}

#[test]
fn a_run_leaves_all_files_and_they_are_complete_after_every_step() {
    let directory = fresh_directory("tiny-run");
    let mut seen = Vec::new();
    let mut progress = Progress(|at: &StepProgress| {
        check_directory(&directory, at.step);
        seen.push((at.step, at.in_contact));
    });
    let summary = run(&coarse(&[]), &directory, &mut progress).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(seen.iter().map(|(step, _)| *step).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    assert!(seen.iter().any(|(_, contact)| *contact), "the ball reaches the barrier");
    check_directory(&directory, 5);
    for file in ["history.csv", "diagnostics.csv", "scenario.toml"] {
        assert!(fs::metadata(directory.join(file)).is_ok_and(|data| data.len() > 500), "{file}");
    }
    let mut entries = fs::read_dir(&directory).expect("a directory").map(|entry| entry.expect("an entry").file_name());
    assert!(entries.all(|name| !name.to_string_lossy().starts_with(".partial")));
    assert_eq!(Summary::read(&directory.join("summary.json")).expect("a summary"), summary);
    assert_eq!((summary.steps, summary.half_domain, summary.stabilisation.as_str()), (5, true, "paper-44-2019"));
    let first = seen.iter().find(|(_, contact)| *contact).map(|(step, _)| *step as f64 * 1e-3);
    assert!((summary.contact_time.expect("contact") - first.expect("contact")).abs() < 1e-12);
    assert!(summary.energy_monotone && summary.max_penetration > 0.0);
    // The scenario that was run can be run again.
    let again = ScenarioFile::read(&directory.join("scenario.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.scenario(), coarse(&[]).scenario());
}

#[test]
fn summary_has_exactly_the_agreed_keys() {
    let text = serde_json::to_value(Summary::default()).expect("JSON");
    let mut keys: Vec<&str> = text.as_object().expect("an object").keys().map(String::as_str).collect();
    let expected = "bodies case cells closed_volume_change contact_intervals contact_offset contact_time dimension dofs dt energy_defect \
                    energy_generated energy_lost_at_surfaces energy_lost_in_contact energy_monotone factorizations \
                    fallbacks half_domain leading linear_solver max_interface_leak max_penetration max_penetration_over_s \
                    min_distance newton_iterations nnz peak_rss_bytes release_time stabilisation steps timings units \
                    wall_seconds";
    keys.sort_unstable();
    assert_eq!(keys.join(" "), expected);
}

#[test]
fn field_files_hold_the_true_domains() {
    let directory = fresh_directory("fields");
    let Case { setup, .. } = planar_case(&coarse(&["background.size=0.7"]));
    let start = State::initial(&setup).expect("a state");
    let whole = Substep::whole(setup.dt);
    let (state, _) = advance(&setup, &start, whole, &mut Workspace::new()).expect("a step");
    let fluid = state.fluid.as_ref().expect("a fluid");
    for compression in [0, 6] {
        let path = directory.join(format!("fluid-{compression}.vtu"));
        fluid_grid(background(&setup.fluid), fluid).write(&path, compression).unwrap_or_else(|e| panic!("{e}"));
        let grid = read_grid(&path);
        let cut = &fluid.cut;
        let pieces: usize = cut.all_parts().map(|p| if cut.is_whole(p) { 1 } else { cut.part_pieces(p).len() }).sum();
        assert_eq!(grid.cells.types.len(), pieces);
        assert!((area(&grid) - cut.fluid_volume()).abs() < 1e-9, "{} {}", area(&grid), cut.fluid_volume());
        assert_eq!(names(&grid.data.point), ["velocity", "pressure"]);
        assert_eq!(names(&grid.data.cell), ["vorticity", "part", "cut"]);
    }
    let path = directory.join("solid.vtu");
    assert!(bodies_grid(&setup, &state, Shown::Surfaces).is_none(), "the only body deforms");
    let grid = bodies_grid(&setup, &state, Shown::Cells).expect("the elastic body");
    grid.write(&path, 0).unwrap_or_else(|e| panic!("{e}"));
    let grid = read_grid(&path);
    let body = &setup.bodies[0];
    let cells = body.cells(&state.bodies[0]).expect("an elastic body");
    assert_eq!((grid.num_points(), grid.cells.types.len()), (body.reference().len(), cells.cells().count()));
    assert_eq!(names(&grid.data.point), ["displacement", "velocity"]);
    assert_eq!(names(&grid.data.cell), ["cauchy_stress", "principal_stress", "von_mises", "pressure", "body"]);
}

#[test]
fn two_bodies_have_prefixed_columns() {
    let directory = fresh_directory("two-bodies");
    let second = "\n[[body]]\nname = \"block\"\nshape = { kind = \"box\", min = [6.0, 0.0], max = [8.0, 1.0], n = [2, 1] }\n\
                  material = { kind = \"saint-venant-kirchhoff\", young = 5.6e6, poisson = 0.4 }\ndensity = 1.0\n\
                  gravity = [0.0, 0.0]\nboundary = { bottom = \"clamped\" }\n";
    let sets = ["background.size=1.0", "body.0.shape.size=1.0", "time.end=0.002", "output.vtk_every=0"];
    results(&legal(&format!("{BARRIER}{second}"), &[&sets]), &directory);
    let table = history(&directory);
    assert_eq!(table.names().len(), 1 + 2 * 24 + 14);
    assert_eq!(table.names()[1..3], ["ball_d_min [cm]", "ball_d_max [cm]"]);
    assert_eq!(table.column("block_d_min").expect("a column").len(), 2);
    assert!(!directory.join("fluid.pvd").exists());
}

#[test]
fn the_mirrored_case_is_the_full_one() {
    let full = [
        "background.mirrored=true",
        "background.boundary.left=free",
        "body.0.shape.mirrored=true",
        "body.0.boundary={}",
    ];
    let (half, full) = (planar_case(&coarse(&[])), planar_case(&coarse(&full)));
    assert!(half.half_domain && !full.half_domain);
    let n_cells = |case: &Case<2>| background(&case.setup.fluid).n_cells();
    assert_eq!(n_cells(&full), 2 * n_cells(&half));
    let area = |case: &Case<2>| {
        let start = State::initial(&case.setup).expect("a state");
        start.fluid.expect("a fluid").cut.fluid_volume()
    };
    assert!((area(&full) - 2.0 * area(&half)).abs() < 1e-9);
}

/// Times at which an observer was called.
#[derive(Default)]
struct Parts(Vec<f64>);

impl Watch for Parts {
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        (case.n_steps == 5).then_some(Box::new(self))
    }
}

impl<const D: usize> Observer<D> for &mut Parts {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        self.0.push(view.state.time);
        Ok(())
    }
}

#[test]
fn a_divided_run_has_rows_for_parts_and_files_for_steps() {
    // Three corrections are too few for the first touch in one step.
    let directory = fresh_directory("divided");
    let file = coarse(&["solver.newton.max_iterations=3"]);
    let (mut steps, mut parts) = (Vec::new(), Parts::default());
    let mut watch =
        (Progress(|at: &StepProgress| steps.push((at.step, at.is_divided, at.failure.clone()))), &mut parts);
    let summary = run(&file, &directory, &mut watch).unwrap_or_else(|e| panic!("{e}"));
    assert!(summary.divided_steps > 0 && summary.steps == 5);
    assert_eq!(steps.iter().map(|(step, ..)| *step).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    for (_, is_divided, failure) in &steps {
        assert_eq!(*is_divided, failure.as_ref().is_some_and(|cause| cause.contains("3 iterations")), "{failure:?}");
    }
    let table = history(&directory);
    let times = table.column("time").expect("a time");
    assert!(times.len() > 5 && times.windows(2).all(|w| w[1] > w[0]), "{times:?}");
    assert!(table.column("newton").expect("counts").iter().sum::<f64>() as usize == summary.newton_iterations);
    // What failed counts: more corrections than the limit, in a row of a part that came after a failure.
    assert!(table.column("newton").expect("counts").iter().any(|n| *n > 3.0));
    let mut files: Vec<String> = fs::read_dir(directory.join("vtk"))
        .expect("a directory")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("fluid"))
        .collect();
    files.sort();
    assert_eq!(files, [0, 2, 4, 5].map(|step| format!("fluid_{step:06}.vtu")));
    // An observer receives the start and every part.
    assert_eq!(parts.0[0], 0.0);
    assert_eq!(parts.0[1..], times);
}
