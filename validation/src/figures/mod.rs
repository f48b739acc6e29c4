//! Figures of the paper's cases, drawn during a run: vorticity at the contacts, displacement of the bodies.

mod isolines;
mod view;
mod vorticity;

use std::path::Path;

use cutwater::io::{Case, Watch, leading_body};
use cutwater::report::plane::mirror;
use cutwater::solver::body::BodyState;
use cutwater::solver::{Observer, ObserverError, StepView};

/// The figures, by the names of their files, with their captions.
pub(crate) const CAPTIONS: [(&str, &str); 4] = [
    (
        "vorticity.svg",
        "Isolines of the vorticity and velocity vectors at the first contact (at the end, if there is none), and the \
         surroundings of the lowest point.",
    ),
    ("vorticity-second-contact.svg", "The same at the first contact after the rebound."),
    (
        "displacement-contact.svg",
        "Isolines of the vertical displacement of all bodies at the first contact (at the end, if there is none).",
    ),
    (
        "displacement.svg",
        "Isolines of the vertical displacement at the largest violation of the contact offset (at the end, if there is none).",
    ),
];

/// Draws the figures of a run in the plane into its directory.
pub(crate) struct Figures<'a> {
    pub(crate) directory: &'a Path,
}

impl Watch for Figures<'_> {
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        let leading = leading_body(&case.setup).filter(|_| D == 2)?;
        CAPTIONS.iter().for_each(|(name, _)| drop(std::fs::remove_file(self.directory.join(name))));
        Some(Box::new(Drawing::<D> {
            directory: self.directory,
            n_steps: case.n_steps,
            leading,
            mirror: mirror(&case.setup),
            first: None,
            release: None,
            has_second: false,
            touched: false,
            deepest: None,
        }))
    }
}

/// Contacts of a run so far.
struct Drawing<'a, const D: usize> {
    directory: &'a Path,
    n_steps: usize,
    leading: usize,
    mirror: Option<f64>,
    /// The first contact.
    first: Option<f64>,
    /// End of the last contact, and duration of the first one.
    release: Option<(f64, f64)>,
    has_second: bool,
    /// Whether there was contact in the last step.
    touched: bool,
    /// Largest penetration, its time, and the bodies at this time.
    deepest: Option<(f64, f64, Vec<BodyState<D>>)>,
}

impl<const D: usize> Observer<D> for Drawing<'_, D> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let Some(report) = view.report else { return Ok(()) };
        let time = view.state.time;
        let is_end = view.state.step == self.n_steps && view.ends_step();
        let touches = report.contacts.iter().any(|contact| contact.is_active());
        let depth = report.contacts.iter().map(|contact| contact.largest_penetration).fold(0.0, f64::max);
        let write = |name: &str, text: String| std::fs::write(self.directory.join(name), text);
        if self.first.is_none() && (touches || is_end) {
            if let Some(figure) = vorticity::draw(view, self.leading, self.mirror) {
                write("vorticity.svg", figure)?;
            }
            let all: Vec<usize> = (0..view.setup.bodies.len()).collect();
            write("displacement-contact.svg", isolines::draw(view.setup, &view.state.bodies, &all, time, self.mirror))?;
        }
        if depth > self.deepest.as_ref().map_or(0.0, |(depth, ..)| *depth) || (is_end && self.deepest.is_none()) {
            self.deepest = Some((depth, time, view.state.bodies.clone()));
        }
        match (self.touched, touches) {
            (false, true) => {
                let first = *self.first.get_or_insert(time);
                // After a rebound: at least half as long without contact as the first contact lasted.
                let is_second = self.release.is_some_and(|(end, lasted)| time - end >= 0.5 * lasted && time > first);
                if is_second && !self.has_second {
                    self.has_second = true;
                    if let Some(figure) = vorticity::draw(view, self.leading, self.mirror) {
                        write("vorticity-second-contact.svg", figure)?;
                    }
                }
            }
            (true, false) => {
                let lasted = self.release.map_or(time - self.first.unwrap_or(time), |(_, lasted)| lasted);
                self.release = Some((time, lasted));
            }
            _ => {}
        }
        self.touched = touches;
        if let (true, Some((_, time, bodies))) = (is_end, &self.deepest) {
            write("displacement.svg", isolines::draw(view.setup, bodies, &[self.leading], *time, self.mirror))?;
        }
        Ok(())
    }
}
