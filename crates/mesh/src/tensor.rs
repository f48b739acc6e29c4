//! Points, vectors and tensors of dimension `D`, and the conventions for them.
//!
//! Gradients are stored `grad_u[(a, b)] = ∂u_a/∂x_b`, hence `F = I + grad_d`.

use nalgebra::{SMatrix, SVector};

/// A position in space.
pub type Point<const D: usize> = SVector<f64, D>;
/// A vector in space.
pub type Vector<const D: usize> = SVector<f64, D>;
/// A second-order tensor.
pub type Tensor<const D: usize> = SMatrix<f64, D, D>;

/// Names of the axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns the unit vector along an axis with an index from 0 to `D - 1`; zero for another index.
pub fn unit_vector<const D: usize>(axis: usize) -> Vector<D> {
    Vector::from_fn(|a, _| f64::from(u8::from(a == axis)))
}

/// Returns whether surfaces with two unit normals face opposite ways: one normal and the reverse of the other one
/// enclose less than 60 degrees.
#[inline]
pub fn are_opposite<const D: usize>(normal: &Vector<D>, other: &Vector<D>) -> bool {
    normal.dot(other) < -0.5
}

/// Returns the mean of points.
#[inline]
pub fn mean<const D: usize>(points: &[Point<D>]) -> Point<D> {
    points.iter().sum::<Point<D>>() / points.len() as f64
}

/// Returns the determinant of a tensor; nalgebra's own function has trait bounds on the dimension.
#[inline]
pub fn det<const D: usize>(t: &Tensor<D>) -> f64 {
    match D {
        1 => t[(0, 0)],
        2 => t[(0, 0)] * t[(1, 1)] - t[(0, 1)] * t[(1, 0)],
        3 => {
            t[(0, 0)] * (t[(1, 1)] * t[(2, 2)] - t[(1, 2)] * t[(2, 1)])
                - t[(0, 1)] * (t[(1, 0)] * t[(2, 2)] - t[(1, 2)] * t[(2, 0)])
                + t[(0, 2)] * (t[(1, 0)] * t[(2, 1)] - t[(1, 1)] * t[(2, 0)])
        }
        _ => unreachable!("meshes are of dimension 2 or 3"),
    }
}

/// Returns `det(e_c, a_1, .., a_{D-1})` for each c, with the tangents `a_k` of a surface in columns 1 to `D - 1`.
/// Column 0 is not read. The vector is normal to the surface. Its length is the measure of the parallelepiped of the
/// tangents.
#[inline]
pub fn area_vector<const D: usize>(tangents: &Tensor<D>) -> Vector<D> {
    let mut area = Vector::zeros();
    match D {
        2 => {
            area[0] = tangents[(1, 1)];
            area[1] = -tangents[(0, 1)];
        }
        3 => {
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                area[k] = tangents[(i, 1)] * tangents[(j, 2)] - tangents[(j, 1)] * tangents[(i, 2)];
            }
        }
        _ => unreachable!("surfaces are of dimension 1 or 2"),
    }
    area
}

/// Returns the symmetric part of a tensor.
#[inline]
pub fn sym<const D: usize>(t: &Tensor<D>) -> Tensor<D> {
    0.5 * (t + t.transpose())
}

/// Returns the moment `Σ x × f` of forces, given `Σ f xᵀ`. Component `k` is that about axis `k`; in 2D only the last
/// one is not zero.
pub fn moment_of<const D: usize>(forces: &Tensor<D>) -> [f64; 3] {
    let entry = |a: usize, b: usize| if a < D && b < D { forces[(a, b)] } else { 0.0 };
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        entry(j, i) - entry(i, j)
    })
}
