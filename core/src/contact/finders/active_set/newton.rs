//! From Newton step to Newton step until the pieces settle; a step waits for what its direction asks of the factor, so that
//! many loads can ask it together.

use super::descent::Descent;
use crate::cholesky::FactorError;
use crate::contact::kkt::{Direction, Gradients};
use crate::contact::residual::{force_of_settlements, largest_force};
use crate::contact::solution::{ContactSolution, Outcome, Progress, Watch, differing};
use crate::contact::tolerances;

/// At most this many Newton steps; overlapping circles on a rigid bed, one of 150,000 random plates, needed 732.
const NEWTON: usize = 2000;
/// Steps without the pieces settling after which directions are firm.
const UNSETTLED: usize = 8;
/// So many steps, one after another, that leave most of the residual end it: the rest is rounding.
const STALLS: usize = 3;
/// So many on unchanged pieces without a new least residual, up and down, end it as well.
const LASTING: usize = 12;

/// What a descent needs to go on.
pub(super) enum Next {
    /// The motion of the nodes under nodal forces, by the factor that it shares.
    Solve(Vec<f64>),
    End(Outcome),
}

/// Newton's method on one load.
pub(super) struct Newton<'a> {
    pub(super) descent: Descent<'a>,
    /// Whether it began with another solution rather than at rest.
    started: bool,
    step: usize,
    /// Pieces in the present step, and in the one before.
    pieces: Vec<u8>,
    last: Vec<u8>,
    /// The direction that is being sought.
    gradients: Option<Gradients>,
    /// Steps one after another that left most of the imbalance.
    stalled: usize,
    since_settled: usize,
    /// Whether the start has turned out to be too far away.
    far: bool,
    before: f64,
    /// Steps on unchanged pieces since the least imbalance, and that.
    lasting: usize,
    lowest: f64,
    /// Without a load, a force that counts although nothing may push in the end.
    least: f64,
    /// Whether it ended because it stalled, so that its pieces may have a better solution.
    pub(super) fell_short: bool,
}

impl<'a> Newton<'a> {
    pub(super) fn new(descent: Descent<'a>, started: bool, held_value: &[f64]) -> Self {
        // From rest, the first step takes every point on its steepest piece, as the factor does.
        let pieces = if started { descent.pieces() } else { descent.problem.steepest_pieces() };
        let least = if descent.load.iter().all(|&f| f == 0.0) {
            let problem = descent.problem;
            // What bends the plate as far as it is off the points, what strains it, and the rounding of what moves it.
            let off = problem.points.travel_from(&problem.points.shift, &descent.solution.displacement);
            let off = off.iter().zip(descent.pieces()).enumerate();
            let held = off.filter(|(i, (_, piece))| problem.points.piece(*i, *piece).holds());
            let farthest = held.map(|(i, (off, _))| off.abs() * problem.points.arm[i]).fold(0.0, f64::max);
            let strained = force_of_settlements(problem, &problem.strained(held_value));
            let rounding = f64::EPSILON * force_of_settlements(problem, held_value);
            strained.max(rounding).max(problem.scale.stiffness * farthest)
        } else {
            0.0
        };
        Self {
            descent,
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
            fell_short: false,
        }
    }

    /// Goes on with the answer to what was asked for, if anything was; one that does not share its factor goes on to the end.
    pub(super) fn go_on(&mut self, mut answer: Option<Vec<f64>>, watch: &mut Watch<'_>) -> Result<Next, FactorError> {
        loop {
            let direction = match self.gradients.take() {
                Some(mut gradients) => {
                    let Descent { kkt, residual, .. } = &mut self.descent;
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
                    None => Direction::zeros(self.descent.load.len()),
                },
            };
            if let Some(outcome) = self.end_step(&direction, watch) {
                return Ok(Next::End(outcome));
            }
        }
    }

    pub(super) fn ended(self, outcome: Outcome) -> ContactSolution {
        let solution = self.descent.ended();
        if outcome == Outcome::Solved { solution.solved() } else { solution.failed(outcome) }
    }

    /// Begins a step, by seeking its direction unless nothing is out of balance; its end, if that was the last one.
    fn begin_step(&mut self) -> Option<Outcome> {
        self.step += 1;
        if self.step > NEWTON {
            return Some(Outcome::Unsolved);
        }
        let same = self.step > 1 && self.pieces == self.last;
        let lost = self.since_settled == UNSETTLED || self.stalled == STALLS;
        if lost && self.descent.kkt.limit == tolerances::newton::STIFFEST && self.started {
            // The start was too far away: begin with springs that bend the plate, like from rest.
            (self.stalled, self.far) = (0, true);
            self.descent.limit_to(self.descent.problem.first_limit);
            self.pieces = self.descent.pieces();
        }
        let mut settled = self.descent.rounding();
        if self.step > 1 && self.descent.drift() {
            self.pieces = self.descent.pieces();
            // What remains would only send a loose plate away.
            settled = settled.max(tolerances::newton::SETTLED * self.force());
        }
        let tolerance = match (same, self.since_settled < UNSETTLED) {
            (true, _) => tolerances::newton::TIGHT,
            (false, true) => tolerances::newton::LOOSE,
            (false, false) => tolerances::newton::FIRM,
        };
        if self.descent.residual.worst > settled || self.descent.residual.worst.is_nan() {
            let (imbalance, rounding) = (self.descent.residual.imbalance.clone(), self.descent.rounding());
            let mut gradients = Gradients::begin(&self.descent.kkt, &self.pieces, imbalance, tolerance, rounding);
            if self.step <= UNSETTLED {
                gradients.deflate(&mut self.descent.kkt);
            }
            self.gradients = Some(gradients);
        }
        None
    }

    /// The largest force that acts.
    fn force(&self) -> f64 {
        largest_force(self.descent.problem, self.descent.load, &[]).max(self.descent.largest_force())
    }

    /// Follows the direction, and judges where it has led to.
    fn end_step(&mut self, direction: &Direction, watch: &mut Watch<'_>) -> Option<Outcome> {
        self.descent.advance(direction, &self.pieces);
        self.last = std::mem::replace(&mut self.pieces, self.descent.pieces());
        let unchanged = self.pieces == self.last;
        let force = self.force().max(self.least);
        let descent = &mut self.descent;
        let settling =
            unchanged || descent.residual.worst <= tolerances::newton::NEARLY * tolerances::newton::SETTLED * force;
        self.since_settled += 1;
        if settling {
            self.since_settled = 0;
            descent.balance();
            descent.rounding = None;
            // Multipliers follow an equilibrium, not what comes before it.
            let balanced = descent.residual.worst <= tolerances::newton::BALANCED * force;
            let renewed = if balanced { descent.renew_multipliers() } else { f64::INFINITY };
            let limit = descent.kkt.limit;
            if limit < tolerances::newton::STIFFEST && renewed <= tolerances::newton::STEADY * force {
                descent.limit_to(f64::min(tolerances::newton::STIFFER * limit, tolerances::newton::STIFFEST));
                (self.before, self.lasting, self.lowest) = (f64::INFINITY, 0, f64::INFINITY);
            }
            self.pieces = descent.pieces();
        }
        let changing = differing(&self.pieces, &self.last).len();
        let worst = descent.residual.worst;
        if !worst.is_finite() {
            return Some(Outcome::Unsolved);
        }
        // Where nothing acts nothing is out of balance.
        let residual = if worst == 0.0 { 0.0 } else { worst / force };
        if !watch(Progress { step: self.step, changing, residual }) {
            return Some(Outcome::Interrupted);
        }
        if !settling || descent.kkt.limit != tolerances::newton::STIFFEST {
            return None;
        }
        self.settled(worst, force, unchanged)
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
