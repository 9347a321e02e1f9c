//! The stops of a path, as they are shown.

use super::line::Line;
use super::load::{PathEnd, Stop};
use crate::contact::solution::{ContactSolution, differing};
use crate::contact::tolerances;

/// Where the last line has come to, and its sizes.
struct Arrival {
    solution: ContactSolution,
    forces: Vec<f64>,
    lengths: Vec<f64>,
}

/// Shows every stop to whoever watches.
pub(super) struct Trail<'a> {
    visit: &'a mut dyn FnMut(Stop) -> bool,
    arrived: Arrival,
    begun: bool,
}

impl<'a> Trail<'a> {
    /// Begins with the solution at t = 0.
    pub fn new(first: ContactSolution, visit: &'a mut dyn FnMut(Stop) -> bool) -> Self {
        let none = vec![0.0; first.gap.len()];
        Self { visit, arrived: Arrival { solution: first, forces: none.clone(), lengths: none }, begun: false }
    }

    /// What holds where the last line has come to.
    pub fn here(&self) -> &ContactSolution {
        &self.arrived.solution
    }

    /// Comes to the end of a line.
    pub fn arrive(&mut self, line: &Line<'_>, t: f64) {
        self.arrived = Arrival { solution: line.at(t), forces: line.forces.clone(), lengths: line.lengths.clone() };
    }

    /// Shows where a line leaves from: the beginning, an event, or both ends of a jump; whether to go on.
    pub fn leave(&mut self, t: f64, line: &Line<'_>) -> bool {
        let here = &self.arrived.solution;
        let begin = line.at(t);
        let between = self.arrived.jump_to(&begin, line);
        if !self.begun {
            self.begun = true;
            // A plate that touches nothing may rest anywhere; what counts is where the path leaves from.
            let begin = if between.is_some() { begin } else { ContactSolution { piece: begin.piece, ..here.clone() } };
            return (self.visit)(Stop { t, switched: &[], solution: &begin });
        }
        let Some(between) = between else {
            let switched = differing(&here.piece, &begin.piece);
            // Where pivots have led to an event that is none the path goes on as it came.
            return switched.is_empty() || (self.visit)(Stop { t, switched: &switched, solution: &begin });
        };
        let start = ContactSolution { piece: between.clone(), ..here.clone() };
        (self.visit)(Stop { t, switched: &differing(&here.piece, &between), solution: &start })
            && (self.visit)(Stop { t, switched: &differing(&between, &begin.piece), solution: &begin })
    }

    /// The last stop: a solution on the last line, or where no line leaves, what it came with.
    pub fn end(&mut self, t: f64, solution: Option<&ContactSolution>, end: PathEnd) -> PathEnd {
        let solution = solution.unwrap_or(&self.arrived.solution);
        if (self.visit)(Stop { t, switched: &[], solution }) { end } else { PathEnd::Interrupted }
    }
}

impl Arrival {
    /// The pieces on the way to where a line begins; `None` if it begins here.
    ///
    /// Points that stay apart, or without a force, are open or closed all the way.
    fn jump_to(&self, begin: &ContactSolution, line: &Line<'_>) -> Option<Vec<u8>> {
        let largest = |a: f64, b: f64, size: f64| if size > 0.0 { a.abs().max(b.abs()) / size } else { 0.0 };
        let here = &self.solution;
        let presses = |i: usize| largest(here.reaction[i], begin.reaction[i], self.forces[i].max(line.forces[i]));
        let parts = |i: usize| largest(here.gap[i], begin.gap[i], self.lengths[i].max(line.lengths[i]));
        let jumps = |&i: &usize| presses(i).max(parts(i)) > tolerances::path::JUMP;
        differing(&here.piece, &begin.piece).iter().any(jumps).then(|| {
            let stays = |i: usize| here.piece[i] == begin.piece[i];
            // Between the two a point is on the piece that both are on.
            let is_on = |i: usize| {
                let piece = line.points.piece(i, here.piece[i]);
                if piece.holds() {
                    return parts(i) <= tolerances::path::JUMP;
                }
                let size = self.forces[i].max(line.forces[i]);
                (begin.reaction[i] - piece.force).abs() <= tolerances::path::JUMP * size
            };
            let between = |i: usize| if is_on(i) { here.piece[i] } else { begin.piece[i] };
            (0..here.piece.len()).map(|i| if stays(i) { here.piece[i] } else { between(i) }).collect()
        })
    }
}
