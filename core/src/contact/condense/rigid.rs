//! Free rigid motions in the LCP: what elimination knows of them only to rounding is imposed.
//!
//! Let N be how the free motions move the points, J the points whose unknown is the gap, O the others. A motion changes
//! every gap and no reaction, so M_JJ N_J = 0 and M_OJ N_J = N_O; and the reactions of the posed state balance the
//! load, N_Jᵀ q_J = work. Left as rounding, these decide at random whether equilibrium exists where it is marginal.

use super::condensed::{Condensed, InterfaceResidual, PosedLcp, Work};
use crate::contact::tolerances;
use crate::dense::{self, OutOfMemory};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatRef};

/// The free motions in an LCP, as far as they do not depend on the load.
pub(crate) struct FreeMotions {
    /// N_J, and N_J(N_JᵀN_J)⁻¹.
    moves: Mat<f64>,
    dual: Mat<f64>,
    /// Σ_c |M_rc| over J, before the motions are imposed.
    held: Vec<f64>,
    /// S itself keeps its soft modes, and q what goes with them, better than a projection does.
    projected: bool,
}

impl Condensed {
    /// Imposes the free motions on M, which no load has a part in: M_JJ ← QM_JJQ with Q = I − N_J(N_JᵀN_J)⁻¹N_Jᵀ, and M_OJ
    /// moved by the least that satisfies its equation.
    pub(crate) fn impose_motions(&self, lcp: &mut PosedLcp) -> Result<FreeMotions, OutOfMemory> {
        let free = self.moves.ncols();
        let order = lcp.q.len();
        let inside = lcp.gap_is_z.iter().filter(|&&gap| gap).count();
        let moves = |r: usize, k: usize| self.moves[(lcp.point[r], k)];
        let n = Mat::from_fn(inside, free, moves);
        let sum = |r: usize| lcp.matrix[r * order..r * order + inside].iter().map(|m| m.abs()).sum();
        let held = (0..inside).map(sum).collect();
        let projected = order > inside || self.stiffness.is_none();
        if free == 0 {
            return Ok(FreeMotions { dual: n.clone(), moves: n, held, projected });
        }
        let gram = n.transpose() * &n;
        let dual = gram.partial_piv_lu().solve(n.transpose()).transpose().to_owned();
        if !projected {
            return Ok(FreeMotions { moves: n, dual, held, projected });
        }

        let mut within = dense::matrix(inside, inside, |r, c| lcp.matrix[r * order + c])?;
        let before: Vec<f64> = (0..inside).map(|r| within[(r, r)].abs()).collect();
        let across = n.transpose() * &within;
        subtract_product(&mut within, &dual, across.as_ref());
        let along = &within * &n;
        subtract_product(&mut within, &along, dual.transpose());
        // Nothing resists the gap of a point from which little is left: what was there was rounding.
        let loose: Vec<bool> = (0..inside)
            .map(|r| inside == free || within[(r, r)] <= tolerances::interface::PROJECTED * before[r])
            .collect();
        let mut across = dense::matrix(order - inside, inside, |r, c| lcp.matrix[(inside + r) * order + c])?;
        let outside = Mat::from_fn(order - inside, free, |r, k| moves(inside + r, k));
        let missed = &across * &n - &outside;
        subtract_product(&mut across, &missed, dual.transpose());
        for r in 0..order - inside {
            for c in 0..inside {
                let size: f64 = (0..free).map(|k| (outside[(r, k)] * dual[(c, k)]).abs()).sum();
                if across[(r, c)].abs() <= tolerances::interface::POSED * size {
                    across[(r, c)] = 0.0;
                }
            }
        }
        for r in 0..inside {
            for c in 0..inside {
                let even = 0.5 * (within[(r, c)] + within[(c, r)]);
                lcp.matrix[r * order + c] = if loose[r] || loose[c] { 0.0 } else { even };
            }
            for c in 0..order - inside {
                lcp.matrix[(inside + c) * order + r] = across[(c, r)];
                lcp.matrix[r * order + inside + c] = -across[(c, r)];
            }
        }
        Ok(FreeMotions { moves: n, dual, held, projected })
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

impl FreeMotions {
    /// Imposes on q that the reactions of the posed state balance the load; what is rounding of either becomes zero.
    pub(crate) fn balance(&self, q: &mut [f64], interface: &InterfaceResidual, work: &Work) {
        let (inside, free) = (self.moves.nrows(), self.moves.ncols());
        let length = interface.displacement.iter().chain(&interface.remaining).fold(0.0, |a: f64, b| a.max(b.abs()));
        q[inside..]
            .iter_mut()
            .filter(|gap| gap.abs() <= tolerances::interface::POSED * length)
            .for_each(|gap| *gap = 0.0);
        if free == 0 {
            return;
        }
        let done = |k: usize| (0..inside).map(|r| self.moves[(r, k)] * q[r]).sum::<f64>();
        let missing: Vec<f64> = (0..free).map(|k| work.sum[k] - done(k)).collect();
        for r in 0..inside {
            if self.projected {
                q[r] += (0..free).map(|k| self.dual[(r, k)] * missing[k]).sum::<f64>();
            }
            let size: f64 = (0..free).map(|k| self.dual[(r, k)].abs() * work.size[k]).sum();
            if q[r].abs()
                <= tolerances::interface::POSED * size + tolerances::interface::POSED_SUM * self.held[r] * length
            {
                q[r] = 0.0;
            }
        }
    }
}

/// from ← from − left · right, where right has few rows.
fn subtract_product(from: &mut Mat<f64>, left: &Mat<f64>, right: MatRef<'_, f64>) {
    let parallelism = dense::parallelism(from.nrows());
    matmul(from.as_mut(), Accum::Add, left, right, -1.0, parallelism);
}
