//! Surfaces from files, cut by boxes of tetrahedra. The scanned ones are found through `CUTWATER_SURFACES`.

// Names the skipped test.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};

use crate::identities::check_identities;
use crate::setting::write;
use cutcell::{CutMesh, OverlayOptions};
use io::surface::Surface;
use mesh::generate::structured_box;
use mesh::{Aabb, Point};

/// File, volume and area: of the triangulated surface, exact to the digits.
const SURFACES: [(&str, f64, f64); 11] = [
    ("cube", 1.0, 6.0),
    ("65904_2", 0.3161251729, 2.879175717),
    ("Knight", 10547.05264, 3752.730295),
    ("80084", 1122.084677, 1026.017412),
    ("293137", 273280.0337, 29490.7155),
    ("95436", -106151.0182, 20491.66177),
    ("wine_glass", 74.1259597, 497.2758469),
    ("47076", 104370.6789, 21864.75241),
    ("77343", 39323.00768, 21452.98082),
    ("550964", 989.7615795, 1715.987501),
    ("37384", 37990.50386, 7024.476579),
];

fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("CUTWATER_SURFACES").map(PathBuf::from).filter(|f| f.is_dir());
    if folder.is_none() {
        println!("skipped: CUTWATER_SURFACES names no folder of surfaces");
    }
    folder
}

/// Cuts a box of `n`³ cubes around a surface, turned and shifted, and compares volume and area.
fn check(surface: &Surface, n: usize, placement: u32) -> Result<(), String> {
    let t = f64::from(placement);
    let turn = mesh::nalgebra::Rotation3::from_euler_angles(1.1 * t, 0.7 * t, 1.9 * t);
    let surface = surface.moved(|x| turn * x);
    let Aabb { low, high } = Aabb::of_points(surface.positions());
    let margin = (high - low) * (0.1 + 0.03 * (0.37 * t).sin().abs());
    let background =
        structured_box::<3>((low - margin).into(), (high + margin * 1.1).into(), [n; 3]).map_err(|e| e.to_string())?;
    let start = std::time::Instant::now();
    let cut = CutMesh::overlay(&background, &[surface.placed()], &OverlayOptions::new()).map_err(|e| e.to_string())?;
    check_identities(&background, &cut);
    let domain = (high - low + margin * 2.1).product();
    let volume = surface.placed().enclosed().volume;
    let area: f64 = surface.boundary().facets().map(|f| surface.placed().facet_measure(f)).sum();
    let wet: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
    let volume_error = (domain - cut.fluid_volume() - volume).abs() / volume;
    let area_error = (wet - area).abs() / area;
    println!(
        "grid {n}, placement {placement}: {} cut cells, volume error {volume_error:.1e}, area error {area_error:.1e}, {:.2} s",
        cut.report().n_cut_cells,
        start.elapsed().as_secs_f64()
    );
    if volume_error < 1e-10 && area_error < 1e-10 {
        Ok(())
    } else {
        Err(format!("grid {n}, placement {placement}: volume error {volume_error:e}, area error {area_error:e}"))
    }
}

#[test]
fn scanned_surfaces_keep_their_volume_and_area() {
    let Some(folder) = folder() else { return };
    let number =
        |name: &str, default: usize| std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default);
    let (largest_grid, n_placements) = (number("SURFACE_GRID", 10), number("SURFACE_PLACEMENTS", 1));
    let mut failures = Vec::new();
    for (name, volume, area) in SURFACES {
        let path = folder.join(name).with_extension("stl");
        let mut surface = Surface::read(&path).expect("a surface");
        let exact: f64 = surface.boundary().facets().map(|f| surface.placed().facet_measure(f)).sum();
        assert!((exact - area).abs() < 1e-9 * area, "{name}: area {exact}, not {area}");
        let enclosed = surface.placed().enclosed().volume;
        assert!((enclosed - volume).abs() < 1e-9 * volume.abs(), "{name}: volume {enclosed}, not {volume}");
        if volume < 0.0 {
            let background = structured_box::<3>([-1.0; 3], [1.0; 3], [1; 3]).expect("a box");
            let refused = CutMesh::overlay(&background, &[surface.placed()], &OverlayOptions::new());
            assert!(matches!(refused, Err(cutcell::Error::Inward { .. })), "{name} is turned inwards");
            surface = surface.flipped();
        }
        println!("{name}");
        for n in [10, 20, 40].into_iter().filter(|&n| n <= largest_grid) {
            for placement in 0..n_placements as u32 {
                if let Err(failure) = check(&surface, n, placement) {
                    failures.push(format!("{name}: {failure}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n# comment\nf 1 3 2\nf 1/1 2/2 4/3\nf 1//1 4//2 3//3\nf -3 -2 -1\n";

#[test]
fn obj_ascii_and_binary_stl_give_the_same_surface() {
    let obj = Surface::read(&write("tetrahedron.obj", TETRAHEDRON)).expect("an OBJ");
    assert!((obj.placed().enclosed().volume - 1.0 / 6.0).abs() < 1e-15);
    assert_eq!(obj.positions().len(), 4);
    let mut ascii = "solid t\n".to_owned();
    let mut binary = vec![b's'; 80];
    binary.extend(4_u32.to_le_bytes());
    for f in obj.boundary().facets() {
        ascii.push_str("facet normal 0 0 0\nouter loop\n");
        binary.extend([0; 12]);
        for v in obj.boundary().facet(f) {
            let x: Point<3> = obj.positions()[v.index()];
            ascii.push_str(&format!("vertex {} {} {}\n", x[0], x[1], x[2]));
            binary.extend(x.iter().flat_map(|c| (*c as f32).to_le_bytes()));
        }
        ascii.push_str("endloop\nendfacet\n");
        binary.extend([0; 2]);
    }
    ascii.push_str("endsolid t\n");
    for path in [write("t.stl", &ascii), write("b.STL", &binary)] {
        let stl = Surface::read(&path).expect("an STL");
        assert_eq!(stl.placed().enclosed().volume, obj.placed().enclosed().volume);
        assert_eq!((stl.positions().len(), stl.boundary().n_facets()), (4, 4));
    }
    assert!(obj.flipped().placed().enclosed().volume < 0.0);
}

#[test]
fn malformed_files_are_refused_with_their_place() {
    for (name, content, part) in [
        ("a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 x\n", "line 4"),
        ("b.stl", "solid\nouter loop\nvertex 0 0 0\nendloop\n", "line 4: a facet has 1"),
        ("c.stl", "solid\nvertex 0 0 NaN\n", "not finite"),
        ("d.stl", "hello", "neither"),
        ("e.obj", "v 0 0 0\nf 1 2 3\n", "no vertex 2"),
        ("f.obj", "v 0 0\n", "three coordinates"),
        ("g.ply", "ply", "must end in"),
    ] {
        let message = Surface::read(&write(name, content)).expect_err("malformed").to_string();
        assert!(message.contains(part) && message.contains(name), "{message}");
    }
    let missing = Surface::read(Path::new("no/such.stl")).expect_err("missing").to_string();
    assert!(missing.contains("no/such.stl"), "{missing}");
}
