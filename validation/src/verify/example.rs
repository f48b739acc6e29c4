//! Runs of the scenarios in `examples/`, with the histories that checks evaluate.

use std::time::Instant;

use cutwater::io::probes::Probes;
use cutwater::io::scenario::case::case;
use cutwater::io::{ScenarioFile, name_and_unit};
use cutwater::solver::body::Balance;
use cutwater::solver::{Observer, ObserverError, Setup, State, StepView, TimeLoop};

use super::record::Points;
use super::{Failure, P};
use crate::case::example_path;

/// A run of an example.
pub(super) struct Example {
    pub(super) setup: Setup<2>,
    pub(super) history: ExampleHistory,
    /// Wall-clock time, s.
    pub(super) seconds: f64,
}

/// Values after each step, from the start.
#[derive(Default)]
pub(super) struct ExampleHistory {
    probes: Probes<2>,
    pub(super) times: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// Balances of the movable bodies.
    pub(super) balances: Vec<Vec<Balance<2>>>,
    /// Positions of the vertices of all bodies.
    pub(super) positions: Vec<Vec<Vec<P>>>,
    /// Number of quadrature points in contact, over time.
    pub(super) touching: Points,
    /// Smallest gap of all contacts and times.
    pub(super) smallest_gap: f64,
    /// Largest number of unknowns.
    pub(super) n_dofs: usize,
    /// Number of cells of the background.
    pub(super) n_cells: usize,
    /// Number of parts of divided steps.
    pub(super) n_parts: usize,
}

impl Example {
    /// Runs an example to its end, with changes.
    ///
    /// # Errors
    /// The scenario is not valid with the changes, or a step fails.
    pub(super) fn run(name: &str, changes: &[&str]) -> Result<Self, Failure> {
        let changes: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
        let mut case = case::<2>(&ScenarioFile::read(&example_path(name), &changes)?)?;
        let begin = Instant::now();
        let mut history = ExampleHistory {
            probes: std::mem::take(&mut case.probes),
            smallest_gap: f64::INFINITY,
            ..ExampleHistory::default()
        };
        let state = State::initial(&case.setup)?;
        let workspace = std::mem::take(&mut case.workspace);
        TimeLoop::new(&case.setup, state, workspace).run(case.n_steps, &mut [&mut history])?;
        Ok(Self { setup: case.setup, history, seconds: begin.elapsed().as_secs_f64() })
    }
}

impl ExampleHistory {
    /// Returns the values of a probe over time, by its name without the unit.
    pub(super) fn probe(&self, name: &str) -> Result<Points, Failure> {
        let of_name = |full: &str| name_and_unit(full).0 == name;
        let column = self.probes.names().position(of_name).ok_or_else(|| format!("there is no probe {name}"))?;
        Ok(self.times.iter().zip(&self.values).map(|(t, values)| (*t, values[column])).collect())
    }

    /// Returns a quantity of a body over time.
    pub(super) fn of_body(&self, body: usize, number: impl Fn(&Balance<2>) -> f64) -> Points {
        self.times.iter().zip(&self.balances).map(|(t, balances)| (*t, number(&balances[body]))).collect()
    }

    /// Returns the smallest `det F` of all bodies and times.
    pub(super) fn smallest_volume_ratio(&self) -> f64 {
        self.balances.iter().flatten().map(|balance| balance.smallest_volume_ratio).fold(f64::INFINITY, f64::min)
    }
}

impl Observer<2> for ExampleHistory {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        let (setup, state) = (view.setup, view.state);
        if let Some(report) = view.report {
            let gaps = report.contacts.iter().filter_map(|contact| contact.minimum_gap);
            self.smallest_gap = gaps.fold(self.smallest_gap, f64::min);
            self.n_dofs = self.n_dofs.max(report.n_dofs);
        }
        if !view.ends_step() {
            self.n_parts += 1;
            return Ok(());
        }
        let n_touching = view.report.iter().flat_map(|report| &report.contacts).map(|contact| contact.n_active).sum();
        let n_touching: usize = n_touching;
        self.touching.push((state.time, n_touching as f64));
        self.n_cells = setup.fluid.as_ref().map_or(0, |fluid| fluid.background.n_cells());
        self.times.push(state.time);
        self.values.push(self.probes.values(view));
        let balances = setup.bodies.iter().zip(&state.bodies).filter_map(|(body, state)| body.balance(state));
        self.balances.push(balances.collect());
        self.positions.push(setup.positions(&state.bodies));
        Ok(())
    }
}
