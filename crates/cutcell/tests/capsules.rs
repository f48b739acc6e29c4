//! Single cells that failed in earlier versions.

mod identities;

use std::path::Path;

use cutcell::{Capsule, OverlayOptions};
use identities::check_identities;

fn recut<const D: usize>(text: &str) {
    let capsule: Capsule<D> = text.parse().expect("a capsule");
    assert_eq!(capsule.to_string(), text, "written as read");
    let background = capsule.background().expect("a cell");
    let cut = capsule.overlay(&OverlayOptions::new()).expect("a cut");
    check_identities(&background, &cut);
    assert!(cut.report().n_cut_cells == 1, "the facets cut the cell");
}

#[test]
fn capsules_keep_the_identities() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/capsules");
    let mut n_capsules = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a text");
        println!("{}", path.display());
        if text.contains("dimension 2") {
            recut::<2>(&text)
        } else {
            recut::<3>(&text)
        }
        n_capsules += 1;
    }
    assert!(n_capsules > 0);
}

#[test]
fn malformed_capsules_are_refused_with_the_line() {
    let good = "cutcell capsule 1\ndimension 2\ndepth 0\ncell\n0e0 0e0\n1e0 0e0\n0e0 1e0\nvertices 0\nfacets 0\n";
    assert!(good.parse::<Capsule<2>>().is_ok());
    for (from, to, part) in [
        ("capsule 1", "capsule 7", "line 1"),
        ("dimension 2", "dimension 3", "line 2"),
        ("depth 0", "depth x", "line 3"),
        ("1e0 0e0", "1e0", "line 6"),
        ("vertices 0\n", "vertices 1\n", "line 9"),
        ("facets 0\n", "facets 1\n0 0 3 4\n", "unknown vertex"),
        ("facets 0\n", "", "ends"),
    ] {
        let message = good.replace(from, to).parse::<Capsule<2>>().expect_err("malformed").to_string();
        assert!(message.contains(part), "{message}");
    }
}
