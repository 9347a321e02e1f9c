//! The Newton iteration from rest, or from the solution of another load.

use super::exact_sets::exact_sets;
use super::iterate::NewtonIterate;
use crate::cholesky::FactorError;
use crate::contact::backend::Augmentation;
use crate::contact::error::SolveError;
use crate::contact::kkt::{BEFORE_A_FACTOR, CoarseLoad, Direction, Equations, Factored, SharedFactor, direction};
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{Residual, force_of_settlements, largest_force};
use crate::contact::solution::{ContactSolution, Progress, differing};
use crate::contact::system::System;
use crate::contact::tolerances::newton as tolerances;
use std::sync::Arc;

/// Largest number of Newton steps. The largest number that one of 150,000 random plates needed is 732.
const NEWTON: usize = 2000;
/// After this number of successive steps with a changing contact state, directions are computed more accurately.
const UNSETTLED: usize = 8;
/// Number of successive steps with little reduction of the residual after which the iteration ends: the residual is
/// then rounding.
const STALLS: usize = 3;
/// Number of steps on an unchanged contact state, without a new minimum of the residual, after which the iteration
/// ends.
const LASTING: usize = 12;

/// A load to be solved by the Newton method, with the start of the iteration and the first factor.
pub(super) struct Start<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) augmentation: &'a Augmentation,
    pub(super) load: Load<'a>,
    /// The solution of another load, at which the iteration starts; `None` for a start at rest.
    pub(super) solution: Option<&'a ContactSolution>,
    /// The first factor, if several loads share it. For such loads no exact solution on a contact state is computed.
    pub(super) shared: Option<SharedFactor>,
}

/// The factor that is stored with the solution of another load, if it belongs to this problem.
pub(super) fn system_of<'a>(problem: &ContactProblem, solution: &'a ContactSolution) -> Option<&'a Arc<System>> {
    solution.system.as_ref().filter(|system| Arc::ptr_eq(&system.pattern, &problem.pattern))
}

/// Count of Newton steps without progress of the residual, kept at the largest penalty.
struct Stagnation {
    /// Number of successive steps with little reduction of the residual.
    stalled: usize,
    /// Number of steps on an unchanged contact state since the last minimum of the residual.
    lasting: usize,
    before: f64,
    lowest: f64,
}

impl Stagnation {
    const NONE: Self = Self { stalled: 0, lasting: 0, before: f64::INFINITY, lowest: f64::INFINITY };

    /// Forgets earlier residuals, since the equations have changed.
    fn restart(&mut self) {
        *self = Self { stalled: self.stalled, ..Self::NONE };
    }
}

/// Solves one load. The second value is true if the iteration ended because the residual stopped falling: an exact
/// solution on the contact state may then be better.
pub(super) async fn newton(
    start: Start<'_>,
    watch: &mut (impl FnMut(Progress) -> bool + ?Sized),
) -> Result<(ContactSolution, bool), SolveError> {
    let Start { problem, load, .. } = start;
    let (started, seeks_exact) = (start.solution.is_some(), start.shared.is_none());
    let mut iterate = first_iterate(start)?;
    // From rest, every point is on the steepest piece of its law in the first step, as in the first factor.
    let mut pieces = if started { iterate.pieces() } else { problem.steepest_pieces() };
    let least = if load.nodal.iter().all(|&f| f == 0.0) { least_force(&iterate, load.held_value) } else { 0.0 };
    let reference = |iterate: &NewtonIterate| largest_force(problem, load.nodal, &[]).max(iterate.largest_force());
    let mut last = pieces.clone();
    // The last contact state for which an exact solution was computed.
    let mut sought = Vec::new();
    let (mut since_settled, mut restarted, mut stagnation) = (0, false, Stagnation::NONE);
    for step in 1..=NEWTON {
        let same = step > 1 && pieces == last;
        let lost = since_settled == UNSETTLED || stagnation.stalled == STALLS;
        if lost && iterate.kkt.limit == tolerances::STIFFEST && started && !restarted {
            // The start was too far from the solution: restart once with the first penalty, from zero multipliers.
            (stagnation.stalled, restarted) = (0, true);
            iterate.multiplier.fill(0.0);
            iterate.set_penalty(iterate.kkt.augmentation.first_penalty);
            pieces = iterate.pieces();
        }
        let mut negligible = iterate.rounding();
        if step > 1 && iterate.coarse_correction() {
            pieces = iterate.pieces();
            // On soft supports a residual below the value at convergence is rounding: a step for it would only move the
            // plate as a rigid body.
            negligible = negligible.max(tolerances::SETTLED * reference(&iterate));
        }
        let tolerance = match (same, since_settled < UNSETTLED) {
            (true, _) => tolerances::TIGHT,
            (false, true) => tolerances::LOOSE,
            (false, false) => tolerances::FIRM,
        };
        let direction = if iterate.residual.worst > negligible || iterate.residual.worst.is_nan() {
            let rounding = iterate.rounding();
            let NewtonIterate { kkt, residual, .. } = &mut iterate;
            let imbalance = &residual.imbalance;
            let enough = f64::max(tolerance * problem.scale.length(imbalance), rounding);
            let deflates = step <= UNSETTLED;
            direction(kkt, &Equations { pieces: &pieces, imbalance, enough, deflates }).await?
        } else {
            Direction::zeros(load.nodal.len())
        };

        iterate.advance(&direction, &pieces);
        last = std::mem::replace(&mut pieces, iterate.pieces());
        let unchanged = pieces == last;
        let force = reference(&iterate).max(least);
        let nearly = tolerances::NEARLY * tolerances::SETTLED * force;
        let settling = unchanged || iterate.residual.worst <= nearly;
        since_settled = if settling { 0 } else { since_settled + 1 };
        let is_stiffest = iterate.kkt.limit == tolerances::STIFFEST;
        if settling {
            iterate.balance();
            iterate.rounding = None;
            if !is_stiffest {
                iterate.set_penalty(iterate.kkt.augmentation.next_penalty(iterate.kkt.limit));
                stagnation.restart();
            } else if iterate.residual.worst <= tolerances::BALANCED * force {
                // Multipliers are updated only if the nodal forces are nearly in equilibrium.
                iterate.renew_multipliers();
            }
            pieces = iterate.pieces();
        }
        let worst = iterate.residual.worst;
        if !worst.is_finite() {
            return Err(SolveError::Unsolved);
        }
        // Without forces the relative residual is zero.
        let residual = if worst == 0.0 { 0.0 } else { worst / force };
        if !watch(Progress { step, changing: differing(&pieces, &last).len(), residual }) {
            return Err(SolveError::Cancelled);
        }
        if !settling || !is_stiffest {
            continue;
        }

        if worst <= tolerances::SETTLED * force || worst <= iterate.rounding() {
            return Ok((iterate.ended().require_finite()?, false));
        }
        // Points without force and gap may change their piece of the law for ever. So the iteration ends when the
        // residual stops falling.
        let Stagnation { stalled, lasting, before, lowest } = &mut stagnation;
        let is_slow = worst > tolerances::SLOW * *before;
        *stalled = if (unchanged || worst <= nearly) && is_slow { *stalled + 1 } else { 0 };
        if *stalled == STALLS || *lasting == LASTING {
            if worst <= tolerances::STALLED * force {
                return Ok((iterate.ended().require_finite()?, true));
            }
            if !started || restarted || *lasting == LASTING {
                return Err(SolveError::Unsolved);
            }
        }
        *before = worst;
        *lasting = if worst <= tolerances::SLOW * *lowest { 0 } else { *lasting + usize::from(unchanged) };
        *lowest = f64::min(*lowest, worst);

        if seeks_exact && unchanged && iterate.kkt.is_augmented() && sought != last {
            sought.clone_from(&last);
            let found = iterate.on_pieces(last.clone());
            if let Some(exact) = exact_sets(problem, &mut iterate.kkt, &load, &found, &mut |step| watch(step))? {
                iterate.continue_from(exact);
                pieces = iterate.pieces();
                last.clone_from(&pieces);
                stagnation.restart();
            }
        }
    }
    Err(SolveError::Unsolved)
}

/// The first iterate: the plate at rest with the first penalty, or the solution of another load with the largest
/// penalty.
fn first_iterate(start: Start<'_>) -> Result<NewtonIterate<'_>, FactorError> {
    let Start { problem, augmentation, load, solution: start, shared } = start;
    let shares = shared.is_some();
    let limit = if start.is_some() { tolerances::STIFFEST } else { augmentation.first_penalty };
    let given = start.and_then(|start| system_of(problem, start));
    let mut kkt = Factored::new(problem, augmentation, given, limit, shared);
    let mut solution = problem.at_rest(load.held_value);
    let mut multiplier = vec![0.0; problem.points.len()];
    let mut spent = 0;
    if let Some(start) = start {
        solution.displacement.clone_from(&start.displacement);
        multiplier.copy_from_slice(&start.reaction);
        spent = start.spent;
        // K is factored with the springs of the contact state of `start`, unless the given factor already has these
        // springs.
        if !shares && spent >= BEFORE_A_FACTOR && !kkt.differing(&start.piece).is_empty() {
            kkt.refactor(&start.piece)?;
        }
    }
    let mut iterate = NewtonIterate {
        problem,
        load: load.nodal,
        kkt,
        solution,
        augmented_travel: vec![0.0; multiplier.len()],
        multiplier,
        residual: Residual::default(),
        coarse_load: CoarseLoad::under(problem, load.nodal),
        rounding: None,
        spent,
    };
    iterate.balance();
    Ok(iterate)
}

/// Lower bound of the reference force if there is no load. It is the largest of three forces: the force that bends the
/// plate by its largest distance from a contact point, the force of the strain by prescribed displacements, and the
/// rounding of prescribed rigid motions.
fn least_force(iterate: &NewtonIterate<'_>, held_value: &[f64]) -> f64 {
    let problem = iterate.problem;
    let off = problem.points.travel_from(&problem.points.shift, &iterate.solution.displacement);
    let off = off.iter().zip(iterate.pieces()).enumerate();
    let held = off.filter(|(i, (_, piece))| problem.points.piece(*i, *piece).holds());
    let farthest = held.map(|(i, (off, _))| off.abs() * problem.points.arm[i]).fold(0.0, f64::max);
    let strained = force_of_settlements(problem, &problem.strained(held_value));
    let rounding = f64::EPSILON * force_of_settlements(problem, held_value);
    strained.max(rounding).max(problem.scale.stiffness * farthest)
}
