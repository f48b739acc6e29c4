//! Writes the meshes of the examples: an ellipse of second-order triangles and a tank with a step
//! (`falling-ellipse.toml`), a round container (`carried-round.toml`), and a pipe with a conical seat
//! (`check-valve.toml`).
//!
//! `cargo run -p io --example make_meshes -- examples/meshes`. Gmsh makes such files from the geometries in the guide
//! on meshes of one's own.

use std::collections::HashMap;
use std::error::Error;
use std::path::PathBuf;

use io::gmsh::{GmshFormat, GmshVersion, write};
use mesh::generate::{BallOptions, ClosedLine, ball, inside};
use mesh::{Point, SimplexMesh};

/// Half axes of the ellipse, cm.
const AXES: [f64; 2] = [0.5, 0.25];

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).ok_or("usage: make_meshes DIRECTORY")?);
    let disk = ball::<2>([0.0; 2], 1.0, 0.25, &BallOptions::default())?;
    let stretched = |x: &Point<2>| Point::<2>::new(AXES[0] * x[0], AXES[1] * x[1]);
    let boundary = disk.boundary();
    let mut edge_nodes = HashMap::new();
    for facet in boundary.facets() {
        let [a, b] = [0, 1].map(|k| boundary.facet(facet)[k]);
        let middle = (disk.vertex(a) + disk.vertex(b)).normalize();
        edge_nodes.insert([a.min(b), a.max(b)], stretched(&middle));
    }
    let ellipse = disk.mapped(stretched)?.with_cell_tags(|_| Some("solid"));
    let format = GmshFormat { version: GmshVersion::V41, is_binary: false };
    write(&directory.join("ellipse.msh"), &ellipse, &edge_nodes, format)?;

    let corners = [[1.5, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0], [0.0, 1.0], [1.5, 1.0]];
    let names = ["floor", "right", "top", "left", "step", "step"];
    let outline = ClosedLine::polygon(&corners, 0.09, |side| names[side].to_owned())?;
    let tank: SimplexMesh<2> = inside(&[outline], 0.1)?;
    let tank = tank.with_cell_tags(|_| Some("fluid"));
    write(&directory.join("tank.msh"), &tank, &HashMap::new(), format)?;

    let container = ball::<2>([0.0; 2], 10.0, 0.8, &BallOptions::default())?.with_cell_tags(|_| Some("fluid"));
    write(&directory.join("container.msh"), &container, &HashMap::new(), format)?;

    let right = [[0.3, 0.0], [0.3, 1.0], [1.0, 1.7], [1.0, 4.0]];
    let left = right.iter().rev().map(|[x, y]| [-x, *y]);
    let corners: Vec<[f64; 2]> = right.iter().copied().chain(left).collect();
    let names = ["pipe", "seat", "chamber", "outlet", "chamber", "seat", "pipe", "inlet"];
    let outline = ClosedLine::polygon(&corners, 0.05, |side| names[side].to_owned())?;
    let valve: SimplexMesh<2> = inside(&[outline], 0.055)?;
    write(&directory.join("check-valve.msh"), &valve.with_cell_tags(|_| Some("fluid")), &HashMap::new(), format)?;
    Ok(())
}
