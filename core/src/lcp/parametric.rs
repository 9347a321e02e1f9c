//! Parametric linear complementarity: the bases that solve w = Mz + q + t d as t increases from zero.
use super::lemke::{WATCHED, default_max_pivots};
use super::problem::{Lcp, LcpError};
use super::ratio_test::{Stuck, choose};
use super::scaling::{CoveredLcp, Scaling};
use super::tableau::Tableau;
use super::tolerances;
use crate::dense::OutOfMemory;

/// How the path of a parametric problem ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParametricEnd {
    /// The path reached the requested largest t.
    Reached,
    /// For larger t no z ≥ 0 gives w ≥ 0, provided that M is positive semidefinite.
    Infeasible,
    /// The pivot limit was reached, t decreased (M is not positive semidefinite), or rounding made a basis singular.
    Stopped,
    /// The callback cancelled the path.
    Interrupted,
}

/// A complementary basis on the path, and the range of t in which this basis solves the problem.
#[derive(Clone, Debug, PartialEq)]
pub struct ParametricSegment {
    /// Smallest t at which the basis solves the problem.
    pub from: f64,
    /// Largest t at which the basis solves the problem; it may be infinite.
    pub to: f64,
    /// For each pair (m,), true if z_i is basic, so that w_i = 0.
    pub basis: Vec<bool>,
}

/// The solutions of w = Mz + q + t d for t ≥ 0. Within each segment z and w are linear in t.
#[derive(Clone, Debug)]
pub struct ParametricPath {
    pub segments: Vec<ParametricSegment>,
    pub end: ParametricEnd,
    pub pivots: usize,
}

/// Follows the solution of w = Mz + q + t d, w ≥ 0, z ≥ 0, zᵀw = 0 from t = 0 to t = `end`, with d = `direction` (m,).
/// `basis` (m,), true where z_i is basic, must solve the problem at t = 0.
///
/// t is the artificial variable of Lemke's algorithm with covering vector d, whose entries may have any sign. The
/// problem is transformed to `basis`, and t enters. When a variable falls to zero, its complement enters. If M is
/// positive semidefinite, t does not decrease. If no basic variable blocks the entering variable, t either grows
/// without bound or stays constant; if t stays constant, no larger t is feasible. The ratio test is lexicographic, so
/// there are finitely many pivots at each t. Segments of zero length are not returned. Every 64 pivots `watch` is
/// called with the number of pivots. If `watch` returns false, the path ends.
///
/// Returns an error if `direction` or `basis` does not have m entries, an entry is not finite, or the tableau does not
/// fit into memory.
///
/// # Source
/// Cottle, Pang & Stone (1992), section 4.5; Murty (1988), section 5.
///
/// # Example
/// ```
/// use signorini_core::lcp::{Lcp, LcpError, ParametricEnd, parametric};
///
/// // One spring closes at t = 1, the other at t = 3.
/// let (matrix, q, direction) = ([1.0, 0.0, 0.0, 1.0], [1.0, 3.0], [-1.0, -1.0]);
/// let path = parametric(&Lcp::new(&matrix, &q)?, &direction, &[false, false], f64::INFINITY, &mut |_| true)?;
/// let ends: Vec<f64> = path.segments.iter().map(|segment| segment.to).collect();
/// assert_eq!((ends, path.end), (vec![1.0, 3.0, f64::INFINITY], ParametricEnd::Reached));
/// assert_eq!(path.segments[1].basis, [true, false]);
/// # Ok::<(), LcpError>(())
/// ```
pub fn parametric(
    lcp: &Lcp,
    direction: &[f64],
    basis: &[bool],
    end: f64,
    watch: &mut dyn FnMut(usize) -> bool,
) -> Result<ParametricPath, LcpError> {
    lcp.check_length("direction", direction.len())?;
    lcp.check_length("basis", basis.len())?;
    if let Some(index) = direction.iter().position(|d| !d.is_finite()) {
        return Err(LcpError::Entry { name: "direction", index, value: direction[index] });
    }
    let mut path = ParametricPath { segments: Vec::new(), end: ParametricEnd::Reached, pivots: 0 };
    if direction.iter().all(|&d| d == 0.0) {
        path.segments.push(ParametricSegment { from: 0.0, to: f64::INFINITY, basis: basis.to_vec() });
        return Ok(path);
    }
    let scaling = Scaling::of(lcp);
    let (scaled, unit) = scaling.scale_along(lcp, direction);
    // If the unit of t is beyond the range of f64, the ends of the segments cannot be computed.
    match scaled.pivoted(basis)?.filter(|_| unit.is_normal()) {
        Some(origin) => path.end = follow(origin, basis, unit, end, &mut path, watch)?,
        None => path.end = ParametricEnd::Stopped,
    }
    Ok(path)
}

/// Follows the parametric path from the slack basis of a problem that is transformed to the basis `origin`. `unit` is
/// the t that corresponds to 1 in the scaled problem.
fn follow(
    mut problem: CoveredLcp,
    origin: &[bool],
    unit: f64,
    end: f64,
    path: &mut ParametricPath,
    watch: &mut dyn FnMut(usize) -> bool,
) -> Result<ParametricEnd, OutOfMemory> {
    let order = problem.order();
    // The basis solves the problem at t = 0, so negative entries of q are rounding errors.
    problem.q.iter_mut().for_each(|q| *q = q.max(0.0));
    let limit = default_max_pivots(order).max(1000);
    let mut tableau = Tableau::new(&problem)?;
    let parameter = tableau.artificial();
    let mut entering = parameter;
    let mut from = 0.0;
    let mut tied = Vec::new();
    loop {
        let leaving = match choose(&mut tableau, entering, &mut tied) {
            Ok(leaving) => leaving,
            Err(Stuck::Singular) => return Ok(ParametricEnd::Stopped),
            Err(Stuck::OutOfMemory) => return Err(OutOfMemory),
        };
        // From here to the next event, the entering variable is basic and the parameter t is not.
        let basic = |i: usize| tableau.is_basic(order + i) || entering == order + i;
        let basis: Vec<bool> = (0..order).map(|i| origin[i] != basic(i)).collect();
        let Some(leaving) = leaving else {
            let grows = match tableau.row_of(parameter) {
                Some(row) => tableau.column[row] > tolerances::PIVOT * largest(&tableau.column),
                None => true,
            };
            if !grows {
                return Ok(ParametricEnd::Infeasible);
            }
            path.segments.push(ParametricSegment { from: from * unit, to: f64::INFINITY, basis });
            return Ok(ParametricEnd::Reached);
        };
        if path.pivots == limit {
            return Ok(ParametricEnd::Stopped);
        }
        let left = tableau.exchange(leaving, entering)?;
        path.pivots += 1;
        if path.pivots % WATCHED == 0 && !watch(path.pivots) {
            return Ok(ParametricEnd::Interrupted);
        }
        let Some(row) = tableau.row_of(parameter) else {
            return Ok(ParametricEnd::Stopped);
        };
        let to = tableau.values[row];
        let least = tolerances::SAME_EVENT * to.abs().max(1.0);
        if to < from - least {
            return Ok(ParametricEnd::Stopped);
        }
        if to > from + least {
            path.segments.push(ParametricSegment { from: from * unit, to: to * unit, basis });
            from = to;
        }
        if from * unit >= end {
            return Ok(ParametricEnd::Reached);
        }
        entering = tableau.complement(left);
    }
}

fn largest(column: &[f64]) -> f64 {
    column.iter().fold(1.0, |a: f64, x| a.max(x.abs()))
}
