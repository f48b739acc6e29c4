//! Half of the domain and the whole of it: the same contact, and a ball that falls straight down.

use cutwater::algebra::Workspace;
use cutwater::io::scenario::case::case;
use cutwater::io::{Error, ScenarioFile};
use cutwater::solver::{Observer, ObserverError, State, StepView, TimeLoop};

use super::{Failure, Record};
use crate::case::scenario_path;
use crate::units::cgs;

/// Largest lateral drift of the centre, cm.
const DRIFT: f64 = 1e-4;
/// Changes of the virtual barrier: no field files, and an end shortly after the release.
const SHORT: [&str; 2] = ["time.end=0.14", "output.vtk_every=0"];
/// Coarse meshes for the quick version.
const COARSE: [&str; 4] =
    ["background.size.fine=0.4", "background.size.coarse=1.0", "body.0.shape.size=0.4", "time.step=2e-3"];
/// Changes from the half of the domain to the whole.
const MIRRORED: [&str; 4] =
    ["background.mirrored=true", "background.boundary.left=free", "body.0.shape.mirrored=true", "body.0.boundary={}"];

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    for set in ["standard", "paper-44-2019"] {
        let (half, whole) = (fall(record.full, set, &[])?, fall(record.full, set, &MIRRORED)?);
        let time = |time: Option<f64>| time.unwrap_or(f64::NAN);
        for (event, whole, half) in [("contact", whole.contact, half.contact), ("release", whole.release, half.release)]
        {
            let quantity = format!("{set}: {event} of the whole ball [s]; reference: of the half");
            record.near(quantity, time(whole), time(half), 0.0);
        }
        record.at_most(cgs(&format!("{set}: lateral drift of the whole ball [<length>]")), whole.drift, DRIFT);
    }
    Ok(())
}

fn fall(full: bool, set: &str, changes: &[&str]) -> Result<SymmetryRecorder, Error> {
    let resolution: &[&str] = if full { &[] } else { &COARSE };
    let changes = SHORT.iter().chain(resolution).chain(changes).map(|change| (*change).to_owned());
    let stabilisation = format!("fluid.stabilisation={set:?}");
    let changes: Vec<String> = changes.chain([stabilisation]).collect();
    let case = case::<2>(&ScenarioFile::read(&scenario_path("virtual-barrier"), &changes)?)?;
    let mut fall = SymmetryRecorder::default();
    let state = State::initial(&case.setup)?;
    TimeLoop::new(&case.setup, state, Workspace::new()).run(case.n_steps, &mut [&mut fall])?;
    Ok(fall)
}

/// Contact, release and drift of a run.
#[derive(Default)]
struct SymmetryRecorder {
    contact: Option<f64>,
    release: Option<f64>,
    /// Largest distance of the centre of mass from the line of symmetry.
    drift: f64,
}

impl Observer<2> for SymmetryRecorder {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        let Some(report) = view.report else { return Ok(()) };
        match report.contacts.iter().any(|contact| contact.is_active()) {
            true => self.contact = self.contact.or(Some(view.state.time)),
            false if self.contact.is_some() => self.release = self.release.or(Some(view.state.time)),
            false => {}
        }
        let centres = report.bodies.iter().filter_map(|body| body.balance.as_ref()).map(|b| b.centre_of_mass[0].abs());
        self.drift = centres.fold(self.drift, f64::max);
        Ok(())
    }
}
