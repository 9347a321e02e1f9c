//! A line: the solutions on a fixed contact state, linear in the load factor t. A segment of the path is part of it.

use crate::contact::points::Points;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// Solutions `ends` on a fixed contact state, at the two load factors `at`. The solution is linear in t.
pub(super) struct Line<'a> {
    pub points: &'a Points,
    pub at: [f64; 2],
    pub ends: [ContactSolution; 2],
    pub scales: Scales,
    /// Reference deflection: the largest deflection in the two solutions `ends`.
    pub deflection: f64,
}

/// Reference force (m,) and reference travel (m,) of each contact point.
#[derive(Clone)]
pub(super) struct Scales {
    pub force: Vec<f64>,
    pub travel: Vec<f64>,
}

impl Scales {
    /// Reference size for the distance of point i from an end of its piece of the law: a force if the force depends on
    /// the travel on this piece, otherwise a travel.
    pub fn of(&self, points: &Points, i: usize, piece: u8) -> f64 {
        if points.piece(i, piece).holds() { self.force[i] } else { self.travel[i] }
    }
}

/// The lower or upper end of the piece of its law on which a contact point is.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Breakpoint {
    pub point: usize,
    pub is_upper: bool,
}

impl Breakpoint {
    /// Number of the piece of the law beyond this end; `pieces` is the contact state (m,).
    pub fn beyond(self, pieces: &[u8]) -> u8 {
        if self.is_upper { pieces[self.point] + 1 } else { pieces[self.point] - 1 }
    }
}

/// The lower and upper ends of the pieces of the laws on which the points are, without ends at infinity.
pub(super) fn breakpoints(points: &Points, pieces: &[u8]) -> Vec<Breakpoint> {
    let of = |point: usize| {
        let [low, high] = points.ends(point, pieces[point]);
        let breakpoint = |end: Option<[f64; 2]>, is_upper| end.map(|_| Breakpoint { point, is_upper });
        [breakpoint(low, false), breakpoint(high, true)]
    };
    (0..points.len()).flat_map(of).flatten().collect()
}

/// Largest change of the deflection of a node between two solutions.
pub(super) fn travel(a: &ContactSolution, b: &ContactSolution) -> f64 {
    let change = |i: usize| (b.displacement.at(i) - a.displacement.at(i)).value().abs();
    (0..a.displacement.hi.len()).step_by(3).map(change).fold(0.0, f64::max)
}

impl Line<'_> {
    pub fn pieces(&self) -> &[u8] {
        &self.ends[0].piece
    }

    pub fn breakpoints(&self) -> Vec<Breakpoint> {
        breakpoints(self.points, self.pieces())
    }

    /// Distance of a point from an end of its piece of the law in solution 0 or 1 of the line, divided by the reference
    /// size.
    pub fn value(&self, end: usize, Breakpoint { point: i, is_upper }: Breakpoint) -> f64 {
        let state = self.ends[end].state(i);
        let inside = self.points.signed_distance(i, state, is_upper).expect("an end");
        let size = self.scales.of(self.points, i, state.piece);
        if size > 0.0 { inside / size } else { 0.0 }
    }

    /// Decrease of the distance of a point from an end of its piece of the law, divided by the reference size, from
    /// solution 0 to solution 1 of the line. It is 0 if the decrease is rounding.
    pub fn fall(&self, breakpoint: Breakpoint) -> f64 {
        let fall = self.value(0, breakpoint) - self.value(1, breakpoint);
        if fall.abs() > tolerances::path::STILL { fall } else { 0.0 }
    }

    /// Largest change of the deflection of a node between two values of t.
    pub fn travel(&self, from: f64, to: f64) -> f64 {
        let [a, b] = &self.ends;
        travel(a, b) * (to - from) / (self.at[1] - self.at[0])
    }

    /// Whether all points are within the bounds of their pieces of the laws at the values `from` and `to` of t.
    pub fn signs_are_feasible(&self, from: f64, to: f64) -> bool {
        let parts = [self.part(from), self.part(to)];
        self.breakpoints().into_iter().all(|breakpoint| {
            let (begin, end) = (self.value(0, breakpoint), self.value(1, breakpoint));
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

    /// The ends of their present pieces of the laws that points pass when the contact state changes to `next`.
    pub fn crossed(&self, next: &[u8]) -> Vec<Breakpoint> {
        let leaves = |breakpoint: &Breakpoint| {
            let (from, to) = (self.pieces()[breakpoint.point], next[breakpoint.point]);
            if breakpoint.is_upper { to > from } else { to < from }
        };
        self.breakpoints().into_iter().filter(leaves).collect()
    }

    /// The t at which points reach the ends `crossed` of their pieces of the laws. `None` unless this t differs by less
    /// than `within` from `seen`, the t from pivoting.
    pub fn root(&self, crossed: &[Breakpoint], seen: f64, within: f64) -> Option<f64> {
        let span = self.at[1] - self.at[0];
        let falling = crossed.iter().copied().filter(|&breakpoint| self.fall(breakpoint) > 0.0);
        let first = falling.max_by(|&a, &b| self.fall(a).total_cmp(&self.fall(b)))?;
        let root = self.at[1] + self.value(1, first) / self.fall(first) * span;
        ((root - seen).abs() < within).then_some(root)
    }
}
