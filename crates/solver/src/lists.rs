//! A state as lists of numbers, for checkpoints.

use algebra::time::Level;
use body::BodyState;
use mesh::{Point, Vector};
use xfem_space::XfemSpace;

use crate::overlay::overlay;
use crate::setup::FluidSetup;
use crate::state::KineticProducts;
use crate::{Error, FluidState, Setup, State, StepError};

impl<const D: usize> State<D> {
    /// Returns the numbers of the state that setup and geometry do not determine. [`State::from_lists`] restores the
    /// same state from them, bit for bit.
    ///
    /// Lists: step, time and contact energy. For each body: displacements, velocities and accelerations, one vector
    /// after the other, and [`BodyState::inner`]. If there is a fluid: the time of its pressure with the products of
    /// velocity and acceleration; velocities, accelerations and pressures of the dofs; for each body the positions at
    /// which the background was cut.
    pub fn to_lists(&self) -> Vec<Vec<f64>> {
        let mut lists = vec![vec![self.step as f64, self.time, self.contact_energy]];
        for body in &self.bodies {
            let Level { displacement, velocity, acceleration } = &body.level;
            lists.extend([displacement, velocity, acceleration].map(|values| flat(values)));
            lists.push(body.inner.clone());
        }
        if let Some(fluid) = &self.fluid {
            let [uu, ua, aa] = fluid.products.0;
            lists.push(vec![fluid.pressure_time, uu, ua, aa]);
            lists.extend([flat(&fluid.velocity), flat(&fluid.acceleration), fluid.pressure.clone()]);
            lists.extend(fluid.positions.iter().map(|positions| flat(positions)));
        }
        lists
    }

    /// Restores a state from the lists of [`State::to_lists`]. Cut and space are computed from the positions and the
    /// time.
    ///
    /// # Errors
    /// [`StepError`]: the setup does not pass [`Setup::check`], the lists do not have the lengths of this setup, or the
    /// surfaces cannot cut the background.
    pub fn from_lists(setup: &Setup<D>, lists: &[Vec<f64>]) -> Result<Self, StepError> {
        Self::read(setup, lists).map_err(|source| StepError::at(0, 0.0, source))
    }

    fn read(setup: &Setup<D>, lists: &[Vec<f64>]) -> Result<Self, Error> {
        setup.check()?;
        let mut lists = Lists(lists);
        let first = lists.list("step, time and contact energy", 3)?;
        let mut bodies = Vec::new();
        for body in &setup.bodies {
            let n = body.reference().len();
            let displacement = lists.vectors("displacements of a body", n)?;
            let velocity = lists.vectors("velocities of a body", n)?;
            let acceleration = lists.vectors_or_none("accelerations of a body", n)?;
            let inner = lists.list("own numbers of a body", body.initial().inner.len())?.to_vec();
            bodies.push(BodyState { level: Level { displacement, velocity, acceleration }, inner });
        }
        let fluid = setup.fluid.as_ref().map(|fluid| lists.fluid(setup, fluid, first[1])).transpose()?;
        lists.end()?;
        Ok(Self { step: first[0] as usize, time: first[1], fluid, bodies, contact_energy: first[2] })
    }
}

fn flat<const D: usize>(vectors: &[Vector<D>]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.iter().copied()).collect()
}

/// The lists that are still to be read.
struct Lists<'a>(&'a [Vec<f64>]);

impl<'a> Lists<'a> {
    /// Takes the next list, which has a given length.
    fn list(&mut self, what: &'static str, length: usize) -> Result<&'a [f64], Error> {
        let found = self.0.first().map(Vec::len);
        let (Some((first, rest)), true) = (self.0.split_first(), found == Some(length)) else {
            return Err(Error::Lists { what, expected: length, found: found.unwrap_or(0) });
        };
        self.0 = rest;
        Ok(first)
    }

    fn vectors<const D: usize>(&mut self, what: &'static str, n: usize) -> Result<Vec<Vector<D>>, Error> {
        Ok(self.list(what, n * D)?.chunks_exact(D).map(Vector::from_column_slice).collect())
    }

    /// Takes the next list, of vectors, which may be empty.
    fn vectors_or_none<const D: usize>(&mut self, what: &'static str, n: usize) -> Result<Vec<Vector<D>>, Error> {
        let is_empty = self.0.first().is_some_and(Vec::is_empty);
        self.vectors(what, if is_empty { 0 } else { n })
    }

    fn fluid<const D: usize>(
        &mut self,
        setup: &Setup<D>,
        fluid: &FluidSetup<D>,
        time: f64,
    ) -> Result<FluidState<D>, Error> {
        let numbers = self.list("time of the pressure and kinetic products", 4)?;
        // The number of dofs is known once the background is cut, for which the last lists are needed.
        let (of_dofs, of_bodies) = self.0.split_at(self.0.len().min(3));
        self.0 = of_bodies;
        let bodies = setup.bodies.iter();
        let positions: Vec<Vec<Point<D>>> = bodies
            .map(|body| self.vectors("positions at the cut", body.reference().len()))
            .collect::<Result<_, _>>()?;
        let cut = overlay(setup, fluid, &positions, time)?;
        let space = XfemSpace::new(&fluid.background, &cut);
        let (mut of_dofs, n) = (Lists(of_dofs), space.len());
        let velocity = of_dofs.vectors("velocities of the fluid", n)?;
        let acceleration = of_dofs.vectors_or_none("accelerations of the fluid", n)?;
        let pressure = of_dofs.list("pressures of the fluid", n)?.to_vec();
        let products = KineticProducts([numbers[1], numbers[2], numbers[3]]);
        Ok(FluidState { positions, cut, space, velocity, acceleration, pressure, pressure_time: numbers[0], products })
    }

    fn end(&self) -> Result<(), Error> {
        match self.0.first() {
            None => Ok(()),
            Some(list) => Err(Error::Lists { what: "nothing more", expected: 0, found: list.len() }),
        }
    }
}
