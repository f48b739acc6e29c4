//! STL, ASCII and binary.

use super::coordinates::coordinates;
use super::{Malformed, Place};

const HEADER: usize = 80;
const RECORD: usize = 50;

/// Corners of all triangles. Normals in the file are ignored: the order of the corners decides.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<[[f64; 3]; 3]>, Malformed> {
    // Binary files may begin with "solid" too: their length gives them away.
    if let Some(count) = bytes.get(HEADER..HEADER + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes)
        && HEADER + 4 + RECORD * count as usize == bytes.len()
    {
        return binary(&bytes[HEADER + 4..]);
    }
    match std::str::from_utf8(bytes) {
        Ok(text) if text.trim_start().starts_with("solid") => ascii(text),
        _ => Err(Malformed {
            at: Place::Byte(0),
            what: format!("neither ASCII STL (`solid ...`) nor binary STL of the right length ({} bytes)", bytes.len()),
        }),
    }
}

fn binary(records: &[u8]) -> Result<Vec<[[f64; 3]; 3]>, Malformed> {
    let mut triangles = Vec::with_capacity(records.len() / RECORD);
    for (index, record) in records.chunks_exact(RECORD).enumerate() {
        let mut corners = [[0.0_f64; 3]; 3];
        for (slot, number) in corners.as_flattened_mut().iter_mut().zip(record[12..48].chunks_exact(4)) {
            *slot = f64::from(number.try_into().map(f32::from_le_bytes).unwrap_or(f32::NAN));
            if !slot.is_finite() {
                let at = Place::Byte(HEADER + 4 + RECORD * index);
                return Err(Malformed { at, what: "a coordinate of this triangle is not finite".to_owned() });
            }
        }
        triangles.push(corners);
    }
    Ok(triangles)
}

fn ascii(text: &str) -> Result<Vec<[[f64; 3]; 3]>, Malformed> {
    let mut triangles = Vec::new();
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    for (index, line) in text.lines().enumerate() {
        let line_number = index + 1;
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vertex") => corners.push(coordinates(line_number, words)?),
            Some("endloop") => match corners.as_slice() {
                &[a, b, c] => {
                    triangles.push([a, b, c]);
                    corners.clear();
                }
                _ => {
                    let what = format!("a facet has {} vertices, not 3", corners.len());
                    return Err(Malformed::line(line_number, what));
                }
            },
            None | Some("solid" | "endsolid" | "facet" | "endfacet" | "outer") => {}
            Some(word) => return Err(Malformed::line(line_number, format!("`{word}` is no word of STL"))),
        }
    }
    if !corners.is_empty() {
        return Err(Malformed::line(text.lines().count(), "the file ends inside a facet"));
    }
    Ok(triangles)
}
