//! Runs that outlast a command: results stay in a directory, and a later command resumes what was stopped.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use cutwater::io::{Begin, Error, RunOptions, ScenarioFile, Watch, checkpoint_steps};

use crate::verify::document;

/// File with the version of the code in the directory of a run.
const VERSION: &str = "version.txt";
/// Change of a scenario with which its runs can be resumed.
pub(crate) const CHECKPOINTS: &str = "output.checkpoint_minutes=5";

/// A scenario with the directory of its results.
#[derive(Clone, Copy)]
pub(crate) struct StoredRun<'a> {
    pub(crate) file: &'a ScenarioFile,
    pub(crate) directory: &'a Path,
}

impl StoredRun<'_> {
    /// Returns the version of the code that made the results; empty if it is not known.
    pub(crate) fn version(&self) -> String {
        std::fs::read_to_string(self.directory.join(VERSION)).unwrap_or_default()
    }

    /// Returns whether the directory has results of the same scenario; their output may differ.
    pub(crate) fn is_of_scenario(&self) -> bool {
        let problem = |text: String| {
            let mut table: toml::Table = text.parse().ok()?;
            table.remove("output");
            Some(table)
        };
        let stored = std::fs::read_to_string(self.directory.join("scenario.toml")).ok().and_then(problem);
        stored.is_some() && stored == self.file.to_toml().ok().and_then(problem)
    }

    /// Returns whether the directory has results of the same scenario by the code in the tree.
    pub(crate) fn is_current(&self) -> bool {
        self.is_of_scenario() && document::is_current(&self.version())
    }

    /// Runs the scenario, to its end or until the watch sets `stop`. The run begins at the last checkpoint of the same
    /// code if there is one, and `again` is not set. Otherwise it replaces the results in the directory.
    ///
    /// # Errors
    /// Those of a run, except that it is stopped.
    pub(crate) fn run(&self, again: bool, watch: &mut impl Watch, stop: Option<&AtomicBool>) -> Result<(), Error> {
        let has_checkpoints = !checkpoint_steps(self.directory).is_empty();
        self.run_from(has_checkpoints && !again && self.is_current(), watch, stop)
    }

    /// Runs the scenario from the last checkpoint in the directory, or from the start.
    fn run_from(&self, resumes: bool, watch: &mut impl Watch, stop: Option<&AtomicBool>) -> Result<(), Error> {
        let path = self.directory.join(VERSION);
        // Without the version, a directory with files of two versions is not taken for a run of either.
        if !resumes && path.is_file() {
            std::fs::remove_file(&path).map_err(|source| Error::Write { path: path.clone(), source })?;
        }
        // A run without this file is not resumed: if it cannot be written, the next command runs from the start.
        let stamp = Begin(|_: &_| drop(std::fs::write(&path, document::version())));
        let options = RunOptions { resumes, overwrites: true, discards: !resumes, stop };
        match options.run(self.file, self.directory, &mut ((!resumes).then_some(stamp), watch)) {
            Ok(_) | Err(Error::Interrupted { .. }) => Ok(()),
            Err(error) => Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use cutwater::io::{Case, TABLES};
    use cutwater::solver::{Observer, ObserverError, StepView};
    use std::sync::atomic::Ordering;

    use super::*;
    use crate::case::scenario_path;

    const N_STEPS: usize = 4;

    /// Watch that stops a run after a step, and records the steps that were taken.
    struct StopAfter<'a> {
        last: usize,
        stop: &'a AtomicBool,
        taken: Vec<usize>,
    }

    impl Watch for StopAfter<'_> {
        fn observer<const D: usize>(&mut self, _: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
            Some(Box::new(self))
        }
    }

    impl<const D: usize> Observer<D> for &mut StopAfter<'_> {
        fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
            if view.report.is_some() {
                self.taken.push(view.state.step);
            }
            self.stop.store(view.state.step >= self.last, Ordering::Relaxed);
            Ok(())
        }
    }

    fn history_without_clock(directory: &Path) -> Vec<String> {
        let text = std::fs::read_to_string(directory.join(TABLES[0])).unwrap();
        let is_clock = |name: &str| name.contains("seconds");
        let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        assert!(head.iter().any(|name| is_clock(name)), "{head:?}");
        let kept = |line: &str| {
            line.split(',').zip(&head).filter(|(_, name)| !is_clock(name)).map(|(v, _)| v).collect::<Vec<_>>().join(",")
        };
        text.lines().map(kept).collect()
    }

    #[test]
    fn a_stopped_run_is_resumed_with_the_same_history_or_begun_again() {
        let root = std::env::temp_dir().join(format!("cutwater-stored-{}", std::process::id()));
        let (directory, whole) = (root.join("stopped"), root.join("whole"));
        let coarse = ["background.size.fine=0.5", "background.size.coarse=1.0", "body.0.shape.size=0.5"];
        let set = [&coarse[..], &["output.vtk_every=0", CHECKPOINTS]].concat();
        let mut set: Vec<String> = set.into_iter().map(str::to_owned).collect();
        let standard = ScenarioFile::read(&scenario_path("virtual-barrier"), &set).unwrap();
        set.push(format!("time.end={}", *standard.scenario().time.step * N_STEPS as f64));
        let file = ScenarioFile::read(&scenario_path("virtual-barrier"), &set).unwrap();
        let run = |directory: &Path, resumes: bool, last: usize| {
            let stop = AtomicBool::new(false);
            let mut watch = StopAfter { last, stop: &stop, taken: Vec::new() };
            StoredRun { file: &file, directory }.run_from(resumes, &mut watch, Some(&stop)).unwrap();
            watch.taken
        };
        assert_eq!(run(&whole, false, N_STEPS), [1, 2, 3, 4]);
        assert_eq!(run(&directory, false, 2), [1, 2]);
        let stored = StoredRun { file: &file, directory: &directory };
        assert!(stored.is_of_scenario() && stored.version() == document::version());
        assert_eq!(run(&directory, true, N_STEPS), [3, 4]);
        assert_eq!(history_without_clock(&directory), history_without_clock(&whole));
        assert_eq!(run(&directory, true, N_STEPS), [0_usize; 0]);
        // Replaces a finished run, and then a stopped one.
        assert_eq!(run(&directory, false, 1), [1]);
        assert_eq!(run(&directory, false, 2), [1, 2]);
        // The public function resumes the run if no change of the code is uncommitted, and begins again if requested.
        let resumed = |again: bool| {
            let stop = AtomicBool::new(false);
            let mut watch = StopAfter { last: 3, stop: &stop, taken: Vec::new() };
            stored.run(again, &mut watch, Some(&stop)).unwrap();
            watch.taken
        };
        let is_clean = !stored.version().contains("-dirty") && !stored.version().is_empty();
        assert_eq!(resumed(false), if is_clean { vec![3] } else { vec![1, 2, 3] });
        assert_eq!(resumed(true), [1, 2, 3]);
        set.push("fluid.viscosity=1.0".to_owned());
        let other = ScenarioFile::read(&scenario_path("virtual-barrier"), &set).unwrap();
        assert!(!StoredRun { file: &other, directory: &directory }.is_of_scenario());
        std::fs::remove_dir_all(&root).unwrap();
    }
}
