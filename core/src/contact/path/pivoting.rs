//! Path tracing by parametric pivoting of the LCP of condensed points.

use super::line::Line;
use super::load::PathEnd;
use super::recorder::PathRecorder;
use super::tracer::PathTracer;
use crate::contact::error::SolveError;
use crate::contact::finders::posed_from;
use crate::contact::interface::{Interface, Work};
use crate::contact::residual::Residual;
use crate::contact::solution::Progress;
use crate::contact::tolerances;
use crate::lcp::{Lcp, ParametricEnd, ParametricPath, parametric};

/// Segments of a path with the basis of the LCP on each, and the contact state of each basis.
type Pivoted = (ParametricPath, Vec<Vec<u8>>);

impl PathTracer<'_> {
    /// Traces the path from the solution at t = 0. If rounding stops the pivoting, the path is traced on from event to
    /// event.
    pub(super) fn pivot_along(
        &mut self,
        interface: &Interface,
        recorder: &mut PathRecorder,
    ) -> Result<PathEnd, SolveError> {
        let load = self.load;
        let (result, sets) = match self.pivoted(interface, &recorder.here().piece) {
            Err(SolveError::Unsolved) => return self.step_along(0.0, recorder),
            pivoted => pivoted?,
        };
        let mut t = 0.0;
        for (k, segment) in result.segments.iter().enumerate() {
            let far = match segment.to.min(load.end.max(segment.from)) {
                far if far.is_finite() => far,
                _ => segment.from + self.span(segment.from),
            };
            // The change between solutions at nearly equal t would be rounding. So the two solutions of a line are at
            // least `SHORT` times a step of t (`span`) apart.
            let (span, reach) = (self.span(t), |from: f64| far.max(from + tolerances::path::SHORT * self.span(from)));
            let line = match self.standing_on(recorder.here(), &sets[k]) {
                Some(from) if far > t => self.line_from(from, [t, reach(t)])?,
                _ => self.line(&sets[k], [segment.from, reach(segment.from)], None)?,
            };
            let next = sets.get(k + 1);
            let to = line.as_ref().map_or(far, |line| {
                let leaving = next.map_or(Vec::new(), |next| line.crossed(next));
                let within = tolerances::path::MOVED * (far - t) + tolerances::path::SEEN * span;
                line.root(&leaving, far, within).unwrap_or(far).max(t)
            });
            let stays = |line: &Line<'_>| line.travel(t, to) <= tolerances::path::SAME_PLACE * line.deflection;
            if segment.to < load.end && line.as_ref().is_some_and(stays) {
                continue;
            }
            // If no point approaches an end of its piece of the law, the basis changed because of rounding, and there
            // is no event.
            let real = |line: &Line<'_>| {
                next.is_none_or(|next| line.crossed(next).into_iter().any(|breakpoint| line.fall(breakpoint) > 0.0))
            };
            let Some(line) = line.filter(|line| real(line) && line.signs_are_feasible(t, to.min(load.end))) else {
                return self.step_along(t, recorder);
            };
            if !recorder.emit(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            t = to;
            if segment.to.is_infinite() || t >= load.end {
                return Ok(self.end_on(&line, t, recorder));
            }
            recorder.arrive(&line, t);
        }
        let end = self.step_along(t, recorder)?;
        let infeasible = result.end == ParametricEnd::Infeasible && end == PathEnd::Unsolved;
        Ok(if infeasible { PathEnd::NoEquilibrium } else { end })
    }

    /// Pivots the LCP along the path. Returns its segments with their bases, and the contact state of each basis.
    fn pivoted(&mut self, interface: &Interface, pieces: &[u8]) -> Result<Pivoted, SolveError> {
        let (problem, load) = (self.problem, self.load);
        let form = interface.better_form();
        let rest = problem.at_rest(load.held_value);
        let first = posed_from(problem, interface, load.start, form, &rest)?;
        // Residual of the added load f₁ alone, without gaps and prescribed values.
        let mut imbalance = load.add.to_vec();
        problem.release_held(&mut imbalance);
        let added = Residual { imbalance, violation: vec![0.0; pieces.len()], worst: 0.0 };
        let added = problem.reduced(interface, &added, form)?.rhs;
        let template = problem.lcp_template(form)?;
        let work = Work::of(&interface.free_motions, load.start);
        let q = template.balanced_q(interface, &problem.points, &first.rhs, &work, &rest.reaction)?;
        let mut along = template.increment(interface, &added)?;
        template.balance_increment(&mut along, &added, &Work::of(&interface.free_motions, load.add));
        let basis = template.vertices.basis(pieces);
        let mut watch = |step| self.goes_on(Progress { step, changing: 0, residual: 0.0 });
        let lcp = Lcp::new(&template.matrix, &q)?;
        let path = parametric(&lcp, &along, &basis, load.end, &mut watch)?;
        let sets = path.segments.iter().map(|segment| template.vertices.pieces(&segment.basis)).collect();
        Ok((path, sets))
    }
}
