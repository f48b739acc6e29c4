//! The pressure of the fluid on surfaces that move, wet and closed.

use std::collections::HashMap;
use std::sync::Arc;

use algebra::time::Affine;
use algebra::{BlockLayout, Contributions, DofId, FieldId, Integral, for_each_residual, worst_tangent_entry};
use body::{ByDof, SurfaceMotion, SurfaceStress, SurfaceVelocity};
use cutcell::{CutMesh, OverlayOptions};
use fluid_ns::{FluidFields, FluidGeometry};
use interface_dg::terms::{ClosedPressure, MovedPressure};
use interface_dg::{ClosedPoints, FluidStress, InterfacePoints, MovedSurface, PieceValues, SolidShare};
use mesh::generate::structured_box;
use mesh::{BodyId, BoundaryMesh, Coordinates, FacetId, Order, Placed, Point, SimplexMesh, Tensor, Vector, VertexId};
use xfem_space::{PartValues, XfemSpace, face_values};

use crate::FLUID;

/// Returns the derivative of the enclosed volume in a direction, by central differences.
fn change_of_volume<const D: usize>(boundary: &BoundaryMesh<D>, points: &[Point<D>], along: &[Vector<D>]) -> f64 {
    let step = 1e-4;
    let volume = |by: f64| {
        let moved: Vec<Point<D>> = points.iter().zip(along).map(|(x, v)| x + v * by).collect();
        Placed::new(boundary, &moved).enclosed().volume
    };
    (volume(step) - volume(-step)) / (2.0 * step)
}

/// Returns the boundary of a mesh with elements of some order and straight edges, and its nodes.
fn boundary_of<const D: usize>(mesh: &SimplexMesh<D>, order: Order) -> (BoundaryMesh<D>, Vec<Point<D>>) {
    let (mut nodes, mut on_edges) = (mesh.vertices().to_vec(), HashMap::new());
    let (mut element_to_node, mut tags) = (Vec::new(), Vec::new());
    for facet in mesh.facets().filter(|facet| mesh.is_boundary(*facet)) {
        let on_edge = |ends: [VertexId; 2]| {
            *on_edges.entry(ends).or_insert_with(|| {
                nodes.push((mesh.vertex(ends[0]) + mesh.vertex(ends[1])) * 0.5);
                VertexId::new(nodes.len() - 1)
            })
        };
        order.push_nodes(mesh.facet(facet), on_edge, &mut element_to_node);
        tags.push(None);
    }
    let boundary = BoundaryMesh::of_elements(order, element_to_node, &[], &tags);
    (boundary.with_coordinates(mesh.coordinates()), nodes)
}

/// A body without stress.
struct NoStress;

impl<const D: usize> SurfaceStress<D> for NoStress {
    fn dofs(&self, _facet: FacetId, _out: &mut Vec<DofId>) {}

    fn on(&self, _facet: FacetId, _x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        derivatives.clear();
        Vector::zeros()
    }
}

/// A body with curved surface that moves, and a uniform pressure of 2.
struct Moved<'a, const D: usize> {
    /// Reference positions of the nodes.
    points: &'a [Point<D>],
    velocity: &'a [Vector<D>],
    /// Positions at the stage.
    at_stage: &'a [Point<D>],
    field: FieldId,
    interface: InterfacePoints<'a, D>,
    x: Vec<f64>,
}

/// Velocities that differ from place to place, so that opposite sides of a box get different shapes.
fn wave<const D: usize>(shift: f64) -> impl Fn(&Point<D>) -> Vector<D> {
    move |x| Vector::from_fn(|a, _| (3.0 * x[(a + 1) % D] + 1.7 * x[a] + shift + a as f64).sin())
}

/// Length of the step of a body that moves.
const DT: f64 = 0.1;

/// Checks a body that is a distorted box, with its corners at `ends`, in a background from 0 to 2.
fn with_moved_body<const D: usize>(
    coordinates: Coordinates,
    order: Order,
    ends: [f64; 2],
    check: impl FnOnce(&Moved<'_, D>),
) {
    let in_coordinates = |mesh: SimplexMesh<D>| mesh.with_coordinates(coordinates).expect("a mesh off the axis");
    let background = in_coordinates(structured_box::<D>([0.0; D], [2.0; D], [3; D]).expect("a box"));
    let mesh = in_coordinates(structured_box::<D>([ends[0]; D], [ends[1]; D], [2; D]).expect("a box"));
    let (boundary, points) = &boundary_of(&mesh, order);
    let moved = |shift: f64, by: f64| points.iter().map(|x| x + wave(shift)(x) * by).collect::<Vec<Point<D>>>();
    let (predicted, geometry) = (moved(0.7, 0.12), moved(1.9, 0.15));

    let placed = [Placed::new(boundary, &geometry)];
    let cut = CutMesh::overlay(&background, &placed, &OverlayOptions::new()).expect("a cut");
    let space = XfemSpace::new(&background, &cut);
    let parts = PartValues::new(&background, &cut);
    let faces = face_values(&background, &cut, &space, &parts);
    let values = PieceValues::new(&background, &cut, &parts, &[boundary], 2);
    let history = vec![Vector::zeros(); space.len()];
    let acceleration = Affine { slope: 1.0, predicted: Vec::new() };
    let mut layout = BlockLayout::new();
    let flow = layout.push("velocity", space.len(), D);
    let pressure_field = layout.push_on(flow, "pressure", 1);
    let field = layout.push("body", points.len(), D);
    let velocity: Vec<Vector<D>> = points.iter().map(wave(2.5)).collect();
    let mut x = vec![0.0; layout.len()];
    layout.set(field, velocity.iter().map(|v| (*v).into()), &mut x);
    layout.set(pressure_field, vec![[2.0]; space.len()], &mut x);
    let at_stage: Vec<Point<D>> = predicted.iter().zip(&velocity).map(|(x, v)| x + v * DT).collect();
    let surface = SurfaceMotion {
        boundary,
        start: geometry.clone(),
        end: Affine { slope: 0.0, predicted: geometry.clone() },
        stage: Some(Affine { slope: DT, predicted }),
        geometry: geometry.clone(),
        velocity: SurfaceVelocity::Field(field),
    };
    let interface = InterfacePoints {
        geometry: FluidGeometry {
            background: &background,
            cut: &cut,
            space: &space,
            parts: &parts,
            faces: &faces,
            known_velocity: &history,
            films: None,
            acceleration: &acceleration,
        },
        fields: FluidFields { layout: &layout, velocity: flow, pressure: pressure_field },
        values: &values,
        surfaces: vec![&surface],
        fluid: FLUID,
        solid: None,
    };
    check(&Moved { points, velocity: &velocity, at_stage: &at_stage, field, interface, x });
}

/// Returns the residual of terms on the nodes of a field.
fn forces<const D: usize>(
    terms: &dyn Contributions,
    layout: &BlockLayout,
    field: FieldId,
    x: &[f64],
) -> Vec<Vector<D>> {
    let mut residual = vec![0.0; layout.len()];
    for_each_residual(
        terms,
        0..terms.len(),
        x,
        |_| true,
        |_, dofs, values| {
            dofs.iter().zip(values).for_each(|(dof, value)| residual[dof.index()] += value);
        },
    );
    layout.values(field, &residual).map(Vector::<D>::from).collect()
}

/// Adds the forces of the mortar on the nodes of the body by a pressure.
fn add_mortar<const D: usize>(
    interface: &InterfacePoints<'_, D>,
    pressure: impl Fn(&Point<D>) -> f64,
    forces: &mut [Vector<D>],
) {
    for (item, piece) in interface.geometry.cut.interface().iter().enumerate() {
        for at in interface.values.points(item) {
            for (node, shape) in interface.surfaces[0].boundary.nodes(piece.facet).iter().zip(&at.solid) {
                forces[node.index()] += piece.normal * (pressure(&at.point) * at.weight * shape);
            }
        }
    }
}

/// Checks that forces on nodes have no resultant and, in Cartesian coordinates, no moment.
fn check_balance<const D: usize>(coordinates: Coordinates, forces: &[Vector<D>], positions: &[Point<D>]) {
    // In axisymmetric coordinates forces along the radius are those of hoops.
    let sum: Vector<D> = forces.iter().sum();
    let free = (0..D).filter(|a| coordinates.radial() != Some(*a));
    assert!(free.map(|a| sum[a].abs()).fold(0.0, f64::max) < 1e-12, "{sum}");
    if coordinates == Coordinates::Cartesian {
        let moment: Tensor<D> = forces.iter().zip(positions).map(|(f, x)| f * x.transpose()).sum();
        assert!((moment - moment.transpose()).amax() < 1e-12, "{moment}");
    }
}

/// Checks the pressure on a moved surface. With that of the mortar, a uniform one has no resultant and no moment, and
/// it has a potential. For order 1 its work is the pressure times the change of the volume, in place of that at the
/// cut. The tangent of any pressure is exact, and the force has the weight of the fluid's traction.
fn pressure_on_a_moved_surface<const D: usize>(body: &Moved<'_, D>) {
    let Moved { points, velocity, at_stage, field, interface, x } = body;
    let (surface, fields, field) = (interface.surfaces[0], &interface.fields, *field);
    let (boundary, layout, space) = (surface.boundary, fields.layout, interface.geometry.space);
    let (coordinates, order, background) = (boundary.coordinates(), boundary.order(), interface.geometry.background);
    let mut x = x.clone();
    let expected = [*at_stage, surface.geometry.as_slice()];
    let expected = expected.map(|positions| 2.0 * change_of_volume(boundary, positions, velocity));
    let moved = MovedSurface::new(interface.clone(), BodyId::new(0));
    let force = moved.force(&x);
    let terms = Integral::new("moved surface", moved, vec![&MovedPressure]);
    let power = algebra::power(&terms, &x);
    assert!((expected[0] - expected[1]).abs() > 0.01);
    if order == Order::Linear {
        assert!((power - (expected[0] - expected[1])).abs() < 1e-6, "{power} {expected:?}");
    }
    let residual = |x: &[f64]| forces::<D>(&terms, layout, field, x);
    let mut all = residual(&x);
    assert!((all.iter().sum::<Vector<D>>() + force).amax() < 1e-12);
    add_mortar(interface, |_| 2.0, &mut all);
    check_balance(coordinates, &all, at_stage);
    // The derivative of a gradient is symmetric.
    let directions = [0.3, 4.0].map(|shift| points.iter().map(wave(shift)).collect::<Vec<_>>());
    let along = |k: usize, l: usize| {
        let at = |by: f64| {
            let varied = velocity.iter().zip(&directions[k]).map(|(v, d)| (v + d * by).into());
            let mut y = x.clone();
            layout.set(field, varied, &mut y);
            residual(&y).iter().zip(&directions[l]).map(|(f, d)| f.dot(d)).sum::<f64>()
        };
        at(0.5) - at(-0.5)
    };
    let (one, other) = (along(0, 1), along(1, 0));
    assert!((one - other).abs() < 1e-10 && one.abs() > 1e-3, "{one} {other}");
    let solid = SolidShare { alpha: 0.4, stresses: vec![Some(Arc::new(NoStress))], start: x.as_slice().into() };
    let shared = InterfacePoints { solid: Some(solid), ..interface.clone() };
    let of_share = MovedSurface::new(shared.clone(), BodyId::new(0));
    let of_share = algebra::power(&Integral::new("moved surface", of_share, vec![&MovedPressure]), &x);
    assert!((of_share - 0.4 * power).abs() < 1e-12 && power.abs() > 1e-3, "{of_share} {power}");
    if coordinates == Coordinates::Cartesian {
        // On the elements at the cut: a hydrostatic pressure carries the weight of their volume, of which the load of a
        // uniform one is the derivative.
        let surface = at_the_cut(surface);
        let at_cut = InterfacePoints { surfaces: vec![&surface], ..shared.clone() };
        let at_cut = MovedSurface::new(at_cut, BodyId::new(0));
        let at_cut = Integral::new("moved surface", at_cut, vec![&MovedPressure]);
        let slope = Vector::<D>::from_fn(|a, _| 1.5 - a as f64);
        let loads = |pressure: &dyn Fn(&Point<D>) -> f64| {
            let mut y = x.clone();
            layout.set(fields.pressure, space.vertices().iter().map(|k| [pressure(&background.vertex(*k))]), &mut y);
            let of_term = forces::<D>(&at_cut, layout, field, &y);
            let mut loads: Vec<Vector<D>> = of_term.iter().map(|f| f / 0.4).collect();
            add_mortar(interface, pressure, &mut loads);
            loads
        };
        let uniform = loads(&|_| 1.0);
        let volume = uniform.iter().zip(&surface.geometry).map(|(f, x)| f.dot(x)).sum::<f64>() / D as f64;
        let hydrostatic: Vector<D> = loads(&|x| slope.dot(x)).iter().sum();
        assert!((hydrostatic - slope * volume).amax() < 1e-12 && volume > 0.1, "{hydrostatic} {volume}");
    }
    let varying = |node: &VertexId| [2.0 + background.vertex(*node)[0].sin()];
    layout.set(fields.pressure, space.vertices().iter().map(varying), &mut x);
    // Slivers have tangents of the size of round-off.
    let items = (0..terms.len()).filter(|item| interface.geometry.cut.interface()[*item].measure > 1e-9);
    let worst = worst_tangent_entry(&terms, items, &x, 1e-5);
    assert!(worst.relative < 1e-8, "{D} {coordinates:?} {order:?} {worst:?}");
}

/// Returns the surface with the pressure at the positions of the cut.
fn at_the_cut<'s, const D: usize>(surface: &SurfaceMotion<'s, D>) -> SurfaceMotion<'s, D> {
    SurfaceMotion {
        boundary: surface.boundary,
        geometry: surface.geometry.clone(),
        start: surface.start.clone(),
        end: surface.end.clone(),
        stage: None,
        velocity: SurfaceVelocity::Field(surface.field().expect("unknown velocities")),
    }
}

/// Returns the pressure on the closed part of the first body, with a body force of the fluid.
fn closed_pressure<'a, const D: usize>(
    interface: &InterfacePoints<'a, D>,
    force: Vector<D>,
) -> Integral<'static, ClosedPoints<'a, D>> {
    let stress = FluidStress::new(interface.clone(), BodyId(0), |_| force);
    Integral::new("closed surface", ClosedPoints::new(Arc::new(stress)), vec![&ClosedPressure])
}

/// Checks the pressure on a body that is only in part in the fluid. On the wet and the closed part together a uniform
/// one has no resultant and no moment, and a hydrostatic one carries the weight of the volume of the elements.
fn pressure_on_wet_and_closed_parts<const D: usize>(body: &Moved<'_, D>) {
    let Moved { at_stage, field, interface, x, .. } = body;
    let (surface, fields) = (interface.surfaces[0], &interface.fields);
    let (boundary, layout, space) = (surface.boundary, fields.layout, interface.geometry.space);
    let coordinates = boundary.coordinates();
    let all = |interface: &InterfacePoints<'_, D>, pressure: &dyn Fn(&Point<D>) -> f64, force: Vector<D>| {
        let mut y = x.clone();
        let at = |node: &VertexId| [pressure(&interface.geometry.background.vertex(*node))];
        layout.set(fields.pressure, space.vertices().iter().map(at), &mut y);
        let wet = MovedSurface::new(interface.clone(), BodyId(0));
        let wet = forces::<D>(&Integral::new("moved surface", wet, vec![&MovedPressure]), layout, *field, &y);
        let closed = forces::<D>(&closed_pressure(interface, force), layout, *field, &y);
        assert!(closed.iter().map(|f| f.norm()).fold(0.0, f64::max) > 0.1, "a closed part");
        let mut sum: Vec<Vector<D>> = wet.iter().zip(&closed).map(|(a, b)| a + b).collect();
        add_mortar(interface, pressure, &mut sum);
        sum
    };
    let uniform = all(interface, &|_| 2.0, Vector::zeros());
    check_balance(coordinates, &uniform, at_stage);
    if coordinates == Coordinates::Cartesian {
        let surface = at_the_cut(surface);
        let at_cut = InterfacePoints { surfaces: vec![&surface], ..interface.clone() };
        let volume = all(&at_cut, &|_| 1.0, Vector::zeros());
        let volume = volume.iter().zip(&surface.geometry).map(|(f, x)| f.dot(x)).sum::<f64>() / D as f64;
        let slope = Vector::<D>::from_fn(|a, _| 1.5 - a as f64);
        let hydrostatic: Vector<D> = all(&at_cut, &|x| slope.dot(x), slope).iter().sum();
        assert!((hydrostatic - slope * volume).amax() < 1e-12 && volume > 0.1, "{hydrostatic} {volume}");
    }
    let closed = closed_pressure(interface, Vector::repeat(0.7));
    // On mostly wet facets the weights cancel up to round-off. Forces are quadratic: a large difference step is exact.
    let worst = worst_tangent_entry(&closed, 0..closed.len(), x, 0.1);
    assert!(worst.relative < 1e-8, "{D} {coordinates:?} {worst:?}");
}

#[test]
fn a_uniform_pressure_moves_with_the_surface() {
    for order in [Order::Linear, Order::Quadratic] {
        let (inside, across) = ([0.5, 1.5], [0.6, 2.4]);
        let (planar, axisymmetric) = (Coordinates::Cartesian, Coordinates::Axisymmetric);
        with_moved_body::<2>(planar, order, inside, pressure_on_a_moved_surface);
        with_moved_body::<2>(axisymmetric, order, inside, pressure_on_a_moved_surface);
        with_moved_body::<3>(planar, order, inside, pressure_on_a_moved_surface);
        with_moved_body::<2>(planar, order, across, pressure_on_wet_and_closed_parts);
        with_moved_body::<2>(axisymmetric, order, across, pressure_on_wet_and_closed_parts);
        with_moved_body::<3>(planar, order, across, pressure_on_wet_and_closed_parts);
    }
}
