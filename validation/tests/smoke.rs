//! Every scenario of the repository can be read, and its meshes can be built.

use std::fs;
use std::path::Path;

use cutwater::io::{ScenarioFile, sizes};

/// Coarse meshes, so that the test is fast.
const COARSE: [&str; 3] = ["background.size.fine=0.5", "background.size.coarse=1.0", "body.0.shape.size=0.5"];

#[test]
fn every_scenario_has_meshes_and_a_first_step() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    let mut n = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let file = ScenarioFile::read(&path, &COARSE.map(str::to_owned)).unwrap();
            let sizes = sizes(&file).unwrap();
            assert!(sizes.n_steps > 0 && sizes.cut_cells > 0 && sizes.dofs > 0, "{}: {sizes:?}", path.display());
            assert_eq!(Some(file.scenario().name.as_str()), path.file_stem().and_then(|stem| stem.to_str()));
            n += 1;
        }
    }
    assert!(n > 0, "no scenarios");
}
