//! The Turek-Hron benchmark FSI1: an elastic flag behind a cylinder, bent by a steady flow.

use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::mesh::{SimplexMesh, VertexId};
use cutwater::solid_svk::{LameParameters, Order, SaintVenantKirchhoff, SolidMesh, Support, SupportKind};

use super::channel::{CENTRE, Channel, ChannelResolution, N_CORNERS, RADIUS};
use super::csm::{self, DENSITY, SOFT, displacement};
use super::dry::elastic_of;
use super::flow::force;
use super::record::{Points, TextTable};
use super::{DirectRun, Failure, P, Record, V, short};

const CHANNEL: Channel = Channel { length: 2.5, density: 1e3, viscosity: 1.0, speed: 0.2, has_flag: true };
/// Displacement of the tip, m, drag and lift, N/m: level 7 of FEATFLOW.
const KNOWN: [f64; 4] = [2.270_493e-5, 8.208_773e-4, 14.294_26, 0.763_746];
const NAMES: [&str; 4] = ["u_x [m]", "u_y [m]", "drag [N/m]", "lift [N/m]"];
/// Largest relative errors with the finest resolution; forces as in the check `cfd`.
const ACCURACY: [f64; 4] = [0.03, 0.03, 0.01, 0.03];
/// The same for `u_y` with the coarse ones of the quick version: twice the error of the lift of CFD1 with 16 cells in a
/// diameter.
const QUICK_ACCURACY: f64 = 0.06;
const N_QUICK: usize = 2;
/// Cells in a diameter of the cylinder, rows of cells across the flag, and order of its elements; the full version ends
/// with the finest, the quick one has the first [`N_QUICK`].
const RESOLUTIONS: [(usize, usize, Order); 6] = [
    (16, ROWS, Order::Quadratic),
    (32, ROWS, Order::Quadratic),
    (32, 8, Order::Linear),
    (32, 16, Order::Linear),
    (32, 32, Order::Linear),
    (64, ROWS, Order::Quadratic),
];
/// Rows of quadratic elements across the flag, those of the check `csm`.
pub(super) const ROWS: usize = 4;
/// Length of a step, s, about the time in which the fluid damps the flag: it rests after a few steps.
const STEP: f64 = 1.0;
/// Lengths that are compared.
const STEPS: [f64; 4] = [0.1, 0.3, STEP, 10.0];
// Largest change of the tip in the last step, relative to its displacement, and largest number of steps.
const UNCHANGED: f64 = 1e-4;
const MOST_STEPS: usize = 60;

/// The flag at rest in the flow.
struct BentFlag {
    /// In the order of [`NAMES`].
    numbers: [f64; 4],
    n_dofs: usize,
    /// `u_y` after each step.
    history: Points,
}

/// Measures displacement and forces on several meshes of fluid and flag.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let resolutions = if record.full { &RESOLUTIONS[..] } else { &RESOLUTIONS[..N_QUICK] };
    let head = ["fluid", "rows of the flag", "order", "unknowns", "steps"]
        .into_iter()
        .chain(NAMES)
        .map(str::to_owned)
        .collect();
    let mut rows = Vec::new();
    for (n, &resolution) in resolutions.iter().enumerate() {
        let (cells, across, order) = resolution;
        let bent = bend(resolution, STEP)?;
        let name = format!("h = D/{cells}, {across} rows of order {}", order.degree());
        let is_finest = n + 1 == RESOLUTIONS.len();
        for (k, quantity) in NAMES.into_iter().enumerate().filter(|_| is_finest || n < N_QUICK) {
            let quantity = format!("{name}: {quantity}");
            let accuracy = if is_finest { Some(ACCURACY[k]) } else { (k == 1).then_some(QUICK_ACCURACY) };
            match accuracy {
                Some(accuracy) => record.near_relative(quantity, bent.numbers[k], KNOWN[k], accuracy),
                None => record.show(quantity, bent.numbers[k], Some(KNOWN[k])),
            }
        }
        let errors = (0..4).map(|k| {
            let error = 100.0 * (bent.numbers[k] / KNOWN[k] - 1.0);
            format!("{} ({error:+.2} %)", short(bent.numbers[k]))
        });
        let counts = [across, order.degree(), bent.n_dofs, bent.history.len()].map(|count| count.to_string());
        let sizes = [format!("D/{cells}")].into_iter().chain(counts);
        rows.push(sizes.chain(errors).collect());
    }
    record.tables.push(TextTable { head, rows });
    if record.full {
        let resolution = RESOLUTIONS[1];
        let cells = resolution.0;
        let mut curves = Vec::new();
        for step in STEPS {
            let bent = bend(resolution, step)?;
            let name = format!("h = D/{cells}, steps of {} s", short(step));
            record.show(format!("{name}: steps"), bent.history.len() as f64, None);
            record.show(format!("{name}: u_y [m]"), bent.numbers[1], Some(KNOWN[1]));
            curves.push((format!("steps of {} s", short(step)), bent.history));
        }
        record.figure(format!("u_y of the tip [m], h = D/{cells}, {ROWS} rows of order 2"), "step", curves);
    }
    record.note(format!(
        "Channel, refinement and force of the check `cfd`. Cylinder and flag are one elastic body, that of CSM1 with a disk whose vertices are \
         held; the mesh of the fluid does not follow it. Steps neglect inertia (`quasi-static`), have {} s, begin at rest, and end when the tip changes by \
         less than {} of its displacement.",
        short(STEP),
        short(UNCHANGED),
    ));
    record.note(
        "The geometry of a step is that of its start, and a flag that is bent has less lift. So long steps alternate around the result. In short \
         steps the fluid damps the flag, which approaches the result slowly.",
    );
    record.note(
        "Linear triangles in few rows are too stiff in bending, and forces on a coarse mesh of the fluid are too large.",
    );
    Ok(())
}

/// Computes the flag at rest, with one of the [`RESOLUTIONS`] and a length of steps.
fn bend((cells, rows, order): (usize, usize, Order), step: f64) -> Result<BentFlag, Failure> {
    let mut setup = CHANNEL.setup(&ChannelResolution::new(cells), |_| 1.0)?;
    (setup.scheme, setup.dt) = (Arc::new(QuasiStatic), step);
    let (solid, held) = obstacle(rows, order)?;
    let material = SaintVenantKirchhoff::new(LameParameters::new(SOFT, 4.0 * SOFT)?);
    let mut flag = elastic_of(solid, DENSITY, material, V::zeros(), Arc::clone(&setup.scheme))?;
    flag.options.supports.push(Support { vertices: held, kind: SupportKind::Clamped });
    setup.bodies = vec![flag.body("flag")?];
    let mut run = DirectRun::lagged(setup)?;
    let (mut before, mut history) = (V::zeros(), Vec::new());
    for n in 1..=MOST_STEPS {
        let report = run.advance()?;
        let u = displacement(&run)?;
        history.push((n as f64, u[1]));
        if (u - before).norm() <= UNCHANGED * u.norm() {
            let (force, _) = force(&run.state, &report, 0, &P::zeros())?;
            return Ok(BentFlag { numbers: [u[0], u[1], force[0], force[1]], n_dofs: report.n_dofs, history });
        }
        before = u;
    }
    Err(format!("the flag still moves after {MOST_STEPS} steps").into())
}

/// Returns the elements of flag and cylinder, and the nodes of the cylinder. Those at the end of the flag are nodes of
/// both.
pub(super) fn obstacle(rows: usize, order: Order) -> Result<(SolidMesh<2>, Vec<VertexId>), Failure> {
    let (flag, centre) = (csm::mesh(rows, true)?, P::from(CENTRE));
    let mut vertices = flag.vertices().to_vec();
    let mut cells: Vec<VertexId> = flag.cells().flat_map(|cell| flag.cell(cell)).copied().collect();
    let is_on_circle = |v: &usize| ((vertices[*v] - centre).norm() - RADIUS).abs() < 1e-9;
    let mut rim: Vec<usize> = (0..vertices.len()).filter(is_on_circle).collect();
    rim.sort_by(|&a, &b| vertices[a][1].total_cmp(&vertices[b][1]));
    // Without the end of the flag, and the two corners where it begins.
    let corners = CHANNEL.obstacle(N_CORNERS);
    let arc = &corners[3..corners.len() - 1];
    rim.extend(vertices.len()..vertices.len() + arc.len());
    vertices.extend(arc);
    let hub = vertices.len();
    vertices.push(centre);
    let next = rim.iter().cycle().skip(1);
    cells.extend(rim.iter().zip(next).flat_map(|(&a, &b)| [hub, a, b].map(VertexId::new)));
    let mesh = SimplexMesh::new(vertices, cells)?;
    let solid = match order {
        Order::Linear => SolidMesh::new(mesh)?,
        Order::Quadratic => {
            let on_flag = csm::edge_nodes(rows)?;
            SolidMesh::curved(mesh, |ends, middle| on_flag(ends).unwrap_or(middle))?
        }
    };
    // The regular polygon is larger than the circle by less than this.
    let is_held = |x: &P| (x - centre).norm() < RADIUS * (1.0 + 1e-4);
    let held = (0..solid.nodes().len()).filter(|&node| is_held(&solid.nodes()[node])).map(VertexId::new).collect();
    Ok((solid, held))
}

#[cfg(test)]
mod tests {
    use super::super::flow::area;
    use super::*;

    #[test]
    fn flag_and_cylinder_are_one_body() {
        let (rows, columns) = (4, 70);
        let (solid, held) = obstacle(rows, Order::Linear).expect("elements");
        assert_eq!(held.len(), N_CORNERS + rows + 1);
        assert_eq!(solid.boundary().n_facets(), N_CORNERS + rows + 2 * columns);
        let area = area(&CHANNEL.obstacle(N_CORNERS));
        let volume = solid.mesh().volume();
        assert!((volume / area - 1.0).abs() < 1e-4, "{volume} {area}");

        // On the rim, and on the spokes between rim and hub: as many nodes on edges as vertices.
        let (solid, of_order_2) = obstacle(rows, Order::Quadratic).expect("elements");
        assert_eq!(of_order_2.len(), held.len() + 2 * (held.len() - 1));
        assert_eq!(solid.boundary().n_facets(), 2 * (N_CORNERS + rows + 2 * columns));
        let end: Vec<&P> =
            solid.nodes().iter().filter(|x| x[0] > CENTRE[0] && (x[1] - CENTRE[1]).abs() < 0.0099).collect();
        let on_circle = end.iter().filter(|x| ((**x - P::from(CENTRE)).norm() - RADIUS).abs() < 1e-12).count();
        assert_eq!(on_circle, 2 * rows - 1);
    }
}
