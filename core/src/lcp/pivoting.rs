//! Principal pivotal transforms, and the basic solution of a complementary basis.
use faer::{Mat, MatMut};

use super::scaling::CoveredLcp;
use super::tableau::{Parts, Tableau};
use super::tolerances;
use crate::dense::{Lu, OutOfMemory, matrix};
use crate::double_double::DoubleDouble;
use crate::vectorized::vectorized;

impl CoveredLcp<'_> {
    /// The problem with z_i and w_i exchanged where `basis` is true, and with a covering vector of ones. `None` if the
    /// principal submatrix of M for these indices is singular (Cottle, Pang & Stone 1992, section 2.3).
    pub(super) fn principal_transform(&self, basis: &[bool]) -> Result<Option<CoveredLcp<'static>>, OutOfMemory> {
        let ones = vec![1.0; self.order()];
        Ok(self.pivoted(basis)?.map(|pivoted| CoveredLcp { covering: ones, ..pivoted }))
    }

    /// As [`Self::principal_transform`], but the covering vector is transformed like q.
    pub(super) fn pivoted(&self, basis: &[bool]) -> Result<Option<CoveredLcp<'static>>, OutOfMemory> {
        let exchanged = indices(basis);
        let mut tableau = Tableau::new(self)?;
        if !tableau.exchange_block(&exchanged, &exchanged)? {
            return Ok(None);
        }
        let Parts { matrix, covering, q } = tableau.into_parts()?;
        Ok(Some(CoveredLcp { matrix: matrix.into(), units: vec![1.0; self.order()].into(), q, covering }))
    }

    /// Values of z and w at a complementary basis. Negative values within rounding become zero. `None` if the basis is
    /// singular, or if z or w has larger negative values.
    pub(super) fn basic_solution(&self, basis: &[bool]) -> Result<Option<BasicValues>, OutOfMemory> {
        let Some(basis) = Basis::of(self, basis)? else { return Ok(None) };
        let Some(mut result) = basis.values(self)?.filter(|result| result.feasible) else { return Ok(None) };
        result.z.iter_mut().chain(&mut result.w).for_each(|x| *x = x.max(0.0));
        Ok(Some(result))
    }

    /// The principal block M′_αα of the scaled M for the indices α. Eight rows are copied at a time, because M is
    /// row-major and the block column-major.
    fn principal_block(&self, indices: &[usize]) -> Result<Mat<f64>, OutOfMemory> {
        let order = self.order();
        let units: Vec<f64> = indices.iter().map(|&i| self.units[i]).collect();
        let mut block = matrix(indices.len(), indices.len(), |_, _| 0.0)?;
        for (tile, (rows, row_units)) in indices.chunks(8).zip(units.chunks(8)).enumerate() {
            for (j, (&column, unit)) in indices.iter().zip(&units).enumerate() {
                let target = &mut block.col_as_slice_mut(j)[8 * tile..];
                for ((a, row), row_unit) in target.iter_mut().zip(rows).zip(row_units) {
                    *a = self.matrix[row * order + column] * row_unit * unit;
                }
            }
        }
        Ok(block)
    }
}

/// A complementary basis, with the LU factors of the block of the scaled M′ in the rows and columns of the basic z.
pub(super) struct Basis {
    basis: Vec<bool>,
    basic: Vec<usize>,
    block: Mat<f64>,
    factors: Lu,
}

/// Values of z and w (m,) at a complementary basis; their entries may have any sign.
pub(super) struct BasicValues {
    pub(super) z: Vec<f64>,
    pub(super) w: Vec<f64>,
    /// Whether z ≥ 0 and w ≥ 0, up to rounding.
    pub(super) feasible: bool,
}

impl Basis {
    /// Factors the block of the scaled M′ in the rows and columns of the basic z; `None` if this block is singular.
    pub(super) fn of(problem: &CoveredLcp, basis: &[bool]) -> Result<Option<Self>, OutOfMemory> {
        let basic = indices(basis);
        let block = problem.principal_block(&basic)?;
        let factors = Lu::of(matrix(basic.len(), basic.len(), |i, j| block[(i, j)])?)?;
        let regular = factors.has_pivots_above(tolerances::PIVOT);
        Ok(regular.then(|| Self { basis: basis.to_vec(), basic, block, factors }))
    }

    /// Values of z and w, after one step of iterative refinement with a double-double residual. `None` if a value
    /// overflows.
    pub(super) fn values(&self, problem: &CoveredLcp) -> Result<Option<BasicValues>, OutOfMemory> {
        let (order, basic) = (problem.order(), &self.basic);
        let solve = |vector: &mut [f64]| {
            self.factors.solve_in_place(MatMut::from_column_major_slice_mut(vector, basic.len(), 1))
        };
        let right: Vec<f64> = basic.iter().map(|&i| -problem.q[i]).collect();
        let mut solution = right.clone();
        solve(&mut solution)?;
        let mut correction = residual(&self.block, &solution, &right);
        solve(&mut correction)?;
        solution.iter_mut().zip(&correction).for_each(|(x, c)| *x += c);
        if solution.iter().any(|x| !x.is_finite()) {
            return Ok(None);
        }
        let largest = solution.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut feasible = solution.iter().all(|&x| x >= -tolerances::FEASIBILITY * largest);
        let mut z = vec![0.0; order];
        basic.iter().zip(&solution).for_each(|(&i, x)| z[i] = *x);

        let work: f64 = basic.iter().map(|&j| (problem.q[j] * z[j]).abs()).sum();
        let scaled: Vec<f64> = basic.iter().map(|&j| z[j] * problem.units[j]).collect();
        let mut w = vec![0.0; order];
        for i in (0..order).filter(|&i| !self.basis[i]) {
            let row = &problem.matrix[i * order..(i + 1) * order];
            let (mut product, mut size) = (0.0, 0.0);
            for (&j, x) in basic.iter().zip(&scaled) {
                let term = row[j] * x;
                product += term;
                size += term.abs();
            }
            w[i] = problem.q[i] + product * problem.units[i];
            let size = problem.q[i].abs() + size * problem.units[i] + (problem.entry(i, i).abs() * work).sqrt();
            feasible &= w[i] >= -tolerances::FEASIBILITY * size;
        }
        Ok(Some(BasicValues { z, w, feasible }))
    }
}

/// The residual right − block · x, summed in double-double. Columns are added one after the other, so that the sums of
/// the rows can be formed in SIMD lanes.
fn residual(block: &Mat<f64>, x: &[f64], right: &[f64]) -> Vec<f64> {
    let (mut high, mut low) = (right.to_vec(), vec![0.0; right.len()]);
    vectorized(
        #[inline(always)]
        || {
            for (j, x) in x.iter().enumerate() {
                for ((hi, lo), a) in high.iter_mut().zip(&mut low).zip(block.col_as_slice(j)) {
                    let mut sum = DoubleDouble { hi: *hi, lo: *lo };
                    sum.add_product_fused(-a, *x);
                    (*hi, *lo) = (sum.hi, sum.lo);
                }
            }
        },
    );
    high.iter().zip(&low).map(|(hi, lo)| hi + lo).collect()
}

fn indices(basis: &[bool]) -> Vec<usize> {
    (0..basis.len()).filter(|&i| basis[i]).collect()
}
