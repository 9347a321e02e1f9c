//! The equations of one contact state with displacements and reactions both unknown:
//!
//! ```text
//! K  Gᵀ   u     f
//! G  −C   R  =  g
//! ```
//!
//! Condensed onto points that nearly repeat each other, P = GK⁻¹Gᵀ holds what tells them apart squared; here it stands
//! as it is (Benzi, Golub & Liesen 2005, section 5). So are the shear forces of thin elements ([`Shears`]).

use super::refinement::Correction;
use super::shears::Shears;
use crate::assembly::{Assembly, HELD};
use crate::contact::problem::ContactProblem;
use crate::contact::tolerances;
use crate::dense::OutOfMemory;
use crate::double_double::DoubleDouble;
use crate::vectorized::vectorized;
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{FaerError, SparseColMat, Triplet};

/// Right-hand sides for which the factor is read once: two registers of the widest machines.
pub(crate) const TOGETHER: usize = 16;

/// Solves with one right-hand side, each of what the one before left.
const REFINEMENTS: usize = 4;

/// A contact problem with what increments meet.
pub(crate) struct Regularized<'a> {
    pub(crate) problem: &'a ContactProblem,
    /// Compliance of every point's support, and at least what its increments meet.
    pub(crate) compliance: Vec<f64>,
    /// Stiffness that an increment of deflection meets at every node.
    bed: f64,
}

impl<'a> Regularized<'a> {
    /// Increments of reaction meet at least `part` of the plate's own compliance.
    pub(crate) fn of(problem: &'a ContactProblem, part: f64) -> Self {
        assert!(problem.active.is_empty(), "all points are condensed");
        let stiffness = problem.scale.stiffness;
        let least = |i: usize| part / (problem.lever(i) * problem.lever(i) * stiffness);
        let own = problem.constraints.compliance.iter().enumerate();
        let compliance = own.map(|(i, own)| own.max(least(i))).collect();
        let kept = (tolerances::proximal::STIFFNESS * part.sqrt()).max(tolerances::proximal::LEAST_STIFFNESS);
        Self { problem, compliance, bed: kept * stiffness / problem.plate.node_count() as f64 }
    }
}

/// The system of one contact state, factored.
pub(crate) struct Saddle {
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
    pub(crate) fn of(regularized: &Regularized, closed: &[bool]) -> Result<Option<Self>, OutOfMemory> {
        let problem = regularized.problem;
        let (plate, constraints, numbering) = (&problem.plate, &problem.constraints, &problem.numbering);
        let points: Vec<usize> = (0..closed.len()).filter(|&i| closed[i]).collect();
        let free = numbering.len();
        let behind = free + points.len();
        let stiffness = Assembly::new(plate, &problem.springs, &[], numbering).thick_only().lower_triangle();
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
        let matrix = SparseColMat::try_new_from_triplets(unit.len(), unit.len(), &triplets).map_err(|_| OutOfMemory)?;
        match matrix.sp_lu() {
            Ok(factor) => Ok(Some(Self { factor, points, entries, unit })),
            Err(LuError::Generic(FaerError::OutOfMemory)) => Err(OutOfMemory),
            Err(_) => Ok(None),
        }
    }

    /// The motion of the nodes and the increments of reaction that an imbalance and what is left of the gaps ask for.
    pub(crate) fn response(&self, problem: &ContactProblem, imbalance: &[f64], remaining: &[f64]) -> Correction {
        let right = self.right(problem, imbalance, remaining);
        let unknown = self.solve::<1>([right]);
        let free = problem.numbering.len();
        let value = |i: usize| self.unit[i] * unknown[i][0];
        let mut reaction = vec![0.0; problem.constraints.rows.len()];
        for (at, &point) in self.points.iter().enumerate() {
            reaction[point] = value(free + at);
        }
        let moved: Vec<f64> = (0..free).map(value).collect();
        Correction::of(problem.scatter(&moved), reaction)
    }

    /// The motions of the nodes under [`TOGETHER`] imbalances alone.
    pub(crate) fn motions(&self, problem: &ContactProblem, imbalances: &[Vec<f64>; TOGETHER]) -> [Vec<f64>; TOGETHER] {
        let still = vec![0.0; problem.constraints.rows.len()];
        let unknown = self.solve(imbalances.each_ref().map(|imbalance| self.right(problem, imbalance, &still)));
        let free = problem.numbering.len();
        std::array::from_fn(|k| {
            let moved: Vec<f64> = (0..free).map(|i| self.unit[i] * unknown[i][k]).collect();
            problem.scatter(&moved)
        })
    }

    /// The scaled right-hand side.
    fn right(&self, problem: &ContactProblem, imbalance: &[f64], remaining: &[f64]) -> Vec<f64> {
        let mut right = problem.gather(imbalance);
        right.extend(self.points.iter().map(|&point| remaining[point]));
        right.resize(self.unit.len(), 0.0);
        right.iter_mut().zip(&self.unit).for_each(|(value, unit)| *value *= unit);
        right
    }

    /// The scaled unknowns of `N` right-hand sides side by side, each solve correcting what the one before left.
    fn solve<const N: usize>(&self, right: [Vec<f64>; N]) -> Vec<[f64; N]> {
        let size = self.unit.len();
        let right: Vec<[f64; N]> = (0..size).map(|i| std::array::from_fn(|k| right[k][i])).collect();
        let largest = |values: &[[f64; N]], k: usize| values.iter().fold(0.0, |most: f64, row| most.max(row[k].abs()));
        let mut unknown = vec![[0.0; N]; size];
        let mut left = right.clone();
        for _ in 0..REFINEMENTS {
            let mut increment = Mat::from_fn(size, N, |i, k| left[i][k]);
            self.factor.solve_in_place(increment.as_mut());
            for (i, unknown) in unknown.iter_mut().enumerate() {
                (0..N).for_each(|k| unknown[k] += increment[(i, k)]);
            }
            left = self.left(&right, &unknown);
            if (0..N).all(|k| largest(&left, k) <= f64::EPSILON * largest(&right, k)) {
                break;
            }
        }
        unknown
    }

    /// What the unknowns leave of right-hand sides, all scaled: exact, since a loose plate's motions are the sums of what
    /// nearly cancels.
    fn left<const N: usize>(&self, right: &[[f64; N]], unknown: &[[f64; N]]) -> Vec<[f64; N]> {
        let (mut high, mut low) = (right.to_vec(), vec![[0.0; N]; right.len()]);
        vectorized(
            #[inline(always)]
            || {
                for &(row, column, value) in &self.entries {
                    // An entry off the diagonal stands in the upper triangle too.
                    for (row, column) in [(row, column), (column, row)].into_iter().take(1 + usize::from(row != column))
                    {
                        let (high, low, unknown) = (&mut high[row], &mut low[row], &unknown[column]);
                        for k in 0..N {
                            let mut sum = DoubleDouble { hi: high[k], lo: low[k] };
                            sum.add_product_fused(-value, unknown[k]);
                            (high[k], low[k]) = (sum.hi, sum.lo);
                        }
                    }
                }
            },
        );
        high.iter().zip(&low).map(|(high, low)| std::array::from_fn(|k| high[k] + low[k])).collect()
    }
}
