//! Who follows a path from its first solution on: what solves it from one line to the next, and is watched.

use super::line::{Line, travel};
use super::load::{PathEnd, PathLoad, Stop};
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::kkt::OnSet;
use crate::contact::problem::ContactProblem;
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Outcome, Progress, Start, differing};
use crate::contact::tolerances;

/// Who follows the path of one load.
pub(super) struct Follower<'a> {
    pub problem: &'a ContactProblem,
    pub load: &'a PathLoad<'a>,
    /// How the equations of its contact sets are solved.
    how: OnSet,
    watch: &'a mut dyn FnMut(Progress) -> bool,
    /// Whether whoever watches wanted no more.
    pub interrupted: bool,
    lines: usize,
}

impl<'a> Follower<'a> {
    /// Whether to go on.
    pub fn goes_on(&mut self, now: Progress) -> bool {
        self.interrupted = self.interrupted || !(self.watch)(now);
        !self.interrupted
    }

    /// The solution at one t, beginning with another if there is one.
    pub fn solution(&mut self, t: f64, near: Option<&ContactSolution>) -> Result<ContactSolution, FactorError> {
        let PathLoad { held_value, proximal, .. } = *self.load;
        let (problem, load) = (self.problem, self.load.at(t));
        let own = self.how.own.take();
        let start = near.map(|near| Start { solution: near, factored: own.as_ref(), reference: None });
        let mut watch = |now| self.goes_on(now);
        let found = if proximal {
            problem.solve_by_proximal_steps(&load, held_value, tolerances::proximal::COMPLIANCE, None, &mut watch)
        } else {
            problem.solve_from(&load, held_value, None, start.as_ref(), &mut watch)
        };
        self.how.own = own;
        found
    }

    /// The line on a contact set; `None` where that leaves the plate free.
    pub fn line(
        &mut self,
        closed: &[bool],
        at: [f64; 2],
        start: Option<&ContactSolution>,
    ) -> Result<Option<Line>, FactorError> {
        match self.solution_on(closed, at, 0, start)? {
            Some(from) => self.line_from(from, at),
            None => Ok(None),
        }
    }

    /// The line on the contact set of a solution, which holds at the first of two t.
    pub fn line_from(&mut self, from: ContactSolution, at: [f64; 2]) -> Result<Option<Line>, FactorError> {
        let Some(to) = self.solution_on(&from.closed, at, 1, Some(&from))? else { return Ok(None) };
        let loads = at.map(|t| self.load.at(t));
        // A load that hardly presses on the points says nothing of what they do, nor a plate that cannot deflect.
        let counts = |force: f64| match force {
            0.0 => self.problem.scale.largest(&loads[1]),
            force => force.max(tolerances::path::UNSEEN * self.size(at[0])),
        };
        let force = counts(f64::max(largest(&from.reaction), largest(&to.reaction)));
        let least = loads.iter().map(|load| self.problem.least_length(load)).fold(0.0, f64::max);
        let ends = [from, to];
        let deflection = ends.iter().flat_map(|end| end.displacement.hi.iter().step_by(3));
        let deflection = deflection.fold(least, |most, w| most.max(w.abs()));
        let lengths: Vec<f64> = self.lengths(&ends[0]).into_iter().map(|length| length.max(deflection)).collect();
        let forces = self.forces(force, &lengths);
        Ok(Some(Line { at, ends, forces, lengths, deflection }))
    }

    /// The solution with another contact set, if it stands on that too: points that differ neither press nor part.
    pub fn standing_on(&self, solution: &ContactSolution, set: &[bool]) -> Option<ContactSolution> {
        let lengths = self.lengths(solution);
        let forces = self.forces(largest(&solution.reaction), &lengths);
        let idle = |&i: &usize| {
            let nothing = tolerances::path::NOTHING;
            solution.reaction[i].abs() <= nothing * forces[i] && solution.gap[i].abs() <= nothing * lengths[i]
        };
        let differing = differing(&solution.closed, set);
        differing.iter().all(idle).then(|| {
            let mut same = ContactSolution { closed: set.to_vec(), ..solution.clone() };
            for i in differing {
                (same.reaction[i], same.gap[i]) = (0.0, 0.0);
            }
            same
        })
    }

    /// Largest part of the load where the two that it is made of do not cancel, and both count.
    fn size(&self, t: f64) -> f64 {
        let [start, add] = self.parts();
        start + self.span(t) * add
    }

    /// A step of t that changes the load about as much as there is of it; where there is none, a unit of what is added.
    pub fn span(&self, t: f64) -> f64 {
        let [start, add] = self.parts();
        let there = start / add;
        if there > 0.0 && there.is_finite() {
            there.max(t)
        } else if t > tolerances::path::NO_LOAD {
            t
        } else {
            1.0
        }
    }

    /// From no load, a unit of t in which the plate moves by about its least gap, a power of two; 1 if that is not far
    /// below it, and where nothing tells.
    fn unit(&mut self, rest: &ContactSolution) -> Result<f64, FactorError> {
        if self.parts()[0] != 0.0 {
            return Ok(1.0);
        }
        // On bases that have moved, points in contact have gaps of rounding.
        let least = tolerances::path::SIGN * travel(&self.problem.at_rest(self.load.held_value), rest);
        let gap = self.one_sided().map(|i| rest.gap[i]).filter(|&gap| gap > least).fold(f64::INFINITY, f64::min);
        if gap.is_infinite() {
            return Ok(1.0);
        }
        let far = f64::min(1.0, 0.5 * self.load.end);
        let moved = match self.line(&rest.closed, [0.0, far], Some(rest))? {
            Some(line) => line.travel(0.0, far),
            // How far a plate that floats at first falls does not go with its load; how it bends then does.
            None => {
                let half = self.solution(0.5 * far, Some(rest))?;
                if half.outcome != Outcome::Solved {
                    return Ok(1.0);
                }
                let whole = self.solution(far, Some(&half))?;
                if whole.outcome == Outcome::Solved { 2.0 * travel(&half, &whole) } else { 0.0 }
            }
        };
        let unit = gap * far / moved;
        Ok(if unit > 0.0 && unit < tolerances::path::FAR_BELOW { unit.log2().floor().exp2() } else { 1.0 })
    }

    /// Sizes of the load that is there and of the one that is added.
    fn parts(&self) -> [f64; 2] {
        [self.load.start, self.load.add].map(|load| self.problem.scale.largest(load))
    }

    /// What the gap of every point is measured by, in the caller's order.
    fn lengths(&self, solution: &ContactSolution) -> Vec<f64> {
        self.problem.in_order(&self.problem.lengths(solution))
    }

    /// What the reaction of every point is measured by, in the caller's order: the largest, or, of a spring too soft for
    /// that, what presses it by its length. Its gap and its reaction then tell alike when it opens and closes.
    fn forces(&self, force: f64, lengths: &[f64]) -> Vec<f64> {
        let (constraints, active) = (&self.problem.constraints, &self.problem.active);
        let compliance = self.problem.in_order(&[&constraints.compliance[..], &active.compliance].concat());
        let of = |(length, compliance): (&f64, f64)| if *length > 0.0 { force.min(length / compliance) } else { force };
        lengths.iter().zip(compliance).map(of).collect()
    }

    /// The solution on a set at one end of a line.
    fn solution_on(
        &mut self,
        closed: &[bool],
        at: [f64; 2],
        end: usize,
        start: Option<&ContactSolution>,
    ) -> Result<Option<ContactSolution>, FactorError> {
        self.lines += 1;
        if !self.goes_on(Progress { step: self.lines, changing: 0, residual: 0.0 }) {
            return Ok(None);
        }
        let loads = at.map(|t| self.load.at(t));
        let scale = &self.problem.scale;
        self.how.least = f64::max(scale.largest(&loads[0]), scale.largest(&loads[1]));
        let found = self.problem.solve_on_set(&loads[end], self.load.held_value, closed, start, &mut self.how)?;
        Ok((found.outcome == Outcome::Solved).then_some(found))
    }

    /// Ends the path on its last line: at the t asked for, or where there is none, at `far`.
    pub fn end_on(&self, line: &Line, far: f64, trail: &mut Trail) -> PathEnd {
        let (last, end) = match self.load.end.is_finite() {
            true => (self.load.end, PathEnd::Reached),
            false => (far, PathEnd::Unbounded),
        };
        trail.end(last, Some(&line.at(last)), end)
    }

    /// Contact points that may open, in the caller's order.
    pub fn one_sided(&self) -> impl Iterator<Item = usize> + use<'a> {
        let problem = self.problem;
        let condensed = problem.order.condensed.iter().zip(&problem.constraints.two_sided);
        let of_lcp = condensed.filter(|(_, two_sided)| !**two_sided).map(|(&i, _)| i);
        of_lcp.chain(problem.order.active.iter().copied())
    }
}

impl ContactProblem {
    /// Follows the path, and shows every stop on it to `visit`, which may end it by returning false, as `watch` may between
    /// them, which sees the steps of all solves.
    ///
    /// The first stop is the solution at t = 0; if there is none, `visit` is not called.
    pub fn path(
        &self,
        load: &PathLoad,
        visit: &mut dyn FnMut(Stop) -> bool,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<PathEnd, FactorError> {
        let how = OnSet { uncondensed: load.proximal, ..OnSet::default() };
        let (add, counted);
        let mut follower = Follower { problem: self, load, how, watch, interrupted: false, lines: 0 };
        let first = follower.solution(0.0, None)?;
        let end = match first.outcome {
            Outcome::Solved => {
                let unit = follower.unit(&first)?;
                add = load.add.iter().map(|force| unit * force).collect::<Vec<f64>>();
                counted = PathLoad { add: &add, end: load.end / unit, ..*load };
                follower.load = &counted;
                follower.follow(first, &mut |stop| visit(Stop { t: unit * stop.t, ..stop }))?
            }
            Outcome::NoEquilibrium => PathEnd::NoEquilibrium,
            _ => PathEnd::Unsolved,
        };
        Ok(if follower.interrupted { PathEnd::Interrupted } else { end })
    }
}

impl Follower<'_> {
    fn follow(&mut self, first: ContactSolution, visit: &mut dyn FnMut(Stop) -> bool) -> Result<PathEnd, FactorError> {
        if self.interrupted {
            return Ok(PathEnd::Interrupted);
        }
        let mut trail = Trail::new(first, visit);
        if self.load.end <= 0.0 {
            return Ok(trail.end(0.0, None, PathEnd::Reached));
        }
        if self.problem.active.is_empty() && !self.load.proximal {
            self.pivot_along(&mut trail)
        } else {
            self.step_along(0.0, &mut trail)
        }
    }
}
