//! From basis to basis of the condensed points' LCP.

use super::follower::Follower;
use super::line::Line;
use super::load::PathEnd;
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::lcp::in_memory;
use crate::contact::solution::{Progress, differing};
use crate::contact::tolerances;
use crate::lcp::{Lcp, ParametricEnd, ParametricPath, parametric};

/// The bases of the LCP along a path, and the contact set of each.
type Pivoted = (ParametricPath, Vec<Vec<bool>>);

impl Follower<'_> {
    /// As [`ContactProblem::path`], from the solution at t = 0 on. Where rounding stops the pivots it goes on in steps.
    pub(super) fn pivot_along(&mut self, trail: &mut Trail) -> Result<PathEnd, FactorError> {
        let load = self.load;
        let Some((found, sets)) = self.pivoted(&trail.here().closed)? else {
            return self.step_along(0.0, trail);
        };
        let mut t = 0.0;
        for (k, segment) in found.segments.iter().enumerate() {
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
                let leaving = next.map_or(Vec::new(), |next| differing(next, &sets[k]));
                let within = tolerances::path::MOVED * (far - t) + tolerances::path::SEEN * span;
                line.root(&leaving, far, within).unwrap_or(far).max(t)
            });
            let stays = |line: &Line| line.travel(t, to) <= tolerances::path::SAME_PLACE * line.deflection;
            if segment.to < load.end && line.as_ref().is_some_and(stays) {
                continue;
            }
            // An event that rounding alone brings is none, nor are those that pivots find beyond it.
            let real =
                |line: &Line| next.is_none_or(|next| differing(next, &sets[k]).into_iter().any(|i| line.fall(i) > 0.0));
            let Some(line) = line.filter(|line| real(line) && line.signs_hold(self.one_sided(), t, to.min(load.end)))
            else {
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
        let infeasible = found.end == ParametricEnd::Infeasible && end == PathEnd::Unsolved;
        Ok(if infeasible { PathEnd::NoEquilibrium } else { end })
    }

    /// The bases of the LCP along the path, and the contact set of each.
    fn pivoted(&mut self, closed: &[bool]) -> Result<Option<Pivoted>, FactorError> {
        let (problem, load) = (self.problem, self.load);
        let condensed = &problem.base.condensed;
        let form = condensed.better_form();
        let rest = problem.at_rest(load.held_value);
        let first = problem.residual(load.start, &rest);
        // What is added, by itself: no gaps, nothing held elsewhere than at zero.
        let mut added = load.add.to_vec();
        problem.release_held(&mut added);
        let still = vec![0.0; rest.reaction.len()];
        let reduced = |imbalance: &[f64], remaining: &[f64]| {
            Ok::<_, FactorError>(problem.reduced(&problem.base, imbalance, remaining, form)?.interface)
        };
        let interfaces = [reduced(&first.imbalance, &first.remaining)?, reduced(&added, &still)?];
        let (mut begin, mut along) = condensed.posed(form, &interfaces, &rest.reaction)?;
        let motions = condensed.impose_motions(&mut begin)?;
        motions.balance(&mut begin.q, &interfaces[0], &problem.work(load.start));
        motions.balance(&mut along[0], &interfaces[1], &problem.work(load.add));
        let basis = condensed.basis(&begin, closed);
        let mut watch = |step| self.goes_on(Progress { step, changing: 0, residual: 0.0 });
        let solved =
            Lcp::new(&begin.matrix, &begin.q).and_then(|lcp| parametric(&lcp, &along[0], &basis, load.end, &mut watch));
        Ok(in_memory(solved)?.map(|found| {
            let sets = found.segments.iter().map(|segment| condensed.closed_points(&begin, &segment.basis)).collect();
            (found, sets)
        }))
    }
}
