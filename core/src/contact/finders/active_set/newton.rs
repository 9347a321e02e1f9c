//! The Newton iteration until the contact state settles. A step stops while it waits for the solve of its direction, so
//! that solves of many loads can be batched.

use super::iterate::NewtonIterate;
use crate::cholesky::FactorError;
use crate::contact::error::SolveError;
use crate::contact::kkt::{Direction, Gradients};
use crate::contact::residual::{force_of_settlements, largest_force};
use crate::contact::solution::{ContactSolution, Progress, Watch, differing};
use crate::contact::tolerances;

/// Largest number of Newton steps; overlapping circles on a rigid bed, one of 150,000 random plates, needed 732.
const NEWTON: usize = 2000;
/// Number of steps with a changing contact state after which directions are computed accurately.
const UNSETTLED: usize = 8;
/// Number of successive steps with little reduction of the residual after which the iteration ends: the residual is
/// then rounding.
const STALLS: usize = 3;
/// Number of steps on an unchanged contact state without a new least residual after which the iteration ends.
const LASTING: usize = 12;

/// How the iteration ended.
pub(super) type End = Result<(), SolveError>;

/// The next request of the iteration to its caller.
pub(super) enum Next {
    /// Needs the displacements under these nodal forces (3n,) by the shared factor.
    Solve(Vec<f64>),
    /// The contact state settled at the largest penalty: an exact solution may be sought.
    Settled,
    End(End),
}

/// The Newton method on one load.
pub(super) struct Newton<'a> {
    pub(super) iterate: NewtonIterate<'a>,
    /// Whether the iteration started from another solution.
    started: bool,
    step: usize,
    /// Contact states (m,) of the present step and of the previous one.
    pieces: Vec<u8>,
    last: Vec<u8>,
    /// The conjugate gradient iteration for the present direction.
    gradients: Option<Gradients>,
    /// Number of successive steps with little reduction of the residual.
    stalled: usize,
    since_settled: usize,
    /// Whether the iteration restarted with the first penalty, since the start was too far from the solution.
    far: bool,
    before: f64,
    /// Number of steps on an unchanged contact state since the least residual, and that residual.
    lasting: usize,
    lowest: f64,
    /// Lower bound of the reference force if there is no load.
    least: f64,
    /// The last contact state that was offered for an exact solution.
    offered: Vec<u8>,
    /// Whether the iteration ended by stagnation, so that its contact state may have a better solution.
    pub(super) fell_short: bool,
}

impl<'a> Newton<'a> {
    pub(super) fn new(iterate: NewtonIterate<'a>, started: bool, held_value: &[f64]) -> Self {
        // From rest, the first step has every point on its steepest piece, as the factor does.
        let pieces = if started { iterate.pieces() } else { iterate.problem.steepest_pieces() };
        let least = if iterate.load.iter().all(|&f| f == 0.0) {
            let problem = iterate.problem;
            // The largest of: the force that bends the plate by its distance from the points, the force that strains
            // it, and the rounding of prescribed motions.
            let off = problem.points.travel_from(&problem.points.shift, &iterate.solution.displacement);
            let off = off.iter().zip(iterate.pieces()).enumerate();
            let held = off.filter(|(i, (_, piece))| problem.points.piece(*i, *piece).holds());
            let farthest = held.map(|(i, (off, _))| off.abs() * problem.points.arm[i]).fold(0.0, f64::max);
            let strained = force_of_settlements(problem, &problem.strained(held_value));
            let rounding = f64::EPSILON * force_of_settlements(problem, held_value);
            strained.max(rounding).max(problem.scale.stiffness * farthest)
        } else {
            0.0
        };
        Self {
            iterate,
            started,
            step: 0,
            last: pieces.clone(),
            pieces,
            gradients: None,
            stalled: 0,
            since_settled: 0,
            far: false,
            before: f64::INFINITY,
            lasting: 0,
            lowest: f64::INFINITY,
            least,
            offered: Vec::new(),
            fell_short: false,
        }
    }

    /// Iterates until the shared factor is needed. `answer` is its solution if the last call returned [`Next::Solve`].
    /// Without a shared factor, iterates to the end.
    pub(super) fn go_on(&mut self, mut answer: Option<Vec<f64>>, watch: &mut Watch<'_>) -> Result<Next, FactorError> {
        loop {
            let direction = match self.gradients.take() {
                Some(mut gradients) => {
                    let NewtonIterate { kkt, residual, .. } = &mut self.iterate;
                    let Some(direction) = gradients.go_on(kkt, &residual.imbalance, answer.take())? else {
                        let asked = gradients.residual.clone();
                        self.gradients = Some(gradients);
                        return Ok(Next::Solve(asked));
                    };
                    direction
                }
                None => match self.begin_step() {
                    Some(end) => return Ok(Next::End(end)),
                    None if self.gradients.is_some() => continue,
                    None => Direction::zeros(self.iterate.load.len()),
                },
            };
            if let Some(next) = self.end_step(&direction, watch) {
                return Ok(next);
            }
        }
    }

    /// The present displacements and reactions on the contact state that is offered for an exact solution.
    pub(super) fn offer(&self) -> ContactSolution {
        let mut solution = ContactSolution { piece: self.offered.clone(), ..self.iterate.solution.clone() };
        solution.reaction = (0..self.offered.len()).map(|i| self.iterate.force(i)).collect();
        solution
    }

    /// Continues from an exact solution, with its reactions as multipliers.
    pub(super) fn resume(&mut self, exact: ContactSolution) {
        let iterate = &mut self.iterate;
        iterate.solution.displacement = exact.displacement;
        iterate.solution.corrections += exact.corrections;
        iterate.multiplier = exact.reaction;
        iterate.rounding = None;
        iterate.balance();
        self.pieces = iterate.pieces();
        self.last.clone_from(&self.pieces);
        (self.before, self.lasting, self.lowest) = (f64::INFINITY, 0, f64::INFINITY);
    }

    pub(super) fn ended(self, end: End) -> Result<ContactSolution, SolveError> {
        end.and_then(|()| self.iterate.ended().require_finite())
    }

    /// Starts a step and its direction, unless the residual is rounding. Returns `Some` if the iteration ends.
    fn begin_step(&mut self) -> Option<End> {
        self.step += 1;
        if self.step > NEWTON {
            return Some(Err(SolveError::Unsolved));
        }
        let same = self.step > 1 && self.pieces == self.last;
        let lost = self.since_settled == UNSETTLED || self.stalled == STALLS;
        if lost && self.iterate.kkt.limit == tolerances::newton::STIFFEST && self.started {
            // The start was too far away: restart with the first penalty, from zero multipliers.
            (self.stalled, self.far) = (0, true);
            self.iterate.multiplier.fill(0.0);
            self.iterate.set_penalty(self.iterate.kkt.augmentation.first_penalty);
            self.pieces = self.iterate.pieces();
        }
        let mut settled = self.iterate.rounding();
        if self.step > 1 && self.iterate.coarse_correction() {
            self.pieces = self.iterate.pieces();
            // The rest of the residual would only move a free plate away.
            settled = settled.max(tolerances::newton::SETTLED * self.force());
        }
        let tolerance = match (same, self.since_settled < UNSETTLED) {
            (true, _) => tolerances::newton::TIGHT,
            (false, true) => tolerances::newton::LOOSE,
            (false, false) => tolerances::newton::FIRM,
        };
        if self.iterate.residual.worst > settled || self.iterate.residual.worst.is_nan() {
            let (imbalance, rounding) = (self.iterate.residual.imbalance.clone(), self.iterate.rounding());
            let mut gradients = Gradients::begin(&self.iterate.kkt, &self.pieces, imbalance, tolerance, rounding);
            if self.step <= UNSETTLED {
                gradients.deflate(&mut self.iterate.kkt);
            }
            self.gradients = Some(gradients);
        }
        None
    }

    /// Reference force.
    fn force(&self) -> f64 {
        largest_force(self.iterate.problem, self.iterate.load, &[]).max(self.iterate.largest_force())
    }

    /// Moves along the direction and tests for convergence. Returns `None` if the next step follows.
    fn end_step(&mut self, direction: &Direction, watch: &mut Watch<'_>) -> Option<Next> {
        self.iterate.advance(direction, &self.pieces);
        self.last = std::mem::replace(&mut self.pieces, self.iterate.pieces());
        let unchanged = self.pieces == self.last;
        let force = self.force().max(self.least);
        let iterate = &mut self.iterate;
        let settling =
            unchanged || iterate.residual.worst <= tolerances::newton::NEARLY * tolerances::newton::SETTLED * force;
        self.since_settled += 1;
        let limit = iterate.kkt.limit;
        if settling {
            self.since_settled = 0;
            iterate.balance();
            iterate.rounding = None;
            if limit < tolerances::newton::STIFFEST {
                iterate.set_penalty(iterate.kkt.augmentation.next_penalty(limit));
                (self.before, self.lasting, self.lowest) = (f64::INFINITY, 0, f64::INFINITY);
            } else if iterate.residual.worst <= tolerances::newton::BALANCED * force {
                // Multipliers are updated in equilibrium only.
                iterate.renew_multipliers();
            }
            self.pieces = iterate.pieces();
        }
        let changing = differing(&self.pieces, &self.last).len();
        let worst = iterate.residual.worst;
        if !worst.is_finite() {
            return Some(Next::End(Err(SolveError::Unsolved)));
        }
        // Without forces the relative residual is zero.
        let residual = if worst == 0.0 { 0.0 } else { worst / force };
        if !watch(Progress { step: self.step, changing, residual }) {
            return Some(Next::End(Err(SolveError::Cancelled)));
        }
        if !settling || limit != tolerances::newton::STIFFEST {
            return None;
        }
        if let Some(outcome) = self.settled(worst, force, unchanged) {
            return Some(Next::End(outcome));
        }
        let offers = unchanged && self.iterate.kkt.is_augmented() && self.offered != self.last;
        offers.then(|| {
            self.offered.clone_from(&self.last);
            Next::Settled
        })
    }

    /// Tests for the end at the largest penalty; `None` if the iteration continues.
    fn settled(&mut self, worst: f64, force: f64, unchanged: bool) -> Option<End> {
        if worst <= tolerances::newton::SETTLED * force || worst <= self.iterate.rounding() {
            return Some(Ok(()));
        }
        // Points without force and gap may change their piece for ever; the residual then gives no further information.
        let idle = unchanged || worst <= tolerances::newton::NEARLY * tolerances::newton::SETTLED * force;
        self.stalled = if idle && worst > tolerances::newton::SLOW * self.before { self.stalled + 1 } else { 0 };
        if self.stalled == STALLS || self.lasting == LASTING {
            if worst <= tolerances::newton::STALLED * force {
                self.fell_short = true;
                return Some(Ok(()));
            }
            if !self.started || self.far || self.lasting == LASTING {
                return Some(Err(SolveError::Unsolved));
            }
        }
        self.before = worst;
        self.lasting =
            if worst <= tolerances::newton::SLOW * self.lowest { 0 } else { self.lasting + usize::from(unchanged) };
        self.lowest = f64::min(self.lowest, worst);
        None
    }
}
