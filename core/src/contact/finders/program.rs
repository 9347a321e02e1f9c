//! The contact problem as a quadratic program, and proofs of infeasibility.

use crate::assembly::{Assembly, Bedding, HELD, Numbering};
use crate::contact::points::Points;
use crate::contact::problem::ContactProblem;
use crate::contact::scale::largest;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use crate::residual::residual;
use clarabel::algebra::CscMatrix;

/// The quadratic program min ½xᵀPx + qᵀx subject to Ax + s = b, scaled so that P has the diagonal 1 and each row of A
/// the norm 1.
///
/// A point travels along its pieces: g·u = s₀ − t₀ + Σ t_j with 0 ≤ t_j ≤ length_j and energy r_j t_j + ½ k_j t_j².
/// Vertical pieces have no t; a horizontal first piece without force is a slack.
pub(super) struct Program {
    /// Upper triangle of P.
    pub(super) quadratic: CscMatrix<f64>,
    pub(super) linear: Vec<f64>,
    pub(super) rows: CscMatrix<f64>,
    pub(super) right: Vec<f64>,
    pub(super) equations: usize,
    /// Row of each contact point.
    pub(super) row_of: Vec<usize>,
    /// Displacement per unit of x, and force per unit of a multiplier.
    pub(super) displacement_unit: Vec<f64>,
    pub(super) force_unit: Vec<f64>,
}

/// A row of A: columns and coefficients, and the right-hand side.
#[derive(Default)]
struct Row {
    entries: Vec<(usize, f64)>,
    right: f64,
}

/// A column for a travel: its quadratic and linear cost.
struct Travel {
    square: f64,
    linear: f64,
}

impl Program {
    /// Poses the program, scaled by the load, or by the gaps where there is no load.
    pub(super) fn pose(problem: &ContactProblem, numbering: &Numbering, load: &[f64], rest: &ContactSolution) -> Self {
        let ContactProblem { plate, springs, points, .. } = problem;
        let matrix = Assembly::new(plate, springs, &Bedding::default(), numbering).lower_triangle();
        let (n, m) = (numbering.len(), points.len());
        let lower = || (0..n).flat_map(|j| (matrix.column_start[j]..matrix.column_start[j + 1]).map(move |at| (j, at)));
        let mut unit = vec![1.0; n];
        for (j, at) in lower().filter(|&(j, at)| matrix.row[at] == j && matrix.value[at] > 0.0) {
            unit[j] = 1.0 / matrix.value[at].sqrt();
        }
        let mut p: Vec<_> =
            lower().map(|(j, at)| (j, matrix.row[at], unit[matrix.row[at]] * unit[j] * matrix.value[at])).collect();
        let travel = points.travel_from(&points.shift, &rest.displacement);
        let (mut equalities, mut inequalities) = (Vec::new(), Vec::new());
        let mut travels: Vec<Travel> = Vec::new();
        let mut place = Vec::with_capacity(m);
        for i in 0..m {
            let column = |(dof, c): (usize, f64)| (numbering.column[dof], c);
            let own = points.row(i).map(column).filter(|&(column, _)| column != HELD);
            let mut row =
                Row { entries: own.map(|(column, c)| (column, c * unit[column])).collect(), right: -travel[i] };
            let is_slack =
                add_travels(points, i, problem.scale.stiffness, n, &mut row, &mut travels, &mut inequalities);
            let table = if is_slack { &mut inequalities } else { &mut equalities };
            place.push((is_slack, table.len()));
            table.push(row);
        }
        let equations = equalities.len();
        let row_of = place.into_iter().map(|(is_slack, at)| if is_slack { equations + at } else { at }).collect();
        p.extend(travels.iter().enumerate().map(|(at, travel)| (n + at, n + at, travel.square)));
        let mut a = Vec::new();
        let mut norms = Vec::new();
        let mut right = Vec::new();
        for (at, row) in equalities.into_iter().chain(inequalities).enumerate() {
            let square = row.entries.iter().map(|(_, c)| c * c).sum::<f64>();
            let norm = if square > 0.0 { square.sqrt() } else { 1.0 };
            a.extend(row.entries.into_iter().map(|(column, c)| (at, column, c / norm)));
            right.push(row.right / norm);
            norms.push(norm);
        }
        let force = residual(plate, springs, load, &rest.displacement);
        let mut linear: Vec<f64> = (0..n).map(|j| -unit[j] * force[numbering.dof[j]]).collect();
        linear.extend(travels.iter().map(|travel| travel.linear));
        let size = [largest(&linear), largest(&right), 1.0].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
        linear.iter_mut().chain(&mut right).for_each(|value| *value /= size);
        let columns = n + travels.len();
        Self {
            quadratic: compressed(columns, columns, &p),
            linear,
            rows: compressed(norms.len(), columns, &a),
            right,
            equations,
            row_of,
            displacement_unit: unit.into_iter().map(|unit| size * unit).collect(),
            force_unit: norms.into_iter().map(|norm| size / norm).collect(),
        }
    }

    /// The contact state of travels and forces: travels relative to the largest displacement or gap, forces to the
    /// largest force.
    pub(super) fn pieces(&self, points: &Points, travel: &[f64], reaction: &[f64], multiplier: &[f64]) -> Vec<u8> {
        let size = largest(&self.displacement_unit);
        let force = largest(multiplier).max(largest(&self.linear));
        let compliance = |i: usize| {
            let unit = self.force_unit[self.row_of[i]];
            let length = largest(travel).max(largest(&points.shift)).max(f64::MIN_POSITIVE * size);
            length / (force * unit)
        };
        let at = |i: usize| {
            let compliance = compliance(i);
            points.piece_at(i, compliance, travel[i] + compliance * reaction[i])
        };
        (0..points.len()).map(at).collect()
    }

    /// Product of the first columns of A with x.
    fn travel(&self, x: &[f64]) -> Vec<f64> {
        let mut travel = vec![0.0; self.right.len()];
        for (j, x) in x.iter().enumerate() {
            for at in self.rows.colptr[j]..self.rows.colptr[j + 1] {
                travel[self.rows.rowval[at]] += self.rows.nzval[at] * x;
            }
        }
        travel
    }

    /// Whether multipliers z of the right sign prove that the constraints are infeasible: Aᵀz = 0 and bᵀz < 0.
    pub(super) fn gaps_contradict(&self, z: &[f64]) -> bool {
        let (mut sum, mut size) = (vec![0.0; self.rows.n], 0.0_f64);
        for (column, sum) in sum.iter_mut().enumerate() {
            let mut terms = 0.0;
            for at in self.rows.colptr[column]..self.rows.colptr[column + 1] {
                let term = self.rows.nzval[at] * z[self.rows.rowval[at]];
                *sum += term;
                terms += term.abs();
            }
            size = size.max(terms);
        }
        largest(&sum) <= tolerances::interior_point::PROOF * size && is_negative(&self.right, z)
    }

    /// Whether x is a motion without resistance on which the load works: Px = 0, Ax ≤ 0, qᵀx < 0.
    pub(super) fn moves_freely(&self, x: &[f64]) -> bool {
        let (mut force, mut force_size) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (j, start) in self.quadratic.colptr[..x.len()].iter().enumerate() {
            for at in *start..self.quadratic.colptr[j + 1] {
                let (i, value) = (self.quadratic.rowval[at], self.quadratic.nzval[at]);
                force[i] += value * x[j];
                force_size[i] += (value * x[j]).abs();
                if i != j {
                    force[j] += value * x[i];
                    force_size[j] += (value * x[i]).abs();
                }
            }
        }
        let against = |(row, &t): (usize, &f64)| if row < self.equations { t.abs() } else { t };
        let closing = self.travel(x).iter().enumerate().map(against).fold(0.0, f64::max);
        largest(&force) <= tolerances::interior_point::PROOF * largest(&force_size)
            && closing <= tolerances::interior_point::PROOF * largest(x)
            && is_negative(&self.linear, x)
    }
}

/// Adds the travels of a point to its row, and their bounds; returns whether the row has a slack. Travels on horizontal
/// pieces are scaled by the plate `stiffness`.
fn add_travels(
    points: &Points,
    i: usize,
    stiffness: f64,
    first: usize,
    row: &mut Row,
    travels: &mut Vec<Travel>,
    bounds: &mut Vec<Row>,
) -> bool {
    let graph = points.graph(i);
    let begin = points.piece(i, 0);
    let [travel, force] = points.ends(i, 0)[1].unwrap_or([begin.travel, begin.force]);
    row.right += travel - points.shift[i];
    let is_slack = !graph.is_straight() && begin.slope == 0.0 && begin.force == 0.0;
    let mut add = |slope: f64, force: f64, sign: f64, length: Option<f64>, is_bounded: bool| {
        let unit = 1.0 / if slope > 0.0 { slope } else { stiffness }.sqrt();
        let column = first + travels.len();
        travels.push(Travel { square: if slope > 0.0 { 1.0 } else { 0.0 }, linear: sign * force * unit });
        row.entries.push((column, -sign * unit));
        if is_bounded {
            bounds.push(Row { entries: vec![(column, -1.0)], right: 0.0 });
        }
        if let Some(length) = length {
            bounds.push(Row { entries: vec![(column, 1.0)], right: length / unit });
        }
    };
    if graph.is_straight() {
        if begin.slope.is_finite() {
            add(begin.slope, begin.force, 1.0, None, false);
        }
        return false;
    }
    if !is_slack && begin.slope.is_finite() {
        add(begin.slope, force, -1.0, None, true);
    }
    for number in 1..graph.pieces() as u8 {
        let piece = points.piece(i, number);
        if piece.slope.is_finite() {
            let [low, high] = points.ends(i, number);
            let length = high.zip(low).map(|(high, low)| high[0] - low[0]);
            let force = low.map_or(0.0, |end| end[1]);
            // The slack bounds the travel of the only piece.
            add(piece.slope, force, 1.0, length, !(is_slack && graph.pieces() == 2));
        }
    }
    is_slack
}

/// The sparse matrix of entries (row, column, value).
fn compressed(rows: usize, columns: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let (row, column) = entries.iter().map(|entry| (entry.0, entry.1)).unzip();
    CscMatrix::new_from_triplets(rows, columns, row, column, entries.iter().map(|entry| entry.2).collect())
}

/// Whether the product of two vectors is negative, beyond its residual.
fn is_negative(a: &[f64], b: &[f64]) -> bool {
    let terms = || a.iter().zip(b).map(|(a, b)| a * b);
    let scale: f64 = terms().map(f64::abs).sum();
    terms().sum::<f64>() < -tolerances::interior_point::MARGIN * scale
}
