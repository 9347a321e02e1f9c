//! The linear complementarity problem, its solution, and the verification of a solution.
use std::fmt;

use crate::dense::OutOfMemory;
use crate::vectorized::vectorized;

/// The problem of finding z, w with w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0.
///
/// ```
/// use signorini_core::lcp::{Lcp, LcpError};
///
/// let lcp = Lcp::new(&[2.0, 1.0, 1.0, 2.0], &[-5.0, -6.0])?;
/// let residuals = lcp.residuals(&[4.0 / 3.0, 7.0 / 3.0], &[0.0, 0.0])?;
/// assert!(residuals.worst() < 1e-15);
/// assert!(Lcp::new(&[1.0, 2.0], &[1.0, 2.0]).is_err());
/// # Ok::<(), LcpError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Lcp<'a> {
    matrix: &'a [f64],
    q: &'a [f64],
}

/// How a solver of the problem ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LcpStatus {
    /// The solver found a complementary solution.
    Solved,
    /// The path ended on a secondary ray; if M is copositive-plus, the problem is infeasible.
    Ray,
    /// The solver stopped without a solution: at the pivot limit, or because rounding made every basis infeasible.
    PivotLimit,
    /// The callback cancelled the solver.
    Interrupted,
}

impl LcpStatus {
    /// The meaning of the status, as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Solved => "A complementary solution was found.",
            Self::Ray => "The path ended on a secondary ray: if M is copositive-plus, the problem is infeasible.",
            Self::PivotLimit => {
                "The solver stopped without a solution, at the pivot limit or where rounding kept every basis infeasible."
            }
            Self::Interrupted => "The callback stopped the solver.",
        }
    }
}

impl fmt::Display for LcpStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence())
    }
}

/// Result of a solver for m pairs; each vector has m entries.
#[derive(Clone, Debug)]
pub struct LcpSolution {
    /// The complementary variables z (m,); NaN unless the problem is solved.
    pub z: Vec<f64>,
    /// The slacks w = Mz + q (m,); NaN unless the problem is solved.
    pub w: Vec<f64>,
    /// For each pair (m,), true if z_i is basic (w_i = 0), false if w_i is basic. All entries are false unless the
    /// problem is solved.
    pub basis: Vec<bool>,
    pub status: LcpStatus,
    /// Number of pivots, including the pivot by which the artificial variable enters.
    pub pivots: usize,
    /// The direction v ≥ 0 (m,) of z on the secondary ray, scaled to max v = 1. It is present only if the status is
    /// `Ray`. [`Lcp::infeasibility`] computes whether v proves that the problem is infeasible.
    pub ray: Option<Vec<f64>>,
}

/// Relative errors of a pair (z, w) as a solution of the problem. Each error is at least zero; it is NaN if an input is
/// NaN.
///
/// With s_i = |q_i| + Σ_j |M_ij z_j| and the work W = Σ_i |z_i| s_i, the reference size of row i is t_i = s_i +
/// √(|M_ii| W). For a semidefinite M the root bounds |(Mz)_i|. Without the root, the errors of a row whose terms are
/// all zero would be relative to rounding. All errors except `negative_z` are independent of the units of the unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Residuals {
    /// Error of z ≥ 0: max_i −z_i / max_j |z_j|.
    pub negative_z: f64,
    /// Error of w ≥ 0: max_i −w_i / t_i, with t_i as in [`Residuals`].
    pub negative_w: f64,
    /// Error of zᵀw = 0: max_i |z_i w_i| / W, with W as in [`Residuals`].
    pub complementarity: f64,
    /// Error of w = Mz + q: max_i |w_i − (Mz)_i − q_i| / t_i, with t_i as in [`Residuals`].
    pub equation: f64,
}

impl Residuals {
    /// The largest of the four relative errors.
    pub fn worst(&self) -> f64 {
        [self.negative_z, self.negative_w, self.complementarity, self.equation].into_iter().fold(0.0, larger)
    }
}

/// How well a vector v proves that the problem is infeasible: no z ≥ 0 has Mz + q ≥ 0 if v ≥ 0, Mᵀv ≤ 0 and qᵀv < 0
/// (Farkas).
#[derive(Clone, Copy, Debug)]
pub struct InfeasibilityProof {
    /// Error of v ≥ 0: max_i −v_i / max_j |v_j|, at least zero.
    pub negative: f64,
    /// Error of Mᵀv ≤ 0: max_j (Mᵀv)_j / Σ_i |M_ij v_i|, at least zero.
    pub transpose: f64,
    /// −qᵀv / Σ_i |q_i v_i|; qᵀv < 0 holds if this number is positive.
    pub decrease: f64,
}

impl InfeasibilityProof {
    /// Whether v ≥ 0, Mᵀv ≤ 0 and qᵀv < 0 hold within the relative tolerance `tolerance`.
    pub fn holds(&self, tolerance: f64) -> bool {
        self.negative <= tolerance && self.transpose <= tolerance && self.decrease > tolerance
    }
}

impl<'a> Lcp<'a> {
    /// Makes the problem from `matrix`, which is M (m, m) in row-major order, and the m entries of `q`.
    ///
    /// Returns an error if `matrix` is not m×m, or if an entry is not finite.
    pub fn new(matrix: &'a [f64], q: &'a [f64]) -> Result<Self, LcpError> {
        let order = q.len();
        if matrix.len() != order * order {
            return Err(LcpError::MatrixLength { found: matrix.len(), order });
        }
        if let Some(at) = first_not_finite(matrix) {
            return Err(LcpError::MatrixEntry { row: at / order, column: at % order, value: matrix[at] });
        }
        if let Some(index) = first_not_finite(q) {
            return Err(LcpError::Entry { name: "q", index, value: q[index] });
        }
        Ok(Self { matrix, q })
    }

    /// As [`Lcp::new`], for a matrix whose entries were found to be finite before.
    pub(super) fn with_matrix_of(matrix: &'a [f64], q: &'a [f64]) -> Result<Self, LcpError> {
        if matrix.len() != q.len() * q.len() {
            return Err(LcpError::MatrixLength { found: matrix.len(), order: q.len() });
        }
        match first_not_finite(q) {
            Some(index) => Err(LcpError::Entry { name: "q", index, value: q[index] }),
            None => Ok(Self { matrix, q }),
        }
    }

    /// The number m of complementary pairs (z_i, w_i).
    pub fn order(&self) -> usize {
        self.q.len()
    }

    /// The matrix M (m, m), row-major.
    pub fn matrix(&self) -> &'a [f64] {
        self.matrix
    }

    /// The vector q (m,).
    pub fn q(&self) -> &'a [f64] {
        self.q
    }

    /// Row i (m,) of M.
    pub fn row(&self, i: usize) -> &'a [f64] {
        &self.matrix[i * self.order()..(i + 1) * self.order()]
    }

    /// Relative errors of the vectors `z` and `w` as a solution, computed from M and q.
    ///
    /// Returns an error if `z` or `w` does not have m entries.
    pub fn residuals(&self, z: &[f64], w: &[f64]) -> Result<Residuals, LcpError> {
        self.check_length("z", z.len())?;
        self.check_length("w", w.len())?;
        let largest = z.iter().map(|x| x.abs()).fold(0.0, larger);
        let slack_and_size = |i: usize| {
            let terms = || self.row(i).iter().zip(z).map(|(a, x)| a * x);
            (self.q[i] + terms().sum::<f64>(), self.q[i].abs() + terms().map(f64::abs).sum::<f64>())
        };
        let rows: Vec<(f64, f64)> = (0..self.order()).map(slack_and_size).collect();
        let work: f64 = rows.iter().zip(z).map(|((_, size), x)| size * x.abs()).sum();
        let mut found = Residuals { negative_z: 0.0, negative_w: 0.0, complementarity: 0.0, equation: 0.0 };
        for (i, (slack, size)) in rows.into_iter().enumerate() {
            let size = size + (self.row(i)[i].abs() * work).sqrt();
            found.negative_z = larger(found.negative_z, relative(-z[i], largest));
            found.negative_w = larger(found.negative_w, relative(-w[i], size));
            found.complementarity = larger(found.complementarity, relative((z[i] * w[i]).abs(), work));
            found.equation = larger(found.equation, relative((w[i] - slack).abs(), size));
        }
        Ok(found)
    }

    /// How well the vector `v` proves that the problem is infeasible, computed from M and q.
    ///
    /// Returns an error if `v` does not have m entries.
    pub fn infeasibility(&self, v: &[f64]) -> Result<InfeasibilityProof, LcpError> {
        self.check_length("v", v.len())?;
        let largest = v.iter().map(|x| x.abs()).fold(0.0, larger);
        let mut product = vec![0.0; v.len()];
        let mut size = vec![0.0; v.len()];
        for (i, x) in v.iter().enumerate() {
            for (j, a) in self.row(i).iter().enumerate() {
                product[j] += a * x;
                size[j] += (a * x).abs();
            }
        }
        let decrease: f64 = self.q.iter().zip(v).map(|(a, x)| -a * x).sum();
        let total: f64 = self.q.iter().zip(v).map(|(a, x)| (a * x).abs()).sum();
        Ok(InfeasibilityProof {
            negative: v.iter().map(|x| relative(-x, largest)).fold(0.0, larger),
            transpose: product.iter().zip(&size).map(|(p, s)| relative(*p, *s)).fold(0.0, larger),
            decrease: relative(decrease, total),
        })
    }

    pub(super) fn check_length(&self, name: &'static str, found: usize) -> Result<(), LcpError> {
        if found == self.order() { Ok(()) } else { Err(LcpError::Length { name, found, order: self.order() }) }
    }
}

/// Index of the first entry that is not finite; `None` if all are finite. Whole chunks are tested first, which is fast.
fn first_not_finite(entries: &[f64]) -> Option<usize> {
    let all_finite = |chunk: &[f64]| {
        vectorized(
            #[inline(always)]
            || chunk.iter().fold(true, |finite, x| finite & x.is_finite()),
        )
    };
    let chunk = entries.chunks(1024).position(|chunk| !all_finite(chunk))?;
    (chunk * 1024..entries.len()).find(|&at| !entries[at].is_finite())
}

/// The larger of two numbers, or NaN if one of them is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// value / scale, with 0/0 = 0.
fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

/// Errors in a linear complementarity problem or in the arguments of its solvers.
#[derive(Clone, Debug, PartialEq)]
pub enum LcpError {
    /// M has `found` entries. q has `order` entries, so M must have order² entries.
    MatrixLength { found: usize, order: usize },
    /// An entry of M is NaN or infinite.
    MatrixEntry { row: usize, column: usize, value: f64 },
    /// An entry of the vector `name` is NaN or infinite.
    Entry { name: &'static str, index: usize, value: f64 },
    /// The vector `name` has `found` entries; M has `order` rows.
    Length { name: &'static str, found: usize, order: usize },
    /// An entry of the covering vector is not positive, or it is not finite.
    Covering { index: usize, value: f64 },
    /// The tableau does not fit into memory.
    OutOfMemory,
}

impl fmt::Display for LcpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MatrixLength { found, order } => {
                write!(f, "M has {found} entries; q has {order}, so M needs {order} x {order}")
            }
            Self::MatrixEntry { row, column, value } => {
                write!(f, "M[{row}, {column}] is {value}; every entry must be finite")
            }
            Self::Entry { name, index, value } => write!(f, "{name}[{index}] is {value}; every entry must be finite"),
            Self::Length { name, found, order } => {
                write!(f, "{name} has {found} entries; M is {order} x {order}, so it needs {order}")
            }
            Self::Covering { index, value } => {
                write!(f, "covering[{index}] is {value}; every entry must be finite and greater than zero")
            }
            Self::OutOfMemory => write!(f, "the tableau of the complementarity problem does not fit into memory"),
        }
    }
}

impl std::error::Error for LcpError {}

impl From<OutOfMemory> for LcpError {
    fn from(_: OutOfMemory) -> Self {
        Self::OutOfMemory
    }
}
