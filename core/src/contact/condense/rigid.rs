//! Free rigid motions in the LCP: what elimination knows of them only to rounding is imposed.
//!
//! Let N be how the free motions move the points, J the points whose unknown is the gap, O the others. A motion changes
//! every gap and no reaction, so M_JJ N_J = 0 and M_OJ N_J = N_O; and the reactions of the posed state balance the
//! load, N_Jᵀ q_J = work. Left as rounding, these decide at random whether equilibrium exists where it is marginal.

use super::{Condensed, Drive, PosedLcp};
use faer::Mat;
use faer::linalg::solvers::Solve;

/// A posed reaction this small, relative to the load, is zero: the load is balanced without it. So is a gap, relative to
/// the largest move, and a lever, relative to the moves it is made of.
const ROUNDING: f64 = 1e-12;

/// Rounding of a sum of stiffnesses times gaps.
const SUM: f64 = 1e-14;

/// A stiffness of which the projection leaves less than this part was rounding.
const LEFT: f64 = 1e-6;

impl Condensed {
    /// The LCP with the free motions imposed: M_JJ ← QM_JJQ with Q = I − N_J(N_JᵀN_J)⁻¹N_Jᵀ, and M_OJ, q_J moved by the
    /// least that satisfies their equations.
    pub(in crate::contact) fn balanced(&self, mut lcp: PosedLcp, drive: &Drive) -> PosedLcp {
        let free = self.moves.ncols();
        let order = lcp.q.len();
        let inside = lcp.gap_is_z.iter().filter(|&&gap| gap).count();
        let length = drive.displacement.iter().chain(&drive.remaining).fold(0.0, |a: f64, b| a.max(b.abs()));
        lcp.q[inside..].iter_mut().filter(|gap| gap.abs() <= ROUNDING * length).for_each(|gap| *gap = 0.0);
        if free == 0 {
            return lcp;
        }
        let moves = |r: usize, k: usize| self.moves[(lcp.point[r], k)];
        let n = Mat::from_fn(inside, free, moves);
        let gram = n.transpose() * &n;
        let dual = gram.partial_piv_lu().solve(n.transpose()).transpose().to_owned();

        let mut within = Mat::from_fn(inside, inside, |r, c| lcp.matrix[r * order + c]);
        let before: Vec<f64> = (0..inside).map(|r| within[(r, r)].abs()).collect();
        within = &within - &dual * (n.transpose() * &within);
        within = &within - (&within * &n) * dual.transpose();
        // Nothing resists the gap of a point from which little is left: what was there was rounding.
        let loose: Vec<bool> = (0..inside).map(|r| inside == free || within[(r, r)] <= LEFT * before[r]).collect();
        let mut across = Mat::from_fn(order - inside, inside, |r, c| lcp.matrix[(inside + r) * order + c]);
        let outside = Mat::from_fn(order - inside, free, |r, k| moves(inside + r, k));
        across = &across + (&outside - &across * &n) * dual.transpose();
        for r in 0..order - inside {
            for c in 0..inside {
                let size: f64 = (0..free).map(|k| (outside[(r, k)] * dual[(c, k)]).abs()).sum();
                if across[(r, c)].abs() <= ROUNDING * size {
                    across[(r, c)] = 0.0;
                }
            }
        }

        let mut missing = drive.work.clone();
        for (k, missing) in missing.iter_mut().enumerate() {
            *missing -= (0..inside).map(|r| n[(r, k)] * lcp.q[r]).sum::<f64>();
        }
        // S itself keeps its soft modes, and q what goes with them, better than a projection does.
        let imposed = order > inside || self.stiffness.is_none();
        for r in 0..inside {
            if imposed {
                lcp.q[r] += (0..free).map(|k| dual[(r, k)] * missing[k]).sum::<f64>();
            }
            let size: f64 = (0..free).map(|k| dual[(r, k)].abs() * drive.work_size[k]).sum();
            let held: f64 = lcp.matrix[r * order..r * order + inside].iter().map(|m| m.abs() * length).sum();
            if lcp.q[r].abs() <= ROUNDING * size + SUM * held {
                lcp.q[r] = 0.0;
            }
            for c in (0..inside).filter(|_| imposed) {
                let even = 0.5 * (within[(r, c)] + within[(c, r)]);
                lcp.matrix[r * order + c] = if loose[r] || loose[c] { 0.0 } else { even };
            }
            for c in 0..order - inside {
                lcp.matrix[(inside + c) * order + r] = across[(c, r)];
                lcp.matrix[r * order + inside + c] = -across[(c, r)];
            }
        }
        lcp
    }

    /// Displacements of the points without the free motion nearest to them, which no reaction answers.
    pub(super) fn without_rigid_motion(&self, moved: &[f64]) -> Vec<f64> {
        let n = &self.moves;
        if n.ncols() == 0 {
            return moved.to_vec();
        }
        let column = Mat::from_fn(moved.len(), 1, |i, _| moved[i]);
        let motion = (n.transpose() * n).partial_piv_lu().solve(n.transpose() * &column);
        let rest = column - n * motion;
        (0..moved.len()).map(|i| rest[(i, 0)]).collect()
    }
}
