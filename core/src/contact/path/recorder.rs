//! Passes the stops of a load path, in order of t, to a callback.

use super::line::{Line, Scales};
use super::load::{PathEnd, Stop};
use crate::contact::solution::{ContactSolution, differing};
use crate::contact::tolerances;

/// The solution at the end of the last line (segment) of the path, and the reference sizes of this line.
struct Arrival {
    solution: ContactSolution,
    scales: Scales,
}

/// Reports every stop of a path to the callback `visit`.
pub(super) struct PathRecorder<'a> {
    visit: &'a mut dyn FnMut(Stop) -> bool,
    arrived: Arrival,
    begun: bool,
}

impl<'a> PathRecorder<'a> {
    /// A recorder that starts from `first`, the solution at t = 0.
    pub fn new(first: ContactSolution, visit: &'a mut dyn FnMut(Stop) -> bool) -> Self {
        let none = vec![0.0; first.gap.len()];
        let scales = Scales { force: none.clone(), travel: none };
        Self { visit, arrived: Arrival { solution: first, scales }, begun: false }
    }

    /// The stored solution, at the end of the last line (segment) of the path.
    pub fn here(&self) -> &ContactSolution {
        &self.arrived.solution
    }

    /// Stores the solution at t, where the segment on `line` ends.
    pub fn arrive(&mut self, line: &Line<'_>, t: f64) {
        self.arrived = Arrival { solution: line.at(t), scales: line.scales.clone() };
    }

    /// Reports the stop at the start of a line: the start of the path, an event, or both ends of a jump. Returns false
    /// if the callback cancels the path.
    pub fn emit(&mut self, t: f64, line: &Line<'_>) -> bool {
        let here = &self.arrived.solution;
        let begin = line.at(t);
        let between = self.arrived.jump_to(&begin, line);
        if !self.begun {
            self.begun = true;
            // If no point is in contact, the position of the plate is not unique; the path then starts with the
            // solution on its first line.
            let begin = if between.is_some() { begin } else { ContactSolution { piece: begin.piece, ..here.clone() } };
            return (self.visit)(Stop { t, switched: &[], solution: &begin });
        }
        let Some(between) = between else {
            let switched = differing(&here.piece, &begin.piece);
            // If no point changes its piece of the law, the event is not reported.
            return switched.is_empty() || (self.visit)(Stop { t, switched: &switched, solution: &begin });
        };
        let start = ContactSolution { piece: between.clone(), ..here.clone() };
        (self.visit)(Stop { t, switched: &differing(&here.piece, &between), solution: &start })
            && (self.visit)(Stop { t, switched: &differing(&between, &begin.piece), solution: &begin })
    }

    /// Reports the last stop, with `solution`, or with the stored solution if that is `None`. Returns how the path
    /// ended.
    pub fn end(&mut self, t: f64, solution: Option<&ContactSolution>, end: PathEnd) -> PathEnd {
        let solution = solution.unwrap_or(&self.arrived.solution);
        if (self.visit)(Stop { t, switched: &[], solution }) { end } else { PathEnd::Interrupted }
    }
}

impl Arrival {
    /// The contact state during a jump from the stored solution to `begin`, the start of a line; `None` if both
    /// solutions coincide.
    fn jump_to(&self, begin: &ContactSolution, line: &Line<'_>) -> Option<Vec<u8>> {
        let largest = |a: f64, b: f64, size: f64| if size > 0.0 { a.abs().max(b.abs()) / size } else { 0.0 };
        let here = &self.solution;
        let presses =
            |i: usize| largest(here.reaction[i], begin.reaction[i], self.scales.force[i].max(line.scales.force[i]));
        let parts = |i: usize| largest(here.gap[i], begin.gap[i], self.scales.travel[i].max(line.scales.travel[i]));
        let jumps = |&i: &usize| presses(i).max(parts(i)) > tolerances::path::JUMP;
        differing(&here.piece, &begin.piece).iter().any(jumps).then(|| {
            let stays = |i: usize| here.piece[i] == begin.piece[i];
            // During the jump a point is on a piece of its law that contains its states before and after the jump.
            let is_on = |i: usize| {
                let piece = line.points.piece(i, here.piece[i]);
                if piece.holds() {
                    return parts(i) <= tolerances::path::JUMP;
                }
                let size = self.scales.force[i].max(line.scales.force[i]);
                (begin.reaction[i] - piece.force).abs() <= tolerances::path::JUMP * size
            };
            let between = |i: usize| if is_on(i) { here.piece[i] } else { begin.piece[i] };
            (0..here.piece.len()).map(|i| if stays(i) { here.piece[i] } else { between(i) }).collect()
        })
    }
}
