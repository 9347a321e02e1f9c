//! From basis to basis of the condensed points' LCP.

use super::follower::Follower;
use super::line::Line;
use super::load::PathEnd;
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::finders::{in_memory, posed_from};
use crate::contact::interface::{AtPoints, Work};
use crate::contact::residual::Residual;
use crate::contact::solution::Progress;
use crate::contact::tolerances;
use crate::lcp::{Lcp, ParametricEnd, ParametricPath, parametric};

/// The bases of the LCP along a path, and the pieces of each.
type Pivoted = (ParametricPath, Vec<Vec<u8>>);

impl Follower<'_> {
    /// As [`ContactProblem::path`], from the solution at t = 0 on. Where rounding stops the pivots it goes on in steps.
    pub(super) fn pivot_along(&mut self, trail: &mut Trail) -> Result<PathEnd, FactorError> {
        let load = self.load;
        let Some((result, sets)) = self.pivoted(&trail.here().piece)? else {
            return self.step_along(0.0, trail);
        };
        let mut t = 0.0;
        for (k, segment) in result.segments.iter().enumerate() {
            let far = match segment.to.min(load.end.max(segment.from)) {
                far if far.is_finite() => far,
                _ => segment.from + self.span(segment.from),
            };
            // What changes on a short line is rounding; on a longer one it is told.
            let (span, reach) = (self.span(t), |from: f64| far.max(from + tolerances::path::SHORT * self.span(from)));
            let line = match self.standing_on(trail.here(), &sets[k]) {
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
            // An event that rounding alone brings is none, nor are those that pivots find beyond it.
            let real = |line: &Line<'_>| {
                next.is_none_or(|next| line.crossed(next).into_iter().any(|border| line.fall(border) > 0.0))
            };
            let Some(line) = line.filter(|line| real(line) && line.signs_hold(t, to.min(load.end))) else {
                return self.step_along(t, trail);
            };
            if !trail.leave(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            t = to;
            if segment.to.is_infinite() || t >= load.end {
                return Ok(self.end_on(&line, t, trail));
            }
            trail.arrive(&line, t);
        }
        let end = self.step_along(t, trail)?;
        let infeasible = result.end == ParametricEnd::Infeasible && end == PathEnd::Unsolved;
        Ok(if infeasible { PathEnd::NoEquilibrium } else { end })
    }

    /// The bases of the LCP along the path, and the pieces of each.
    fn pivoted(&mut self, pieces: &[u8]) -> Result<Option<Pivoted>, FactorError> {
        let (problem, load) = (self.problem, self.load);
        let interface = problem.interface();
        let form = interface.better_form();
        let rest = problem.at_rest(load.held_value);
        let first = posed_from(problem, load.start, form, &rest)?;
        // What is added, by itself: no gaps, nothing held elsewhere than at zero.
        let mut imbalance = load.add.to_vec();
        problem.release_held(&mut imbalance);
        let added = Residual { imbalance, violation: vec![0.0; pieces.len()], worst: 0.0 };
        let at_points: [AtPoints; 2] = [first.at_points, problem.reduced(&added, form)?.at_points];
        let (mut begin, mut along) = interface.posed(&problem.points, form, &at_points, &rest.reaction)?;
        let motions = interface.impose_motions(&problem.points, &mut begin)?;
        motions.balance(&mut begin.q, &at_points[0], &Work::of(&problem.free_motions, load.start));
        motions.balance_increment(&mut along[0], &at_points[1], &Work::of(&problem.free_motions, load.add));
        let basis = begin.basis(pieces);
        let mut watch = |step| self.goes_on(Progress { step, changing: 0, residual: 0.0 });
        let solved =
            Lcp::new(&begin.matrix, &begin.q).and_then(|lcp| parametric(&lcp, &along[0], &basis, load.end, &mut watch));
        Ok(in_memory(solved)?.map(|path| {
            let sets = path.segments.iter().map(|segment| begin.pieces(&segment.basis)).collect();
            (path, sets)
        }))
    }
}
