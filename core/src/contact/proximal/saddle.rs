//! The equations of one contact state with displacements and reactions both unknown:
//!
//! ```text
//! K  Gᵀ   u     f
//! G  −C   R  =  g
//! ```
//!
//! Condensed onto points that nearly repeat each other, P = GK⁻¹Gᵀ holds what tells them apart squared; here it stands
//! as it is (Benzi, Golub & Liesen 2005, section 5). So are the shear forces of thin elements ([`Shears`]).

use super::regularized::Regularized;
use super::shears::Shears;
use crate::assembly::{HELD, assemble_thick};
use crate::contact::problem::ContactProblem;
use crate::contact::tolerances;
use crate::double_double::DoubleDouble;
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};

/// Solves with one right-hand side, each of what the one before left.
const REFINEMENTS: usize = 4;

/// The system of one contact state, factored.
pub(super) struct Saddle {
    factor: Lu<usize, f64>,
    /// Closed points, one a row behind the free dofs; behind them what thin elements have inside.
    points: Vec<usize>,
    /// Lower triangle of the system, each entry with its row and column.
    entries: Vec<(usize, usize, f64)>,
    /// What rows and columns are multiplied by, so that their largest entries are about 1.
    unit: Vec<f64>,
}

impl Saddle {
    /// `None` if the system is singular.
    pub(super) fn of(regularized: &Regularized, closed: &[bool]) -> Option<Self> {
        let problem = regularized.problem;
        let (plate, constraints, numbering) = (&problem.plate, &problem.constraints, &problem.numbering);
        let points: Vec<usize> = (0..closed.len()).filter(|&i| closed[i]).collect();
        let free = numbering.len();
        let behind = free + points.len();
        let stiffness = assemble_thick(plate, &problem.springs, numbering);
        let shears = Shears::of(plate, numbering, behind);
        let mut unit = vec![1.0; behind];
        unit.extend(shears.unit);
        let mut entries = Vec::with_capacity(2 * stiffness.value.len() + shears.entries.len());
        for column in 0..free {
            for at in stiffness.column_start[column]..stiffness.column_start[column + 1] {
                let (row, mut value) = (stiffness.row[at], stiffness.value[at]);
                if row == column {
                    let bed = if numbering.dof[row] % 3 == 0 { regularized.bed } else { 0.0 };
                    let own = value + shears.stiffness[row];
                    let least = bed.max(tolerances::SUM * own);
                    value += least;
                    unit[row] = 1.0 / (own + least).sqrt();
                }
                if value != 0.0 {
                    entries.push((row, column, value));
                }
            }
        }
        entries.extend(shears.entries);
        for (at, &point) in points.iter().enumerate() {
            let row = free + at;
            let mut largest = 0.0_f64;
            for (dof, value) in constraints.rows.entries(plate, point) {
                let column = numbering.column[dof];
                if column != HELD {
                    entries.push((row, column, value));
                    largest = largest.max(value.abs() * unit[column]);
                }
            }
            entries.push((row, row, -regularized.compliance[point]));
            if largest > 0.0 {
                unit[row] = 1.0 / largest;
            }
        }
        for (row, column, value) in &mut entries {
            *value *= unit[*row] * unit[*column];
        }
        let both = |&(row, column, value): &(usize, usize, f64)| {
            let mirrored = (row != column).then_some(Triplet::new(column, row, value));
            [Some(Triplet::new(row, column, value)), mirrored]
        };
        let triplets: Vec<_> = entries.iter().flat_map(both).flatten().collect();
        let matrix = SparseColMat::try_new_from_triplets(unit.len(), unit.len(), &triplets).ok()?;
        Some(Self { factor: matrix.sp_lu().ok()?, points, entries, unit })
    }

    /// The motion of the nodes and the increments of reaction that an imbalance and what is left of the gaps ask for.
    pub(super) fn response(
        &self,
        problem: &ContactProblem,
        imbalance: &[f64],
        remaining: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut right = problem.gather(imbalance);
        let free = right.len();
        right.extend(self.points.iter().map(|&point| remaining[point]));
        right.resize(self.unit.len(), 0.0);
        right.iter_mut().zip(&self.unit).for_each(|(value, unit)| *value *= unit);
        let mut unknown = vec![0.0; right.len()];
        let mut left = right.clone();
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        for _ in 0..REFINEMENTS {
            let mut increment = Mat::from_fn(left.len(), 1, |i, _| left[i]);
            self.factor.solve_in_place(increment.as_mut());
            unknown.iter_mut().enumerate().for_each(|(i, value)| *value += increment[(i, 0)]);
            left = self.left(&right, &unknown);
            if largest(&left) <= f64::EPSILON * largest(&right) {
                break;
            }
        }
        unknown.iter_mut().zip(&self.unit).for_each(|(value, unit)| *value *= unit);
        let mut reaction = vec![0.0; problem.constraints.rows.len()];
        for (&point, value) in self.points.iter().zip(&unknown[free..]) {
            reaction[point] = *value;
        }
        (problem.scatter(&unknown[..free]), reaction)
    }
    /// What the unknowns leave of the right-hand side, both scaled: exact, since a loose plate's motions are the sums of
    /// what nearly cancels.
    fn left(&self, right: &[f64], unknown: &[f64]) -> Vec<f64> {
        let mut left: Vec<DoubleDouble> = right.iter().map(|&value| DoubleDouble::from(value)).collect();
        for &(row, column, value) in &self.entries {
            left[row].add_product(-value, unknown[column]);
            if row != column {
                left[column].add_product(-value, unknown[row]);
            }
        }
        left.into_iter().map(DoubleDouble::value).collect()
    }
}
