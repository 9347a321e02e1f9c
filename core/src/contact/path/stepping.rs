//! From event to event on the sparse K.

use super::follower::Follower;
use super::line::{Border, Line};
use super::load::{MOST_EVENTS, PathEnd};
use super::trail::Trail;
use crate::cholesky::FactorError;
use crate::contact::solution::{ContactSolution, Outcome};
use crate::contact::tolerances;

/// Times that points which move the wrong way from an event on are switched.
const ROUNDS: usize = 20;

/// Times that a line without events is lengthened.
const LENGTHENED: usize = 2;

impl<'a> Follower<'a> {
    /// As [`ContactProblem::path`], from some t on.
    pub(super) fn step_along(&mut self, mut t: f64, trail: &mut Trail) -> Result<PathEnd, FactorError> {
        let load = self.load;
        let mut pieces = trail.here().piece.clone();
        // Sets on which the path got no further than where it is.
        let mut spent: Vec<Vec<u8>> = Vec::new();
        for _ in 0..=MOST_EVENTS {
            let Some(mut line) = self.leaving(t, &pieces, trail.here())? else {
                return Ok(trail.end(t, None, PathEnd::Unsolved));
            };
            // A set that comes back would lead round for ever: rounding decides what closes.
            if spent.contains(&line.ends[0].piece) {
                return Ok(trail.end(t, None, PathEnd::Unsolved));
            }
            if !trail.leave(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            let (mut to, mut borders) = self.next_event(&line, t);
            if to.is_infinite()
                && load.end.is_infinite()
                && let Some(longer) = self.until_it_counts(&line)?
            {
                line = longer;
                (to, borders) = self.next_event(&line, t);
            }
            let reach = to.min(load.end);
            if reach > line.at[1] && reach.is_finite() {
                // Beyond its far end a line is less exact than up to it.
                if let Some(longer) = self.line_from(line.ends[0].clone(), [t, reach])? {
                    line = longer;
                    (to, borders) = self.next_event(&line, t);
                }
            }
            if to >= load.end {
                return Ok(self.end_on(&line, line.at[1], trail));
            }
            trail.arrive(&line, to);
            pieces.clone_from(&trail.here().piece);
            borders.into_iter().for_each(|border: Border| pieces[border.point] = border.beyond(&pieces));
            if to - t > tolerances::path::SAME_EVENT * self.span(t) {
                spent.clear();
            } else {
                let [from, _] = line.ends;
                spent.push(from.piece);
            }
            t = to;
        }
        Ok(PathEnd::TooMany)
    }

    /// A line without events, so long that what is added moves the plate by as much as any gap, if it then has one.
    ///
    /// Beside little load, or far from a support, a first step may be too short to tell that a gap closes.
    fn until_it_counts(&mut self, line: &Line<'a>) -> Result<Option<Line<'a>>, FactorError> {
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
    fn leaving(&mut self, t: f64, pieces: &[u8], here: &ContactSolution) -> Result<Option<Line<'a>>, FactorError> {
        let span = self.span(t);
        let mut set = pieces.to_vec();
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
                Some(borders) if borders.is_empty() => return Ok(Some(line)),
                Some(borders) => borders.into_iter().for_each(|border| set[border.point] = border.beyond(&set)),
                None => break,
            }
        }
        for part in tolerances::path::BEYOND {
            let near = self.solution(t + part * span, Some(here))?;
            if near.outcome != Outcome::Solved {
                continue;
            }
            if let Some(line) = self.line(&near.piece, [t, t + span], Some(&near))?
                && self.wrong(&line).is_some_and(|borders| borders.is_empty())
            {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// Ends of pieces at which points are where the line begins, and beyond which they go on; `None` if some are beyond them
    /// there.
    fn wrong(&self, line: &Line<'_>) -> Option<Vec<Border>> {
        let mut wrong = Vec::new();
        for border in line.borders() {
            let (now, fall) = (line.value(0, border), line.fall(border));
            if now < -tolerances::path::SIGN {
                return None;
            }
            if fall > 0.0 && now <= tolerances::path::SAME_EVENT * fall {
                wrong.push(border);
            }
        }
        Some(wrong)
    }

    /// The next t at which points reach ends of their pieces, infinite if none ever does, and which.
    fn next_event(&self, line: &Line<'_>, from: f64) -> (f64, Vec<Border>) {
        let span = line.at[1] - line.at[0];
        let roots: Vec<(f64, Border)> = line
            .borders()
            .into_iter()
            .map(|border| (border, line.value(0, border), line.fall(border)))
            .filter(|&(_, _, fall)| fall > 0.0)
            .map(|(border, now, fall)| (from + span * (now / fall).max(0.0), border))
            .collect();
        let first = roots.iter().map(|(t, _)| *t).fold(f64::INFINITY, f64::min);
        let together = |&&(t, _): &&(f64, Border)| t <= first + tolerances::path::SAME_EVENT * span;
        (first, roots.iter().filter(together).map(|&(_, border)| border).collect())
    }
}
