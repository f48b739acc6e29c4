//! Any bytes as an STL or OBJ file: reading and cutting return a result or an error.

#![no_main]

use std::path::PathBuf;

use cutcell::{CutMesh, OverlayOptions};
use io::surface::Surface;
use libfuzzer_sys::fuzz_target;
use mesh::generate::structured_box;

fuzz_target!(|data: (bool, &[u8])| {
    let (is_stl, bytes) = data;
    let path = file(if is_stl { "stl" } else { "obj" });
    std::fs::write(&path, bytes).expect("a file for temporary use");
    let Ok(surface) = Surface::read(&path) else { return };
    let background = structured_box::<3>([0.0; 3], [1.0; 3], [2; 3]).expect("a box");
    if let Ok(cut) = CutMesh::overlay(&background, &[surface.placed()], &OverlayOptions::new()) {
        assert!(cut.fluid_volume() < 1.0 + 1e-9);
    }
});

/// Returns the path of a temporary file of this process.
fn file(extension: &str) -> PathBuf {
    std::env::temp_dir().join(format!("cutwater-fuzz-{}.{extension}", std::process::id()))
}
