//! Choice of the leaving variable: the lexicographic minimum ratio test (Dantzig, Orden & Wolfe 1955).
//!
//! q is regarded as q + (ε, ε², …) with an arbitrarily small ε > 0. Then no two ratios are equal, the artificial
//! variable decreases at every pivot, and no basis occurs twice. In the values of the basic variables, the coefficients
//! of ε, ε², … are the columns of the initial basis. If slack j is nonbasic, column j is minus the column of slack j in
//! the tableau; if slack j is basic, column j is a unit vector.
use super::kernels::{LANES, largest_size};
use super::tableau::Tableau;
use super::tolerances;
use crate::dense::OutOfMemory;
use crate::vectorized::vectorized;

/// Row of the first pivot, in which the artificial variable enters: the lexicographic minimum of (q_i, e_i) / d_i, with
/// e_i row i of the unit matrix. This is the last row with the smallest q_i / d_i.
pub(super) fn first_row(values: &[f64], covering: &[f64]) -> usize {
    let ratios = || values.iter().zip(covering).map(|(q, d)| q / d);
    let least = ratios().fold(f64::INFINITY, f64::min);
    let tied = values.iter().zip(covering).rposition(|(q, d)| q - least * d <= tolerances::TIE * q.abs().max(1.0));
    tied.unwrap_or(0)
}

/// The row that leaves the basis, and whether its pivot is doubtful: so small that it may be a rounding error.
struct Leaving {
    row: usize,
    doubtful: bool,
}

/// The row that leaves the basis if the variable of `tableau.column` increases from zero; `None` if no basic variable
/// falls to zero.
///
/// If the artificial variable can leave, it leaves: the basis is then complementary. `tied` is workspace.
fn leaving_row(tableau: &Tableau, tied: &mut Vec<usize>) -> Option<Leaving> {
    let (values, column) = (&tableau.values, &tableau.column);
    let largest = vectorized(
        #[inline(always)]
        || {
            let largest = largest_size(column).max(1.0);
            let least = -tolerances::PIVOT * largest;
            let step = least_ratio(values, column, least);
            find_tied(values, column, least, step, tied);
            largest
        },
    );
    let row = match tied.iter().find(|&&i| tableau.row_variable[i] == tableau.artificial()) {
        Some(&i) => i,
        None => lexicographic_minimum(tableau, tied)?,
    };
    Some(Leaving { row, doubtful: -column[row] < tolerances::DOUBTFUL_PIVOT * largest })
}

/// A doubtful pivot is recomputed if at least this number of exchanges followed the last recomputation of the tableau:
/// the larger of `RECOMPUTE_AGE` and the order divided by `RECOMPUTE_PART`.
///
/// A recomputation costs as much as many exchanges, more with increasing order. If rounding errors dominate, every
/// pivot is doubtful. With this rule a path for 4057 contact points took 44 s; without the rule it had not ended after
/// two minutes.
const RECOMPUTE_AGE: usize = 16;
const RECOMPUTE_PART: usize = 32;

/// Reasons why the next pivot cannot be chosen.
pub(super) enum Stuck {
    /// Rounding made the basis of the tableau singular.
    Singular,
    OutOfMemory,
}

impl From<OutOfMemory> for Stuck {
    fn from(_: OutOfMemory) -> Self {
        Self::OutOfMemory
    }
}

/// Sets the entering variable and returns the row that leaves; `None` if no basic variable falls to zero. A doubtful
/// pivot, or the end of a path, is accepted only if the tableau was recomputed by a factorization shortly before.
pub(super) fn choose(tableau: &mut Tableau, entering: usize, tied: &mut Vec<usize>) -> Result<Option<usize>, Stuck> {
    loop {
        tableau.choose(entering);
        let leaving = leaving_row(tableau, tied);
        let trusted_age = match &leaving {
            Some(leaving) if leaving.doubtful => RECOMPUTE_AGE.max(tableau.order() / RECOMPUTE_PART),
            Some(_) => usize::MAX,
            None => 1,
        };
        if tableau.age < trusted_age {
            return Ok(leaving.map(|leaving| leaving.row));
        }
        *tableau = tableau.recomputed()?.ok_or(Stuck::Singular)?;
    }
}

fn lexicographic_minimum(tableau: &Tableau, tied: &mut Vec<usize>) -> Option<usize> {
    let column = &tableau.column;
    for slack in 0..tableau.order() {
        if tied.len() == 1 {
            break;
        }
        match tableau.row_of(slack) {
            Some(basic) => tied.retain(|&i| i != basic),
            None => {
                let entries = tableau.entries(tied, slack);
                let ratios: Vec<f64> = entries.iter().zip(&*tied).map(|(entry, &i)| entry / column[i]).collect();
                let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
                let bound = least + tolerances::TIE * least.abs().max(1.0);
                let mut ratio = ratios.iter();
                tied.retain(|_| ratio.next().is_some_and(|r| *r <= bound));
            }
        }
    }
    tied.iter().copied().min_by(|&a, &b| column[a].total_cmp(&column[b]))
}

/// Ratio test: the smallest max(value, 0) / −a over the rows with a < `least`, where a is the entry of the row in
/// `column`. Infinite without such a row.
#[inline(always)]
fn least_ratio(values: &[f64], column: &[f64], least: f64) -> f64 {
    let mut lanes = [f64::INFINITY; LANES];
    for (values, column) in values.chunks_exact(LANES).zip(column.chunks_exact(LANES)) {
        for ((lane, value), a) in lanes.iter_mut().zip(values).zip(column) {
            let value = if *value > 0.0 { *value } else { 0.0 };
            let ratio = if *a < least { value / -a } else { f64::INFINITY };
            *lane = if ratio < *lane { ratio } else { *lane };
        }
    }
    lanes.into_iter().fold(f64::INFINITY, f64::min)
}

/// Writes to `tied` the rows with an entry a < `least` in `column` whose basic variables are zero, within the
/// tolerance, when the entering variable is `step`.
#[inline(always)]
fn find_tied(values: &[f64], column: &[f64], least: f64, step: f64, tied: &mut Vec<usize>) {
    let reaches = |value: f64, a: f64| {
        let size = if value.abs() > 1.0 { value.abs() } else { 1.0 };
        (a < least) & (value + step * a <= tolerances::TIE * size)
    };
    tied.clear();
    for (chunk, (values, column)) in values.chunks_exact(LANES).zip(column.chunks_exact(LANES)).enumerate() {
        if values.iter().zip(column).fold(false, |any, (value, a)| any | reaches(*value, *a)) {
            for i in 0..LANES {
                if reaches(values[i], column[i]) {
                    tied.push(chunk * LANES + i);
                }
            }
        }
    }
}
