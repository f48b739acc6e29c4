//! Wavefront OBJ: vertices and faces; everything else is ignored.

use super::coordinates::coordinates;
use super::{Malformed, Place};

/// Corners of all triangles; faces with more corners are fanned.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<[[f64; 3]; 3]>, Malformed> {
    let text = std::str::from_utf8(bytes)
        .map_err(|e| Malformed { at: Place::Byte(e.valid_up_to()), what: "the file is not UTF-8".to_owned() })?;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut triangles = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line_number = index + 1;
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => vertices.push(coordinates(line_number, words)?),
            Some("f") => {
                let corners = words.map(|word| corner(line_number, word, &vertices)).collect::<Result<Vec<_>, _>>()?;
                if corners.len() < 3 {
                    let what = format!("a face has {} vertices; at least 3 are needed", corners.len());
                    return Err(Malformed::line(line_number, what));
                }
                triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Ok(triangles)
}

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count from the last vertex.
fn corner(line: usize, word: &str, vertices: &[[f64; 3]]) -> Result<[f64; 3], Malformed> {
    let number = word.split('/').next().unwrap_or_default();
    let index: i64 = number.parse().map_err(|_| Malformed::line(line, format!("`{number}` is no vertex number")))?;
    let position = if index < 0 { vertices.len() as i64 + index } else { index - 1 };
    usize::try_from(position)
        .ok()
        .and_then(|k| vertices.get(k))
        .copied()
        .ok_or_else(|| Malformed::line(line, format!("there is no vertex {index} yet; {} are known", vertices.len())))
}
