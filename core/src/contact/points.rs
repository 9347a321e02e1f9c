//! Contact points: the rows of G, and the law of each point.

use super::error::{SolveError, require_length, require_values};
use super::graph::{Graph, Piece};
use crate::assembly::Bedding;
use crate::displacement::Displacement;
use crate::element::packed;
use crate::plate::Plate;
use crate::rows::Rows;
use crate::vectorized::vectorized;
use rayon::prelude::*;
use std::collections::HashMap;

/// The elements on whose dofs a row of G has coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Over {
    One(u32),
    /// The pair of elements with this index in `Points::pairs`.
    Pair(u32),
    Several,
}

/// Contact points in the caller's order. Point i has the travel s_i = (g_i·u − shift_i)/unit_i and the reaction r_i =
/// weight_i · graph_i(s_i), with row g_i of G, its law graph_i, and Ku + Gᵀr = f.
#[derive(Clone, Debug, Default)]
pub struct Points {
    start: Vec<usize>,
    dof: Vec<u32>,
    coefficient: Vec<f64>,
    over: Vec<Over>,
    /// Whether each row of G has deflection dofs only.
    deflects: Vec<bool>,
    /// The pairs of elements that rows of G connect, and the index of each pair in this list.
    pairs: Vec<[u32; 2]>,
    pair: HashMap<[u32; 2], u32>,
    graphs: Vec<Graph>,
    graph: Vec<u32>,
    /// Displacement g·u (m,) at which s = 0: gap plus settlement, called g in docs/theory.md.
    pub shift: Vec<f64>,
    /// Force scale F₀ (m,): reaction per unit force of the law, which is an area, a length or a stiffness.
    pub weight: Vec<f64>,
    /// Travel scale d (m,): displacement per unit travel of the law. It differs from 1 where points whose laws differ
    /// only by their limits share one law in units of the limit.
    pub unit: Vec<f64>,
    /// Lever arm (m,) of points whose reaction is a couple, 1 at all other points. A reaction divided by `arm` is a
    /// force; a travel times `arm` is a length.
    pub arm: Vec<f64>,
}

/// State of a contact point: its piece of the law, its reaction, and its gap. The gap is the travel to the reference
/// vertex of a horizontal piece, 0 on other pieces.
#[derive(Clone, Copy)]
pub(super) struct PointState {
    pub(super) piece: u8,
    pub(super) reaction: f64,
    pub(super) gap: f64,
}

/// Laws of m contact points, with their gaps and scales.
pub struct PointLaws {
    pub graphs: Vec<Graph>,
    /// For each point (m,), the index of its law in `graphs`.
    pub graph: Vec<usize>,
    /// `shift`, `weight` and `unit` (m,) of each point, as defined in [`Points`].
    pub shift: Vec<f64>,
    pub weight: Vec<f64>,
    pub unit: Vec<f64>,
}

impl Points {
    /// Makes m contact points, one for each row of G in the table `rows`.
    pub fn on_rows(plate: &Plate, rows: &Rows, laws: PointLaws) -> Result<Self, SolveError> {
        let PointLaws { graphs, graph, shift, weight, unit } = laws;
        require_length("the laws of points", graph.len(), rows.len())?;
        require_length("shift", shift.len(), rows.len())?;
        require_length("weight", weight.len(), rows.len())?;
        if let Some(index) = graph.iter().position(|&law| law >= graphs.len()) {
            return Err(SolveError::Value { name: "the laws of points", index, allowed: "the number of a law" });
        }
        let mut points = Self { graphs, ..Self::with_capacity(rows.len()) };
        for i in 0..rows.len() {
            points.push_row(plate, rows, i, graph[i] as u32, shift[i], weight[i]);
        }
        points.unit = unit;
        points.require_valid()?;
        Ok(points)
    }

    /// Returns an error if a vector has the wrong length or a number is out of range.
    pub(super) fn require_valid(&self) -> Result<(), SolveError> {
        for (name, values) in [("shift", &self.shift), ("weight", &self.weight), ("unit", &self.unit)] {
            require_length(name, values.len(), self.len())?;
        }
        require_values("shift", &self.shift, "finite", f64::is_finite)?;
        require_values("weight", &self.weight, "finite and not negative", |w| w >= 0.0 && w.is_finite())?;
        require_values("unit", &self.unit, "finite and positive", |unit| unit > 0.0 && unit.is_finite())
    }

    /// Makes an empty list with memory for `count` points whose rows have the deflections of one element.
    pub fn with_capacity(count: usize) -> Self {
        let mut points = Self::default();
        points.dof.reserve(8 * count);
        points.coefficient.reserve(8 * count);
        points
    }

    pub fn len(&self) -> usize {
        self.graph.len()
    }

    pub fn is_empty(&self) -> bool {
        self.graph.is_empty()
    }

    /// Adds a law and returns its index in the list of laws.
    pub fn add_graph(&mut self, graph: Graph) -> u32 {
        self.graphs.push(graph);
        self.graphs.len() as u32 - 1
    }

    /// Appends a contact point. `row` has the dofs of its row of G with their coefficients, each dof once.
    pub fn push(&mut self, row: impl Iterator<Item = (usize, f64)>, graph: u32, shift: f64, weight: f64) {
        if self.start.is_empty() {
            self.start.push(0);
        }
        for (dof, coefficient) in row.filter(|(_, coefficient)| *coefficient != 0.0) {
            self.dof.push(dof as u32);
            self.coefficient.push(coefficient);
        }
        self.start.push(self.dof.len());
        self.arm.push(1.0);
        self.over.push(Over::Several);
        self.deflects.push(self.dof[self.start[self.len()]..].iter().all(|dof| dof % 3 == 0));
        self.graph.push(graph);
        self.shift.push(shift);
        self.weight.push(weight);
        self.unit.push(1.0);
    }

    /// Appends a contact point whose row of G is row i of the table `rows`.
    pub fn push_row(&mut self, plate: &Plate, rows: &Rows, i: usize, graph: u32, shift: f64, weight: f64) {
        self.push(rows.entries(plate, i), graph, shift, weight);
        let over = match rows.pair(i) {
            Some(pair) => Over::Pair(self.number_of(pair)),
            None if rows.further.contains_key(&i) => Over::Several,
            None => Over::One(rows.element[i] as u32),
        };
        *self.over.last_mut().expect("just pushed") = over;
    }

    fn number_of(&mut self, elements: [u32; 2]) -> u32 {
        *self.pair.entry(elements).or_insert_with(|| {
            self.pairs.push(elements);
            self.pairs.len() as u32 - 1
        })
    }

    /// Whether both lists of contact points have the same rows of G.
    pub(super) fn has_rows_of(&self, other: &Self) -> bool {
        self.start == other.start
            && self.dof == other.dof
            && self.coefficient == other.coefficient
            && self.over == other.over
            && self.pairs == other.pairs
    }

    /// The pairs of elements that rows of G connect.
    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The elements of row i of G if these are one or two, otherwise an empty list.
    fn elements(&self, i: usize) -> &[u32] {
        match &self.over[i] {
            Over::One(element) => std::slice::from_ref(element),
            Over::Pair(pair) => &self.pairs[*pair as usize],
            Over::Several => &[],
        }
    }

    /// Sets `arm` of the points whose rows have rotation dofs only, so that their reactions are couples.
    pub(super) fn set_arm(&mut self, arm: f64) {
        for i in 0..self.len() {
            let mut dofs = self.dof[self.start[i]..self.start[i + 1]].iter();
            self.arm[i] = if dofs.len() > 0 && dofs.all(|dof| dof % 3 != 0) { arm } else { 1.0 };
        }
    }

    /// The dofs of row i of G, each with its coefficient.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let at = self.start[i]..self.start[i + 1];
        self.dof[at.clone()].iter().zip(&self.coefficient[at]).map(|(&dof, &coefficient)| (dof as usize, coefficient))
    }

    pub fn dot(&self, i: usize, vector: &[f64]) -> f64 {
        self.row(i).map(|(dof, coefficient)| coefficient * vector[dof]).sum()
    }

    /// Adds `force` times row i of G to a nodal vector (3n,).
    pub fn scatter(&self, i: usize, force: f64, vector: &mut [f64]) {
        self.row(i).for_each(|(dof, coefficient)| vector[dof] += force * coefficient);
    }

    /// Adds `factor` · Gᵀ`force` to a nodal vector (3n,).
    pub fn scatter_all(&self, force: &[f64], factor: f64, vector: &mut [f64]) {
        for (i, force) in force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            self.scatter(i, factor * force, vector);
        }
    }

    /// G times a nodal vector (3n,), one value for each point (m,).
    pub fn change(&self, vector: &[f64]) -> Vec<f64> {
        (0..self.len()).into_par_iter().with_min_len(4096).map(|i| self.dot(i, vector)).collect()
    }

    /// Travels Gu − `from` (m,) of the contact points, summed in double-double.
    pub fn travel_from(&self, from: &[f64], displacement: &Displacement) -> Vec<f64> {
        let mut out = vec![0.0; self.len()];
        out.par_chunks_mut(1024).enumerate().for_each(|(chunk, out)| {
            vectorized(
                #[inline(always)]
                || self.some_travels(1024 * chunk, from, displacement, out),
            );
        });
        out
    }

    #[inline(always)]
    fn some_travels(&self, first: usize, from: &[f64], displacement: &Displacement, out: &mut [f64]) {
        for (i, out) in (first..).zip(out) {
            let (mut high, mut low) = (-from[i], 0.0);
            for at in self.start[i]..self.start[i + 1] {
                let (dof, value) = (self.dof[at] as usize, self.coefficient[at]);
                let (hi, lo) = (displacement.hi[dof], displacement.lo[dof]);
                let product = hi * value;
                let error = hi.mul_add(value, -product);
                let sum = high + product;
                let part = sum - high;
                low += (high - (sum - part)) + (product - part) + error + lo * value;
                high = sum;
            }
            *out = high + low;
        }
    }

    pub fn graph(&self, i: usize) -> &Graph {
        &self.graphs[self.graph[i] as usize]
    }

    /// The line of piece `number` of the law of point i: reaction over displacement g·u.
    pub fn piece(&self, i: usize, number: u8) -> Piece {
        let Piece { travel, force, slope } = self.graph(i).piece(number);
        let (weight, unit) = (self.weight[i], self.unit[i]);
        Piece { travel: self.shift[i] + unit * travel, force: weight * force, slope: weight / unit * slope }
    }

    /// Lower and upper end [displacement g·u, reaction] of piece `number` of the law of point i; `None` where the piece
    /// is unbounded.
    pub fn ends(&self, i: usize, number: u8) -> [Option<[f64; 2]>; 2] {
        let own = |[travel, force]: [f64; 2]| [self.shift[i] + self.unit[i] * travel, self.weight[i] * force];
        self.graph(i).ends(number).map(|end| end.map(own))
    }

    /// Distance of a point from the lower or upper end of its piece of the law, positive inside the piece. The distance
    /// is a force if the force depends on the travel on this piece, otherwise a travel. `None` where the piece is
    /// unbounded.
    pub(super) fn signed_distance(&self, i: usize, state: PointState, is_upper: bool) -> Option<f64> {
        let piece = self.piece(i, state.piece);
        let end = self.ends(i, state.piece)[usize::from(is_upper)]?;
        let above = match piece.holds() {
            true => state.reaction - end[1],
            false => -state.gap - (end[0] - piece.travel),
        };
        Some(if is_upper { -above } else { above })
    }

    /// Number of the piece of the law of point i at the augmented travel s + σr, with s = g·u − `shift` and σ =
    /// `compliance`.
    pub fn piece_at(&self, i: usize, compliance: f64, augmented_travel: f64) -> u8 {
        self.graph(i).piece_at(compliance * self.weight[i] / self.unit[i], augmented_travel / self.unit[i])
    }

    /// Reaction r of point i at the augmented travel s + σr (travel s, augmentation compliance σ = `compliance`), and
    /// the derivative of r with respect to s + σr.
    pub fn force_at(&self, i: usize, compliance: f64, augmented_travel: f64) -> (f64, f64) {
        let (weight, unit) = (self.weight[i], self.unit[i]);
        let (force, slope) = self.graph(i).force_at(compliance * weight / unit, augmented_travel / unit);
        (weight * force, weight / unit * slope)
    }

    /// The line of the steepest piece of the law of point i.
    pub fn steepest(&self, i: usize) -> Piece {
        self.piece(i, self.graph(i).steepest())
    }

    /// For each point (m,), whether its force depends on its travel on the piece of its law that `pieces` gives.
    pub fn holding(&self, pieces: &[u8]) -> Vec<bool> {
        (0..self.len()).map(|i| self.graph(i).piece(pieces[i]).holds()).collect()
    }

    /// For each point (m,), whether it can have a force on the piece of its law that `pieces` gives; false at open
    /// points.
    pub fn acting(&self, pieces: &[u8]) -> Vec<bool> {
        let acts = |piece: Piece| piece.holds() || piece.force != 0.0;
        (0..self.len()).map(|i| acts(self.graph(i).piece(pieces[i]))).collect()
    }

    /// For each point (m,), the first piece of its law on which the force depends on the travel if `holds` is true, or
    /// does not depend on the travel if `holds` is false. Piece 0 for a point without such a piece.
    pub fn pieces_holding(&self, holds: &[bool]) -> Vec<u8> {
        let first = |i: usize| (0..self.graph(i).pieces() as u8).find(|&p| self.graph(i).piece(p).holds() == holds[i]);
        (0..self.len()).map(|i| first(i).unwrap_or(0)).collect()
    }

    /// The first contact state: every point (m,) is on piece 0 of its law, where a one-sided point is open.
    pub fn first_pieces(&self) -> Vec<u8> {
        vec![0; self.len()]
    }

    pub fn has_straight(&self) -> bool {
        self.graph.iter().any(|&graph| self.graphs[graph as usize].is_straight())
    }

    pub fn is_straight(&self, i: usize) -> bool {
        self.graph(i).is_straight()
    }

    /// Whether row i of G has dofs of one element only.
    pub(super) fn is_narrow(&self, i: usize) -> bool {
        matches!(self.over[i], Over::One(_))
    }

    /// Whether a spring at point i is assembled with the element matrices, not as a multiplier row.
    pub(super) fn is_bedding(&self, i: usize) -> bool {
        self.deflects[i] && !matches!(self.over[i], Over::Several)
    }

    /// The smallest value of `of_element(e)` among all elements e on which rows of G act.
    pub(super) fn least_at(&self, of_element: impl Fn(usize) -> f64 + Sync) -> f64 {
        let least = |i: usize| self.elements(i).iter().map(|&e| of_element(e as usize)).fold(f64::INFINITY, f64::min);
        (0..self.len()).into_par_iter().with_min_len(4096).map(least).reduce(|| f64::INFINITY, f64::min)
    }

    /// Element matrices of springs with the stiffness `stiffness` (m,) at the contact points, except those that need
    /// multiplier rows.
    pub fn bedding(&self, plate: &Plate, stiffness: &[f64]) -> Bedding<'_> {
        let mut bedding = Bedding { pairs: &self.pairs, ..Bedding::default() };
        if stiffness.iter().all(|&k| k == 0.0) {
            return bedding;
        }
        bedding.own.resize(plate.elements().len(), [0.0; 36]);
        bedding.across.resize(self.pairs.len(), [[0.0; 8]; 8]);
        for i in (0..self.len()).filter(|&i| self.is_bedding(i) && stiffness[i] != 0.0) {
            let elements = self.elements(i);
            let mut rows = [[0.0; 8]; 2];
            for (dof, coefficient) in self.row(i) {
                let in_element = |&e: &u32| plate.leading(e as usize).iter().position(|&node| node == dof / 3);
                let mut places = elements.iter().map(in_element).zip(&mut rows);
                let (at, row) = places.find_map(|(at, row)| Some((at?, row))).expect("a node of its elements");
                row[at] += coefficient;
            }
            for (&element, row) in elements.iter().zip(&rows) {
                let sum = &mut bedding.own[element as usize];
                for a in 0..8 {
                    for b in 0..=a {
                        sum[packed(a, b)] += stiffness[i] * row[a] * row[b];
                    }
                }
            }
            let Over::Pair(pair) = self.over[i] else { continue };
            for (sums, own) in bedding.across[pair as usize].iter_mut().zip(rows[0]) {
                sums.iter_mut().zip(rows[1]).for_each(|(sum, other)| *sum += stiffness[i] * own * other);
            }
        }
        bedding
    }
}
