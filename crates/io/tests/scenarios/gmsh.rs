//! Reading and writing of Gmsh files, and refusal of malformed ones.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use io::gmsh::{GmshFile, GmshFormat, GmshMesh, GmshVersion, write};
use mesh::generate::{BallOptions, ball, structured_box};
use mesh::{FacetId, Placed, Point, SimplexMesh, Vector, VertexId};
use solid_svk::{ElasticBody, ElasticOptions, LameParameters, Material, SaintVenantKirchhoff, SolidForm, SolidMesh};
use solver::body::Body;

type EdgeNodes<const D: usize> = HashMap<[VertexId; 2], Point<D>>;

fn path(name: &str) -> PathBuf {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("gmsh");
    std::fs::create_dir_all(&directory).expect("a directory");
    directory.join(name)
}

const FORMATS: [GmshFormat; 4] = [
    GmshFormat { version: GmshVersion::V22, is_binary: false },
    GmshFormat { version: GmshVersion::V22, is_binary: true },
    GmshFormat { version: GmshVersion::V41, is_binary: false },
    GmshFormat { version: GmshVersion::V41, is_binary: true },
];

/// Returns the bytes of a file. Tests run at the same time, so that each file has a name of its own.
fn bytes<const D: usize>(mesh: &SimplexMesh<D>, edge_nodes: &EdgeNodes<D>, format: GmshFormat) -> Vec<u8> {
    static N_FILES: AtomicUsize = AtomicUsize::new(0);
    let path = path(&format!("bytes-{}.msh", N_FILES.fetch_add(1, Ordering::Relaxed)));
    write(&path, mesh, edge_nodes, format).expect("a file");
    std::fs::read(path).expect("the file")
}

/// A mesh with two groups of cells, cells without a group, and a part of the boundary without a name.
fn grouped<const D: usize>(mesh: SimplexMesh<D>) -> SimplexMesh<D> {
    let centroids: Vec<f64> = mesh.cells().map(|cell| mesh.simplex(cell).centroid()[0]).collect();
    let mesh = mesh.with_cell_tags(|cell| match centroids[cell.index()] {
        x if x < 0.4 => Some("soft part"),
        x if x < 0.8 => Some("right"),
        _ => None,
    });
    let names: Vec<Option<String>> = mesh
        .facets()
        .map(|facet| Some(mesh.tag_names()[mesh.facet_tag(facet)?.index()].clone()).filter(|name| name != "top"))
        .collect();
    mesh.with_facet_tags(|facet| names[facet.index()].as_deref())
}

/// Returns nodes on all edges of a mesh, off their middles.
fn bent<const D: usize>(mesh: &SimplexMesh<D>) -> EdgeNodes<D> {
    let mut nodes = HashMap::new();
    for cell in mesh.cells() {
        for (k, &a) in mesh.cell(cell).iter().enumerate() {
            for &b in &mesh.cell(cell)[..k] {
                let middle = (mesh.vertex(a) + mesh.vertex(b)) * 0.5;
                nodes.insert([a.min(b), a.max(b)], middle + middle * (0.01 / 3.0));
            }
        }
    }
    nodes
}

fn assert_same<const D: usize>(found: &GmshMesh<D>, mesh: &SimplexMesh<D>, edge_nodes: &EdgeNodes<D>) {
    assert_eq!(found.mesh.vertices(), mesh.vertices());
    assert!(mesh.cells().all(|cell| found.mesh.cell(cell) == mesh.cell(cell)));
    assert_eq!(found.edge_nodes, *edge_nodes);
    let name = |mesh: &SimplexMesh<D>, tag: Option<mesh::Tag>| tag.map(|tag| mesh.tag_names()[tag.index()].clone());
    for cell in mesh.cells() {
        assert_eq!(name(&found.mesh, found.mesh.cell_tag(cell)), name(mesh, mesh.cell_tag(cell)));
    }
    for facet in mesh.facets() {
        assert_eq!(name(&found.mesh, found.mesh.facet_tag(facet)), name(mesh, mesh.facet_tag(facet)));
    }
    assert_eq!((found.n_turned, found.n_inside, found.n_ambiguous), (0, 0, 0));
}

fn round_trip<const D: usize>(mesh: SimplexMesh<D>) {
    let mesh = grouped(mesh.mapped(|x| x / 3.0).expect("a mesh"));
    for edge_nodes in [HashMap::new(), bent(&mesh)] {
        for format in FORMATS {
            let file = GmshFile::parse(&bytes(&mesh, &edge_nodes, format)).expect("a file");
            assert_eq!((file.version(), file.dimension()), (format.version, D));
            assert_eq!(file.order(D), if edge_nodes.is_empty() { 1 } else { 2 });
            assert_same(&file.mesh::<D>().expect("a mesh"), &mesh, &edge_nodes);
        }
    }
}

#[test]
fn a_mesh_is_read_as_it_was_written() {
    round_trip(structured_box([0.0, 0.0], [3.0, 2.0], [4, 3]).expect("a mesh"));
    round_trip(structured_box([0.0; 3], [3.0, 2.0, 1.0], [3, 2, 2]).expect("a mesh"));
}

/// Two triangles in the form in which Gmsh writes version 4.1: nodes by entity, gaps in their numbers, a point that no
/// element uses, and other sections.
const V41: &str = include_str!("gmsh-files/two-triangles-41.msh");

/// The same in version 2.2, the second triangle clockwise. The elements in two groups are written twice.
const V22: &str = include_str!("gmsh-files/two-triangles-22.msh");

#[test]
fn files_of_both_versions_are_understood() {
    for (text, n_turned) in [(V41, 0), (V22, 1), (&V22.replace("100 30 1", "100 1 30"), 0)] {
        for end in ["\n", "\r\n", " \n"] {
            let text = text.replace('\n', end);
            let found = GmshFile::parse(text.as_bytes()).expect("a file").mesh::<2>().expect("a mesh");
            let GmshMesh { mesh, edge_nodes, .. } = found;
            assert!(edge_nodes.is_empty());
            let at = |x: f64, y: f64| Point::<2>::new(x, y);
            assert_eq!(mesh.vertices(), [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)]);
            assert_eq!((mesh.volume(), mesh.n_cells()), (2.0, 2));
            let soft = mesh.tag("soft \"part\"");
            assert!(soft.is_some() && mesh.cells().all(|cell| mesh.cell_tag(cell) == soft));
            // The name of a group without one is its number.
            let on = |name: &str| -> Vec<FacetId> {
                mesh.facets().filter(|facet| mesh.facet_tag(*facet) == mesh.tag(name)).collect()
            };
            let [slip, eight] = ["no slip", "8"].map(on);
            assert_eq!((slip.len(), eight.len()), (1, 1));
            assert!((mesh.facet_measure(slip[0]), mesh.facet_measure(eight[0])) == (2.0, 1.0));
            assert_eq!((found.n_ambiguous, found.n_inside, found.n_turned), (1, 0, n_turned));
        }
    }
    let clockwise = V22.replace("1 20 30\n12", "1 30 20\n12");
    let turned = GmshFile::parse(clockwise.as_bytes()).expect("a file").mesh::<2>().expect("a mesh");
    assert_eq!((turned.n_turned, turned.mesh.volume()), (2, 2.0));
    // A point that no element uses may lie anywhere.
    let beyond = V22.replace("40 9 9 0", "40 9 9 5");
    assert_eq!(GmshFile::parse(beyond.as_bytes()).expect("a file").dimension(), 2);
    // A line in the inside has no effect.
    let inside = V22.replace("4 1 2 8 2 20 30", "4 1 2 8 2 1 30");
    assert_eq!(GmshFile::parse(inside.as_bytes()).expect("a file").mesh::<2>().expect("a mesh").n_inside, 1);
}

#[test]
fn the_highest_byte_may_come_first() {
    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    let int = |bytes: &mut Vec<u8>, number: i32| bytes.extend(number.to_be_bytes());
    int(&mut bytes, 1);
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n3\n");
    for (k, x) in [[0.0, 0.0], [2.0, 0.0], [0.0, 3.0_f64]].iter().enumerate() {
        int(&mut bytes, k as i32 + 1);
        [x[0], x[1], 0.0].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n1\n");
    [2, 1, 1, 5, 9, 1, 2, 3].iter().for_each(|number| int(&mut bytes, *number));
    bytes.extend(b"\n$EndElements\n");
    let mesh = GmshFile::parse(&bytes).expect("a file").mesh::<2>().expect("a mesh").mesh;
    assert_eq!((mesh.volume(), mesh.tag_names()), (3.0, &["9".to_owned()][..]));
}

#[test]
fn surfaces_are_oriented() {
    let ball = ball::<3>([0.0; 3], 1.0, 0.5, &BallOptions::default()).expect("a mesh");
    // The file without its tetrahedra, and with every third triangle turned.
    let text = String::from_utf8(bytes(&ball, &HashMap::new(), FORMATS[0])).expect("a text");
    let (before, rest) = text.split_once("$Elements\n").expect("elements");
    let (mut k, mut lines) = (0, Vec::new());
    for words in rest.lines().map(|line| line.split(' ').collect::<Vec<_>>()).filter(|words| words.get(1) == Some(&"2"))
    {
        let &[number, kind, n, group, entity, a, b, c, ..] = &words[..] else { panic!("{words:?}") };
        let [b, c] = if k % 3 == 1 { [c, b] } else { [b, c] };
        k += 1;
        lines.push([number, kind, n, group, entity, a, b, c].join(" "));
    }
    let text = format!("{before}$Elements\n{}\n{}\n$EndElements\n", lines.len(), lines.join("\n"));
    let file = GmshFile::parse(text.as_bytes()).expect("a file");
    assert!(!file.has_cells(3) && file.dimension() == 3);
    let (surface, positions) = file.surface::<3>().expect("a surface");
    let volume = Placed::new(&surface, &positions).enclosed().volume;
    assert!((volume.abs() - ball.volume()).abs() < 1e-12);
    assert!(file.mesh::<3>().is_err_and(|problem| problem.contains("no tetrahedra")));
    let open = format!("{before}$Elements\n{}\n{}\n$EndElements\n", lines.len() - 1, lines[1..].join("\n"));
    let problem = GmshFile::parse(open.as_bytes()).expect("a file").surface::<3>().expect_err("it is open");
    assert!(problem.contains("is open at (") && problem.contains("close it"), "{problem}");

    let square = V22
        .replace("5 1 2 7 2 20 30\n11 2 2 3 5 1 20 30\n12 2 4 3 5 1 0 100 30 1", "5 1 2 0 2 100 30\n6 1 2 0 2 100 1");
    let square = square.replace("$Elements\n6", "$Elements\n5");
    let (surface, positions) = GmshFile::parse(square.as_bytes()).expect("a file").surface::<2>().expect("a surface");
    assert_eq!((surface.n_facets(), Placed::new(&surface, &positions).enclosed().volume.abs()), (4, 2.0));
}

/// Checks the beginning of the message for a file.
#[track_caller]
fn refused(text: &str, message: &str) {
    let found = GmshFile::parse(text.as_bytes()).and_then(|file| file.mesh::<2>().map(|_| ()));
    let found = found.expect_err(message);
    assert!(found.starts_with(message), "expected: {message}\nfound:    {found}");
}

/// Two triangles of order 2 whose common edge has one node in its middle, two at the same place, and two apart.
#[test]
fn edges_have_one_node_in_their_middle() {
    let with = |middle: &str, node: usize| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.5 0 0\n6 1 0.5 0\n7 0.5 0.5 0\n8 0.5 1 0\n\
             9 0 0.5 0\n10 {middle} 0\n$EndNodes\n$Elements\n2\n1 9 2 0 1 1 2 3 5 6 7\n2 9 2 0 1 1 3 4 {node} 8 9\n$EndElements\n"
        )
    };
    for text in [with("0.5 0.5", 7), with("0.5 0.5", 10)] {
        let found = GmshFile::parse(text.as_bytes()).and_then(|file| file.mesh::<2>()).expect("a mesh");
        assert_eq!(found.edge_nodes.len(), 5);
    }
    refused(
        &with("0.51 0.49", 10),
        "element 2 and one before it have different nodes in the middle of their common edge near (0.51",
    );
}

/// A mesh that is there twice, and one of which a part covers another.
#[test]
fn meshes_that_overlap_are_refused() {
    let square = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [3, 3]).expect("a box");
    for shift in [0.0, 0.3] {
        let mut points = square.vertices().to_vec();
        points.extend(square.vertices().iter().map(|x| x + Vector::repeat(shift)));
        let second = |vertex: &VertexId| VertexId::new(vertex.index() + square.n_vertices());
        let corners = |cell| -> [VertexId; 3] { std::array::from_fn(|k| square.cell(cell)[k]) };
        let once: Vec<VertexId> = square.cells().flat_map(corners).collect();
        let twice: Vec<VertexId> = once.iter().copied().chain(once.iter().map(second)).collect();
        let mesh = SimplexMesh::<2>::new(points, twice).expect("a mesh");
        let bytes = bytes(&mesh, &HashMap::new(), FORMATS[0]);
        let found = GmshFile::parse(&bytes).and_then(|file| file.mesh::<2>().map(|_| ()));
        let found = found.expect_err("an overlap");
        assert!(found.contains("overlap near") && found.contains("remove one of them"), "{found}");
    }
}

#[test]
fn malformed_files_are_refused_with_place_and_remedy() {
    refused("", "the file is empty; save the mesh again");
    refused(&V22[..V22.find("$Nodes").expect("nodes")], "the file has no nodes; make the mesh before it is saved");
    let of_22 = [
        ("2.2 0 8", "2.2 0 4", "line 2: numbers of 4 bytes are not read"),
        ("2.2 0 8", "2.2 2 8", "line 2: `2` is neither 0 for text nor 1 for binary"),
        ("2.2 0 8", "2.2", "line 2: `2.2` is not a version, 0 or 1 for text or binary, and 8"),
        ("2.2 0 8", "2.2 1 8", "byte 24: the integer 1 of a binary file is missing"),
        ("1 7 \"no slip\"", "1 7 no slip", "line 6: `1 7 no slip` is not a dimension, a number, and a name"),
        ("$PhysicalNames\n2", "$PhysicalNames\ntwo", "line 5: `two` is not a number of entries"),
        ("$Nodes\n5", "$Nodes\n6", "line 16: `$EndNodes` is found within the entries of the section"),
        ("30 2 1 0", "-30 2 1 0", "line 13: the number -30 is negative"),
        ("11 2 2 3 5 1 20 30", "11 77 2 3 5 1 20 30", "line 23: this element is of the unknown kind 77"),
        ("11 2 2 3 5 1 20 30", "11 2 -2 3 5 1 20 30", "line 23: the number of tags of this element is invalid"),
        ("$Elements\n6", "$Elements\n7", "line 25: `$EndElements` is found within the entries of the section"),
        ("$EndElements", "", "line 26: `$NodeData` is found instead of `$EndElements`"),
        ("$EndNodeData\n", "", "line 26: the section `$NodeData` has no end; the file is cut off"),
        ("$NodeData", "$EndNodeData", "line 26: `$EndNodeData` ends a section that did not begin"),
        ("30 2 1 0", "30 1 0 0", "element 11 near (1.000000, 0.000000) is degenerate (no area or volume)"),
        ("100 0 1 0", "100 1.9 0.1 0", "the elements 11 and 12 lie on the same side of their common facet near ("),
    ];
    let of_41 = [
        ("3 5 1 100", "3 6 1 100", "line 33: the section states 6 nodes, and its blocks have 5; save the mesh again"),
        ("3 4 1 12", "3 3 1 12", "line 43: the section states 3 elements, and its blocks have 4; save the mesh again"),
        ("$Entities", "$PartitionedEntities", "line 12: the mesh is divided into partitions; save it without them"),
        ("1 2 1 0\n", "1 2 1 77777\n", "line 13: 77777 entries are announced"),
        ("2 5 0 2\n", "2 5 0 20000\n", "line 29: 20000 entries are announced"),
        ("2 5 2 2\n", "2 5 3 2\n", "line 41: this element is a quadrangle"),
        ("2 5 2 2\n", "2 5 2 -2\n", "line 41: `-2` is not a whole number, zero or above"),
    ];
    for (good, (from, to, message)) in of_22.map(|case| (V22, case)).into_iter().chain(of_41.map(|case| (V41, case))) {
        assert!(good.contains(from), "{from}");
        refused(&good.replacen(from, to, 1), message);
    }
}

/// A group of a fixture: its name, the number of its elements, and their length, area or volume for elements of order 1
/// and 2.
type Group = (&'static str, usize, [f64; 2]);

/// Numbers that Gmsh 4.15.2 states of the meshes of `gmsh-files`: nodes of cells of order 2, corners, and groups of the
/// boundary and of cells. Measures are sums of its Jacobians with its rule `Gauss6`.
struct Numbers {
    name: &'static str,
    nodes: usize,
    corners: usize,
    boundary: [Group; 3],
    cells: [Group; 2],
}

const PLANE: Numbers = Numbers {
    name: "plane",
    nodes: 209,
    corners: 59,
    boundary: [("left", 4, [1.0, 1.0]), ("right", 4, [1.0, 1.0]), ("walls", 16, [4.0, 4.0])],
    cells: [
        ("soft", 77, [1.712342411933971, 1.686127431624925]),
        ("hard part", 15, [0.28765758806603303, 0.3138725683750787]),
    ],
};

const SPACE: Numbers = Numbers {
    name: "space",
    nodes: 368,
    corners: 62,
    boundary: [("bottom", 14, [1.0, 1.0]), ("sides", 56, [4.0, 4.0]), ("top", 14, [1.0, 1.0])],
    cells: [
        ("core", 30, [0.07693226934543246, 0.07693226934543246]),
        ("shell", 173, [0.9230677306549836, 0.9230677306549836]),
    ],
};

/// Returns the volume of a group with elements of order 2: the mass of a body in which only the group has a density to
/// speak of.
fn curved_volume<const D: usize>(found: &GmshMesh<D>, group: &str) -> f64 {
    let (mesh, nodes) = (&found.mesh, &found.edge_nodes);
    let tag = mesh.tag(group);
    let of_cell = mesh.cells().map(|cell| usize::from(mesh.cell_tag(cell) == tag)).collect();
    let solid = SolidMesh::curved(mesh.clone(), |ends, middle| nodes.get(&ends).copied().unwrap_or(middle));
    let solid = solid.and_then(|solid| solid.with_groups(of_cell)).expect("a solid");
    let material =
        || -> Arc<dyn Material<D>> { Arc::new(SaintVenantKirchhoff::new(LameParameters { mu: 1.0, lambda: 1.0 })) };
    let form = SolidForm::of_groups(vec![(1e-15, material()), (1.0, material())], Vector::zeros()).expect("a form");
    let body = ElasticBody::new("body", solid, form, ElasticOptions::default()).expect("a body");
    body.balance(&body.initial()).expect("a balance").mass
}

fn check_numbers<const D: usize>(numbers: &Numbers) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/gmsh-files");
    for order in [1, 2] {
        for format in ["22-text", "22-binary", "41-text", "41-binary"] {
            let name = format!("{}-{order}-{format}.msh", numbers.name);
            let file = GmshFile::read(&folder.join(&name)).unwrap_or_else(|error| panic!("{error}"));
            let found = file.mesh::<D>().unwrap_or_else(|error| panic!("{name}: {error}"));
            let mesh = &found.mesh;
            assert_eq!((file.order(D), mesh.n_vertices()), (order, numbers.corners), "{name}");
            // Every edge of a cell of order 2 has a node.
            let n_edge_nodes = if order == 2 { numbers.nodes - numbers.corners } else { 0 };
            assert_eq!(found.edge_nodes.len(), n_edge_nodes, "{name}");
            for (group, n, measures) in numbers.boundary {
                let tag = mesh.tag(group);
                let of_group: Vec<FacetId> =
                    mesh.facets().filter(|f| tag.is_some() && mesh.facet_tag(*f) == tag).collect();
                let measure: f64 = of_group.iter().map(|facet| mesh.facet_measure(*facet)).sum();
                assert_eq!(of_group.len(), n, "{name}: {group}");
                assert!((measure - measures[order - 1]).abs() < 1e-12, "{name}: {group} {measure}");
            }
            for (group, n, measures) in numbers.cells {
                let tag = mesh.tag(group);
                let of_group: Vec<_> = mesh.cells().filter(|c| tag.is_some() && mesh.cell_tag(*c) == tag).collect();
                let linear: f64 = of_group.iter().map(|cell| mesh.cell_volume(*cell)).sum();
                let volume = if order == 1 { linear } else { curved_volume(&found, group) };
                assert_eq!(of_group.len(), n, "{name}: {group}");
                assert!((linear - measures[0]).abs() < 1e-12, "{name}: {group} {linear}");
                assert!((volume - measures[order - 1]).abs() < 1e-12, "{name}: {group} {volume}");
            }
        }
    }
}

#[test]
fn files_of_gmsh_have_the_numbers_that_gmsh_states() {
    check_numbers::<2>(&PLANE);
    check_numbers::<3>(&SPACE);
}
