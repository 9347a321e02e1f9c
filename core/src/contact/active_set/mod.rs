//! One-sided points in any number: a semismooth Newton method on the sparse K (a primal–dual active set; Hintermüller,
//! Ito & Kunisch 2002), inside the method of multipliers (Rockafellar 1976) where supports are rigid or nearly so.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, every Newton direction
//! is followed by an exact line search on it, and the multipliers are a proximal point iteration on the dual. Rigid
//! points begin on springs that bend the plate over many elements, and stiffen from stage to stage.
//! One factor, of K with the points closed that are expected to be, preconditions every direction; only where the set
//! turns out to be quite another one is it factored anew.

mod afloat;
mod direction;
mod fixed;
mod line_search;
mod points;
mod push;
mod together;

pub use points::{ActivePoints, Softened};

use super::condense::ContactState;
use super::problem::{ContactProblem, Factored};
use super::refinement::Step;
use super::solution::{ContactSolution, Outcome};
use crate::cholesky::FactorError;
use crate::plate::Plate;
use crate::residual::internal_magnitude;
use direction::Direction;
use together::{Desk, at_once};

/// One Newton step, to whoever watches.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Points that have opened or closed since the step before.
    pub changing: usize,
    /// Largest imbalance over the largest nodal force.
    pub residual: f64,
}

/// Stiffest springs that rigid points act through, over the plate's stiffness in shear: at the end, where multipliers
/// converge the faster the stiffer they are, and how much stiffer they become from stage to stage.
const STIFFEST: f64 = 1e4;
const STIFFER: f64 = 10.0;
/// Bending stiffness over that in shear of a wave of ten elements, over the square of thickness over element size.
const LONG_WAVE: f64 = 0.04;
/// At most this many Newton steps.
const NEWTON: usize = 500;
/// What conjugate gradients leave of the imbalance, while the set still changes and when it does not.
const LOOSE: f64 = 0.3;
/// Instead of the first after so many steps without the set settling: true Newton directions then need fewer.
const FIRM: f64 = 1e-3;
const PATIENT: usize = 8;
const TIGHT: f64 = 1e-8;
/// Imbalance, over the largest nodal force, at which the points are settled.
const SETTLED: f64 = 1e-13;
/// Times that imbalance from which points are looked at anew although some still change sides.
const NEARLY: f64 = 1e3;
/// Steps on one set that leave this part of the imbalance, one after another, that end it: what is left is rounding.
const SLOW: f64 = 0.8;
const STALLS: usize = 3;
/// So many on unchanged sets without a new least imbalance, up and down, end it as well.
const LASTING: usize = 12;
/// What rounding leaves at most, in the thinnest plates; where it stalls above, supports contradict each other.
const ROUNDING: f64 = 1e-3;
/// Imbalance, over the largest nodal force, up to which multipliers are renewed.
const BALANCED: f64 = 1e-3;
/// Change of the multipliers, over the largest force, at which the next stage begins.
const STEADY: f64 = 5e-2;

/// Where to begin: displacements over all dofs, reactions and states in the caller's order, and a factor, if not the
/// problem's own.
pub(super) struct Start<'a> {
    pub displacement: &'a [f64],
    pub reaction: &'a [f64],
    pub closed: &'a [bool],
    pub factored: Option<&'a Factored>,
    pub balanced: Option<Balanced<'a>>,
}

/// The load that a start is the solution of, the low-order part of its displacement, and how far the points overlap in it.
#[derive(Clone, Copy)]
pub(super) struct Balanced<'a> {
    load: &'a [f64],
    low: &'a [f64],
    overlap: &'a [f64],
}

/// One load's solution and the factor of its contact set, for loads not unlike it to begin with.
pub struct Reference {
    pub solution: ContactSolution,
    factored: Factored,
    load: Vec<f64>,
    overlap: Vec<f64>,
}

impl Reference {
    pub(super) fn start(&self) -> Start<'_> {
        Start {
            displacement: &self.solution.displacement.hi,
            reaction: &self.solution.reaction,
            closed: &self.solution.closed,
            factored: Some(&self.factored),
            balanced: Some(Balanced { load: &self.load, low: &self.solution.displacement.lo, overlap: &self.overlap }),
        }
    }
}

/// A solution on its way.
struct Descent<'a> {
    problem: &'a ContactProblem,
    load: &'a [f64],
    /// Stiffest springs, over the plate's stiffness in shear.
    limit: f64,
    springs: Softened,
    /// The factor that it was given, and the one in its place, if any.
    given: &'a Factored,
    own: Option<Factored>,
    /// Where the factor that it was given is asked, if others ask it too; there are no two-sided points then.
    desk: Option<&'a Desk>,
    /// Two-sided points, held.
    state: ContactState,
    solution: ContactSolution,
    multiplier: Vec<f64>,
    stretch: Vec<f64>,
    step: Step,
    /// Points that are closed whatever their stretch, and all others open, where the set is not to be found.
    imposed: Option<Vec<bool>>,
    /// Rounding of the internal forces, below which an imbalance says nothing.
    rounding: f64,
}

impl ContactProblem {
    /// The limit that the active set begins with: springs that bend the plate over many elements find the set in few
    /// steps.
    pub(super) fn first_limit(plate: &Plate, points: &ActivePoints) -> f64 {
        if points.is_empty() {
            return STIFFEST;
        }
        let slenderness = |e: usize| {
            let geometry = plate.geometry(e);
            let size = geometry.at.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
            plate.thickness.first(plate.kind, e) / size
        };
        let thinnest = points.element.iter().map(|&e| slenderness(e)).fold(f64::INFINITY, f64::min);
        let limit = f64::min(LONG_WAVE * thinnest * thinnest, 1.0);
        let all_softer = points.softened(limit).softening.iter().all(|&s| s == 0.0);
        if all_softer { STIFFEST } else { limit }
    }

    /// Displacements, reactions and gaps under one load, beginning with those of a start if there is one; `watch` may
    /// stop it by returning false.
    pub(super) fn solve_active(
        &self,
        load: &[f64],
        held_value: &[f64],
        start: Option<&Start<'_>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        at_once(self.descend(load, held_value, start, None, watch))
    }

    async fn descend<W: FnMut(Progress) -> bool + ?Sized>(
        &self,
        load: &[f64],
        held_value: &[f64],
        start: Option<&Start<'_>>,
        desk: Option<&Desk>,
        watch: &mut W,
    ) -> Result<ContactSolution, FactorError> {
        let mut solution = self.at_rest(load.len(), held_value);
        let given = start.and_then(|start| start.factored).unwrap_or(&self.base);
        let Some(state) = given.condensed.state(self.constraints.two_sided.clone()) else {
            return Ok(solution.failed(Outcome::Unsolved));
        };
        solution.closed.clone_from(&self.constraints.two_sided);
        let mut multiplier = vec![0.0; self.active.len()];
        if let Some(start) = start {
            solution.displacement.hi.copy_from_slice(start.displacement);
            for (multiplier, &i) in multiplier.iter_mut().zip(&self.order.active) {
                *multiplier = if start.closed[i] { start.reaction[i] } else { 0.0 };
            }
        }
        let limit = if start.is_some() { STIFFEST } else { self.first_limit };
        let mut descent = Descent {
            problem: self,
            load,
            given,
            limit,
            springs: self.active.softened(limit),
            own: None,
            desk,
            state,
            solution,
            stretch: vec![0.0; multiplier.len()],
            multiplier,
            step: Step::default(),
            imposed: None,
            rounding: 0.0,
        };
        match start.and_then(|start| start.balanced) {
            Some(balanced) if self.constraints.rows.is_empty() => descent.depart(balanced),
            _ => descent.refine()?,
        }
        let outcome = descent.run(start.is_some(), watch).await?;
        Ok(match outcome {
            Outcome::Solved => descent.in_order().solved(),
            _ => descent.in_order().failed(outcome),
        })
    }
}

impl ContactProblem {
    /// Solves one load and factors the contact set found; `None` where there is no active set, no solution, or the set
    /// does not hold the plate.
    pub fn reference(&self, load: &[f64], held_value: &[f64]) -> Result<Option<Reference>, FactorError> {
        let solution = self.solve(load, held_value, None, None, &mut |_| true)?;
        if self.active.is_empty() || solution.outcome != Outcome::Solved {
            return Ok(None);
        }
        let stiffness = self.active.softened(STIFFEST).stiffness;
        let closed = self.order.active.iter().map(|&i| solution.closed[i]);
        let carried = stiffness.iter().zip(closed).map(|(&k, closed)| if closed { k } else { 0.0 }).collect();
        match self.refactored(carried) {
            Ok(factored) => {
                let overlap = self.active.overlap(&self.plate, &solution.displacement);
                Ok(Some(Reference { solution, factored, load: load.to_vec(), overlap }))
            }
            Err(FactorError::NotPositiveDefinite { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Descent<'_> {
    fn factored(&self) -> &Factored {
        self.own.as_ref().unwrap_or(self.given)
    }

    async fn run<W: FnMut(Progress) -> bool + ?Sized>(
        &mut self,
        started: bool,
        watch: &mut W,
    ) -> Result<Outcome, FactorError> {
        // From rest, the first step takes every point closed, as the factor does.
        let mut closed: Vec<bool> = self.stretch.iter().map(|&s| s > 0.0 || !started).collect();
        let mut last = closed.clone();
        let mut stalled = 0;
        let mut since_settled = 0;
        let mut far = false;
        let mut before = f64::INFINITY;
        let (mut lasting, mut lowest) = (0, f64::INFINITY);
        // Without a load nothing may push in the end, so forces count from those of the settlements at the start.
        let least = if self.load.iter().all(|&f| f == 0.0) { self.largest_push() } else { 0.0 };
        for step in 1..=NEWTON {
            if self.is_afloat() {
                self.move_rigidly();
                closed = self.stretch.iter().map(|&s| s > 0.0).collect();
            }
            let same = step > 1 && closed == last;
            let lost = since_settled == PATIENT || stalled == STALLS;
            if lost && self.limit == STIFFEST && started {
                // The start was too far away: begin with springs that bend the plate, like from rest.
                (stalled, far) = (0, true);
                self.limit = self.problem.first_limit;
                self.springs = self.problem.active.softened(self.limit);
                self.balance();
                closed = self.stretch.iter().map(|&s| s > 0.0).collect();
            }
            let tolerance = match (same, since_settled < PATIENT) {
                (true, _) => TIGHT,
                (false, true) => LOOSE,
                (false, false) => FIRM,
            };
            let direction = match self.step.worst <= self.rounding {
                true => Direction::zeros(self.load.len(), self.solution.reaction.len()),
                false => self.direction(&closed, tolerance).await?,
            };
            self.advance(&direction, &closed);
            last = closed;
            closed = self.stretch.iter().map(|&s| s > 0.0).collect();
            let unchanged = closed == last;
            let force = self.problem.largest_force(self.load, &self.solution).max(self.largest_push()).max(least);
            let settling = unchanged || self.step.worst <= NEARLY * SETTLED * force;
            since_settled += 1;
            if settling {
                since_settled = 0;
                self.refine()?;
                // Multipliers follow an equilibrium, not what comes before it.
                let balanced = self.step.worst <= BALANCED * force;
                let renewed = if balanced { self.renew_multipliers() } else { f64::INFINITY };
                if self.limit < STIFFEST && renewed <= STEADY * force {
                    self.limit = f64::min(STIFFER * self.limit, STIFFEST);
                    self.springs = self.problem.active.softened(self.limit);
                    self.balance();
                    before = f64::INFINITY;
                    (lasting, lowest) = (0, f64::INFINITY);
                }
                closed = self.stretch.iter().map(|&s| s > 0.0).collect();
            }
            let changing = closed.iter().zip(&last).filter(|(a, b)| a != b).count();
            let worst = self.step.worst;
            if !worst.is_finite() {
                return Ok(Outcome::Unsolved);
            }
            if !watch(Progress { step, changing, residual: worst / force }) {
                return Ok(Outcome::Interrupted);
            }
            if settling && self.limit == STIFFEST {
                if worst <= f64::max(SETTLED * force, self.rounding) {
                    return Ok(Outcome::Solved);
                }
                // Points that neither push nor gape may change sides for ever; what is out of balance tells nothing more.
                let idle = unchanged || worst <= NEARLY * SETTLED * force;
                stalled = if idle && worst > SLOW * before { stalled + 1 } else { 0 };
                if stalled == STALLS || lasting == LASTING {
                    if worst <= ROUNDING * force {
                        return Ok(Outcome::Solved);
                    }
                    if !started || far || lasting == LASTING {
                        return Ok(Outcome::Unsolved);
                    }
                }
                before = worst;
                lasting = if worst <= SLOW * lowest { 0 } else { lasting + usize::from(unchanged) };
                lowest = f64::min(lowest, worst);
            }
        }
        Ok(Outcome::Unsolved)
    }

    /// Follows a direction to the least energy on it; what is out of balance then is known without the refined residual.
    fn advance(&mut self, direction: &Direction, closed: &[bool]) {
        let (problem, points) = (self.problem, &self.problem.active);
        let change = points.change(&problem.plate, &direction.nodal);
        let length = if self.imposed.is_some() { 1.0 } else { self.line_search(direction, &change, closed) };
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.solution.displacement.add(dof, length * value);
        }
        let mut loss: Vec<f64> = direction.force.iter().map(|f| -length * f).collect();
        let carried = self.own.as_ref().unwrap_or(self.given).carried.iter();
        for (i, &carried) in carried.enumerate() {
            let old = self.stretch[i];
            self.stretch[i] += length * change[i];
            let pushes = self.springs.stiffness[i] * (self.pushing(i) - self.pushes(i, old));
            let factor = length * carried * change[i] - pushes;
            if factor != 0.0 {
                points.scatter(&problem.plate, i, factor, &mut loss);
            }
        }
        let steps: Vec<f64> = direction.reaction.iter().map(|r| -length * r).collect();
        problem.spread(&steps, &mut loss);
        for (total, increment) in self.solution.reaction.iter_mut().zip(&direction.reaction) {
            *total += length * increment;
        }
        problem.release_held(&mut loss);
        for (value, loss) in self.step.imbalance.iter_mut().zip(&loss) {
            *value += loss;
        }
        self.step.worst = self.step.imbalance.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        self.solution.iterations += 1;
    }

    /// From the solution under another load, what is out of balance is what the loads differ by.
    fn depart(&mut self, from: Balanced) {
        self.solution.displacement.lo.copy_from_slice(from.low);
        let softened = self.springs.softening.iter().zip(&self.multiplier);
        self.stretch = from.overlap.iter().zip(softened).map(|(overlap, (s, force))| overlap + s * force).collect();
        let imbalance = self.load.iter().zip(from.load).map(|(load, balanced)| load - balanced).collect();
        self.step = self.problem.step_of(imbalance, self.load, &self.solution);
    }

    /// Stretches and imbalance anew, in double-double; two-sided points are brought back to where they belong.
    fn refine(&mut self) -> Result<(), FactorError> {
        self.balance();
        if !self.problem.constraints.rows.is_empty() {
            let with = self.own.as_ref().unwrap_or(self.given);
            let motion = self.problem.motion(with, &self.step, with.condensed.better_form())?;
            self.problem.correct(with, &self.state, motion, &mut self.solution)?;
            self.balance();
        }
        if self.imposed.is_some() && self.rounding > 0.0 {
            // One load on one set: the internal forces stay.
            return Ok(());
        }
        let (plate, held) = (&self.problem.plate, &self.problem.held);
        self.rounding = f64::EPSILON * internal_magnitude(plate, held, &self.solution.displacement);
        Ok(())
    }

    fn balance(&mut self) {
        let (problem, points) = (self.problem, &self.problem.active);
        let mut imbalance = problem.imbalance(self.load, &self.solution.displacement, &self.solution.reaction);
        self.stretch = points.overlap(&problem.plate, &self.solution.displacement);
        for i in 0..points.len() {
            self.stretch[i] += self.springs.softening[i] * self.multiplier[i];
            let pushing = self.pushing(i);
            if pushing != 0.0 {
                points.scatter(&problem.plate, i, -self.springs.stiffness[i] * pushing, &mut imbalance);
            }
        }
        self.step = problem.step_of(imbalance, self.load, &self.solution);
    }

    /// The solution with every point in the caller's order.
    fn in_order(self) -> ContactSolution {
        let order = &self.problem.order;
        let count = order.condensed.len() + order.active.len();
        let mut all = ContactSolution {
            reaction: vec![0.0; count],
            gap: vec![0.0; count],
            closed: vec![false; count],
            ..self.solution.clone()
        };
        for (at, &i) in order.condensed.iter().enumerate() {
            all.reaction[i] = self.solution.reaction[at];
            all.closed[i] = true;
        }
        for (at, &i) in order.active.iter().enumerate() {
            let stretch = self.stretch[at];
            all.reaction[i] = self.springs.stiffness[at] * self.pushing(at);
            all.closed[i] = self.imposed.as_ref().map_or(stretch > 0.0, |closed| closed[at]);
            all.gap[i] = if all.closed[i] { 0.0 } else { self.springs.softening[at] * self.multiplier[at] - stretch };
        }
        all
    }
}
