//! Memory that a run needs, and memory of the machine.

/// Smallest memory of a run per cell of the background, with the factors of the linear solver, bytes. Measured were
/// 8.4e3 to 9.4e3 in 2D for 14 000 to 230 000 cells, and 9.8e3 to 26e3 in 3D for 6000 to 162 000 cells.
const PER_CELL: f64 = 8e3;

/// Smallest memory for the mesh of a body per cell, bytes. Measured: 290 for disks of 0.4 and 0.9 million cells.
const PER_CELL_OF_BODY: f64 = 280.0;

/// Returns an explanation if the mesh of a body with about this number of cells needs more memory than is available.
pub(crate) fn shortage_of_body(n_cells: f64) -> Option<String> {
    explained(n_cells, PER_CELL_OF_BODY, available())
}

/// Returns an explanation if a background with about this number of cells needs more memory than `available`, bytes.
pub(crate) fn shortage(n_cells: f64, available: f64) -> Option<String> {
    explained(n_cells, PER_CELL, available)
}

fn explained(n_cells: f64, per_cell: f64, available: f64) -> Option<String> {
    let [needed, available] = [n_cells * per_cell, available].map(|bytes| bytes / 2.0_f64.powi(30));
    (needed > available).then(|| {
        let needed = if needed < 1e6 { format!("{needed:.0}") } else { format!("{needed:.1e}") };
        format!(
            "about {n_cells:.1e} cells need at least {needed} GiB of memory, and {available:.1} GiB are available; increase the size"
        )
    })
}

/// Returns the memory that is available, in bytes; infinity if it is not known.
pub(crate) fn available() -> f64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kib = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kib.map_or(f64::INFINITY, |kib| 1024.0 * kib)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shortage_is_explained_with_both_amounts() {
        let gib = 2.0_f64.powi(30);
        assert_eq!(shortage(1e5, gib), None);
        let text = shortage(1e6, 2.5 * gib).expect("8 GB do not fit");
        assert!(text.contains("1.0e6 cells") && text.contains("7 GiB") && text.contains("2.5 GiB"), "{text}");
        assert!(available() > 1e6);
    }
}
