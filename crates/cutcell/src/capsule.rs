//! Minimal reproducible cases: one cell and the facets that touch it.

use std::fmt;
use std::str::FromStr;

use mesh::{BodyId, CellId, FacetId, Placed, Point, SimplexMesh, VertexId};

use crate::classify::depths;
use crate::cutting::Cutting;
use crate::surface::{self, Facet};
use crate::touched::TouchedCells;
use crate::{CutMesh, Cutter, Error, OverlayOptions};

/// A cell with the facets that touch it. They determine the cut of the cell bit for bit.
///
/// `Display` writes a short text for defect reports and tests, and `FromStr` reads it back. The facets need not form a
/// closed surface; [`Capsule::overlay`] cuts the cell nevertheless.
///
/// ```
/// use cutcell::{Capsule, OverlayOptions};
/// use mesh::{CellId, Placed, generate::{Size, structured_box}};
///
/// let background = structured_box::<2>([0.0, 0.0], [4.0, 4.0], [4, 4])?;
/// let square = structured_box::<2>([1.1, 1.2], [2.3, 3.1], [1, 1])?;
/// let boundary = square.boundary();
/// let surfaces = [Placed::new(&boundary, square.vertices())];
/// let capsule = Capsule::around(&background, &surfaces, CellId(10), &OverlayOptions::new())?;
/// let again: Capsule<2> = capsule.to_string().parse()?;
/// assert_eq!(again, capsule);
/// let cut = again.overlay(&OverlayOptions::new())?;
/// assert_eq!(cut.report().n_cut_cells, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule<const D: usize> {
    /// Corners of the cell.
    cell: Vec<Point<D>>,
    /// Number of bodies around the first corner.
    depth: i32,
    /// Vertices of the facets.
    vertices: Vec<Point<D>>,
    /// Body, facet, and vertices (positions in `vertices`; only the first `D` are used).
    facets: Vec<(BodyId, FacetId, [u32; 3])>,
}

/// First line of the text.
const TITLE: &str = "cutcell capsule 1";

impl<const D: usize> Capsule<D> {
    /// Extracts one cell of an overlay.
    ///
    /// # Errors
    /// As [`CutMesh::overlay`].
    ///
    /// # Panics
    /// If the cell does not exist.
    pub fn around(
        background: &SimplexMesh<D>,
        surfaces: &[Placed<'_, D>],
        cell: CellId,
        options: &OverlayOptions,
    ) -> Result<Self, Error> {
        let (mut all, mut touched, mut depth) = (Vec::new(), TouchedCells::default(), Vec::new());
        surface::collect(background, surfaces, options, &mut all)?;
        touched.find(background, &all);
        depths(background, &all, &touched, &mut depth);
        let depth = depth[background.cell(cell)[0].index()];
        let mut capsule =
            Self { cell: background.simplex(cell).points().to_vec(), depth, vertices: Vec::new(), facets: Vec::new() };
        let mut numbers: Vec<u32> = Vec::new();
        for &index in touched.position(cell).map_or(&[][..], |k| touched.facets(k)) {
            let facet = &all[index as usize];
            let mut corners = [0; 3];
            for ((slot, number), x) in corners.iter_mut().zip(facet.vertices).zip(facet.points()) {
                let known = numbers.iter().position(|n| *n == number);
                *slot = known.unwrap_or_else(|| {
                    numbers.push(number);
                    capsule.vertices.push(*x);
                    numbers.len() - 1
                }) as u32;
            }
            capsule.facets.push((facet.body, facet.id, corners));
        }
        Ok(capsule)
    }

    /// Cuts the cell; the background is the cell alone.
    ///
    /// # Errors
    /// [`Error::Capsule`] if the corners do not form a cell.
    pub fn overlay(&self, options: &OverlayOptions) -> Result<CutMesh<D>, Error> {
        let background = self.background()?;
        let facets: Vec<Facet<D>> = self
            .facets
            .iter()
            .map(|&(body, id, corners)| {
                let points: Vec<Point<D>> = corners[..D].iter().map(|&k| self.vertices[k as usize]).collect();
                Facet::new(body, id, &points, corners)
            })
            .collect();
        let mut touched = TouchedCells::default();
        touched.find(&background, &facets);
        let depth = vec![self.depth; background.n_vertices()];
        Ok(Cutter::new().cut(&Cutting::new(&background, &facets, &touched, &depth, options)))
    }

    /// Returns the cell as a mesh.
    ///
    /// # Errors
    /// [`Error::Capsule`] if the corners do not form a cell.
    pub fn background(&self) -> Result<SimplexMesh<D>, Error> {
        SimplexMesh::new(self.cell.clone(), (0..self.cell.len()).map(VertexId::new).collect())
            .map_err(|error| Error::Capsule { line: 0, what: error.to_string() })
    }
}

impl<const D: usize> fmt::Display for Capsule<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{TITLE}\ndimension {D}\ndepth {}\ncell", self.depth)?;
        let write_points = |f: &mut fmt::Formatter<'_>, points: &[Point<D>]| {
            // The shortest decimals that parse to the same number.
            points.iter().try_for_each(|x| {
                let words: Vec<String> = x.iter().map(|c| format!("{c:e}")).collect();
                writeln!(f, "{}", words.join(" "))
            })
        };
        write_points(f, &self.cell)?;
        writeln!(f, "vertices {}", self.vertices.len())?;
        write_points(f, &self.vertices)?;
        writeln!(f, "facets {} (body, facet, vertices)", self.facets.len())?;
        self.facets.iter().try_for_each(|(body, facet, corners)| {
            let words: Vec<String> = corners[..D].iter().map(u32::to_string).collect();
            writeln!(f, "{} {} {}", body.0, facet.0, words.join(" "))
        })
    }
}

/// Numbered lines of the text of a capsule.
struct Lines<'a>(std::iter::Enumerate<std::str::Lines<'a>>);

impl<'a> Lines<'a> {
    fn next(&mut self, expected: &str) -> Result<(usize, &'a str), Error> {
        let missing = || Error::Capsule { line: 0, what: format!("the text ends before: {expected}") };
        self.0.next().map(|(index, line)| (index + 1, line)).ok_or_else(missing)
    }

    /// Reads the number after a keyword.
    fn number<T: FromStr>(&mut self, keyword: &str) -> Result<T, Error> {
        let (line, text) = self.next(keyword)?;
        let number = text.strip_prefix(keyword).and_then(|rest| rest.split_whitespace().next()?.parse().ok());
        number.ok_or_else(|| Error::Capsule { line, what: format!("expected `{keyword}` and a number") })
    }

    fn numbers<T: FromStr>(&mut self, count: usize, expected: &str) -> Result<Vec<T>, Error> {
        let (line, text) = self.next(expected)?;
        let numbers: Vec<T> = text.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let complete = numbers.len() == count && text.split_whitespace().count() == count;
        if complete { Ok(numbers) } else { Err(Error::Capsule { line, what: format!("expected {expected}") }) }
    }

    fn point<const D: usize>(&mut self) -> Result<Point<D>, Error> {
        let coordinates = self.numbers::<f64>(D, "the coordinates of a point")?;
        Ok(Point::from_fn(|k, _| coordinates[k]))
    }
}

impl<const D: usize> FromStr for Capsule<D> {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let mut lines = Lines(text.lines().enumerate());
        let (line, title) = lines.next(TITLE)?;
        if title.trim() != TITLE {
            return Err(Error::Capsule { line, what: format!("expected `{TITLE}`") });
        }
        if lines.number::<usize>("dimension")? != D {
            return Err(Error::Capsule { line: 2, what: format!("expected dimension {D}") });
        }
        let depth = lines.number("depth")?;
        lines.next("cell")?;
        let cell = (0..=D).map(|_| lines.point()).collect::<Result<_, _>>()?;
        let n_vertices: u32 = lines.number("vertices")?;
        let vertices = (0..n_vertices).map(|_| lines.point()).collect::<Result<_, _>>()?;
        let n_facets: usize = lines.number("facets")?;
        let mut facets = Vec::new();
        for _ in 0..n_facets {
            let words = lines.numbers::<u32>(D + 2, "a body, a facet and its vertices")?;
            if words[2..].iter().any(|&v| v >= n_vertices) {
                return Err(Error::Capsule { line: 0, what: format!("facet {} has an unknown vertex", words[1]) });
            }
            let mut corners = [0; 3];
            corners[..D].copy_from_slice(&words[2..]);
            facets.push((BodyId(words[0]), FacetId(words[1]), corners));
        }
        Ok(Self { cell, depth, vertices, facets })
    }
}
