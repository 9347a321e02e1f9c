//! Iterative refinement of a solution on its contact state, with residuals in double-double.
//!
//! Corrections are applied as long as each reduces the residual to a quarter (Wilkinson 1963). If the regularization
//! makes this too slow, corrections become directions of generalized conjugate residuals (Eisenstat, Elman & Schultz
//! 1983; refinement by a Krylov method as in Carson & Higham 2017).

use super::kkt::{Correction, Kkt};
use super::problem::ContactProblem;
use super::residual::{Residual, Sizes, rounding};
use super::scale::{dot, norm};
use super::solution::ContactSolution;
use super::tolerances;
use crate::cholesky::FactorError;

/// Largest number of corrections of one solution.
const CORRECTIONS: usize = 80;
/// Number of most recent directions whose joint reduction of the residual decides whether refinement continues.
const LAST: usize = 10;

/// A direction of generalized conjugate residuals, and the change of the scaled residual along it. The changes of all
/// directions are orthonormal.
struct Taken {
    direction: Correction,
    change: Vec<f64>,
}

/// The correction that removes a residual. If the solver separates rigid motions, these are added first, and the rest
/// is solved for the residual that remains. `None` if the contact state leaves a rigid motion free.
pub(super) fn correction(
    problem: &ContactProblem,
    load: &[f64],
    kkt: &mut dyn Kkt,
    residual: &Residual,
    solution: &ContactSolution,
) -> Result<Option<Correction>, FactorError> {
    let Some(mut rigid) = kkt.rigid(residual) else { return kkt.solve(residual) };
    let mut coarse_load = solution.clone();
    coarse_load.follow(problem, &rigid, 1.0);
    let Some(rest) = kkt.solve(&Residual::of(problem, load, &coarse_load))? else { return Ok(None) };
    rigid.nodal = rest.nodal;
    rigid.reaction.iter_mut().zip(&rest.reaction).for_each(|(total, increment)| *total += increment);
    Ok(Some(rigid))
}

/// Refines a solution on its contact state and returns the last residual. `None` if the contact state leaves a rigid
/// motion free and the plate is not in equilibrium. Forces far below `least` count as rounding.
pub(super) fn refine(
    problem: &ContactProblem,
    load: &[f64],
    least: f64,
    kkt: &mut dyn Kkt,
    mut residual: Residual,
    solution: &mut ContactSolution,
) -> Result<Option<Residual>, FactorError> {
    let mut sizes = None;
    let mut lengths = Vec::new();
    let mut taken: Vec<Taken> = Vec::new();
    let mut own_rounding = None;
    for _ in 0..CORRECTIONS {
        let Some(mut direction) = correction(problem, load, kkt, &residual, solution)? else {
            // Although a rigid motion is free, the plate may be in equilibrium, for example without load.
            let sizes = Sizes::of(problem, load, solution, least);
            let scaled = residual.scaled(problem, &sizes, &solution.piece);
            return Ok(is_within(&scaled, tolerances::newton::SETTLED).then_some(residual));
        };
        let mut trial = solution.clone();
        trial.follow(problem, &direction, 1.0);
        let next = Residual::of(problem, load, &trial);
        // Reference sizes are taken after the first correction, since all displacements may be zero before it.
        let sizes = sizes.get_or_insert_with(|| Sizes::of(problem, load, &trial, least));
        let now = residual.scaled(problem, sizes, &solution.piece);
        let after = next.scaled(problem, sizes, &solution.piece);
        let (before, length) = (norm(&now), norm(&after));
        if lengths.is_empty() {
            lengths.push(before);
        }
        if taken.is_empty() && length <= tolerances::PROGRESS * before {
            (*solution, residual) = (trial, next);
            lengths.push(length);
            if is_within(&after, tolerances::RESIDUAL) && kkt.is_settled(&residual, sizes.force) {
                break;
            }
            continue;
        }
        let own = *own_rounding.get_or_insert_with(|| rounding(problem, &trial) / sizes.force);
        if is_within(&now, own.max(tolerances::RESIDUAL)) {
            if length < before {
                (*solution, residual) = (trial, next);
            }
            break;
        }
        let mut change: Vec<f64> = now.iter().zip(&after).map(|(before, after)| before - after).collect();
        // Orthogonalizes twice, because for nearly parallel vectors the result of the first pass is rounding.
        for earlier in taken.iter().chain(&taken) {
            let part = dot(&change, &earlier.change);
            subtract(&mut change, part, &earlier.change);
            direction.subtract(part, &earlier.direction);
        }
        let size = norm(&change);
        if !(size > 0.0 && size.is_finite()) {
            break;
        }
        change.iter_mut().for_each(|value| *value /= size);
        direction.divide(size);
        let mut trial = solution.clone();
        trial.follow(problem, &direction, dot(&now, &change));
        let next = Residual::of(problem, load, &trial);
        let after = next.scaled(problem, sizes, &solution.piece);
        let length = norm(&after);
        if length.is_nan() || length >= before {
            if taken.is_empty() {
                break;
            }
            // The directions have lost their orthogonality; refinement starts again without them.
            taken.clear();
            continue;
        }
        (*solution, residual) = (trial, next);
        taken.push(Taken { direction, change });
        lengths.push(length);
        let slow = lengths.len() > LAST && length > tolerances::SLOW * lengths[lengths.len() - 1 - LAST];
        if slow || is_within(&after, tolerances::RESIDUAL) {
            break;
        }
    }
    Ok(Some(residual))
}

impl ContactSolution {
    /// Adds `length` times a correction to the solution.
    pub(super) fn follow(&mut self, problem: &ContactProblem, direction: &Correction, length: f64) {
        if !direction.rigid.is_empty() {
            let rigid: Vec<[f64; 3]> = direction.rigid.iter().map(|motion| motion.map(|part| length * part)).collect();
            self.displacement.add_rigid(&problem.plate, problem.scale.centre, &rigid);
        }
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.displacement.add(dof, length * value);
        }
        self.displacement.follow(problem.plate.bodies());
        for (total, increment) in self.reaction.iter_mut().zip(&direction.reaction) {
            *total += length * increment;
        }
        self.corrections += 1;
    }
}

impl Correction {
    fn subtract(&mut self, part: f64, other: &Self) {
        subtract(self.rigid.as_flattened_mut(), part, other.rigid.as_flattened());
        subtract(&mut self.nodal, part, &other.nodal);
        subtract(&mut self.reaction, part, &other.reaction);
    }

    fn divide(&mut self, by: f64) {
        let all = self.rigid.as_flattened_mut().iter_mut().chain(&mut self.nodal).chain(&mut self.reaction);
        all.for_each(|value| *value /= by);
    }
}

fn subtract(from: &mut [f64], part: f64, other: &[f64]) {
    from.iter_mut().zip(other).for_each(|(value, other)| *value -= part * other);
}

fn is_within(scaled: &[f64], tolerance: f64) -> bool {
    scaled.iter().all(|value| value.abs() <= tolerance)
}
