//! The fluid in one step: cut, space, history, terms and boundary values.

use std::time::Instant;

use algebra::time::{Affine, Level};
use algebra::{BlockLayout, Constraints, Contributions, FieldId, Integral, Sites as _, power};
use body::{BodyStep, StepTime};
use cutcell::CutMesh;
use fluid_ns::terms::{
    Backflow, BodyForce, Cavitation, CipPressure, CipVelocity, Convection, Film, GhostPenalty, Hoop, HoopConvection,
    Incompressibility, Inertia, Traction, Viscous,
};
use fluid_ns::{FilmSurfaces, FilmValues, FluidFields, FluidForm, FluidGeometry, OpenBoundary, OpenPoint};
use interface_dg::{InterfacePoints, MortarForm, PieceValues};
use mesh::{Aabb, Point, Tag, Vector, facet_normal};
use xfem_space::{
    BoundaryPoint, FaceValue, PartValues, Sources, XfemSpace, boundary_dofs, boundary_points, face_values,
    symmetry_values,
};

use crate::extension::Extension;
use crate::overlay::overlay;
use crate::setup::{ConvectionForm, FluidBoundary, FluidSetup, TractionField};
use crate::state::KineticProducts;
use crate::surfaces::Surfaces;
use crate::{Error, FluidState, Setup, Stabilisation, State};

/// Degree of quadrature on interface pieces: products of two P1 functions.
const PIECE_DEGREE: usize = 2;
/// Degree of quadrature on open boundaries: products of three P1 functions.
const BOUNDARY_DEGREE: usize = 3;

/// Stiffness `C` of the penalty for vapour: pressures fall below the floor by about a thousandth of their differences
/// in the film.
const VAPOUR: f64 = 1e3;

/// The fluid in one step.
pub(crate) struct FluidStep<'a, const D: usize> {
    pub(crate) setup: &'a FluidSetup<D>,
    /// Positions of the vertices of each body at which the mesh is cut.
    pub(crate) positions: Vec<Vec<Point<D>>>,
    pub(crate) cut: CutMesh<D>,
    pub(crate) space: XfemSpace<D>,
    pub(crate) parts: PartValues<D>,
    faces: Vec<FaceValue<D>>,
    films: Option<FilmValues<D>>,
    pieces: PieceValues<D>,
    pub(crate) sources: Sources,
    /// Velocity `u*` and acceleration at the start on the space of the step, one value per dof.
    start: Level<Vector<D>>,
    /// Velocity extrapolated to the stage, for the weights of stabilisations; `None` if accelerations are not known.
    extrapolated: Option<Vec<Vector<D>>>,
    pub(crate) time: StepTime,
    /// Acceleration at the stage.
    acceleration: Affine<Vector<D>>,
    pub(crate) velocity: FieldId,
    pub(crate) pressure: FieldId,
    pub(crate) form: FluidForm<'a, D>,
    pub(crate) mortar: MortarForm,
    open_boundaries: Vec<OpenTerms<'a, D>>,
    /// Wall-clock time of the cut, s.
    pub(crate) seconds_cut: f64,
    /// Wall-clock time of the transfer of the history, s.
    pub(crate) seconds_transfer: f64,
}

/// Points and terms of one open boundary.
struct OpenTerms<'a, const D: usize> {
    points: Vec<BoundaryPoint<D>>,
    traction: Option<Traction<'a, D>>,
    backflow: Option<Backflow>,
}

impl<'a, const D: usize> FluidStep<'a, D> {
    /// Cuts the background, builds the space on the cut, transfers the velocity and registers the unknowns. Returns
    /// `None` without a fluid.
    pub(crate) fn new(
        setup: &'a Setup<D>,
        previous: &State<D>,
        time: &StepTime,
        layout: &mut BlockLayout,
    ) -> Result<Option<Self>, Error> {
        let (Some(fluid), Some(before)) = (&setup.fluid, &previous.fluid) else { return Ok(None) };
        let bodies = setup.bodies.iter().zip(&previous.bodies);
        let positions: Vec<_> = bodies.map(|(body, state)| body.geometry(state, time)).collect();
        check_domain(setup, fluid.background.vertices(), &positions)?;
        let background = &fluid.background;
        let clock = Instant::now();
        let cut = overlay(setup, fluid, &positions, time.end)?;
        let seconds_cut = clock.elapsed().as_secs_f64();
        let space = XfemSpace::new(background, &cut);
        let clock = Instant::now();
        let sources = Sources::between(background, &before.cut, &before.space, &cut, &space);
        let mut seconds_transfer = clock.elapsed().as_secs_f64();
        let parts = PartValues::new(background, &cut);
        let mut faces = face_values(background, &cut, &space, &parts);
        for (tag, condition) in &fluid.boundary {
            if let FluidBoundary::Symmetry { normal } = condition {
                faces.extend(symmetry_values(background, &cut, &space, &parts, *tag, *normal));
            }
        }
        let mut films = fluid.film.map(|film| {
            let surfaces = FilmSurfaces::new(&setup.surfaces(&positions), background, |tag| fluid.is_wall(tag));
            let mut films = FilmValues::new(background, &cut, &parts, &surfaces, film.roughness);
            films.extend_to_edges(background, &cut, &space, &parts, &faces, &surfaces);
            if let Some(force) = &fluid.body_force {
                films.set_rest(background, &cut, |x| force(x, time.stage()));
            }
            films
        });
        let of_bodies: Vec<_> = setup.bodies.iter().map(|body| body.surface()).collect();
        let mut pieces = PieceValues::new(background, &cut, &parts, &of_bodies, PIECE_DEGREE);
        if let Some(films) = &mut films {
            pieces.set_films(&cut, &of_bodies, films);
            let slip = fluid.stabilisation.penalty.slip_share();
            films.subtract_slip(background, &cut, slip, |piece| pieces.viscous_length(piece));
        }
        let clock = Instant::now();
        let (at_start, lead) = (setup.positions(&previous.bodies), time.weights.extrapolated[0].velocity);
        let surfaces = Surfaces {
            setup,
            previous,
            at_start,
            positions: &positions,
            lead,
            cut: &cut,
            space: &space,
            parts: &parts,
        };
        let extension = Extension { cut: &cut, space: &space, faces: &faces, pieces: &pieces, sources: &sources };
        let start = surfaces.carry(before, &extension).map_err(Error::Extension)?;
        seconds_transfer += clock.elapsed().as_secs_f64();
        let moved = |(u, a): (&Vector<D>, &Vector<D>)| u + a * lead;
        let extrapolated: Option<Vec<_>> = (!start.acceleration.is_empty())
            .then(|| start.velocity.iter().zip(&start.acceleration).map(moved).collect());
        let at_stage = extrapolated.as_ref().unwrap_or(&start.velocity);
        pieces.set_relative_speeds(&cut, &space, at_stage, |item| surfaces.extrapolated_velocities(item));
        if !start.acceleration.is_empty() {
            let of_bodies = |item| surfaces.accelerations(item, &start.velocity);
            pieces.set_relative_accelerations(&cut, &space, &start.acceleration, of_bodies);
        }
        let acceleration = Affine::new(&time.weights.stage_acceleration, &start);
        let velocity = layout.push_keyed("velocity", space.keys(), D);
        let pressure = layout.push_on(velocity, "pressure", 1);
        let (stage, rate) = (time.stage(), acceleration.slope);
        Ok(Some(Self {
            setup: fluid,
            form: form(fluid, rate, stage),
            mortar: MortarForm::new(fluid.material, fluid.stabilisation.penalty, rate),
            open_boundaries: open_boundaries(fluid, &cut, stage),
            seconds_cut,
            seconds_transfer,
            positions,
            cut,
            space,
            parts,
            faces,
            films,
            pieces,
            sources,
            start,
            extrapolated,
            time: *time,
            acceleration,
            velocity,
            pressure,
        }))
    }

    /// Returns the geometry with known velocity and acceleration for fluid terms.
    pub(crate) fn geometry(&self) -> FluidGeometry<'_, D> {
        FluidGeometry {
            background: &self.setup.background,
            cut: &self.cut,
            space: &self.space,
            parts: &self.parts,
            faces: &self.faces,
            known_velocity: self.extrapolated.as_deref().unwrap_or(&self.start.velocity),
            acceleration: &self.acceleration,
            films: self.films.as_ref(),
        }
    }

    pub(crate) fn fields<'p>(&self, layout: &'p BlockLayout) -> FluidFields<'p> {
        FluidFields { layout, velocity: self.velocity, pressure: self.pressure }
    }

    /// Returns the interface with the bodies of the step.
    pub(crate) fn interface<'p>(
        &'p self,
        layout: &'p BlockLayout,
        bodies: &'p [Box<dyn BodyStep<D> + 'p>],
    ) -> InterfacePoints<'p, D> {
        InterfacePoints {
            geometry: self.geometry(),
            fields: self.fields(layout),
            values: &self.pieces,
            surfaces: bodies.iter().map(|body| body.surface()).collect(),
            fluid: self.setup.material,
            solid: None,
        }
    }

    /// Returns the terms on parts, faces and open boundaries.
    pub(crate) fn contributions<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let (geometry, fields) = (self.geometry(), self.fields(layout));
        let mut all = self.form.contributions(geometry, fields);
        all.extend(self.open_terms(layout));
        all
    }

    /// Returns the terms on open boundaries.
    pub(crate) fn open_terms<'p>(&'p self, layout: &'p BlockLayout) -> Vec<Box<dyn Contributions + 'p>> {
        let (geometry, fields) = (self.geometry(), self.fields(layout));
        let integral = |OpenTerms { points, traction, backflow }: &'p OpenTerms<'a, D>| {
            let points = OpenBoundary { geometry, fields, points };
            let mut integral = Integral::linear("open boundary", points, Vec::new());
            integral.extend(traction.as_ref());
            integral.extend(backflow.as_ref());
            Box::new(integral) as Box<dyn Contributions + 'p>
        };
        self.open_boundaries.iter().map(integral).collect()
    }

    /// Returns the power of the backflow on open boundaries.
    pub(crate) fn backflow_power(&self, layout: &BlockLayout, x: &[f64]) -> f64 {
        let (geometry, fields) = (self.geometry(), self.fields(layout));
        let of_terms = |OpenTerms { points, backflow, .. }: &OpenTerms<'a, D>| {
            let points = OpenBoundary { geometry, fields, points };
            backflow.as_ref().map_or(0.0, |term| power(&Integral::linear("backflow", points, vec![term]), x))
        };
        self.open_boundaries.iter().map(of_terms).sum()
    }

    /// Returns the kinetic energy of the fluid that enters during the step through sides without the term for backflow.
    /// It is a part of the work of convection.
    pub(crate) fn inflow_energy(&self, layout: &BlockLayout, x: &[f64]) -> f64 {
        let (geometry, fields, density) = (self.geometry(), self.fields(layout), self.setup.material.density);
        let of_side = |(tag, condition): &(Tag, FluidBoundary<D>)| {
            let has_energy = match condition {
                FluidBoundary::Velocity(_) | FluidBoundary::Parallel { .. } => true,
                FluidBoundary::Open { backflow, .. } => !backflow,
                FluidBoundary::NoSlip | FluidBoundary::Symmetry { .. } => false,
            };
            if !has_energy || self.setup.convection.is_none() {
                return 0.0;
            }
            let points = &boundary_points(&self.setup.background, &self.cut, *tag, BOUNDARY_DEGREE);
            let (sites, mut power) = (OpenBoundary { geometry, fields, points }, 0.0);
            for item in 0..sites.len() {
                sites.visit(item, x, |OpenPoint { at, velocity: u, .. }| {
                    power -= 0.5 * density * at.weight * u.norm_squared() * u.dot(&at.normal).min(0.0);
                });
            }
            power
        };
        self.time.length * self.setup.boundary.iter().map(of_side).sum::<f64>()
    }

    /// Constrains the velocity on the boundary such that its values at the end of the step are the given ones. At a
    /// vertex with several conditions, walls override prescribed velocities. Planes of symmetry and parallel outflows
    /// are combined and do not change other values.
    pub(crate) fn constrain(&self, layout: &BlockLayout, constraints: &mut Constraints) {
        let background = &self.setup.background;
        let dofs = |tag| boundary_dofs(background, &self.cut, &self.space, tag).into_iter();
        let start = |dof: u32| self.start.velocity[dof as usize];
        let mut set = |dof: u32, end: Vector<D>| {
            for (axis, place) in layout.node(self.velocity, dof as usize).enumerate() {
                constraints.set(place, self.time.weights.stage_velocity(end[axis], start(dof)[axis]));
            }
        };
        for (tag, condition) in &self.setup.boundary {
            let FluidBoundary::Velocity(velocity) = condition else { continue };
            dofs(*tag).for_each(|dof| set(dof, velocity(&background.vertex(self.space.vertex(dof)), self.time.end)));
        }
        for (tag, _) in self.setup.boundary.iter().filter(|(_, of)| matches!(of, FluidBoundary::NoSlip)) {
            dofs(*tag).for_each(|dof| set(dof, Vector::zeros()));
        }
        for (tag, condition) in &self.setup.boundary {
            for across in condition.without_flow() {
                for dof in dofs(*tag) {
                    let equation: Vec<_> =
                        layout.node(self.velocity, dof as usize).zip(across.iter().copied()).collect();
                    constraints.impose(&equation, self.time.weights.stage_velocity(0.0, across.dot(&start(dof))));
                }
            }
        }
        self.end_films(layout, constraints);
    }

    /// Prescribes the pressure where films end at open boundaries: minus the given normal traction. The film term does
    /// not contain this traction. Its natural condition is zero flux, which would close the end of the film.
    fn end_films(&self, layout: &BlockLayout, constraints: &mut Constraints) {
        let (Some(films), background) = (&self.films, &self.setup.background) else { return };
        for piece in self.cut.boundary().iter().filter(|piece| films.of(piece.part).is_some()) {
            let tag = background.facet_tag(piece.facet);
            let condition = self.setup.condition(tag);
            if !self.setup.is_open(tag) {
                continue;
            }
            let normal = facet_normal(&background.facet_points(piece.facet)[..D]);
            let cell = background.cell(self.cut.part_cell(piece.part));
            for vertex in background.facet(piece.facet) {
                let Some(local) = cell.iter().position(|v| v == vertex) else { continue };
                let of_traction = |traction: &TractionField<D>| {
                    -traction(&background.vertex(*vertex), &normal, self.time.stage()).dot(&normal)
                };
                let pressure = condition.and_then(FluidBoundary::traction).map_or(0.0, of_traction);
                let dof = self.space.dofs(piece.part)[local];
                constraints.set(layout.dof(self.pressure, dof as usize, 0), pressure);
            }
        }
    }

    /// Writes the transferred velocity, and the pressures of the previous step (zero at dofs without one).
    pub(crate) fn guess(&self, layout: &BlockLayout, pressure: &[f64], x: &mut [f64]) {
        layout.set(self.velocity, self.start.velocity.iter().map(|u| (*u).into()), x);
        let earlier = self.sources.earlier_dofs().iter();
        layout.set(self.pressure, earlier.map(|dof| [dof.map_or(0.0, |dof| pressure[dof as usize])]), x);
    }

    /// Returns velocity and acceleration at the end of the step.
    fn end(&self, layout: &BlockLayout, x: &[f64]) -> Level<Vector<D>> {
        let velocity: Vec<Vector<D>> = layout.values(self.velocity, x).map(Vector::from).collect();
        self.time.weights.end(&self.start, &velocity)
    }

    /// Returns the products of velocity and acceleration at the end of the step, on the geometry of the step.
    pub(crate) fn products_at_end(&self, layout: &BlockLayout, x: &[f64]) -> KineticProducts {
        let end = self.end(layout, x);
        self.products(&end.velocity, &end.acceleration)
    }

    fn products(&self, velocity: &[Vector<D>], acceleration: &[Vector<D>]) -> KineticProducts {
        KineticProducts::new(self.setup.material.density, &self.cut, &self.space, &self.parts, [velocity, acceleration])
    }

    /// Returns two values of the energy of the scheme ([`algebra::time::Weights::of_energy`]) at the start of the step,
    /// on the geometry of the step: with the transferred acceleration, and with the acceleration at the end in place of
    /// an unknown one.
    ///
    /// Both are equal unless the acceleration at the start is unknown, as in the first step.
    pub(crate) fn scheme_energies(&self, layout: &BlockLayout, x: &[f64]) -> [f64; 2] {
        let start = &self.start;
        let energy =
            |acceleration: &[Vector<D>]| self.products(&start.velocity, acceleration).scheme_energy(&self.time.weights);
        let carried = energy(&start.acceleration);
        let is_known = !start.acceleration.is_empty();
        [carried, if is_known { carried } else { energy(&self.end(layout, x).acceleration) }]
    }

    /// Returns the fluid at the end of the step.
    pub(crate) fn finish(self, layout: &BlockLayout, x: &[f64]) -> FluidState<D> {
        let pressure = x[layout.range(self.pressure)].to_vec();
        let end = self.end(layout, x);
        let products = self.products(&end.velocity, &end.acceleration);
        let pressure_time = self.time.stage();
        let (Level { velocity, acceleration, .. }, Self { positions, cut, space, .. }) = (end, self);
        FluidState { positions, cut, space, velocity, acceleration, pressure, pressure_time, products }
    }
}

/// Returns an error if a movable body has left the bounding box of the background, where nothing can stop it. A body
/// that is larger than the background may have no vertex in it.
fn check_domain<const D: usize>(
    setup: &Setup<D>,
    background: &[Point<D>],
    positions: &[Vec<Point<D>>],
) -> Result<(), Error> {
    let bounds = Aabb::of_points(background);
    for (body, positions) in setup.bodies.iter().zip(positions) {
        if body.is_movable() && !Aabb::of_points(positions).overlaps(&bounds) {
            return Err(Error::LeftDomain { body: body.name().to_owned() });
        }
    }
    Ok(())
}

/// Returns the terms of the fluid. `rate` is the derivative of the acceleration with respect to the velocity.
fn form<const D: usize>(fluid: &FluidSetup<D>, rate: f64, time: f64) -> FluidForm<'_, D> {
    let (density, viscosity) = (fluid.material.density, fluid.material.viscosity);
    let Stabilisation { cip, gamma_pressure, gamma_ghost, time: of_penalty, .. } = fluid.stabilisation;
    let is_axisymmetric = fluid.background.coordinates().radial().is_some();
    FluidForm {
        inertia: (rate != 0.0).then_some(Inertia { density }),
        viscous: Viscous { viscosity },
        incompressibility: Incompressibility,
        hoop: is_axisymmetric.then_some(Hoop { viscosity }),
        convection: fluid.convection.map(|form| Convection { density, skew: form == ConvectionForm::Skew }),
        hoop_convection: (is_axisymmetric && fluid.convection == Some(ConvectionForm::Skew))
            .then_some(HoopConvection { density }),
        film: fluid.film.map(|_| Film {
            viscosity,
            force: fluid.body_force.as_ref().map(|force| force.as_ref() as _),
            time,
        }),
        cavitation: fluid.film.and_then(|film| film.floor).map(|floor| Cavitation {
            viscosity,
            floor,
            stiffness: VAPOUR,
            enclosed: Vec::new(),
        }),
        body_force: fluid.body_force.as_ref().map(|force| BodyForce { force: force.as_ref(), time }),
        cip_velocity: CipVelocity { profile: cip, density },
        cip_pressure: CipPressure {
            gamma_pressure,
            density,
            viscosity,
            rate: of_penalty.filter(|_| rate != 0.0).map_or(rate, f64::recip),
        },
        ghost_penalty: GhostPenalty { gamma_ghost, viscosity },
    }
}

fn open_boundaries<'a, const D: usize>(fluid: &'a FluidSetup<D>, cut: &CutMesh<D>, time: f64) -> Vec<OpenTerms<'a, D>> {
    let mut open = Vec::new();
    for (tag, condition) in &fluid.boundary {
        let traction = condition.traction();
        let has_backflow = matches!(condition, FluidBoundary::Open { backflow: true, .. });
        if traction.is_some() || has_backflow {
            // Without convection, inflow brings no energy.
            let has_backflow = has_backflow && fluid.convection.is_some();
            open.push(OpenTerms {
                points: boundary_points(&fluid.background, cut, *tag, BOUNDARY_DEGREE),
                traction: traction.map(|traction| Traction { traction: traction.as_ref(), time }),
                backflow: has_backflow.then_some(Backflow { density: fluid.material.density }),
            });
        }
    }
    open
}
