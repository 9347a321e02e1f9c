//! The path tracer: it computes one line of the path after another and calls the callbacks.

use super::line::{Line, Scales, travel};
use super::load::{PathEnd, PathLoad, Stop};
use super::recorder::PathRecorder;
use crate::contact::backend::Backend;
use crate::contact::error::SolveError;
use crate::contact::fixed_state::{kkt, solve_on};
use crate::contact::kkt::Kkt;
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{least_length, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Progress, Watch, differing};
use crate::contact::solve::Settings;
use crate::contact::tolerances;

/// Tracer of the path of solutions under one load f₀ + t f₁.
pub(super) struct PathTracer<'a> {
    pub problem: &'a ContactProblem,
    pub load: &'a PathLoad<'a>,
    /// Solver of fixed contact states, which keeps its last factor.
    kkt: Box<dyn Kkt + 'a>,
    watch: &'a mut Watch<'a>,
    /// Whether the callback cancelled the path.
    pub interrupted: bool,
    lines: usize,
}

impl<'a> PathTracer<'a> {
    /// Calls the callback `watch`; returns false if `watch` has cancelled the path.
    pub fn goes_on(&mut self, now: Progress) -> bool {
        self.interrupted = self.interrupted || !(self.watch)(now);
        !self.interrupted
    }

    /// The solution at the load factor t, or `None` without a solution. The solve starts from the solution `near`, if
    /// present.
    pub fn solution(&mut self, t: f64, near: Option<&ContactSolution>) -> Result<Option<ContactSolution>, SolveError> {
        some(self.solved(t, near))
    }

    fn solved(&mut self, t: f64, near: Option<&ContactSolution>) -> Result<ContactSolution, SolveError> {
        let (problem, nodal) = (self.problem, self.load.at(t));
        let load = Load { nodal: &nodal, held_value: self.load.held_value };
        problem.solve(&load, &Settings::default(), near, &mut |now| self.goes_on(now))
    }

    /// The line through the solutions on the contact state `pieces` at two values of t. `None` if the contact state
    /// leaves a rigid motion free.
    pub fn line(
        &mut self,
        pieces: &[u8],
        at: [f64; 2],
        start: Option<&ContactSolution>,
    ) -> Result<Option<Line<'a>>, SolveError> {
        match self.solution_on(pieces, at, 0, start)? {
            Some(from) => self.line_from(from, at),
            None => Ok(None),
        }
    }

    /// The line through `from`, the solution at the first of two values of t, on the contact state of `from`.
    pub fn line_from(&mut self, from: ContactSolution, at: [f64; 2]) -> Result<Option<Line<'a>>, SolveError> {
        let Some(to) = self.solution_on(&from.piece, at, 1, Some(&from))? else { return Ok(None) };
        let loads = at.map(|t| self.load.at(t));
        // Reference sizes have lower bounds: a load may cause hardly any reactions, and a plate may hardly deflect.
        let counts = |force: f64| match force {
            0.0 => self.problem.scale.largest(&loads[1]),
            force => force.max(tolerances::path::UNSEEN * self.size(at[0])),
        };
        let force = counts(f64::max(largest(&from.reaction), largest(&to.reaction)));
        let least = loads.iter().map(|load| least_length(self.problem, load)).fold(0.0, f64::max);
        let ends = [from, to];
        let deflection = ends.iter().flat_map(|end| end.displacement.hi.iter().step_by(3));
        let deflection = deflection.fold(least, |most, w| most.max(w.abs()));
        let lengths: Vec<f64> =
            lengths(self.problem, &ends[0]).into_iter().map(|length| length.max(deflection)).collect();
        let scales = self.scales(force, lengths);
        Ok(Some(Line { points: &self.problem.points, at, ends, scales, deflection }))
    }

    /// The solution with the same displacements on the contact state `pieces`. `None` unless every point that changes
    /// its piece is at the common end of its old and its new piece of the law.
    pub fn standing_on(&self, solution: &ContactSolution, pieces: &[u8]) -> Option<ContactSolution> {
        let points = &self.problem.points;
        let scales = self.scales(largest(&solution.reaction), lengths(self.problem, solution));
        let differing = differing(&solution.piece, pieces);
        let mut same = ContactSolution { piece: pieces.to_vec(), ..solution.clone() };
        for i in differing {
            let (from, to) = (solution.piece[i], pieces[i]);
            if from.abs_diff(to) != 1 {
                return None;
            }
            let [travel, force] = points.ends(i, from)[usize::from(to > from)]?;
            let inside = points.signed_distance(i, solution.state(i), to > from)?;
            if !(inside.abs() <= tolerances::path::NOTHING * scales.of(points, i, from)) {
                return None;
            }
            same.reaction[i] = force;
            let new = points.piece(i, to);
            same.gap[i] = if new.holds() { 0.0 } else { new.travel - travel };
        }
        Some(same)
    }

    /// Reference force of the load at t: the largest nodal force of f₀ plus a step of t (`span`) times the largest
    /// nodal force of f₁.
    fn size(&self, t: f64) -> f64 {
        let [start, add] = self.parts();
        start + self.span(t) * add
    }

    /// A step of t that changes the load by about its own size; 1 if the load is zero.
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

    /// Unit of t for a path that starts without load: a power of two at which the plate moves by about its least gap.
    /// The unit is 1 if this power is not far below 1.
    fn unit(&mut self, rest: &ContactSolution) -> Result<f64, SolveError> {
        if self.parts()[0] != 0.0 {
            return Ok(1.0);
        }
        // If prescribed displacements of springs or held dofs move the plate, rounding gives points in contact gaps of
        // up to `least`.
        let at_rest = self.problem.at_rest(self.load.held_value);
        let least = tolerances::path::SIGN * travel(&at_rest, rest);
        let gap = rest.gap.iter().copied().filter(|&gap| gap > least).fold(f64::INFINITY, f64::min);
        if gap.is_infinite() {
            return Ok(1.0);
        }
        let far = f64::min(1.0, 0.5 * self.load.end);
        let moved = match self.line(&rest.piece, [0.0, far], Some(rest))? {
            Some(line) => line.travel(0.0, far),
            // If a plate has a free rigid motion, its motion until contact is not proportional to the load. Its
            // displacement from half the load to the whole load is.
            None => {
                let Some(half) = self.solution(0.5 * far, Some(rest))? else { return Ok(1.0) };
                let whole = self.solution(far, Some(&half))?;
                whole.map_or(0.0, |whole| 2.0 * travel(&half, &whole))
            }
        };
        let unit = gap * far / moved;
        Ok(if unit > 0.0 && unit < tolerances::path::FAR_BELOW { unit.log2().floor().exp2() } else { 1.0 })
    }

    /// Largest nodal force of f₀, and of f₁; nodal couples are divided by the element size.
    fn parts(&self) -> [f64; 2] {
        [self.load.start, self.load.add].map(|load| self.problem.scale.largest(load))
    }

    /// Reference sizes of the points. The reference force is `force`, or for a soft spring its reference travel divided
    /// by its compliance, if that is smaller. Travel and reaction then have equal weight where a point changes its
    /// piece of the law.
    fn scales(&self, force: f64, travel: Vec<f64>) -> Scales {
        let of = |(i, length): (usize, &f64)| match self.problem.points.steepest(i).compliance() {
            compliance if *length > 0.0 => force.min(length / compliance),
            _ => force,
        };
        Scales { force: travel.iter().enumerate().map(of).collect(), travel }
    }

    /// The solution on the contact state `pieces` at the load factor `at[end]`; `end` is 0 or 1.
    fn solution_on(
        &mut self,
        pieces: &[u8],
        at: [f64; 2],
        end: usize,
        start: Option<&ContactSolution>,
    ) -> Result<Option<ContactSolution>, SolveError> {
        self.lines += 1;
        if !self.goes_on(Progress { step: self.lines, changing: 0, residual: 0.0 }) {
            return Ok(None);
        }
        let loads = at.map(|t| self.load.at(t));
        let scale = &self.problem.scale;
        let least = f64::max(scale.largest(&loads[0]), scale.largest(&loads[1]));
        let Self { problem, kkt, load, .. } = self;
        let load = Load { nodal: &loads[end], held_value: load.held_value };
        some(solve_on(problem, &mut **kkt, &load, pieces, start, least))
    }

    /// Ends the path on its last line, at the requested largest t if this is finite, otherwise at t = `far`.
    pub fn end_on(&self, line: &Line<'_>, far: f64, recorder: &mut PathRecorder) -> PathEnd {
        let (last, end) = match self.load.end.is_finite() {
            true => (self.load.end, PathEnd::Reached),
            false => (far, PathEnd::Unbounded),
        };
        recorder.end(last, Some(&line.at(last)), end)
    }
}

impl ContactProblem {
    /// Traces the path and calls `visit` at every stop; if `visit` returns false, the path ends. `watch` is called at
    /// every step of a solve and may cancel the path.
    ///
    /// The first stop is the solution at t = 0. Without a solution at t = 0, `visit` is not called.
    pub fn path(
        &self,
        load: &PathLoad,
        visit: &mut dyn FnMut(Stop) -> bool,
        watch: &mut Watch<'_>,
    ) -> Result<PathEnd, SolveError> {
        load.require_lengths(self)?;
        let (add, counted);
        let mut watch = watch;
        let mut tracer =
            PathTracer { problem: self, load, kkt: kkt(self), watch: &mut watch, interrupted: false, lines: 0 };
        let end = match tracer.solved(0.0, None) {
            Ok(first) => {
                let unit = tracer.unit(&first)?;
                add = load.add.iter().map(|force| unit * force).collect::<Vec<f64>>();
                counted = PathLoad { add: &add, end: load.end / unit, ..*load };
                tracer.load = &counted;
                tracer.follow(first, &mut |stop| visit(Stop { t: unit * stop.t, ..stop }))?
            }
            Err(SolveError::NoEquilibrium) => PathEnd::NoEquilibrium,
            Err(SolveError::Unsolved) => PathEnd::Unsolved,
            Err(SolveError::Cancelled) => PathEnd::Interrupted,
            Err(error) => return Err(error),
        };
        Ok(if tracer.interrupted { PathEnd::Interrupted } else { end })
    }
}

/// The solution, or `None` if the solve found no solution or was cancelled. Other errors are returned.
fn some(solved: Result<ContactSolution, SolveError>) -> Result<Option<ContactSolution>, SolveError> {
    match solved {
        Ok(solution) => Ok(Some(solution)),
        Err(SolveError::NoEquilibrium | SolveError::Unsolved | SolveError::Cancelled) => Ok(None),
        Err(error) => Err(error),
    }
}

impl PathTracer<'_> {
    fn follow(&mut self, first: ContactSolution, visit: &mut dyn FnMut(Stop) -> bool) -> Result<PathEnd, SolveError> {
        if self.interrupted {
            return Ok(PathEnd::Interrupted);
        }
        let mut recorder = PathRecorder::new(first, visit);
        if self.load.end <= 0.0 {
            return Ok(recorder.end(0.0, None, PathEnd::Reached));
        }
        match &self.problem.backend {
            Backend::Condensed { interface, .. } => self.pivot_along(interface, &mut recorder),
            Backend::Penalised(_) | Backend::SaddlePoint(_) => self.step_along(0.0, &mut recorder),
        }
    }
}
