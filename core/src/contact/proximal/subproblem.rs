//! The complementarity problem of one proximal step.

use crate::cholesky::FactorError;
use crate::contact::condense::PosedLcp;
use crate::contact::kkt::{Regularized, Residual, Saddle, TOGETHER};
use crate::contact::solution::{ContactSolution, Outcome, Progress};
use crate::dense::{OutOfMemory, zeros};
use rayon::prelude::*;

/// What one-sided points do to each other where the two-sided ones hold: the proximal step's M.
pub(super) struct Subproblem {
    held: Saddle,
    /// Its q is that of the last step.
    lcp: PosedLcp,
}

impl Subproblem {
    /// `None` if what is two-sided contradicts itself beyond the arithmetic.
    fn of(regularized: &Regularized) -> Result<Option<Self>, OutOfMemory> {
        let problem = regularized.problem;
        let two_sided = &problem.constraints.two_sided;
        let Some(held) = Saddle::of(regularized, two_sided)? else { return Ok(None) };
        let points: Vec<usize> = (0..two_sided.len()).filter(|&i| !two_sided[i]).collect();
        let (rows, plate) = (&problem.constraints.rows, &problem.plate);
        // The matrix is symmetric, so that what a push does everywhere is a row.
        let mut matrix = zeros(points.len() * points.len())?;
        matrix.par_chunks_mut((TOGETHER * points.len()).max(1)).enumerate().for_each(|(block, lines)| {
            let pushes: [Vec<f64>; TOGETHER] = std::array::from_fn(|k| {
                let mut push = vec![0.0; plate.dof_count()];
                if let Some(&point) = points.get(block * TOGETHER + k) {
                    rows.scatter(plate, point, 1.0, &mut push);
                }
                push
            });
            let motions = held.motions(problem, &pushes);
            for (k, line) in lines.chunks_mut(points.len()).enumerate() {
                for (value, &other) in line.iter_mut().zip(&points) {
                    *value = rows.dot(plate, other, &motions[k]);
                }
                let at = block * TOGETHER + k;
                line[at] += regularized.compliance[points[at]];
            }
        });
        let gap_is_z = vec![false; points.len()];
        Ok(Some(Self { held, lcp: PosedLcp { matrix, q: Vec::new(), point: points, gap_is_z } }))
    }

    /// The contact set of one proximal step; M is made when it is first asked for.
    pub(super) fn contact_set(
        made: &mut Option<Self>,
        regularized: &Regularized,
        step: &Residual,
        near: &mut ContactSolution,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Result<Vec<bool>, Outcome>, FactorError> {
        let problem = regularized.problem;
        let mut closed = problem.constraints.two_sided.clone();
        if closed.iter().all(|&both| both) {
            return Ok(Ok(closed));
        }
        if made.is_none() {
            *made = Self::of(regularized)?;
        }
        let Some(Self { held, lcp }) = made else {
            return Ok(Err(Outcome::Unsolved));
        };
        let (points, matrix) = (&lcp.point, &lcp.matrix);
        let (nodal, _) = held.response(problem, &step.imbalance, &step.remaining);
        let gap = |(row, &point): (usize, &usize)| {
            let acting = matrix[row * points.len()..].iter().zip(points.iter());
            let pushed_by: f64 = acting.map(|(m, &other)| m * near.reaction[other]).sum();
            step.remaining[point] - problem.constraints.rows.dot(&problem.plate, point, &nodal) - pushed_by
        };
        lcp.q = points.iter().enumerate().map(gap).collect();
        let basis: Vec<bool> = lcp.point.iter().map(|&point| near.closed[point]).collect();
        Ok(problem.solve_lcp(lcp, Some(&basis), &mut near.pivots, watch)?.map(|basis| {
            lcp.point.iter().zip(&basis).for_each(|(&point, &basic)| closed[point] = basic);
            closed
        }))
    }
}
