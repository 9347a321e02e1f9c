//! From Newton step to Newton step until the set of closed points settles; a step waits for what its direction asks of the
//! factor, so that many loads can ask it together.

use super::descent::Descent;
use crate::cholesky::FactorError;
use crate::contact::kkt::{ConjugateGradients, Direction};
use crate::contact::solution::{ContactSolution, Outcome, Progress};
use crate::contact::tolerances;

/// At most this many Newton steps; overlapping circles on a rigid bed, one of 150,000 random plates, needed 732.
const NEWTON: usize = 2000;
/// Steps without the set settling after which directions are firm.
const PATIENT: usize = 8;
/// So many steps, one after another, that leave most of the residual end it: what is left is rounding.
const STALLS: usize = 3;
/// So many on unchanged sets without a new least residual, up and down, end it as well.
const LASTING: usize = 12;

/// What a descent needs to go on.
pub(super) enum Next {
    /// K̃⁻¹ times a vector, both in elimination order.
    Solve(Vec<f64>),
    End(Outcome),
}

/// Newton's method on one load.
pub(super) struct Newton<'a> {
    pub(super) descent: Descent<'a>,
    /// Whether it began with another solution rather than at rest.
    started: bool,
    step: usize,
    /// Points that are closed in the present step, and that were in the one before.
    closed: Vec<bool>,
    last: Vec<bool>,
    /// The direction that is being sought.
    gradients: Option<ConjugateGradients>,
    /// Steps one after another that left most of the imbalance.
    stalled: usize,
    since_settled: usize,
    /// Whether the start has turned out to be too far away.
    far: bool,
    before: f64,
    /// Steps on unchanged sets since the least imbalance, and that.
    lasting: usize,
    lowest: f64,
    /// A force that counts although nothing may push in the end: without a load, the largest on the way.
    least: f64,
    unloaded: bool,
    /// Whether it ended because it stalled, so that its set may have a better solution.
    pub(super) fell_short: bool,
}

impl<'a> Newton<'a> {
    pub(super) fn new(descent: Descent<'a>, started: bool) -> Self {
        // From rest, the first step takes every point closed, as the factor does.
        let closed: Vec<bool> = descent.stretch.iter().map(|&s| s > 0.0 || !started).collect();
        let unloaded = descent.load.iter().all(|&f| f == 0.0);
        let least = if unloaded { descent.largest_push() } else { 0.0 };
        Self {
            descent,
            started,
            step: 0,
            last: closed.clone(),
            closed,
            gradients: None,
            stalled: 0,
            since_settled: 0,
            far: false,
            before: f64::INFINITY,
            lasting: 0,
            lowest: f64::INFINITY,
            least,
            unloaded,
            fell_short: false,
        }
    }

    /// Goes on with the answer to what was asked for, if anything was; one that does not share its factor goes on to the end.
    pub(super) fn go_on(
        &mut self,
        mut answer: Option<Vec<f64>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Next, FactorError> {
        loop {
            let direction = match self.gradients.take() {
                Some(mut gradients) => {
                    let Descent { problem, factor, residual, .. } = &mut self.descent;
                    let Some(direction) = factor.direction(&mut gradients, &residual.imbalance, answer.take())? else {
                        let asked = problem.gather(&gradients.residual);
                        self.gradients = Some(gradients);
                        return Ok(Next::Solve(asked));
                    };
                    direction
                }
                None => match self.begin_step() {
                    Some(end) => return Ok(Next::End(end)),
                    None if self.gradients.is_some() => continue,
                    None => Direction::zeros(self.descent.load.len(), self.descent.solution.reaction.len()),
                },
            };
            if let Some(outcome) = self.end_step(&direction, watch)? {
                return Ok(Next::End(outcome));
            }
        }
    }

    /// The solution, with every point in the caller's order.
    pub(super) fn ended(self, outcome: Outcome) -> ContactSolution {
        let found = self.descent.in_order();
        if outcome == Outcome::Solved { found.solved() } else { found.failed(outcome) }
    }

    /// Begins a step, by seeking its direction unless nothing is out of balance; its end, if that was the last one.
    fn begin_step(&mut self) -> Option<Outcome> {
        self.step += 1;
        if self.step > NEWTON {
            return Some(Outcome::Unsolved);
        }
        let same = self.step > 1 && self.closed == self.last;
        let lost = self.since_settled == PATIENT || self.stalled == STALLS;
        if lost && self.descent.factor.limit == tolerances::newton::STIFFEST && self.started {
            // The start was too far away: begin with springs that bend the plate, like from rest.
            (self.stalled, self.far) = (0, true);
            self.descent.penalize(self.descent.problem.first_limit);
            self.closed = self.descent.pushing_points();
        }
        let mut settled = self.descent.rounding();
        if self.step > 1 && self.descent.drift() {
            self.closed = self.descent.pushing_points();
            // What is left would only send a loose plate away.
            let force = self.descent.problem.largest_force(self.descent.load, &self.descent.solution.reaction);
            settled = settled.max(tolerances::newton::SETTLED * force);
        }
        let tolerance = match (same, self.since_settled < PATIENT) {
            (true, _) => tolerances::newton::TIGHT,
            (false, true) => tolerances::newton::LOOSE,
            (false, false) => tolerances::newton::FIRM,
        };
        if self.descent.residual.worst > settled || self.descent.residual.worst.is_nan() {
            let (imbalance, rounding) = (self.descent.residual.imbalance.clone(), self.descent.rounding());
            let mut gradients = self.descent.factor.gradients(&self.closed, imbalance, tolerance, rounding);
            if self.step <= PATIENT {
                self.descent.factor.deflate(&mut gradients);
            }
            self.gradients = Some(gradients);
        }
        None
    }

    /// Follows the direction, and judges where it has led to.
    fn end_step(
        &mut self,
        direction: &Direction,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<Outcome>, FactorError> {
        let descent = &mut self.descent;
        descent.advance(direction, &self.closed);
        self.last = std::mem::replace(&mut self.closed, descent.pushing_points());
        let unchanged = self.closed == self.last;
        let force = descent.problem.largest_force(descent.load, &descent.solution.reaction);
        let force = force.max(descent.largest_push()).max(self.least);
        if self.unloaded {
            self.least = force;
        }
        let settling =
            unchanged || descent.residual.worst <= tolerances::newton::NEARLY * tolerances::newton::SETTLED * force;
        self.since_settled += 1;
        if settling {
            self.since_settled = 0;
            descent.refine()?;
            // Multipliers follow an equilibrium, not what comes before it.
            let balanced = descent.residual.worst <= tolerances::newton::BALANCED * force;
            let renewed = if balanced { descent.renew_multipliers() } else { f64::INFINITY };
            if descent.factor.limit < tolerances::newton::STIFFEST && renewed <= tolerances::newton::STEADY * force {
                descent.penalize(f64::min(
                    tolerances::newton::STIFFER * descent.factor.limit,
                    tolerances::newton::STIFFEST,
                ));
                (self.before, self.lasting, self.lowest) = (f64::INFINITY, 0, f64::INFINITY);
            }
            self.closed = descent.pushing_points();
        }
        let changing = self.closed.iter().zip(&self.last).filter(|(a, b)| a != b).count();
        let worst = descent.residual.worst;
        if !worst.is_finite() {
            return Ok(Some(Outcome::Unsolved));
        }
        // Where nothing acts nothing is out of balance.
        let residual = if worst == 0.0 { 0.0 } else { worst / force };
        if !watch(Progress { step: self.step, changing, residual }) {
            return Ok(Some(Outcome::Interrupted));
        }
        if !settling || self.descent.factor.limit != tolerances::newton::STIFFEST {
            return Ok(None);
        }
        Ok(self.settled(worst, force, unchanged))
    }

    /// How it ends with springs as stiff as they become, if it does.
    fn settled(&mut self, worst: f64, force: f64, unchanged: bool) -> Option<Outcome> {
        if worst <= tolerances::newton::SETTLED * force || worst <= self.descent.rounding() {
            return Some(Outcome::Solved);
        }
        // Points that neither push nor gape may change sides for ever; what is out of balance tells nothing more.
        let idle = unchanged || worst <= tolerances::newton::NEARLY * tolerances::newton::SETTLED * force;
        self.stalled = if idle && worst > tolerances::newton::SLOW * self.before { self.stalled + 1 } else { 0 };
        if self.stalled == STALLS || self.lasting == LASTING {
            if worst <= tolerances::newton::STALLED * force {
                self.fell_short = true;
                return Some(Outcome::Solved);
            }
            if !self.started || self.far || self.lasting == LASTING {
                return Some(Outcome::Unsolved);
            }
        }
        self.before = worst;
        self.lasting =
            if worst <= tolerances::newton::SLOW * self.lowest { 0 } else { self.lasting + usize::from(unchanged) };
        self.lowest = f64::min(self.lowest, worst);
        None
    }
}
