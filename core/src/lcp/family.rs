//! Many linear complementarity problems with the same M. Everything that does not depend on q is computed once.
use std::borrow::Cow;

use super::lemke::{End, default_max_pivots, follow_path};
use super::pivoting::Basis;
use super::problem::{Lcp, LcpError, LcpStatus};
use super::scaling::{CoveredLcp, Scaling};
use super::tolerances;

/// Problems w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0 with the same M and different q. M is transformed to a given
/// complementary basis, at which the path of every problem starts.
///
/// # Example
/// ```
/// use signorini_core::lcp::{Lcp, LcpError, LcpFamily, LcpStatus};
///
/// let (matrix, q) = ([2.0, 1.0, 1.0, 2.0], [-5.0, -6.0]);
/// let family = LcpFamily::new(&Lcp::new(&matrix, &q)?, &[true, true])?;
/// let family = family.expect("this basis is regular");
/// let found = family.solve(&[-5.0, 1.0])?;
/// assert_eq!((found.status, found.basis, found.pivots), (LcpStatus::Solved, vec![true, false], 2));
/// # Ok::<(), LcpError>(())
/// ```
pub struct LcpFamily {
    scaling: Scaling,
    /// The scaled problem at the slack basis. Its q is not used.
    scaled: CoveredLcp<'static>,
    origin: Vec<bool>,
    basis: Basis,
    /// Principal pivotal transform of the scaled M at the basis `origin`, row-major.
    pivoted: Vec<f64>,
}

/// Result of [`LcpFamily::solve`]: the complementary basis at which the path of one problem ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LcpBasis {
    pub status: LcpStatus,
    /// For each pair (m,), true if z_i is basic, so that w_i = 0. All entries are false unless the problem is solved.
    pub basis: Vec<bool>,
    pub pivots: usize,
}

impl LcpFamily {
    /// Makes the family of problems with the matrix of `lcp`, whose q determines only the scaling. `basis` (m,) is true
    /// where z_i is basic. Returns `None` if this basis is singular.
    ///
    /// Returns an error if `basis` does not have m entries, or if the transformed M does not fit into memory.
    pub fn new(lcp: &Lcp, basis: &[bool]) -> Result<Option<Self>, LcpError> {
        lcp.check_length("basis", basis.len())?;
        let scaling = Scaling::of(lcp);
        let scaled = scaling.scale(lcp, None).into_owned()?;
        let (Some(factored), Some(pivoted)) = (Basis::of(&scaled, basis)?, scaled.pivoted(basis)?) else {
            return Ok(None);
        };
        Ok(Some(Self {
            scaling,
            scaled,
            origin: basis.to_vec(),
            basis: factored,
            pivoted: pivoted.matrix.into_owned(),
        }))
    }

    /// Follows Lemke's path for the problem with the given q, from the basis of the family.
    ///
    /// The result has the basis of the last tableau. The basic solution of this basis is not recomputed, so the caller
    /// must verify it. If the path ends neither at a solution nor on a ray that proves infeasibility, the status is
    /// [`LcpStatus::PivotLimit`].
    ///
    /// Returns an error if `q` does not have m entries, an entry is not finite, or the tableau does not fit into
    /// memory.
    pub fn solve(&self, q: &[f64]) -> Result<LcpBasis, LcpError> {
        let lcp = Lcp::with_matrix_of(&self.scaled.matrix, q)?;
        let order = q.len();
        let ended = |status, basis, pivots| Ok(LcpBasis { status, basis, pivots });
        let stopped = |pivots| ended(LcpStatus::PivotLimit, vec![false; order], pivots);
        let problem = CoveredLcp {
            matrix: Cow::Borrowed(&self.scaled.matrix),
            units: Cow::Borrowed(&self.scaled.units),
            q: self.scaling.scale_q(q),
            covering: Vec::new(),
        };
        let Some(at_origin) = self.basis.values(&problem)? else { return stopped(0) };
        if at_origin.feasible {
            return ended(LcpStatus::Solved, self.origin.clone(), 0);
        }
        let values =
            at_origin.z.iter().zip(&at_origin.w).zip(&self.origin).map(|((z, w), &basic)| if basic { *z } else { *w });
        let ones = vec![1.0; order];
        let pivoted = CoveredLcp {
            matrix: Cow::Borrowed(&self.pivoted),
            units: Cow::Borrowed(&ones),
            q: values.collect(),
            covering: ones.clone(),
        };
        let path = follow_path(&pivoted, default_max_pivots(order), &mut |_, _| true)?;
        match path.end {
            End::Complementary(exchanged) => {
                let basis = self.origin.iter().zip(&exchanged).map(|(a, b)| a != b).collect();
                ended(LcpStatus::Solved, basis, path.pivots)
            }
            End::Ray(direction) => {
                let ray = self.scaling.unscaled_ray(&self.origin, &direction);
                match lcp.infeasibility(&ray)?.holds(tolerances::PROOF) {
                    true => ended(LcpStatus::Ray, vec![false; order], path.pivots),
                    false => stopped(path.pivots),
                }
            }
            End::Stopped | End::Interrupted => stopped(path.pivots),
        }
    }
}
