//! Fluid and mortar of a scenario.

use cutcell::OverlayOptions;
use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::Coordinates;
use solver::interface_dg::terms::PenaltyProfile;
use solver::{ConvectionForm, FilmSetup, FluidSetup, Stabilisation};

use super::background::{Background, background};
use super::body::BodyKeys;
use super::condition::fluid_boundary;
use super::error::{ScenarioError, sorted};
use super::field::Field;
use super::key::Quantity;
use super::table::{At, OrTable, choices, keys};
use super::units::Units;

keys! {
    /// The fluid.
    pub struct Fluid {
        /// Density.
        density: f64 [unit(Quantity::DENSITY), positive],
        /// Dynamic viscosity.
        viscosity: f64 [unit(Quantity::VISCOSITY), positive],
        /// Stabilisation of fluid and interface: a set of parameters, or a table with a set and changes.
        stabilisation: At<OrTable<StabilisationChoice, StabilisationKeys>> = "standard",
        /// Form of the convective term.
        convection: ConvectionChoice = "standard",
        /// Flux along films between bodies and walls that are thinner than four cells, which cells do not resolve; not
        /// modelled if left out.
        film: Option<At<FilmKeys>>,
        /// Force per volume; none if left out.
        body_force: Option<Field> [unit(Quantity::FORCE_DENSITY)],
        /// Velocity at the start; at rest if left out.
        initial_velocity: Option<Field> [unit(Quantity::VELOCITY)],
    }
}

keys! {
    /// Films between bodies, and between bodies and walls.
    pub struct FilmKeys {
        /// Height of the asperities of two opposite surfaces together; a thinner film has the conductance of this thickness, or
        /// of the extent of its cell across the film if that is less.
        roughness: f64 [unit(Quantity::LENGTH), non_negative] = 0.0,
        /// Lowest pressure in films, at which vapour appears: the pressure of the vapour minus that of the
        /// surroundings, -1e5 Pa for water in air; not bounded if left out.
        floor: Option<At<f64>> [unit(Quantity::PRESSURE)],
    }
}

choices! {
    /// A set of stabilisation parameters.
    #[derive(Copy, Eq)]
    pub enum StabilisationChoice {
        /// The set for all problems, with which the method is verified.
        Standard = "standard",
        /// A calibration to the results of MOX-Report 44/2019: `γ_Σ = 1e5`, and a numerical viscosity that does not vanish
        /// under refinement.
        Paper = "paper-44-2019",
    }
}

keys! {
    /// A set of stabilisation parameters with changes.
    pub struct StabilisationKeys {
        /// The set.
        set: StabilisationChoice = "standard",
        /// Penalty on the jump of the velocity at the interface.
        penalty: Option<InterfacePenalty>,
        /// Interior penalty of the velocity.
        cip: Option<Cip>,
        /// Parameter `γ_p` of the interior penalty of the pressure.
        gamma_pressure: Option<f64> [positive],
        /// Parameter `γ_g` of the ghost penalty.
        gamma_ghost: Option<f64> [non_negative],
        /// Time in the weight of the interior penalty of the pressure; that of the step if left out. A fixed time makes the
        /// weight independent of the step, for studies of the step.
        time: Option<f64> [unit(Quantity::TIME), positive],
    }
}

choices! {
    /// Penalty on the jump of the velocity at the interface.
    pub enum InterfacePenalty ["kind"] {
        /// Viscosity in both directions, convection and inertia in the normal one only.
        Split = "split" {
            /// Parameter `γ_n`.
            gamma_normal: f64 [positive],
            /// Parameter `γ_t`.
            gamma_tangential: f64 [positive],
        },
        /// Viscosity alone, the form of the paper.
        Uniform = "uniform" {
            /// Parameter `γ_Σ`.
            gamma_sigma: f64 [positive],
        },
    }
}

choices! {
    /// Interior penalty of the velocity.
    pub enum Cip ["profile"] {
        /// Weights a face by its measure; calibrated to the results of the paper.
        Paper = "paper" {
            /// Parameter `γ_1`; in the plane a length, 0.7 cm in the set of the paper: state it in other units.
            gamma_1: f64 [non_negative],
        },
        /// Weights a face by the square of its diameter; vanishes under refinement.
        Consistent = "consistent" {
            /// Parameter `γ_u`.
            gamma_u: f64 [non_negative],
        },
    }
}

impl Fluid {
    /// Returns the name of the set of stabilisation parameters, and whether some are changed.
    pub fn stabilisation_name(&self) -> String {
        let name = |set: &StabilisationChoice| match set {
            StabilisationChoice::Standard => "standard",
            StabilisationChoice::Paper => "paper-44-2019",
        };
        match &*self.stabilisation {
            OrTable::Plain(set) => name(set).to_owned(),
            OrTable::Table(table) => format!("{}, changed", name(&table.set)),
        }
    }

    /// Checks that the units allow the set of the paper, which contains a length in centimetres in 2D.
    pub(super) fn check(&self, units: &Units, dimension: usize) -> Result<(), ScenarioError> {
        let has_length = match &*self.stabilisation {
            OrTable::Plain(set) => *set == StabilisationChoice::Paper,
            OrTable::Table(table) => table.set == StabilisationChoice::Paper && table.cip.is_none(),
        };
        let length = units.label(Quantity::LENGTH);
        if !has_length || length == "cm" || dimension != 2 {
            return Ok(());
        }
        Err(self.stabilisation.at.invalid(format!(
            "`gamma_1` of this set is 0.7 cm, and lengths are in {length}; state it in {length}: {{ set = \"paper-44-2019\", cip = {{ profile = \"paper\", gamma_1 = ... }} }}"
        )))
    }
}

choices! {
    /// Form of the convective term.
    #[derive(Copy, Eq)]
    pub enum ConvectionChoice {
        /// `ρ (u·∇u, v)`.
        Standard = "standard",
        /// `ρ (u·∇u, v) + ρ/2 (∇·u, u·v)`.
        Skew = "skew",
        /// No convection: Stokes flow.
        None = "none",
    }
}

keys! {
    /// Mortar between fluid and bodies.
    pub struct Interface {
        /// Weight of the traction of the fluid; the rest is that of elastic bodies. Below 1 a run ends at once if the
        /// penalty is too small for the stiffness of the bodies.
        alpha: At<f64> [between(0.0, 1.0)] = 1.0,
    }
}

fn stabilisation(given: &OrTable<StabilisationChoice, StabilisationKeys>) -> Stabilisation {
    let of_set = |set| match set {
        StabilisationChoice::Standard => Stabilisation::STANDARD,
        StabilisationChoice::Paper => Stabilisation::PAPER_44_2019,
    };
    let table = match given {
        OrTable::Plain(set) => return of_set(*set),
        OrTable::Table(table) => table,
    };
    let set = of_set(table.set);
    let penalty = table.penalty.as_ref().map(|penalty| match *penalty {
        InterfacePenalty::Split { gamma_normal, gamma_tangential } => {
            PenaltyProfile::Split { gamma_normal, gamma_tangential }
        }
        InterfacePenalty::Uniform { gamma_sigma } => PenaltyProfile::Uniform { gamma_sigma },
    });
    let cip = table.cip.as_ref().map(|cip| match *cip {
        Cip::Paper { gamma_1 } => CipProfile::Paper { gamma_1 },
        Cip::Consistent { gamma_u } => CipProfile::Consistent { gamma_u },
    });
    Stabilisation {
        penalty: penalty.unwrap_or(set.penalty),
        cip: cip.unwrap_or(set.cip),
        gamma_pressure: table.gamma_pressure.unwrap_or(set.gamma_pressure),
        gamma_ghost: table.gamma_ghost.unwrap_or(set.gamma_ghost),
        time: table.time.or(set.time),
    }
}

/// Builds the fluid with its boundary conditions and the weight of its traction in the mortar; `times` are the start
/// and the end of the run.
pub(super) fn fluid<const D: usize>(
    fluid: &Fluid,
    alpha: f64,
    coordinates: Coordinates,
    given: &At<Background>,
    bodies: &[At<BodyKeys>],
    times: [f64; 2],
) -> Result<FluidSetup<D>, ScenarioError> {
    let background = background::<D>(given, bodies)?;
    let background = background.with_coordinates(coordinates).map_err(|error| given.at.error(error))?;
    let conditions = given.boundary();
    let sides = background.boundary_names();
    if let Some((name, condition)) = conditions.0.iter().find(|(name, _)| !sides.contains(&name.as_str())) {
        return Err(condition.at.unknown("side", name, sorted(sides)));
    }
    let mut boundary = Vec::new();
    for side in sides {
        let found = conditions.0.iter().find(|(name, _)| name == side).zip(background.tag(side));
        let missing = || conditions.at.invalid(format!("the condition on side `{side}` is missing; add it"));
        let ((_, condition), tag) = found.ok_or_else(missing)?;
        boundary.push((tag, fluid_boundary(&background, tag, condition, times)?));
    }
    // Elastic bodies are compressible.
    let makes_room =
        boundary.iter().any(|(_, condition)| condition.is_open()) || bodies.iter().any(|body| body.motion.is_none());
    let floor = fluid.film.as_ref().and_then(|film| film.floor.as_ref());
    if let Some(floor) = floor.filter(|_| !makes_room) {
        return Err(floor.at.invalid(
            "no side is open, and no body is elastic: the vapour would take a volume that the fluid cannot leave, and its pressure has no level that the floor refers to; make a side `free`, or leave the floor out",
        ));
    }
    let points = background.vertices();
    let body_force = fluid.body_force.as_ref().map(|force| force.over_time(points, &times)).transpose()?;
    let initial_velocity = fluid.initial_velocity.as_ref().map(|velocity| velocity.at_start(points)).transpose()?;
    Ok(FluidSetup {
        background,
        // Surfaces are simple at the start. During a run an elastic body may fold onto itself.
        overlay: OverlayOptions::new().without_self_intersection_check(),
        material: NewtonianFluid { density: fluid.density, viscosity: fluid.viscosity },
        stabilisation: stabilisation(&fluid.stabilisation),
        film: fluid
            .film
            .as_ref()
            .map(|film| FilmSetup { roughness: film.roughness, floor: film.floor.as_deref().copied() }),
        alpha,
        convection: match fluid.convection {
            ConvectionChoice::Standard => Some(ConvectionForm::Standard),
            ConvectionChoice::Skew => Some(ConvectionForm::Skew),
            ConvectionChoice::None => None,
        },
        body_force,
        initial_velocity,
        boundary,
    })
}
