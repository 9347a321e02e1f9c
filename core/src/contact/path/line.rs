//! A stretch of the path: the plate on given pieces, linear in t.

use crate::contact::points::Points;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// The plate on given pieces at two loads of the path, between and beyond which it is linear.
pub(super) struct Line<'a> {
    pub points: &'a Points,
    pub at: [f64; 2],
    pub ends: [ContactSolution; 2],
    /// Sizes of the reaction and of the travel of every point, and of deflections.
    pub forces: Vec<f64>,
    pub lengths: Vec<f64>,
    pub deflection: f64,
}

/// An end of the piece that a point is on.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Border {
    pub point: usize,
    pub is_upper: bool,
}

impl Border {
    /// The piece beyond.
    pub fn beyond(self, pieces: &[u8]) -> u8 {
        if self.is_upper { pieces[self.point] + 1 } else { pieces[self.point] - 1 }
    }
}

/// Ends of the pieces of all points.
pub(super) fn borders(points: &Points, pieces: &[u8]) -> Vec<Border> {
    let of = |point: usize| {
        let [low, high] = points.ends(point, pieces[point]);
        let border = |end: Option<[f64; 2]>, is_upper| end.map(|_| Border { point, is_upper });
        [border(low, false), border(high, true)]
    };
    (0..points.len()).flat_map(of).flatten().collect()
}

/// Largest change of the deflection from one solution to another.
pub(super) fn travel(a: &ContactSolution, b: &ContactSolution) -> f64 {
    let change = |i: usize| (b.displacement.at(i) - a.displacement.at(i)).value().abs();
    (0..a.displacement.hi.len()).step_by(3).map(change).fold(0.0, f64::max)
}

impl Line<'_> {
    pub fn pieces(&self) -> &[u8] {
        &self.ends[0].piece
    }

    pub fn borders(&self) -> Vec<Border> {
        borders(self.points, self.pieces())
    }

    /// How far a point is from the end of its piece at an end of the line, over what it is measured by.
    pub fn value(&self, end: usize, Border { point: i, is_upper }: Border) -> f64 {
        let (solution, piece) = (&self.ends[end], self.points.piece(i, self.pieces()[i]));
        let border = self.points.ends(i, self.pieces()[i])[usize::from(is_upper)].expect("an end");
        let (value, border, size) = match piece.holds() {
            true => (solution.reaction[i], border[1], self.forces[i]),
            false => (-solution.gap[i], border[0] - piece.travel, self.lengths[i]),
        };
        let inside = if is_upper { border - value } else { value - border };
        if size > 0.0 { inside / size } else { 0.0 }
    }

    /// How much that falls from one end to the other; nothing where that is no more than rounding.
    pub fn fall(&self, border: Border) -> f64 {
        let fall = self.value(0, border) - self.value(1, border);
        if fall.abs() > tolerances::path::STILL { fall } else { 0.0 }
    }

    /// Largest change of the deflection between two t.
    pub fn travel(&self, from: f64, to: f64) -> f64 {
        let [a, b] = &self.ends;
        travel(a, b) * (to - from) / (self.at[1] - self.at[0])
    }

    /// Whether no point is beyond an end of its piece between two t.
    pub fn signs_hold(&self, from: f64, to: f64) -> bool {
        let parts = [self.part(from), self.part(to)];
        self.borders().into_iter().all(|border| {
            let (begin, end) = (self.value(0, border), self.value(1, border));
            parts.iter().all(|part| begin + part * (end - begin) > -tolerances::path::SIGN)
        })
    }

    fn part(&self, t: f64) -> f64 {
        (t - self.at[0]) / (self.at[1] - self.at[0])
    }

    pub fn at(&self, t: f64) -> ContactSolution {
        let mut solution = self.ends[0].clone();
        solution.towards(&self.ends[1], self.part(t));
        solution
    }

    /// The ends of pieces that points reach on the line to go to others.
    pub fn crossed(&self, next: &[u8]) -> Vec<Border> {
        let leaves = |border: &Border| {
            let (from, to) = (self.pieces()[border.point], next[border.point]);
            if border.is_upper { to > from } else { to < from }
        };
        self.borders().into_iter().filter(leaves).collect()
    }

    /// Where points reach these ends; `None` if none does within so much of where pivots saw it.
    pub fn root(&self, crossed: &[Border], seen: f64, within: f64) -> Option<f64> {
        let span = self.at[1] - self.at[0];
        let falling = crossed.iter().copied().filter(|&border| self.fall(border) > 0.0);
        let first = falling.max_by(|&a, &b| self.fall(a).total_cmp(&self.fall(b)))?;
        let root = self.at[1] + self.value(1, first) / self.fall(first) * span;
        ((root - seen).abs() < within).then_some(root)
    }
}
