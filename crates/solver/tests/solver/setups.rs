//! Invalid setups, with the message of each.

use std::error::Error as _;
use std::sync::Arc;

use crate::fixture::*;
use solver::body::Body;
use solver::contact::{self, ContactForm, PenaltyLaw};
use solver::mesh::generate::structured_box;
use solver::mesh::{BodyId, Tag};
use solver::{Contact, FluidBoundary, Setup, State};

#[test]
fn contacts_of_bodies_with_themselves_or_with_none_are_refused() {
    let bodies = dry(vec![Arc::new(rigid("ball", &disk([0.0; 2], 1.0, 0.4), 1.0, V::zeros()))], 1.0).bodies;
    let refused = |slave: u32, obstacle| {
        let form = ContactForm::new(PenaltyLaw::new(1.0, 0.0).expect("a law"), 1.0).expect("a contact");
        Contact::new(&bodies, BodyId(slave), Vec::new(), form, obstacle).err()
    };
    assert_eq!(refused(0, against(0, &bodies)), Some(contact::Error::SelfContact));
    let unknown = contact::Error::UnknownBody { body: BodyId(1), n_bodies: 1 };
    assert_eq!(refused(1, ground()), Some(unknown));
}

#[test]
fn setups_that_cannot_run_are_refused() {
    fn brick() -> Arc<dyn Body<2>> {
        let mesh = structured_box([6.0, 6.0], [7.0, 7.0], [1, 1]).expect("a box");
        Arc::new(rigid("brick", &mesh, 1.0, V::zeros()))
    }
    fn with_mass(mass: f64) -> Arc<dyn Body<2>> {
        let mut body = rigid("ball", &disk([6.0, 6.0], 0.5, 0.4), 1.0, V::zeros());
        body.mass.mass = mass;
        Arc::new(body)
    }
    type Change = fn(&mut Setup<2>);
    let refused: [(Change, &str); 13] = [
        (|setup| setup.bodies[1] = with_mass(-1.0), "mass of a body is -1.0"),
        (
            |setup| on_sides(setup, &["top", "top"], || FluidBoundary::NoSlip),
            "two conditions on sides with the tag \"top\"",
        ),
        (
            |setup| fluid_of(setup).boundary = vec![(Tag(17), FluidBoundary::NoSlip)],
            "condition 0 of the fluid has a tag",
        ),
        (|setup| fluid_of(setup).material.density = -1.0, "density of the fluid is -1.0"),
        (|setup| fluid_of(setup).material.viscosity = 0.0, "viscosity is 0.0"),
        (|setup| fluid_of(setup).stabilisation.time = Some(-1.0), "time of the stabilisation is -1.0"),
        (|setup| setup.dt = 0.0, "time step is 0.0, but must be positive"),
        (|setup| setup.dt = -1e-3, "time step is -0.001"),
        (|setup| setup.dt = f64::NAN, "time step is NaN"),
        (|setup| on_sides(setup, &["left"], || FluidBoundary::symmetry(2)), "normal of a symmetry or flow is 0.0"),
        (|setup| setup.bodies.truncate(1), "body 1 is not among the 1 bodies"),
        (|setup| setup.bodies[0] = brick(), "is not among the 4 facets"),
        (|setup| setup.bodies[1] = Arc::clone(&setup.bodies[0]), "the body to which its boundary belongs"),
    ];
    for (change, words) in refused {
        let mut setup = falling_ball(0.9, 0.3, 0.6, false);
        setup.bodies.push(brick());
        setup.contacts.push(contact(&setup.bodies, 0, (1.0, 0.0, 1.0), against(1, &setup.bodies)));
        change(&mut setup);
        let error = State::initial(&setup).expect_err(words);
        let causes = [Some(error.source.to_string()), error.source.source().map(ToString::to_string)];
        assert!(causes.iter().flatten().any(|cause| cause.contains(words)), "{causes:?}");
    }
}
