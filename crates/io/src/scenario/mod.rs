//! Scenario files: what they may say, how they are read, and what they become.

mod bodies;
mod check;
mod condition;
mod document;
mod fluid;
pub mod lower;
mod motion;
mod placement;
pub mod problem;
pub mod schema;

use std::path::{Path, PathBuf};

pub use condition::{
    Axis, GivenBodyCondition, GivenFluidCondition, GradedSize, InflowProfile, PlainBodyCondition, PlainFluidCondition,
};
pub use lower::{Case, CaseVisitor};
pub use motion::{FormulaError, TableError};
pub use problem::{Place, Problem, ScenarioError};
pub use schema::Scenario;

use crate::Error;
use document::Document;

/// A scenario that was read from a file, with the places of its values.
#[derive(Clone, Debug)]
pub struct ScenarioFile {
    scenario: Scenario,
    document: Document,
}

impl ScenarioFile {
    /// Reads a scenario file and applies changes `KEY=VALUE`, such as `time.step=5e-4` or `body.0.density=2`.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::NotUtf8`], or [`Error::Scenario`] with file, line and key.
    pub fn read(path: &Path, sets: &[String]) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count() + 1;
            Error::NotUtf8 { path: path.to_owned(), line }
        })?;
        Self::parse(path, &text, sets)
    }

    /// A scenario from text; `path` names it in errors.
    ///
    /// # Errors
    /// [`Error::Scenario`].
    pub fn parse(path: &Path, text: &str, sets: &[String]) -> Result<Self, Error> {
        let (document, scenario) = Document::parse(path, text, sets)?;
        let file = Self { scenario, document };
        check::check(&file)?;
        Ok(file)
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The scenario as text, with the changes applied.
    ///
    /// # Errors
    /// [`Error::Text`]: it cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String, Error> {
        Ok(toml::to_string(&self.scenario)?)
    }

    /// Number of steps.
    pub fn n_steps(&self) -> usize {
        (self.scenario.time.end / self.scenario.time.step).round() as usize
    }

    /// The tables of motion that it names: number of the body, and where the table lies.
    pub(crate) fn tables(&self) -> impl Iterator<Item = (usize, PathBuf)> {
        let bodies = self.scenario.bodies.iter().enumerate();
        bodies.filter_map(|(body, given)| match &given.motion {
            Some(schema::Motion::Table { file, .. }) => Some((body, motion::table_path(self, file))),
            _ => None,
        })
    }

    /// A key that is missing in a table.
    fn missing(&self, table: &str, key: &str) -> ScenarioError {
        self.error(table, Problem::Missing { key: key.to_owned() })
    }

    /// An error at a key.
    fn error(&self, path: &str, problem: impl Into<Problem>) -> ScenarioError {
        ScenarioError { place: Box::new(self.document.place(path)), problem: problem.into() }
    }
}
