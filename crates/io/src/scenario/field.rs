//! Vectors that may depend on position and time: constants, and formulas of `x`, `y`, `z` and `t`.

use std::sync::Arc;

use mesh::{Point, Vector};
use solver::body::{PointField, TimeField};
use toml::de::DeValue;

use super::error::{Location, ScenarioError};
use super::field_table::{FieldTable, Variable};
use super::formula::Formula;
use super::key::Form;
use super::table::{At, Choose as _, Components, KeyValue, Node};

/// A number, a formula in the time `t`, or a table over the time.
impl KeyValue for Formula {
    const FORM: Form = Form::Field("t", &FieldTable::FORM);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        if let DeValue::Table(_) = node.value {
            return match <FieldTable as KeyValue>::read(node)?.read()? {
                (Variable::Time, rows) => Ok(Self::through(Variable::Time.word(), rows)),
                (over, _) => {
                    let over = over.word();
                    Err(node
                        .at()
                        .invalid(format!("this is a value over time, and its table is over {over}; use over = \"t\"")))
                }
            };
        }
        read(node, "t", &Self::FORM)
    }
}

/// A number or a formula in position and time.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldFormula(Formula);

impl KeyValue for FieldFormula {
    const FORM: Form = Form::Field("x, y, z, t", &FieldTable::FORM);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        if let DeValue::Table(_) = node.value {
            let (over, rows) = <FieldTable as KeyValue>::read(node)?.read()?;
            if over == Variable::Z && node.document.dimension < 3 {
                let message = "this table is over z, and with dimension = 2 there are x and y only; use over = \"y\" for the height";
                return Err(node.at().part("over").invalid(message));
            }
            return Ok(Self(Formula::through(over.word(), rows)));
        }
        let variables = if node.document.dimension == 3 { "x, y, z, t" } else { "x, y, t" };
        read(node, variables, &Self::FORM).map(Self)
    }
}

fn read(node: &Node<'_>, variables: &'static str, form: &Form) -> Result<Formula, ScenarioError> {
    match node.value {
        DeValue::String(text) => Formula::parse(text, variables).map_err(|error| node.at().error(error)),
        DeValue::Integer(_) | DeValue::Float(_) => f64::read(node).map(Formula::constant),
        _ => Err(node.refuse(form)),
    }
}

impl FieldFormula {
    /// Returns the value as a function of position and time.
    ///
    /// # Errors
    /// A value at one of the points and times is not finite. `at` is the location of the formula.
    pub(super) fn over_time<const D: usize>(
        &self,
        at: &Location,
        points: &[Point<D>],
        times: &[f64],
    ) -> Result<impl Fn(&Point<D>, f64) -> f64 + Send + Sync + use<D>, ScenarioError> {
        for (x, t) in points.iter().flat_map(|x| times.iter().map(move |t| (x.as_slice(), *t))) {
            let value = self.0.at(x, t).value;
            if !value.is_finite() {
                let formula = self.0.text();
                return Err(
                    at.invalid(format!("the formula `{formula}` is {value} at {x:?}, t = {t}; change it there"))
                );
            }
        }
        let formula = self.0.clone();
        Ok(move |x: &Point<D>, t| formula.at(x.as_slice(), t).value)
    }
}

/// Vector that may depend on position and time.
pub type Field = At<Components<FieldFormula>>;

impl Field {
    /// Returns the vector if all of its components are numbers.
    pub(super) fn constant<const D: usize>(&self) -> Option<Vector<D>> {
        let is_constant = self.iter().all(|local| local.0.is_constant());
        is_constant.then(|| Vector::from_fn(|axis, _| self[axis].0.at(&[], 0.0).value))
    }

    /// Returns the field as a function of position and time.
    ///
    /// # Errors
    /// A value at one of the points and times is not finite.
    pub(super) fn over_time<const D: usize>(
        &self,
        points: &[Point<D>],
        times: &[f64],
    ) -> Result<TimeField<D>, ScenarioError> {
        if let Some(value) = self.constant() {
            return Ok(Arc::new(move |_, _| value));
        }
        let local = |(axis, local): (usize, &FieldFormula)| local.over_time(&self.at.part(axis), points, times);
        let axes = self.iter().enumerate().map(local).collect::<Result<Vec<_>, _>>()?;
        Ok(Arc::new(move |x, t| Vector::from_fn(|axis, _| axes[axis](x, t))))
    }

    /// Returns the field of a body that is shifted: positions in formulas are those before the shift.
    ///
    /// # Errors
    /// As [`Self::over_time`].
    pub(super) fn before_shift<const D: usize>(
        &self,
        shift: Vector<D>,
        points: &[Point<D>],
        times: &[f64],
    ) -> Result<TimeField<D>, ScenarioError> {
        let before: Vec<_> = points.iter().map(|x| x - shift).collect();
        let field = self.over_time(&before, times)?;
        Ok(if shift == Vector::<D>::zeros() { field } else { Arc::new(move |x, t| field(&(x - shift), t)) })
    }

    /// Returns the field at the start as a function of position.
    ///
    /// # Errors
    /// As [`Self::over_time`].
    pub(super) fn at_start<const D: usize>(&self, points: &[Point<D>]) -> Result<PointField<D>, ScenarioError> {
        let field = self.over_time(points, &[0.0])?;
        Ok(Arc::new(move |x| field(x, 0.0)))
    }
}
