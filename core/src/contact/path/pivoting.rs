//! From basis to basis of the condensed points' LCP.

use super::line::{Line, standing_on};
use super::load::{PathEnd, PathLoad};
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::condense::{Form, InterfaceResidual};
use crate::contact::kkt::{OnSet, Residual};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::differing;
use crate::contact::tolerances;
use crate::lcp::{Lcp, ParametricEnd, ParametricPath, parametric};

/// The bases of the LCP along a path, and the contact set of each.
type Pivoted = (ParametricPath, Vec<Vec<bool>>);

impl ContactProblem {
    /// As [`ContactProblem::path`], from the solution at t = 0 on. Where rounding stops the pivots it goes on in steps.
    pub(super) fn pivot_along(&self, load: &PathLoad, trail: &mut Trail) -> Result<PathEnd, FactorError> {
        let Some((found, sets)) = self.pivoted(load, &trail.here().closed)? else {
            return self.step_along(load, 0.0, trail);
        };
        let mut how = OnSet::default();
        let mut t = 0.0;
        for (k, segment) in found.segments.iter().enumerate() {
            let far = match segment.to.min(load.end.max(segment.from)) {
                far if far.is_finite() => far,
                _ => segment.from + load.span(segment.from),
            };
            let line = match standing_on(trail.here(), &sets[k]) {
                Some(from) if far > t => self.line_from(load, from, [t, far], &mut how)?,
                _ => self.line(load, &sets[k], [segment.from, far], None, &mut how)?,
            };
            let next = sets.get(k + 1);
            let to = line.as_ref().map_or(far, |line| {
                let leaving = next.map_or(Vec::new(), |next| differing(next, &sets[k]));
                line.root(&leaving).unwrap_or(far).max(t)
            });
            if next.is_some()
                && line.as_ref().is_some_and(|line| line.travel(t, to) <= tolerances::path::SAME_PLACE * line.length)
            {
                continue;
            }
            // An event that rounding alone brings is none, nor are those that pivots find beyond it.
            let real =
                |line: &Line| next.is_none_or(|next| differing(next, &sets[k]).into_iter().any(|i| line.fall(i) > 0.0));
            let Some(line) = line.filter(|line| real(line) && self.signs_hold_on(line, t, to.min(load.end))) else {
                return self.step_along(load, t, trail);
            };
            if !trail.leave(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            t = to;
            if segment.to.is_infinite() {
                let (last, end) = match load.end.is_finite() {
                    true => (load.end, PathEnd::Reached),
                    false => (t, PathEnd::Unbounded),
                };
                return Ok(trail.end(last, &line.at(last), end));
            }
            if t >= load.end {
                return Ok(trail.end(load.end, &line.at(load.end), PathEnd::Reached));
            }
            trail.arrive(&line, t);
        }
        let end = self.step_along(load, t, trail)?;
        let infeasible = found.end == ParametricEnd::Infeasible && end == PathEnd::Unsolved;
        Ok(if infeasible { PathEnd::NoEquilibrium } else { end })
    }

    /// The bases of the LCP along the path, and the contact set of each.
    fn pivoted(&self, load: &PathLoad, closed: &[bool]) -> Result<Option<Pivoted>, FactorError> {
        let condensed = &self.base.condensed;
        let form = condensed.better_form();
        let rest = self.at_rest(load.held_value);
        let posed = condensed.lcp(form, &self.interface(&self.residual(load.start, &rest), form)?, &rest.reaction);
        let rate = self.without_travel(load.add, &vec![0.0; load.add.len()]);
        let along = condensed.lcp(form, &self.interface(&rate, form)?, &rest.reaction).q;
        let basis = condensed.basis(&posed, closed);
        let solved = Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| parametric(&lcp, &along, &basis, load.end));
        let Ok(found) = solved else { return Ok(None) };
        let sets = found.segments.iter().map(|segment| condensed.closed_points(&posed, &segment.basis)).collect();
        Ok(Some((found, sets)))
    }

    fn interface(&self, step: &Residual, form: Form) -> Result<InterfaceResidual, FactorError> {
        Ok(self.reduced(&self.base, step, form)?.interface)
    }

    /// A load by itself: no gaps, nothing held elsewhere than at zero.
    fn without_travel(&self, load: &[f64], still: &[f64]) -> Residual {
        let rest = self.at_rest(still);
        let mut imbalance = load.to_vec();
        self.release_held(&mut imbalance);
        let step = self.residual_of(imbalance, load, &rest);
        Residual { remaining: vec![0.0; rest.reaction.len()], ..step }
    }
}
