//! Traces a path from event to event, with a solver of fixed contact states.

use super::line::{Breakpoint, Line};
use super::load::{MOST_EVENTS, PathEnd};
use super::recorder::PathRecorder;
use super::tracer::PathTracer;
use crate::contact::error::SolveError;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// Largest number of trials for the contact state after an event. After each trial the points that would leave their
/// pieces of the laws change to the adjacent pieces.
const ROUNDS: usize = 20;

/// Largest number of times that a line of solutions without events is extended to larger t.
const LENGTHENED: usize = 2;

impl<'a> PathTracer<'a> {
    /// Traces the path from t on, from event to event.
    pub(super) fn step_along(&mut self, mut t: f64, recorder: &mut PathRecorder) -> Result<PathEnd, SolveError> {
        let load = self.load;
        let mut pieces = recorder.here().piece.clone();
        // Contact states of all segments since t last increased.
        let mut spent: Vec<Vec<u8>> = Vec::new();
        for _ in 0..=MOST_EVENTS {
            let Some(mut line) = self.leaving(t, &pieces, recorder.here())? else {
                return Ok(recorder.end(t, None, PathEnd::Unsolved));
            };
            // If a contact state occurs again at the same t, rounding alone decides which points close; the path then
            // ends.
            if spent.contains(&line.ends[0].piece) {
                return Ok(recorder.end(t, None, PathEnd::Unsolved));
            }
            if !recorder.emit(t, &line) {
                return Ok(PathEnd::Interrupted);
            }
            let (mut to, mut breakpoints) = self.next_event(&line, t);
            if to.is_infinite()
                && load.end.is_infinite()
                && let Some(longer) = self.until_it_counts(&line)?
            {
                line = longer;
                (to, breakpoints) = self.next_event(&line, t);
            }
            let reach = to.min(load.end);
            if reach > line.at[1] && reach.is_finite() {
                // The second solution of the line is computed at the event, since interpolation between two solutions
                // is more exact than extrapolation beyond the second.
                if let Some(longer) = self.line_from(line.ends[0].clone(), [t, reach])? {
                    line = longer;
                    (to, breakpoints) = self.next_event(&line, t);
                }
            }
            if to >= load.end {
                return Ok(self.end_on(&line, line.at[1], recorder));
            }
            recorder.arrive(&line, to);
            pieces.clone_from(&recorder.here().piece);
            breakpoints
                .into_iter()
                .for_each(|breakpoint: Breakpoint| pieces[breakpoint.point] = breakpoint.beyond(&pieces));
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

    /// Extends a line of solutions without events to larger t until the added load moves the plate by a considerable
    /// part of the largest gap. Returns the extended line on which an event appears, or `None` if no event appears.
    ///
    /// If the load is small, or supports are far away, the first step may be too short to detect a gap that closes.
    fn until_it_counts(&mut self, line: &Line<'a>) -> Result<Option<Line<'a>>, SolveError> {
        let [t, mut far] = line.at;
        let gap = line.scales.travel.iter().fold(0.0, |most, &length| f64::max(most, length));
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

    /// The line that starts at t. The first trial for its contact state is `pieces`. Returns `None` if no contact state
    /// is found.
    fn leaving(&mut self, t: f64, pieces: &[u8], here: &ContactSolution) -> Result<Option<Line<'a>>, SolveError> {
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
                Some(breakpoints) if breakpoints.is_empty() => return Ok(Some(line)),
                Some(breakpoints) => {
                    breakpoints.into_iter().for_each(|breakpoint| set[breakpoint.point] = breakpoint.beyond(&set))
                }
                None => break,
            }
        }
        for part in tolerances::path::BEYOND {
            let Some(near) = self.solution(t + part * span, Some(here))? else { continue };
            if let Some(line) = self.line(&near.piece, [t, t + span], Some(&near))?
                && self.wrong(&line).is_some_and(|breakpoints| breakpoints.is_empty())
            {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// The ends of their present pieces of the laws that points pass directly after the start of the line. `None` if a
    /// point is beyond the bounds of its piece at the start.
    fn wrong(&self, line: &Line<'_>) -> Option<Vec<Breakpoint>> {
        let mut wrong = Vec::new();
        for breakpoint in line.breakpoints() {
            let (now, fall) = (line.value(0, breakpoint), line.fall(breakpoint));
            if now < -tolerances::path::SIGN {
                return None;
            }
            if fall > 0.0 && now <= tolerances::path::SAME_EVENT * fall {
                wrong.push(breakpoint);
            }
        }
        Some(wrong)
    }

    /// The smallest t ≥ `from` at which points reach ends of their present pieces of the laws, and these ends. t is
    /// infinite if there is no event.
    fn next_event(&self, line: &Line<'_>, from: f64) -> (f64, Vec<Breakpoint>) {
        let span = line.at[1] - line.at[0];
        let roots: Vec<(f64, Breakpoint)> = line
            .breakpoints()
            .into_iter()
            .map(|breakpoint| (breakpoint, line.value(0, breakpoint), line.fall(breakpoint)))
            .filter(|&(_, _, fall)| fall > 0.0)
            .map(|(breakpoint, now, fall)| (from + span * (now / fall).max(0.0), breakpoint))
            .collect();
        let first = roots.iter().map(|(t, _)| *t).fold(f64::INFINITY, f64::min);
        let together = |&&(t, _): &&(f64, Breakpoint)| t <= first + tolerances::path::SAME_EVENT * span;
        (first, roots.iter().filter(together).map(|&(_, breakpoint)| breakpoint).collect())
    }
}
