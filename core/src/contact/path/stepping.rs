//! From event to event on the sparse K.

use super::{Line, MOST_EVENTS, PathEnd, PathLoad, SIGN, Stop};
use crate::cholesky::FactorError;
use crate::contact::active_set::Start;
use crate::contact::problem::{ContactProblem, Factored};
use crate::contact::solution::{ContactSolution, Outcome};

/// Events nearer than this part of a step are one.
const SAME: f64 = 1e-9;
/// Reactions and gaps that fall by less over a step, over the largest of their kind, stay.
const STILL: f64 = 1e-10;
/// Times that points which move the wrong way from an event on are switched.
const ROUNDS: usize = 20;
/// How far beyond an event, over a step, a solve tells the contact set after it where switching does not.
const BEYOND: [f64; 3] = [1e-3, 1e-5, 1e-7];

impl ContactProblem {
    /// As [`ContactProblem::path`], from the solution at t = 0 on.
    pub(super) fn step_along(
        &self,
        load: &PathLoad,
        first: ContactSolution,
        visit: &mut dyn FnMut(Stop) -> bool,
    ) -> Result<PathEnd, FactorError> {
        let mut own = None;
        let (mut t, mut closed, mut here) = (0.0, first.closed.clone(), first);
        let mut switched: Vec<usize> = Vec::new();
        for event in 0..=MOST_EVENTS {
            let line = self.leaving(load, t, &closed, &here, &mut own)?;
            let set = line.as_ref().map_or(&closed, |line| &line.ends[0].closed);
            if event > 0 {
                switched = (0..set.len()).filter(|&i| set[i] != here.closed[i]).collect();
            }
            let set = set.clone();
            if event == 0
                && let Some(line) = &line
            {
                // A plate that touches nothing may rest anywhere; what counts is where the path leaves from.
                here = line.at(t);
            }
            here.closed = set;
            if !visit(Stop { t, switched: &switched, solution: &here }) {
                return Ok(PathEnd::Interrupted);
            }
            let Some(line) = line else {
                return Ok(PathEnd::Unsolved);
            };
            let (to, points) = self.next_event(&line, t);
            if to >= load.end {
                let ends = load.end.is_finite();
                let last = if ends { load.end } else { line.at[1] };
                let on = visit(Stop { t: last, switched: &[], solution: &line.at(last) });
                return Ok(match (on, ends) {
                    (false, _) => PathEnd::Interrupted,
                    (true, true) => PathEnd::Reached,
                    (true, false) => PathEnd::Unbounded,
                });
            }
            here = line.at(to);
            closed.clone_from(&here.closed);
            points.into_iter().for_each(|i| closed[i] = !closed[i]);
            t = to;
        }
        Ok(PathEnd::TooMany)
    }

    /// The line that leaves from t, beginning with a set that may be right.
    fn leaving(
        &self,
        load: &PathLoad,
        t: f64,
        closed: &[bool],
        here: &ContactSolution,
        own: &mut Option<Factored>,
    ) -> Result<Option<Line>, FactorError> {
        let span = load.span(t);
        let mut set = closed.to_vec();
        for _ in 0..ROUNDS {
            let Some(line) = self.line(load, &set, [t, t + span], Some(here), own)? else {
                break;
            };
            match self.wrong(&line) {
                Some(points) if points.is_empty() => return Ok(Some(line)),
                Some(points) => points.into_iter().for_each(|i| set[i] = !set[i]),
                None => break,
            }
        }
        for part in BEYOND {
            let start = Start {
                displacement: &here.displacement.hi,
                reaction: &here.reaction,
                closed: &here.closed,
                factored: own.as_ref(),
                balanced: None,
            };
            let near = self.solve_from(&load.at(t + part * span), load.held_value, &start, &mut |_| true)?;
            if near.outcome != Outcome::Solved {
                continue;
            }
            if let Some(line) = self.line(load, &near.closed, [t, t + span], Some(&near), own)?
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
        for &i in &self.order.active {
            let (now, later) = (line.value(0, i), line.value(1, i));
            if now < -SIGN {
                return None;
            }
            let fall = now - later;
            if fall > STILL && now <= SAME * fall {
                points.push(i);
            }
        }
        Some(points)
    }

    /// The next t at which reactions or gaps fall to zero, infinite if none ever does, and whose do.
    fn next_event(&self, line: &Line, from: f64) -> (f64, Vec<usize>) {
        let span = line.at[1] - line.at[0];
        let falls = |&i: &usize| (i, line.value(0, i), line.value(0, i) - line.value(1, i));
        let roots: Vec<(f64, usize)> = self
            .order
            .active
            .iter()
            .map(falls)
            .filter(|&(_, _, fall)| fall > STILL)
            .map(|(i, now, fall)| (from + span * (now / fall).max(0.0), i))
            .collect();
        let first = roots.iter().map(|(t, _)| *t).fold(f64::INFINITY, f64::min);
        let together = |&&(t, _): &&(f64, usize)| t <= first + SAME * span;
        (first, roots.iter().filter(together).map(|&(_, i)| i).collect())
    }
}
