//! The parsers, each with good files to begin with.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use cutcell::{CutMesh, OverlayOptions};
use io::gmsh::{GmshFile, GmshFormat, GmshVersion, write};
use io::mesh_file::MeshFile;
use io::surface::Surface;
use io::{RunOptions, ScenarioFile, checkpoint_time, run, sizes};
use mesh::generate::{BallOptions, ball, structured_box};
use mesh::{Point, SimplexMesh, VertexId};

/// Line of a mutated scenario that is an argument of `--set`.
const SET: &str = "#set ";

const BOX: &str = include_str!("seeds/box.toml");
const SPACE: &str = include_str!("seeds/space.toml");
const DRY: &str = include_str!("seeds/dry.toml");
/// Two triangles as Gmsh writes them in blocks of version 4.1 and in the list of version 2.2.
const BLOCKS: &str = include_str!("../scenarios/gmsh-files/two-triangles-41.msh");
const LIST: &str = include_str!("../scenarios/gmsh-files/two-triangles-22.msh");

/// Returns the path of a file of this process.
fn path(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cutwater-mutations-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a directory");
    folder.join(name)
}

fn written(name: &str, bytes: &[u8]) -> PathBuf {
    let path = path(name);
    std::fs::write(&path, bytes).expect("a file for temporary use");
    path
}

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

pub(crate) fn scenario_seeds() -> Vec<Vec<u8>> {
    let files = ["falling-ellipse.toml", "oscillating-cylinder.toml", "../validation/cases/virtual-barrier.toml"];
    let read = |name: &str| std::fs::read(examples().join(name)).expect("the scenario");
    let small = [BOX, SPACE, DRY].map(|text| text.as_bytes().to_vec());
    small.iter().cloned().cycle().take(12).chain(files.map(read)).collect()
}

/// Returns whether all numbers of a text are of the order of one, or so extreme that they must be errors or have no
/// effect on the size of a problem.
fn is_affordable(text: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    let numbers = text.split(|c: char| !is_part(c)).filter_map(|word| word.parse::<f64>().ok()).map(f64::abs);
    let is_fit = |x: f64| x == 0.0 || x <= 1e-6 || (0.29..=30.0).contains(&x) || x >= 1e7 || x.is_nan();
    text.len() < 8000 && numbers.into_iter().all(is_fit)
}

/// Reads a scenario and, if it is small, builds its meshes and its first step.
pub(crate) fn scenario(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let sets: Vec<String> = text.lines().filter_map(|line| line.strip_prefix(SET)).map(str::to_owned).collect();
    let path = examples().join("mutated.toml");
    let Ok(file) = ScenarioFile::parse(&path, &text, &sets) else { return false };
    let again = file.to_toml().expect("text of a scenario that was read");
    ScenarioFile::parse(&path, &again, &[]).expect("a scenario that was written");
    if is_affordable(&text) { sizes(&file).is_ok() } else { true }
}

pub(crate) fn formula_seeds() -> Vec<Vec<u8>> {
    let texts = [
        "0.25*sin(2*pi*0.25*t)",
        "t^3 - 2*t + 1/(1 + t^2)",
        "exp(-t)*cos(3*t)/(2 + tan(0.3*t))",
        "2^(t*t) + sqrt(1 + t)^1.5 - -t",
        "tanh(4*(t - 0.7)) + sinh(t)/cosh(2*t)",
        "asin(t/2) + acos(t/3)*atan(t) + ln(1 + t)",
        "abs(t - 0.9) + min(t, 0.3)*max(0.2, t^2)",
        "((((((1e-1 * 1.5E+1 + .5))))))*e",
    ];
    texts.map(|text| text.as_bytes().to_vec()).into()
}

/// Reads a formula as the motion of a body and as a field, and evaluates it.
pub(crate) fn formula(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let quoted = toml::Value::String(text.into_owned()).to_string();
    let motion = format!("motion = {{ kind = \"formula\", displacement = [0.0, {quoted}] }}");
    let moved = DRY.replacen("motion = { kind = \"free\" }\ndensity = 2.0\ngravity = [0.0, -0.5]\n", &motion, 1);
    let field = DRY.replacen("\"displacement\", value = [\"0.1*x*t\"", &format!("\"traction\", value = [{quoted}"), 1);
    let is_good = |text: &str| {
        let file = ScenarioFile::parse(Path::new("formula.toml"), text, &[]);
        file.is_ok_and(|file| sizes(&file).is_ok())
    };
    let is_moved = is_good(&moved);
    is_good(&field) || is_moved
}

pub(crate) fn gmsh_seeds() -> Vec<Vec<u8>> {
    let mut seeds = [BLOCKS, LIST].map(|text| text.as_bytes().to_vec()).to_vec();
    for version in [GmshVersion::V22, GmshVersion::V41] {
        for is_binary in [false, true] {
            let format = GmshFormat { version, is_binary };
            seeds.extend([gmsh_file::<2>(1, format), gmsh_file::<2>(2, format)]);
            seeds.extend([gmsh_file::<3>(1, format), gmsh_file::<3>(2, format)]);
        }
    }
    seeds
}

fn gmsh_file<const D: usize>(order: usize, format: GmshFormat) -> Vec<u8> {
    let n = if D == 2 { 2 } else { 1 };
    let mesh: SimplexMesh<D> = structured_box([0.0; D], [1.0; D], [n; D]).expect("a box");
    let mesh = mesh.with_cell_tags(|cell| (cell.index() % 2 == 0).then_some("soft"));
    let mut nodes: HashMap<[VertexId; 2], Point<D>> = HashMap::new();
    for cell in mesh.cells().filter(|_| order == 2) {
        for (k, &a) in mesh.cell(cell).iter().enumerate() {
            for &b in &mesh.cell(cell)[..k] {
                nodes.insert([a.min(b), a.max(b)], (mesh.vertex(a) + mesh.vertex(b)) * 0.5);
            }
        }
    }
    let path = path("seed.msh");
    write(&path, &mesh, &nodes, format).expect("a file");
    std::fs::read(path).expect("the file")
}

/// Reads a Gmsh file as meshes and surfaces of both dimensions.
pub(crate) fn gmsh(bytes: &[u8]) -> bool {
    let Ok(file) = GmshFile::parse(bytes) else { return false };
    let is_surface = [file.surface::<2>().is_ok(), file.surface::<3>().is_ok()].contains(&true);
    let is_mesh = [is_sound_mesh::<2>(&file), is_sound_mesh::<3>(&file)].contains(&true);
    let statistics = MeshFile::read(&written("mutated.msh", bytes)).map(|mesh| mesh.statistics());
    assert!(statistics.is_err() || is_surface || is_mesh);
    statistics.is_ok()
}

/// Returns whether a file is a mesh, and checks that its cells then have positive volumes.
fn is_sound_mesh<const D: usize>(file: &GmshFile) -> bool {
    file.mesh::<D>().is_ok_and(|found| {
        let volumes = found.mesh.cells().map(|cell| found.mesh.cell_volume(cell));
        assert!(volumes.into_iter().all(|volume| volume.is_finite() && volume > 0.0));
        true
    })
}

/// Returns the triangles of a ball.
fn triangles() -> Vec<[Point<3>; 3]> {
    let ball = ball::<3>([0.5; 3], 0.3, 0.3, &BallOptions::default()).expect("a ball");
    let boundary = ball.boundary();
    boundary.facets().map(|facet| std::array::from_fn(|k| ball.vertex(boundary.facet(facet)[k]))).collect()
}

pub(crate) fn stl_seeds() -> Vec<Vec<u8>> {
    let triangles = triangles();
    let mut text = "solid ball\n".to_owned();
    let mut binary = vec![b' '; 80];
    binary.extend((triangles.len() as u32).to_le_bytes());
    for corners in &triangles {
        let vertices = corners.map(|x| format!("    vertex {} {} {}\n", x[0], x[1], x[2])).concat();
        text += &format!("  facet normal 0 0 0\n   outer loop\n{vertices}   endloop\n  endfacet\n");
        binary.extend([0; 12]);
        corners.iter().flatten().for_each(|x| binary.extend((*x as f32).to_le_bytes()));
        binary.extend([0; 2]);
    }
    vec![(text + "endsolid ball\n").into_bytes(), binary]
}

pub(crate) fn obj_seeds() -> Vec<Vec<u8>> {
    let triangles = triangles();
    let vertex = |x: &Point<3>| format!("v {} {} {}\n", x[0], x[1], x[2]);
    let vertices: String = triangles.iter().flatten().map(vertex).collect();
    let faces = (0..triangles.len()).map(|k| [3 * k + 1, 3 * k + 2, 3 * k + 3]);
    let plain: String = faces.clone().map(|[a, b, c]| format!("f {a} {b} {c}\n")).collect();
    let full: String = faces.map(|[a, b, c]| format!("f {a}/1/1 {b}//2 {c}/3\n")).collect();
    let tetrahedron =
        "# four\nv 0.2 0.2 0.2\nv 0.8 0.2 0.2\nv 0.2 0.8 0.2\nv 0.2 0.2 0.8\nf -4 -2 -3\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    vec![(vertices.clone() + &plain).into_bytes(), (vertices + &full).into_bytes(), tetrahedron.as_bytes().to_vec()]
}

/// Reads a surface, measures it, and cuts a background by it.
pub(crate) fn surface(extension: &str, bytes: &[u8]) -> bool {
    let path = written(&format!("mutated.{extension}"), bytes);
    let Ok(surface) = Surface::read(&path) else { return false };
    let _ = MeshFile::read(&path).map(|mesh| mesh.statistics());
    let background = structured_box::<3>([0.0; 3], [1.0; 3], [2; 3]).expect("a box");
    let cut = CutMesh::overlay(&background, &[surface.placed()], &OverlayOptions::new());
    cut.is_ok_and(|cut| {
        assert!(cut.fluid_volume() < 1.0 + 1e-9, "{}", cut.fluid_volume());
        true
    })
}

/// Returns the scenario of the checkpoints, whose run ends at a time.
fn dry(end: f64) -> ScenarioFile {
    ScenarioFile::parse(Path::new("dry.toml"), DRY, &[format!("time.end={end}")]).expect("a scenario")
}

pub(crate) fn checkpoint_seeds() -> Vec<Vec<u8>> {
    let directory = path("run");
    run(&dry(1.0), &directory, &mut ()).expect("a run");
    [1, 2].map(|step| std::fs::read(directory.join(format!("checkpoint-{step:08}.bin"))).expect("a checkpoint")).into()
}

/// Reads a checkpoint, with a checksum that is made to fit, and goes on from it.
pub(crate) fn checkpoint(bytes: &[u8]) -> bool {
    let as_it_is = checkpoint_time(bytes).is_ok();
    let end = bytes.len().saturating_sub(4);
    let mut fit = bytes[..end].to_vec();
    fit.extend(crc32fast::hash(&fit).to_le_bytes());
    if checkpoint_time(&fit).is_err() {
        assert!(!as_it_is);
        return false;
    }
    let directory = path("run");
    for step in io::checkpoint_steps(&directory) {
        std::fs::remove_file(directory.join(format!("checkpoint-{step:08}.bin"))).expect("the file");
    }
    written("run/checkpoint-00000002.bin", &fit);
    let options = RunOptions { resumes: true, ..RunOptions::default() };
    options.run(&dry(1.5), &directory, &mut ()).is_ok() || as_it_is
}
