//! A stretch of the path: the plate on one contact set, linear in t.

use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// The plate on one contact set at two loads of the path, between and beyond which it is linear.
pub(super) struct Line {
    pub at: [f64; 2],
    pub ends: [ContactSolution; 2],
    /// Sizes of the reaction and of the gap of every point, and of deflections.
    pub forces: Vec<f64>,
    pub lengths: Vec<f64>,
    pub deflection: f64,
}

/// Largest change of the deflection from one solution to another.
pub(super) fn travel(a: &ContactSolution, b: &ContactSolution) -> f64 {
    let change = |i: usize| (b.displacement.at(i) - a.displacement.at(i)).value().abs();
    (0..a.displacement.hi.len()).step_by(3).map(change).fold(0.0, f64::max)
}

impl Line {
    /// What counts for a point: its reaction where closed, else its gap, at an end and over what it is measured by.
    pub fn value(&self, end: usize, i: usize) -> f64 {
        let solution = &self.ends[end];
        let (value, size) = if solution.closed[i] {
            (solution.reaction[i], self.forces[i])
        } else {
            (solution.gap[i], self.lengths[i])
        };
        if size > 0.0 { value / size } else { 0.0 }
    }

    /// How much a point's value falls from one end to the other; nothing where that is no more than rounding.
    pub fn fall(&self, i: usize) -> f64 {
        let fall = self.value(0, i) - self.value(1, i);
        if fall.abs() > tolerances::path::STILL { fall } else { 0.0 }
    }

    /// Largest change of the deflection between two t.
    pub fn travel(&self, from: f64, to: f64) -> f64 {
        let [a, b] = &self.ends;
        travel(a, b) * (to - from) / (self.at[1] - self.at[0])
    }

    /// Whether no value of these points is negative between two t.
    pub fn signs_hold(&self, mut points: impl Iterator<Item = usize>, from: f64, to: f64) -> bool {
        let parts = [self.part(from), self.part(to)];
        points.all(|i| {
            let (begin, end) = (self.value(0, i), self.value(1, i));
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

    /// Where the points that switch reach zero; `None` if none does within so much of where pivots saw it.
    pub fn root(&self, switched: &[usize], seen: f64, within: f64) -> Option<f64> {
        let span = self.at[1] - self.at[0];
        let falling = switched.iter().copied().filter(|&i| self.fall(i) > 0.0);
        let first = falling.max_by(|&a, &b| self.fall(a).total_cmp(&self.fall(b)))?;
        let root = self.at[1] + self.value(1, first) / self.fall(first) * span;
        ((root - seen).abs() < within).then_some(root)
    }
}
