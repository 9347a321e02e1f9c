//! From event to event on the sparse K.

use super::follower::Follower;
use super::line::Line;
use super::load::{MOST_EVENTS, PathEnd};
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::solution::{ContactSolution, Outcome};
use crate::contact::tolerances;

/// Times that points which move the wrong way from an event on are switched.
const ROUNDS: usize = 20;

/// Times that a line without events is lengthened.
const LENGTHENED: usize = 2;

impl Follower<'_> {
    /// As [`ContactProblem::path`], from some t on.
    pub(super) fn step_along(&mut self, mut t: f64, trail: &mut Trail) -> Result<PathEnd, FactorError> {
        let load = self.load;
        let mut closed = trail.here().closed.clone();
        // Sets on which the path got no further than where it is.
        let mut spent: Vec<Vec<bool>> = Vec::new();
        for _ in 0..=MOST_EVENTS {
            let Some(mut line) = self.leaving(t, &closed, trail.here())? else {
                return Ok(trail.end(t, None, PathEnd::Unsolved));
            };
            // A set that comes back would lead round for ever: rounding decides what closes.
            if spent.contains(&line.ends[0].closed) {
                return Ok(trail.end(t, None, PathEnd::Unsolved));
            }
            if !trail.leave(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            let (mut to, mut points) = self.next_event(&line, t);
            if to.is_infinite()
                && load.end.is_infinite()
                && let Some(longer) = self.until_it_counts(&line)?
            {
                line = longer;
                (to, points) = self.next_event(&line, t);
            }
            let reach = to.min(load.end);
            if reach > line.at[1] && reach.is_finite() {
                // Beyond its far end a line is less exact than up to it.
                if let Some(longer) = self.line_from(line.ends[0].clone(), [t, reach])? {
                    line = longer;
                    (to, points) = self.next_event(&line, t);
                }
            }
            if to >= load.end {
                return Ok(self.end_on(&line, line.at[1], trail));
            }
            trail.arrive(&line, to);
            closed.clone_from(&trail.here().closed);
            points.into_iter().for_each(|i| closed[i] = !closed[i]);
            if to - t > tolerances::path::SAME_EVENT * self.span(t) {
                spent.clear();
            } else {
                let [from, _] = line.ends;
                spent.push(from.closed);
            }
            t = to;
        }
        Ok(PathEnd::TooMany)
    }

    /// A line without events, so long that what is added moves the plate by as much as any gap, if it then has one.
    ///
    /// Beside little load, or far from a support, a first step may be too short to tell that a gap closes.
    fn until_it_counts(&mut self, line: &Line) -> Result<Option<Line>, FactorError> {
        let [t, mut far] = line.at;
        let gap = line.lengths.iter().fold(0.0, |most, &length| f64::max(most, length));
        let mut travel = line.travel(t, far);
        for _ in 0..LENGTHENED {
            if travel == 0.0 || travel >= tolerances::path::COUNTS * gap {
                break;
            }
            far = t + (far - t) * f64::min(gap / travel, tolerances::path::LONGER);
            let Some(longer) = self.line_from(line.ends[0].clone(), [t, far])? else { break };
            travel = longer.travel(t, far);
            if self.next_event(&longer, t).0.is_finite() {
                return Ok(Some(longer));
            }
        }
        Ok(None)
    }

    /// The line that leaves from t, beginning with a set that may be right.
    fn leaving(&mut self, t: f64, closed: &[bool], here: &ContactSolution) -> Result<Option<Line>, FactorError> {
        let span = self.span(t);
        let mut set = closed.to_vec();
        for _ in 0..ROUNDS {
            let at = [t, t + span];
            let line = match self.standing_on(here, &set) {
                Some(from) => self.line_from(from, at)?,
                None => self.line(&set, at, Some(here))?,
            };
            let Some(line) = line else {
                break;
            };
            match self.wrong(&line) {
                Some(points) if points.is_empty() => return Ok(Some(line)),
                Some(points) => points.into_iter().for_each(|i| set[i] = !set[i]),
                None => break,
            }
        }
        for part in tolerances::path::BEYOND {
            let near = self.solution(t + part * span, Some(here))?;
            if near.outcome != Outcome::Solved {
                continue;
            }
            if let Some(line) = self.line(&near.closed, [t, t + span], Some(&near))?
                && self.wrong(&line).is_some_and(|points| points.is_empty())
            {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// Points at zero where the line begins that leave it the wrong way; `None` if some are beyond zero there.
    fn wrong(&self, line: &Line) -> Option<Vec<usize>> {
        let mut points = Vec::new();
        for i in self.one_sided() {
            let (now, fall) = (line.value(0, i), line.fall(i));
            if now < -tolerances::path::SIGN {
                return None;
            }
            if fall > 0.0 && now <= tolerances::path::SAME_EVENT * fall {
                points.push(i);
            }
        }
        Some(points)
    }

    /// The next t at which reactions or gaps fall to zero, infinite if none ever does, and whose do.
    fn next_event(&self, line: &Line, from: f64) -> (f64, Vec<usize>) {
        let span = line.at[1] - line.at[0];
        let falls = |i: usize| (i, line.value(0, i), line.fall(i));
        let roots: Vec<(f64, usize)> = self
            .one_sided()
            .map(falls)
            .filter(|&(_, _, fall)| fall > 0.0)
            .map(|(i, now, fall)| (from + span * (now / fall).max(0.0), i))
            .collect();
        let first = roots.iter().map(|(t, _)| *t).fold(f64::INFINITY, f64::min);
        let together = |&&(t, _): &&(f64, usize)| t <= first + tolerances::path::SAME_EVENT * span;
        (first, roots.iter().filter(together).map(|&(_, i)| i).collect())
    }
}
