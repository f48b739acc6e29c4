//! Surfaces from files.

use crate::setting::write;
use io::surface::Surface;
use mesh::Point;

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
