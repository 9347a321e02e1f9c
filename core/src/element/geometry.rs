//! The map from the reference square, or the reference triangle, to an element of eight nodes.

use super::number::Number;
use super::quadrature::{GAUSS_3, radon, square};
use super::shape::{Shape, serendipity, triangular};
use std::ops::Mul;
use std::sync::LazyLock;

/// Coordinates of an element's eight nodes relative to its first node. T is f64 for one element, or a SIMD register
/// with one lane for each of several elements.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<T = f64> {
    pub at: [[T; 2]; 8],
    /// Whether the element is a triangle, stored with its third corner repeated (`mitc7`).
    pub triangle: bool,
}

/// Derivatives of the map (ξ, η) → (x, y) at one reference point.
pub struct Jacobian<T = f64> {
    pub shape: Shape<8>,
    /// ∂(x, y)/∂(ξ, η): row 0 has the derivatives with respect to ξ, row 1 with respect to η.
    pub tangent: [[T; 2]; 2],
    /// ∂(ξ, η)/∂(x, y), with ∂f/∂x_a = Σ_b inverse[a][b] ∂f/∂ξ_b for any function f.
    pub inverse: [[T; 2]; 2],
    pub determinant: T,
}

impl Geometry {
    /// Largest |x| or |y| of an element's nodes relative to its first node.
    pub fn size(&self) -> f64 {
        self.at.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    /// Whether the Jacobian determinant is ≤ 0 at one of the 3×3 Gauss points of a quadrilateral, or of the seven
    /// integration points of a triangle.
    pub fn is_inverted(&self) -> bool {
        static SQUARE: LazyLock<Vec<Shape<8>>> =
            LazyLock::new(|| square(GAUSS_3).map(|(xi, eta, _)| serendipity(xi, eta)).collect());
        static TRIANGLE: LazyLock<Vec<Shape<8>>> = LazyLock::new(|| radon().map(|(r, s, _)| triangular(r, s)).to_vec());
        let shapes = if self.triangle { &TRIANGLE } else { &SQUARE };
        !shapes.iter().all(|shape| self.jacobian_of(*shape).determinant > 0.0)
    }
}

impl<T: Number> Geometry<T> {
    pub fn jacobian(&self, xi: f64, eta: f64) -> Jacobian<T> {
        self.jacobian_of(if self.triangle { triangular(xi, eta) } else { serendipity(xi, eta) })
    }

    /// The Jacobian at the reference point at which `shape` has been evaluated.
    #[inline(always)]
    pub fn jacobian_of(&self, shape: Shape<8>) -> Jacobian<T> {
        let mut t = [[self.at[0][0].like(0.0); 2]; 2];
        for i in 0..8 {
            for a in 0..2 {
                for b in 0..2 {
                    t[a][b] += self.at[i][b] * shape.gradient[i][a];
                }
            }
        }
        let determinant = t[0][0] * t[1][1] - t[0][1] * t[1][0];
        let inverse =
            [[t[1][1] / determinant, -t[0][1] / determinant], [-t[1][0] / determinant, t[0][0] / determinant]];
        Jacobian { shape, tangent: t, inverse, determinant }
    }
}

impl<T: Number> Jacobian<T> {
    #[inline(always)]
    pub fn physical<U: Copy>(&self, gradient: [U; 2]) -> [T; 2]
    where
        T: Mul<U, Output = T>,
    {
        let inv = &self.inverse;
        [inv[0][0] * gradient[0] + inv[0][1] * gradient[1], inv[1][0] * gradient[0] + inv[1][1] * gradient[1]]
    }
}
