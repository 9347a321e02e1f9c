//! Solver of a fixed contact state on a factor with a spring at each point; the spring's compliance includes the
//! augmentation compliance σ. The penalised method eliminates the forces of the points; the saddle-point method has
//! these forces as unknowns. The method of multipliers removes the effect of σ on rigid points (Rockafellar 1976).

use super::batched_factor::alone;
use super::coarse::CoarseSolver;
use super::factored::Factored;
use super::gradients::{Equations, direction};
use super::solver::{Correction, Kkt};
use crate::cholesky::FactorError;
use crate::contact::residual::Residual;
use crate::contact::tolerances;

impl Kkt for Factored<'_> {
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError> {
        self.pieces = pieces.to_vec();
        let points = &self.problem.points;
        let softened = |i: usize| {
            let piece = points.piece(i, pieces[i]);
            piece.holds().then(|| piece.compliance() + self.series[i])
        };
        self.coarse = CoarseSolver::by(self.problem, (0..pieces.len()).map(softened).collect());
        Ok(true)
    }

    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError> {
        let points = &self.problem.points;
        let pieces = std::mem::take(&mut self.pieces);
        let slopes: Vec<f64> = (0..pieces.len()).map(|i| self.slope(i, pieces[i])).collect();
        let mut imbalance = right.imbalance.clone();
        for (i, slope) in slopes.iter().enumerate().filter(|(_, slope)| **slope > 0.0) {
            points.scatter(i, slope * right.violation[i], &mut imbalance);
        }
        self.problem.release_held(&mut imbalance);
        let enough = tolerances::newton::TIGHT * self.problem.scale.length(&imbalance);
        let equations = Equations { pieces: &pieces, imbalance: &imbalance, enough, deflates: false };
        let direction = alone(direction(self, &equations))?;
        self.pieces = pieces;
        if direction.is_free {
            return Ok(None);
        }
        let moved = points.change(&direction.nodal);
        let push = |i: usize| if slopes[i] > 0.0 { slopes[i] * (moved[i] - right.violation[i]) } else { 0.0 };
        let reaction = (0..slopes.len()).map(push).collect();
        Ok(Some(Correction::of(direction.nodal, reaction)))
    }

    fn rigid(&self, right: &Residual) -> Option<Correction> {
        self.coarse.as_ref().map(|coarse| coarse.response(right))
    }

    fn is_settled(&self, right: &Residual, force: f64) -> bool {
        // Only points with an augmentation compliance σ > 0 are tested. At other points the factor has the exact
        // stiffness, and a correction leaves no violation of the law.
        let softened = (0..self.pieces.len()).filter(|&i| self.series[i] > 0.0);
        let mut pushes = softened.map(|i| self.slope(i, self.pieces[i]) * right.violation[i].abs());
        pushes.all(|push| push <= tolerances::newton::SETTLED * force)
    }
}
