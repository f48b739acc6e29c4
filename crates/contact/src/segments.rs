//! Segments: parts of a slave's facet, each of which lies over one facet of the master.
//!
//! The traction on the slave is smooth along a facet, but the master's shape functions have kinks over the edges of its
//! facets. A quadrature rule is exact on segments, which contain no kinks. With it, bodies with non-matching meshes
//! transmit a uniform pressure exactly.
//!
//! Source: Puso and Laursen 2004, A mortar segment-to-segment contact method for large deformation solid mechanics,
//! doi:10.1016/j.cma.2003.06.020.

use mesh::{Coordinates, Point, Tensor, det, facet_normal};

/// Barycentric coordinates closer to zero than this are zero.
const ON_EDGE: f64 = 1e-10;

/// A simplex inside a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment<const D: usize> {
    /// Its vertices, in barycentric coordinates of the facet.
    pub(crate) corners: [[f64; D]; D],
    /// Its share in the measure of the facet.
    pub(crate) share: f64,
}

impl<const D: usize> Segment<D> {
    /// Returns the segment that is the whole facet.
    pub(crate) fn whole() -> Self {
        Self { corners: std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)))), share: 1.0 }
    }

    /// Returns the barycentric coordinates in the facet of a point given by those in the segment.
    #[inline]
    pub(crate) fn at(&self, barycentric: &[f64]) -> [f64; D] {
        std::array::from_fn(|j| self.corners.iter().zip(barycentric).map(|(corner, b)| corner[j] * b).sum())
    }

    /// Returns the values at the corners of an affine function, given at the vertices of the facet.
    fn values(&self, at_vertices: &[f64; D]) -> [f64; D] {
        self.corners.map(|corner| {
            let value: f64 = corner.iter().zip(at_vertices).map(|(b, v)| b * v).sum();
            if value.abs() < ON_EDGE { 0.0 } else { value }
        })
    }

    /// Divides the segment where an affine function with the given values at the corners is zero, and appends the
    /// parts. Every division reduces the number of corners on one side, so that the depth of the recursion is at most
    /// `D`, also with round-off.
    fn split(self, values: [f64; D], parts: &mut Vec<Self>) {
        let below = values.iter().position(|v| *v < 0.0);
        let above = values.iter().position(|v| *v > 0.0);
        let (Some(i), Some(j)) = (below, above) else { return parts.push(self) };
        let fraction = values[i] / (values[i] - values[j]);
        let zero = std::array::from_fn(|k| self.corners[i][k] + fraction * (self.corners[j][k] - self.corners[i][k]));
        for (replaced, share) in [(j, fraction), (i, 1.0 - fraction)] {
            let (mut part, mut values) = (Self { share: share * self.share, ..self }, values);
            (part.corners[replaced], values[replaced]) = (zero, 0.0);
            part.split(values, parts);
        }
    }
}

/// Returns the barycentric coordinates in a facet of the orthogonal projections of points, one array of values at the
/// points for each vertex of the facet; `None` for a facet without measure.
fn projected<const D: usize>(points: &[Point<D>; D], facet: &[Point<D>; D]) -> Option<[[f64; D]; D]> {
    let mut frame = Tensor::<D>::zeros();
    for k in 1..D {
        frame.set_column(k - 1, &(facet[k] - facet[0]));
    }
    frame.set_column(D - 1, &facet_normal(facet));
    let volume = det(&frame);
    if volume == 0.0 {
        return None;
    }
    let mut coordinates = [[0.0; D]; D];
    for (i, x) in points.iter().enumerate() {
        coordinates[0][i] = 1.0;
        for k in 1..D {
            let mut replaced = frame;
            replaced.set_column(k - 1, &(x - facet[0]));
            coordinates[k][i] = det(&replaced) / volume;
            coordinates[0][i] -= coordinates[k][i];
        }
    }
    Some(coordinates)
}

/// Divides a facet of the slave along the edges of facets of the master that face it. The vertices are at positions
/// that are known before the step. The edges move during the step, which causes an error of quadrature.
///
/// In axisymmetric coordinates vertices on the axis are opposite to each other. Orthogonal to a facet of the master
/// they are not, and the segment between would leave nearly no weight to the end of the slave on the axis.
pub(crate) fn divide<const D: usize>(
    slave: &[Point<D>; D],
    master: impl Iterator<Item = [Point<D>; D]>,
    coordinates: Coordinates,
) -> Vec<Segment<D>> {
    let is_on_axis = |x: &Point<D>| coordinates.weight(x) == 0.0;
    let slave_on_axis = slave.iter().position(is_on_axis);
    let normal = facet_normal(slave);
    let (mut segments, mut parts) = (vec![Segment::whole()], Vec::new());
    for facet in master {
        if facet_normal(&facet).dot(&normal) >= 0.0 {
            continue;
        }
        let Some(mut projection) = projected(slave, &facet) else { continue };
        if let (Some(i), Some(k)) = (slave_on_axis, facet.iter().position(is_on_axis)) {
            projection.iter_mut().enumerate().for_each(|(j, of)| of[i] = f64::from(u8::from(j == k)));
        }
        let is_over = |segment: &Segment<D>| projection.iter().all(|c| segment.values(c).iter().any(|v| *v > 0.0));
        if !is_over(&Segment::whole()) {
            continue;
        }
        for coordinate in &projection {
            parts.clear();
            for &segment in &segments {
                if is_over(&segment) {
                    segment.split(segment.values(coordinate), &mut parts)
                } else {
                    parts.push(segment)
                }
            }
            std::mem::swap(&mut segments, &mut parts);
        }
    }
    segments
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that every segment is over one master facet or none, and that the share over some is `over`. Returns the
    /// number of segments.
    fn check<const D: usize>(slave: &[Point<D>; D], master: &[[Point<D>; D]], over: f64) -> usize {
        let segments = divide(slave, master.iter().copied(), Coordinates::Cartesian);
        let share: f64 = segments.iter().map(|s| s.share).sum();
        assert!((share - 1.0).abs() < 1e-12);
        let mut covered = 0.0;
        for segment in &segments {
            assert!(segment.share > 0.0);
            // Shares are those of measures.
            let corners = Tensor::<D>::from_fn(|i, j| segment.corners[i][j]);
            assert!((det(&corners).abs() - segment.share).abs() < 1e-12);
            let centre = segment.at(&[1.0 / D as f64; D]);
            let mut n_over = 0;
            for facet in master {
                let coordinates = projected(slave, facet).expect("a facet");
                let middle = coordinates.iter().all(|c| c.iter().zip(&centre).map(|(c, b)| c * b).sum::<f64>() > 0.0);
                let corners = coordinates.iter().all(|c| segment.values(c).iter().all(|v| *v >= 0.0));
                assert_eq!(middle, corners, "it is over the facet as a whole or not at all");
                n_over += usize::from(middle);
            }
            assert!(n_over <= 1);
            covered += f64::from(u8::from(n_over == 1)) * segment.share;
        }
        assert!((covered - over).abs() < 1e-12, "{covered}");
        segments.len()
    }

    #[test]
    fn segments_end_over_the_vertices_of_the_master() {
        let point = Point::<2>::new;
        // Normals to the right of segments: the master's upwards, the slave's downwards.
        let master: Vec<_> = [0.7, 0.4, 0.25, 0.0].windows(2).map(|x| [point(x[0], 0.0), point(x[1], 0.0)]).collect();
        assert_eq!(check(&[point(0.1, 0.1), point(0.6, 0.2)], &master, 1.0), 3);
        assert_eq!(check(&[point(-0.3, 0.1), point(0.2, 0.1)], &master, 0.4), 2);
        assert_eq!(check(&[point(0.25, 0.1), point(0.4, 0.1)], &master, 1.0), 1, "over a facet exactly");
        let away = [point(0.6, 0.2), point(0.1, 0.1)];
        assert_eq!(
            divide(&away, master.iter().copied(), Coordinates::Cartesian),
            [Segment::whole()],
            "the normals are equal"
        );
    }

    #[test]
    fn ends_on_the_axis_are_opposite_to_each_other() {
        let point = Point::<2>::new;
        let slave = [point(0.0, 0.1), point(0.1, 0.12)];
        let master = [point(0.1, -0.02), point(0.0, 0.0)];
        for height in [1e-2, 1e-8, -1e-8] {
            let master = master.map(|x| x + point(0.0, 0.1 - height));
            let divided = |coordinates| divide(&slave, [master].into_iter(), coordinates);
            let whole = divided(Coordinates::Axisymmetric);
            let on_axis = whole.iter().find(|s| s.corners.contains(&[1.0, 0.0])).expect("a segment");
            assert!(on_axis.share > 0.9, "{height}: {whole:?}");
            assert!(height < 0.0 || divided(Coordinates::Cartesian).len() > 1);
        }
    }

    #[test]
    fn needles_are_divided_as_well_as_they_can_be() {
        let point = Point::<3>::new;
        let slave = [point(0.0, 0.0, 0.1), point(0.0, 1.0, 0.1), point(1.0, 0.0, 0.1)];
        for k in 0..400 {
            let (height, shift) = (10.0_f64.powi(-4 - k % 9), 0.9 * (f64::from(k) * 0.618).fract());
            let needle = [point(-0.1, shift, 0.0), point(1.3, shift - 0.1, 0.0), point(0.3, shift + height, 0.0)];
            let segments = divide(&slave, [needle].into_iter(), Coordinates::Cartesian);
            let share: f64 = segments.iter().map(|s| s.share).sum();
            assert!((share - 1.0).abs() < 1e-12 && segments.iter().all(|s| s.share >= 0.0), "{k}: {segments:?}");
        }
    }

    #[test]
    fn segments_end_over_the_edges_of_the_master() {
        let point = Point::<3>::new;
        // The unit square in two triangles, normals upwards; the slave's is downwards.
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| point(x, y, 0.0));
        let master = [[a, b, c], [a, c, d]];
        let over = [point(0.2, 0.1, 0.3), point(0.1, 0.9, 0.2), point(0.9, 0.8, 0.1)];
        check(&over, &master, 1.0);
        // Right triangle with legs of 1 along the axes, of which a quarter is a triangle over the square.
        let beside = [point(0.5, 0.5, 0.3), point(0.5, 1.5, 0.3), point(1.5, 0.5, 0.3)];
        check(&beside, &master, 0.5);
    }
}
