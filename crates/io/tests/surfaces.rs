//! Scanned surfaces, cut by boxes of tetrahedra: one test for each of them. They are found through `CUTWATER_SURFACES`;
//! tests count as ignored without it.

// Measured errors go to the output.
#![allow(clippy::print_stdout)]

#[path = "../../cutcell/tests/identities/mod.rs"]
mod identities;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use cutcell::{CutMesh, OverlayOptions};
use identities::check_identities;
use io::surface::Surface;
use libtest_mimic::{Arguments, Failed, Trial};
use mesh::Aabb;
use mesh::generate::structured_box;

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

/// Compares volume and area of a surface with the stated ones, and cuts boxes around it.
fn check_all(folder: &Path, (name, volume, area): (&str, f64, f64)) -> Result<(), Failed> {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default);
    let (largest_grid, n_placements) = (number("SURFACE_GRID", 10_usize), number("SURFACE_PLACEMENTS", 1_usize));
    let mut surface = Surface::read(&folder.join(name).with_extension("stl"))?;
    let exact: f64 = surface.boundary().facets().map(|f| surface.placed().facet_measure(f)).sum();
    assert!((exact - area).abs() < 1e-9 * area, "area {exact}, not {area}");
    let enclosed = surface.placed().enclosed().volume;
    assert!((enclosed - volume).abs() < 1e-9 * volume.abs(), "volume {enclosed}, not {volume}");
    if volume < 0.0 {
        let background = structured_box::<3>([-1.0; 3], [1.0; 3], [1; 3])?;
        let refused = CutMesh::overlay(&background, &[surface.placed()], &OverlayOptions::new());
        assert!(matches!(refused, Err(cutcell::Error::Inward { .. })), "it is turned inwards");
        surface = surface.flipped();
    }
    let grids = [10, 20, 40].into_iter().filter(|&n| n <= largest_grid);
    let placements = grids.flat_map(|n| (0..n_placements as u32).map(move |placement| (n, placement)));
    let failures: Vec<String> = placements.filter_map(|(n, placement)| check(&surface, n, placement).err()).collect();
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n").into()) }
}

fn main() -> ExitCode {
    let folder = std::env::var_os("CUTWATER_SURFACES").map(PathBuf::from).filter(|folder| folder.is_dir());
    if folder.is_none() {
        println!("skipped: CUTWATER_SURFACES names no folder of surfaces");
    }
    let trial = |surface: (&'static str, f64, f64)| {
        let folder = folder.clone();
        let is_skipped = folder.is_none();
        let run = move || check_all(&folder.ok_or("CUTWATER_SURFACES names no folder of surfaces")?, surface);
        Trial::test(format!("{}_keeps_volume_and_area", surface.0), run).with_ignored_flag(is_skipped)
    };
    libtest_mimic::run(&Arguments::from_args(), SURFACES.into_iter().map(trial).collect()).exit_code()
}
