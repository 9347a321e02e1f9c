//! The kinds of element, and the points at which an element of each kind needs its section.

use super::quadrature::{GAUSS_2, GAUSS_3, radon, square};
use std::sync::LazyLock;

/// A kind of plate element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Bathe, Brezzi & Fortin (1989): mixed interpolation, free of locking. Triangles of this kind are mitc7.
    Mitc9,
    /// Hinton & Owen (1977): serendipity functions for w and θ, uniform 2×2 integration. This element locks in thin
    /// plates.
    Q8r,
}

impl Kind {
    /// Points (ξ, η, weight) at which an element needs its section: the integration points of its stiffness, then the
    /// four stress samples with weight 0. In q8r the integration points are also the stress samples. ξ runs fastest.
    pub fn points(self) -> &'static [(f64, f64, f64)] {
        static MITC9: LazyLock<Vec<(f64, f64, f64)>> =
            LazyLock::new(|| square(GAUSS_3).chain(square(GAUSS_2).map(|(xi, eta, _)| (xi, eta, 0.0))).collect());
        static Q8R: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(|| square(GAUSS_2).collect());
        match self {
            Self::Mitc9 => &MITC9,
            Self::Q8r => &Q8R,
        }
    }

    /// [`Kind::points`] of a triangle or of a quadrilateral; their number is the same. A triangle samples stress at
    /// three points of a rule that is exact to the second degree, and at the centroid.
    pub fn points_of(self, triangle: bool) -> &'static [(f64, f64, f64)] {
        const NEAR: f64 = 1.0 / 6.0;
        const FAR: f64 = 2.0 / 3.0;
        const THIRD: f64 = 1.0 / 3.0;
        static MITC7: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(|| {
            let samples = [(NEAR, NEAR), (FAR, NEAR), (NEAR, FAR), (THIRD, THIRD)];
            let rule = radon().map(|(r, s, weight)| (r, s, 0.5 * weight));
            rule.into_iter().chain(samples.map(|(r, s)| (r, s, 0.0))).collect()
        });
        if triangle && self == Self::Mitc9 { &MITC7 } else { self.points() }
    }

    /// Index, in [`Kind::points`], of the first of the four points at which stress is sampled.
    pub fn first_sample(self) -> usize {
        self.points().len() - 4
    }
}
