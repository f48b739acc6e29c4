//! Wavefront OBJ: vertices and faces; everything else is ignored.

use super::lines::{Triangle, coordinates, for_each_line};

/// Returns the corners of all triangles. Faces with more corners are divided into a fan of triangles.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, String> {
    let text = std::str::from_utf8(bytes).map_err(|e| format!("byte {}: the file is not UTF-8", e.valid_up_to()))?;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut triangles = Vec::new();
    for_each_line(text, |mut words| {
        match words.next() {
            Some("v") => vertices.push(coordinates(words)?),
            Some("f") => {
                let corners = words.map(|word| corner(word, &vertices)).collect::<Result<Vec<_>, _>>()?;
                if corners.len() < 3 {
                    return Err(format!("a face has {} vertices; at least 3 are needed", corners.len()));
                }
                triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(triangles)
}

/// Returns a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count from the last vertex.
fn corner(word: &str, vertices: &[[f64; 3]]) -> Result<[f64; 3], String> {
    let number = word.split('/').next().unwrap_or_default();
    let index: i64 = number.parse().map_err(|_| format!("`{number}` is no vertex number"))?;
    let position = if index < 0 { vertices.len() as i64 + index } else { index - 1 };
    let found = usize::try_from(position).ok().and_then(|k| vertices.get(k)).copied();
    found.ok_or_else(|| format!("there is no vertex {index} yet; {} are known", vertices.len()))
}
