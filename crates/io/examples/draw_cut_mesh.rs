//! Draws the pictures of the book's page on cut meshes:
//! `cargo run --release -p io --example draw_cut_mesh -- DIRECTORY`.

use std::fmt::Write;
use std::path::Path;

use cutcell::{CellState, CutMesh, FaceLabel, OverlayOptions};
use io::surface::Surface;
use io::vtk::fluid::fluid_polygons;
use mesh::generate::{BallOptions, ball, structured_box};
use mesh::nalgebra::Rotation3;
use mesh::{BoundaryMesh, CellId, Placed, Point, SimplexMesh, VertexId};

type AnyError = Box<dyn std::error::Error>;

const WATER: &str = "#eaf3fb";
const PARTS: [&str; 2] = ["#9fc9ea", "#5fb3a1"];
const BODY: &str = "#c9c5bd";
const MESH: &str = "#8b95a1";
const INTERFACE: &str = "#c0392b";
const GHOST: &str = "#e08e1b";

fn main() -> Result<(), AnyError> {
    let directory = std::env::args().nth(1).unwrap_or_else(|| "docs/src/images".to_owned());
    let directory = Path::new(&directory);
    std::fs::create_dir_all(directory)?;
    std::fs::write(directory.join("cut-mesh-plane.svg"), plane()?)?;
    std::fs::write(directory.join("cut-mesh-space.svg"), space()?)?;
    Ok(())
}

/// The text of a picture.
struct Svg {
    text: String,
    height: f64,
    /// Pixels per length.
    scale: f64,
}

impl Svg {
    fn new(width: f64, height: f64, scale: f64) -> Self {
        let (w, h) = (width * scale, height * scale);
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{w:.0}\" height=\"{h:.0}\" \
             stroke-linejoin=\"round\" font-family=\"sans-serif\" font-size=\"14\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self { text, height, scale }
    }

    fn polygon(&mut self, corners: impl IntoIterator<Item = [f64; 2]>, fill: &str, stroke: &str, width: f64) {
        self.text += "<polygon points=\"";
        for [x, y] in corners {
            // Writing to a string cannot fail.
            let _ = write!(self.text, "{:.1},{:.1} ", x * self.scale, (self.height - y) * self.scale);
        }
        let _ = writeln!(self.text, "\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>");
    }

    fn words(&mut self, [x, y]: [f64; 2], words: &str) {
        let (x, y) = (x * self.scale, (self.height - y) * self.scale);
        let _ = writeln!(self.text, "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"#22303c\">{words}</text>");
    }

    fn legend(&mut self, at: [f64; 2], entries: &[(&str, &str)]) {
        let row = 22.0 / self.scale;
        for (k, (colour, words)) in entries.iter().enumerate() {
            let (x, y) = (at[0], at[1] - row * k as f64);
            let (w, h) = (0.8 * row, 0.5 * row);
            self.polygon([[x, y], [x + w, y], [x + w, y + h], [x, y + h]], colour, MESH, 0.5);
            self.words([x + 1.2 * row, y], words);
        }
    }

    fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }
}

/// Returns a disk and a thin bar in a box of triangles.
fn plane() -> Result<String, AnyError> {
    let background = structured_box::<2>([0.0, 0.0], [4.0, 3.0], [8, 6])?;
    let disk = ball::<2>([1.32, 1.55], 0.83, 0.08, &BallOptions { area_preserving: true })?;
    let disk_surface = disk.boundary();
    let bar = [[2.55, 0.72], [2.72, 0.66], [3.58, 2.26], [3.41, 2.32]].map(|[x, y]| Point::<2>::new(x, y));
    let bar_surface = BoundaryMesh::from_facets([0, 1, 1, 2, 2, 3, 3, 0].map(VertexId).to_vec());
    let bodies = [Placed::new(&disk_surface, disk.vertices()), Placed::new(&bar_surface, &bar)];
    let cut = CutMesh::overlay(&background, &bodies, &OverlayOptions::new())?;

    let polygons = fluid_polygons(&background, &cut);
    let mut svg = Svg::new(5.75, 3.2, 150.0);
    let place = |x: &Point<2>| [x[0] + 0.1, x[1] + 0.1];
    for cell in background.cells() {
        let fill = if cut.cell_state(cell) == CellState::Fluid { WATER } else { BODY };
        svg.polygon(background.simplex(cell).points().iter().map(place), fill, MESH, 0.8);
    }
    for cell in background.cells().filter(|&cell| cut.cell_state(cell) == CellState::Cut) {
        for (k, part) in cut.parts(cell).enumerate() {
            let fill = PARTS[k % PARTS.len()];
            for (_, corners) in polygons.iter().filter(|(other, _)| *other == part) {
                svg.polygon(corners.iter().map(place), fill, fill, 0.5);
            }
        }
        svg.polygon(background.simplex(cell).points().iter().map(place), "none", MESH, 0.8);
    }
    for face in cut.ghost_faces() {
        let ends: Vec<Point<2>> = background.facet(face.facet).iter().map(|&v| background.vertex(v)).collect();
        let middle = 0.5 * (ends[0] + ends[1]);
        // Only the middle half of the face is drawn, so that neighbours remain distinct.
        svg.polygon(ends.iter().map(|x| place(&(middle + 0.5 * (x - middle)))), "none", GHOST, 2.5);
    }
    for piece in cut.interface() {
        svg.polygon(piece.points[..2].iter().map(place), "none", INTERFACE, 2.2);
        let middle = 0.5 * (piece.points[0] + piece.points[1]);
        let is_on_disk = piece.body.0 == 0;
        if !is_on_disk && piece.measure > 0.12 || is_on_disk && piece.facet.index() % 6 == 0 && piece.measure > 0.03 {
            svg.polygon([place(&middle), place(&(middle + 0.12 * piece.normal))], "none", INTERFACE, 1.0);
        }
    }
    let entries = [
        (WATER, "fluid cell: one part"),
        (PARTS[0], "cut cell: first part"),
        (PARTS[1], "cut cell: second part"),
        (BODY, "covered"),
        (INTERFACE, "interface, normals"),
        (GHOST, "ghost face"),
    ];
    svg.legend([4.3, 2.7], &entries);
    Ok(svg.finish())
}

/// Returns a turned cube in a box of tetrahedra: the fluid parts of the cut cells behind its middle, drawn apart.
fn space() -> Result<String, AnyError> {
    let background = structured_box::<3>([-1.0; 3], [1.0; 3], [4; 3])?;
    let turn = Rotation3::from_euler_angles(0.5, 0.4, 0.2);
    let body = cube().moved(|x| turn * x);
    let cut = CutMesh::overlay(&background, &[body.placed()], &OverlayOptions::new())?;
    let view = Rotation3::from_euler_angles(-1.15, 0.0, 0.0) * Rotation3::from_euler_angles(0.0, 0.0, -0.6);
    let apart = |cell: CellId, x: &Point<3>| view * (x + 0.2 * background.simplex(cell).centroid());
    let is_shown = |cell: CellId| (view * background.simplex(cell).centroid())[2] < -0.02;

    // Polygons with their colours; what is nearer is drawn later.
    let mut polygons: Vec<(Vec<Point<3>>, String)> = Vec::new();
    for part in cut.all_parts().filter(|&part| !cut.is_whole(part) && is_shown(cut.part_cell(part))) {
        let cell = cut.part_cell(part);
        for piece in cut.part_pieces(part) {
            for (face, (label, _)) in piece.faces().enumerate() {
                if let FaceLabel::Cell(local) = label {
                    let corners: Vec<Point<3>> = piece.face_points(face).map(|x| apart(cell, &x)).collect();
                    let towards = (view * outwards(&background, cell, usize::from(local)))[2];
                    if towards > 0.0 {
                        polygons.push((corners, shade([159, 201, 234], towards)));
                    }
                }
            }
        }
    }
    for piece in cut.interface().iter().filter(|piece| is_shown(piece.cell)) {
        let corners: Vec<Point<3>> = piece.points.iter().map(|x| apart(piece.cell, x)).collect();
        polygons.push((corners, shade([205, 72, 55], (view * piece.normal)[2].abs())));
    }
    let depth = |corners: &[Point<3>]| corners.iter().map(|x| x[2]).sum::<f64>() / corners.len() as f64;
    polygons.sort_by(|a, b| depth(&a.0).total_cmp(&depth(&b.0)));
    let mut svg = Svg::new(3.9, 2.95, 180.0);
    for (corners, fill) in &polygons {
        svg.polygon(corners.iter().map(|x| [x[0] + 1.63, x[1] + 1.5]), fill, "#5d6975", 0.3);
    }
    svg.legend([3.1, 2.5], &[(PARTS[0], "fluid parts"), (INTERFACE, "interface")]);
    Ok(svg.finish())
}

/// Returns the normal of a facet of a cell, out of the cell.
fn outwards(background: &SimplexMesh<3>, cell: CellId, local: usize) -> Point<3> {
    let facet = background.cell_to_facet(cell)[local];
    let points: Vec<Point<3>> = background.facet(facet).iter().map(|&v| background.vertex(v)).collect();
    let normal = mesh::facet_normal(&points);
    if background.facet_to_cell(facet)[0] == Some(cell) { normal } else { -normal }
}

/// Returns a colour, darker where the surface turns away.
fn shade(colour: [u8; 3], towards: f64) -> String {
    let [r, g, b] = colour.map(|c| (f64::from(c) * (0.55 + 0.45 * towards)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the cube with edges of length 1.1 around the origin.
fn cube() -> Surface {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 1.1 * (bit as f64 - 0.5));
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[[f64; 3]; 3]> =
        squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c].map(corner), [a, c, d].map(corner)]).collect();
    Surface::weld(&triangles)
}
