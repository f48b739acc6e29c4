//! Isolines of the vorticity with velocity vectors, on the whole domain and near the lowest point of a body.

use crate::units::cgs;
use cutwater::io::vtk::fluid::{curl, fluid_polygons};
use cutwater::mesh::{SimplexMesh, VertexId};
use cutwater::report::Raster;
use cutwater::report::plane::outline;
use cutwater::solver::{FluidState, StepView};

use super::view::{View, bounds, picture};

// Longer side of a view, distance of vectors and length of the longest one, in pixels.
const LONGEST: f64 = 640.0;
const SPACING: f64 = 25.0;
const LONGEST_VECTOR: f64 = 33.0;
/// Levels between the smallest and the largest value.
const LEVELS: f64 = 20.0;
// Width of the lower view divided by that of the body, and its height divided by its width.
const ZOOM: f64 = 0.6;
const ASPECT: f64 = 0.55;

const SOLID: &str = "fill=\"#e2e4e8\"";
const OUTLINE: &str = "fill=\"none\" stroke=\"#282c34\" stroke-width=\"1.2\"";
const VECTOR: &str = "fill=\"none\" stroke=\"#282c34\" stroke-width=\"0.8\" stroke-opacity=\"0.75\"";

/// A corner of a triangle of the fluid.
#[derive(Clone, Copy)]
struct ShownCorner {
    x: [f64; 2],
    velocity: [f64; 2],
    vorticity: f64,
}

/// Returns the figure of a step; `leading` is the body whose lowest point the lower view shows.
pub(super) fn draw<const D: usize>(view: &StepView<'_, D>, leading: usize, mirror: Option<f64>) -> Option<String> {
    let (setup, fluid) = (view.setup, view.state.fluid.as_ref()?);
    let background = &setup.fluid.as_ref()?.background;
    let flat = |x: &cutwater::mesh::Point<D>| [x[0], x[1]];
    let triangles = triangles(background, fluid);
    let (low, high) = bounds(background.vertices().iter().map(flat), mirror);
    let (body_low, body_high) = bounds(fluid.positions[leading].iter().map(flat), mirror);
    let lowest = fluid.positions[leading].iter().map(flat).min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or_default();
    let width = ZOOM * (body_high[0] - body_low[0]);
    let bottom = low[1].max(body_low[1] - 0.4 * ASPECT * width);
    let near = ([lowest[0] - 0.5 * width, bottom], [lowest[0] + 0.5 * width, bottom + ASPECT * width]);
    let title = format!("vorticity and velocity at t = {:.4} s", view.state.time);
    let views = [(title, (low, high)), ("near the lowest point".to_owned(), near)].map(|(title, (low, high))| {
        let mut shown = View::new(low, high, LONGEST, 1.0, mirror);
        for ((body, now), positions) in setup.bodies.iter().zip(&view.state.bodies).zip(&fluid.positions) {
            if let Some(solid) = body.cells(now) {
                let corner = |vertex: VertexId| flat(&positions[vertex.index()]);
                shown.draw(SOLID, solid.cells().map(|cell| [0, 1, 2].map(|k| corner(cell[k]))));
            }
        }
        let is_seen = |x: &[f64; 2]| (0..2).all(|k| low[k] <= x[k] && x[k] <= high[k]);
        let seen = triangles.iter().flatten().filter(|corner| is_seen(&corner.x));
        let mut values: Vec<f64> = seen.map(|corner| corner.vorticity.abs()).collect();
        values.sort_by(f64::total_cmp);
        // A few large values near corners would leave no levels for the others.
        let largest = values.get(values.len() * 98 / 100).copied().unwrap_or(1.0).max(1e-12);
        let corners: Vec<_> = triangles.iter().map(|corners| corners.map(|at| (at.x, at.vorticity))).collect();
        shown.isolines(&corners, (-largest, largest), LEVELS, true);
        for (body, positions) in setup.bodies.iter().zip(&fluid.positions) {
            shown.draw(OUTLINE, outline(body.as_ref(), positions, mirror).into_iter());
        }
        let longest = vectors(&mut shown, &triangles, low, high);
        shown.bar((-largest, largest), "1/s");
        (cgs(&format!("{title}; longest vector {longest:.1} <velocity>")), shown)
    });
    Some(picture(views.into()))
}

/// Draws velocity vectors on a lattice; returns the largest speed among them.
fn vectors(shown: &mut View, triangles: &[[ShownCorner; 3]], low: [f64; 2], high: [f64; 2]) -> f64 {
    let spacing = shown.length(SPACING);
    let mut found = Vec::new();
    let n = [0, 1].map(|k| ((high[k] - low[k]) / spacing + 0.5).floor().max(0.0) as usize);
    let raster = Raster { low, step: [spacing; 2], n };
    for triangle in triangles {
        raster.for_each_point(triangle.map(|corner| corner.x), |index, shares| {
            let component = |k: usize| (0..3).map(|c| triangle[c].velocity[k] * shares[c]).sum::<f64>();
            found.push((raster.point(index), [component(0), component(1)]));
        });
    }
    let longest = found.iter().map(|(_, u)| u[0].hypot(u[1])).fold(0.0, f64::max);
    let scale = shown.length(LONGEST_VECTOR) / longest.max(1e-12);
    let shortest = shown.length(1.5);
    let arrows = found.iter().map(|(x, u)| (*x, u.map(|u| scale * u))).filter(|(_, [a, b])| a.hypot(*b) > shortest);
    let lines = arrows.flat_map(|(x, [a, b])| {
        let tip = [x[0] + a, x[1] + b];
        let head = |turn: f64| [tip[0] - 0.3 * a - turn * b, tip[1] - 0.3 * b + turn * a];
        [[x, tip, head(0.16)], [tip, head(-0.16), tip]]
    });
    shown.draw(VECTOR, lines);
    longest
}

/// Returns the triangles that fill the fluid. The polygons of cut cells end at the bodies, so no value is taken outside
/// the fluid.
fn triangles<const D: usize>(background: &SimplexMesh<D>, fluid: &FluidState<D>) -> Vec<[ShownCorner; 3]> {
    let vorticity = nodal_vorticity(background, fluid);
    let mut triangles = Vec::new();
    for (part, polygon) in fluid_polygons(background, &fluid.cut) {
        let simplex = background.simplex(fluid.cut.part_cell(part));
        let dofs = fluid.space.dofs(part);
        let corners: Vec<_> = (polygon.iter())
            .map(|x| {
                let shape = simplex.barycentric(x).unwrap_or_default();
                let (u, _) = fluid.at(part, &shape);
                let vorticity = dofs.iter().zip(shape).map(|(&k, n)| vorticity[k as usize] * n).sum();
                ShownCorner { x: [x[0], x[1]], velocity: [u[0], u[1]], vorticity }
            })
            .collect();
        triangles.extend((2..corners.len()).map(|k| [0, k - 1, k].map(|i| corners[i])));
    }
    triangles
}

/// Computes the means of the vorticity around each dof, weighted by the volume of fluid.
fn nodal_vorticity<const D: usize>(background: &SimplexMesh<D>, fluid: &FluidState<D>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); fluid.space.len()];
    for part in fluid.cut.all_parts() {
        let weight = fluid.cut.part_volume(part);
        let value = curl(background, fluid, part, fluid.cut.part_cell(part))[2];
        for &dof in fluid.space.dofs(part) {
            let sum = &mut sums[dof as usize];
            *sum = (sum.0 + weight * value, sum.1 + weight);
        }
    }
    sums.into_iter().map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}
