//! STL, ASCII and binary.

use super::lines::{Triangle, coordinates, for_each_line};

/// Bytes of the header of a binary file.
const HEADER: usize = 80;
/// Bytes of a triangle: normal and corners as 12 numbers of 4 bytes, and 2 more bytes.
const RECORD: usize = 50;

/// Returns the corners of all triangles. Normals in the file are ignored; the order of the corners defines them.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, String> {
    // Binary files may begin with "solid" too: they are recognised by their length.
    let count = bytes.get(HEADER..HEADER + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let length = |count: u32| HEADER + 4 + RECORD * count as usize;
    if count.is_some_and(|count| length(count) == bytes.len()) {
        return binary(&bytes[HEADER + 4..]);
    }
    match std::str::from_utf8(bytes) {
        Ok(text) if text.trim_start().starts_with("solid") => ascii(text),
        _ => {
            let n = bytes.len();
            let announced = count.map_or("84 bytes or more".to_owned(), |count| {
                format!("{} bytes for {count} triangles", length(count))
            });
            Err(format!(
                "neither ASCII STL, which begins with `solid`, nor binary STL, which would have {announced} instead of {n}; \
                 save the surface again"
            ))
        }
    }
}

fn binary(records: &[u8]) -> Result<Vec<Triangle>, String> {
    let mut triangles = Vec::with_capacity(records.len() / RECORD);
    for (index, record) in records.chunks_exact(RECORD).enumerate() {
        let mut corners = [[0.0_f64; 3]; 3];
        for (slot, number) in corners.as_flattened_mut().iter_mut().zip(record[12..48].chunks_exact(4)) {
            *slot = f64::from(number.try_into().map(f32::from_le_bytes).unwrap_or(f32::NAN));
        }
        if !corners.as_flattened().iter().all(|x| x.is_finite()) {
            let byte = HEADER + 4 + RECORD * index;
            return Err(format!("byte {byte}: a coordinate of this triangle is not finite"));
        }
        triangles.push(corners);
    }
    Ok(triangles)
}

fn ascii(text: &str) -> Result<Vec<Triangle>, String> {
    let mut triangles = Vec::new();
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    for_each_line(text, |mut words| {
        match words.next() {
            Some("vertex") => corners.push(coordinates(words)?),
            Some("endloop") => {
                let triangle = Triangle::try_from(corners.as_slice());
                triangles.push(triangle.map_err(|_| format!("a facet has {} vertices, not 3", corners.len()))?);
                corners.clear();
            }
            None | Some("solid" | "endsolid" | "facet" | "endfacet" | "outer") => {}
            Some(word) => return Err(format!("`{word}` is no word of STL")),
        }
        Ok(())
    })?;
    if !corners.is_empty() {
        return Err(format!("line {}: the file ends inside a facet", text.lines().count()));
    }
    Ok(triangles)
}
