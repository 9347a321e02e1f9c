//! Lemke's algorithm with the lexicographic ratio test.
use super::pivoting::BasicValues;
use super::problem::{Lcp, LcpError, LcpSolution, LcpStatus};
use super::ratio_test::{Stuck, choose, first_row};
use super::scaling::{CoveredLcp, Scaling};
use super::tableau::Tableau;
use super::tolerances;
use crate::dense::OutOfMemory;

/// Options of the function [`lemke`].
#[derive(Clone, Copy, Debug, Default)]
pub struct LemkeOptions<'a> {
    /// Covering vector d > 0 (m,) of a cold start; `None` means a vector of ones.
    pub covering: Option<&'a [f64]>,
    /// Largest number of pivots; `None` means [`default_max_pivots`].
    pub max_pivots: Option<usize>,
}

/// Default limit on the number of pivots for m pairs: 50 (m + 100). Plates need a few times m pivots. The worst known
/// problems need 2ᵐ, which is within the limit up to m = 12.
pub fn default_max_pivots(order: usize) -> usize {
    50 * (order + 100)
}

/// Solves w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0 by Lemke's algorithm.
///
/// The problem is embedded in w = Mz + q + d z₀, which is feasible for a large artificial variable z₀. The path of
/// almost complementary bases is followed until z₀ is zero. The ratio test is lexicographic, so the path is finite for
/// every M, and in degenerate problems. If M is copositive-plus (for example positive semidefinite) and the problem is
/// feasible, the path ends in [`LcpStatus::Solved`]. For such M, [`LcpStatus::Ray`] means that the problem is
/// infeasible, and the ray proves this. M need not be symmetric. The basic solution of the last basis is computed by a
/// new factorization, so that z and w are free of the tableau's rounding errors; z ≥ 0 and w ≥ 0 hold exactly.
///
/// M is first scaled by powers of two to largest entries of about 1, so the tolerances are relative. Memory is about
/// three times that of M. A pivot takes about 2 m² operations; the first m/8 pivots take far fewer.
///
/// Returns an error if the covering vector has the wrong length or an entry that is not positive, or if the tableau
/// does not fit into memory.
///
/// # Source
/// Lemke (1965); Cottle, Pang & Stone (1992), Algorithm 4.4.5 and, for the lexicographic rule, section 4.9.
///
/// # Example
/// ```
/// use signorini_core::lcp::{Lcp, LcpError, LcpStatus, LemkeOptions, lemke};
///
/// let (matrix, q) = ([1.0, 0.0, 0.0, 2.0, 1.0, 0.0, 2.0, 2.0, 1.0], [-8.0, -12.0, -14.0]);
/// let solution = lemke(&Lcp::new(&matrix, &q)?, &LemkeOptions::default())?;
/// assert_eq!(solution.status, LcpStatus::Solved);
/// assert_eq!((solution.z, solution.w), (vec![8.0, 0.0, 0.0], vec![0.0, 4.0, 2.0]));
/// assert_eq!(solution.pivots, 8);
/// # Ok::<(), LcpError>(())
/// ```
pub fn lemke(lcp: &Lcp, options: &LemkeOptions) -> Result<LcpSolution, LcpError> {
    lemke_watched(lcp, options, None, &mut |_, _| true)
}

/// Solves the problem of [`lemke`] from the complementary basis of an earlier problem with the same or a similar M.
///
/// The problem is first transformed to `basis` (m,), which is true where z_i is basic. If this basis is feasible, no
/// pivot is made. If it is not, a path starts there with a covering vector of ones. A cold start follows if the basis
/// is singular, or if the path ends neither at a solution nor on a ray that proves infeasibility.
///
/// Returns the same errors as [`lemke`], and an error if `basis` does not have m entries.
pub fn lemke_from(lcp: &Lcp, options: &LemkeOptions, basis: &[bool]) -> Result<LcpSolution, LcpError> {
    lemke_watched(lcp, options, Some(basis), &mut |_, _| true)
}

/// [`lemke`], or [`lemke_from`] if `basis` is present, with a callback. Every 64 pivots `watch` is called with the
/// number of pivots, and with the artificial variable relative to its first value. If `watch` returns false, the path
/// ends.
///
/// # Errors
/// See [`lemke`] and [`lemke_from`].
pub fn lemke_watched(
    lcp: &Lcp,
    options: &LemkeOptions,
    basis: Option<&[bool]>,
    watch: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<LcpSolution, LcpError> {
    if let Some(basis) = basis {
        lcp.check_length("basis", basis.len())?;
    }
    solve(lcp, options, basis, watch)
}

/// Largest number of restarts after the first path. A restart begins at the slack basis, or at the final basis of a
/// path from the slack basis, if the recomputed values of this final basis are infeasible.
const RESTARTS: usize = 4;

fn solve(
    lcp: &Lcp,
    options: &LemkeOptions,
    warm: Option<&[bool]>,
    watch: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<LcpSolution, LcpError> {
    if let Some(covering) = options.covering {
        check_covering(lcp, covering)?;
    }
    let limit = options.max_pivots.unwrap_or(default_max_pivots(lcp.order()));
    let scaling = Scaling::of(lcp);
    let problem = scaling.scale(lcp, options.covering);
    let solved = |basis: Vec<bool>, pivots: usize| {
        let Some(result) = problem.basic_solution(&basis)? else { return Ok(None) };
        let BasicValues { mut z, mut w, .. } = result;
        scaling.unscale_z(&mut z);
        scaling.unscale_w(&mut w);
        // Near the largest f64, the transformation of z and w to the original scale overflows.
        let finite = z.iter().chain(&w).all(|x| x.is_finite());
        let result = LcpSolution { z, w, basis, status: LcpStatus::Solved, pivots, ray: None };
        Ok::<_, OutOfMemory>(finite.then_some(result))
    };

    let slacks = vec![false; lcp.order()];
    let first = warm.unwrap_or(&slacks);
    if let Some(solution) = solved(first.to_vec(), 0)? {
        return Ok(solution);
    }
    let mut start = warm.map(<[bool]>::to_vec);
    let mut cold_start_left = true;
    let mut pivots = 0;
    for _ in 0..=RESTARTS {
        let warm_start = match start.take() {
            Some(basis) => problem.principal_transform(&basis)?.map(|from| (from, basis)),
            None => None,
        };
        let cold = warm_start.is_none();
        if cold && !cold_start_left {
            break;
        }
        cold_start_left &= !cold;
        let (from, origin) = warm_start.as_ref().map_or((&problem, &slacks), |(from, origin)| (from, origin));
        let path = follow_path(from, limit - pivots, &mut |more, left| watch(pivots + more, left))?;
        pivots += path.pivots;
        match path.end {
            End::Complementary(exchanged) => {
                let basis: Vec<bool> = origin.iter().zip(&exchanged).map(|(a, b)| a != b).collect();
                if let Some(solution) = solved(basis.clone(), pivots)? {
                    return Ok(solution);
                }
                start = Some(basis).filter(|_| !cold_start_left);
            }
            End::Ray(direction) => {
                let ray = scaling.unscaled_ray(origin, &direction);
                if cold || lcp.infeasibility(&ray)?.holds(tolerances::PROOF) {
                    return Ok(unsolved(lcp.order(), LcpStatus::Ray, pivots, Some(ray)));
                }
            }
            End::Stopped => {}
            End::Interrupted => return Ok(unsolved(lcp.order(), LcpStatus::Interrupted, pivots, None)),
        }
    }
    Ok(unsolved(lcp.order(), LcpStatus::PivotLimit, pivots, None))
}

fn unsolved(order: usize, status: LcpStatus, pivots: usize, ray: Option<Vec<f64>>) -> LcpSolution {
    let nan = vec![f64::NAN; order];
    LcpSolution { z: nan.clone(), w: nan, basis: vec![false; order], status, pivots, ray }
}

fn check_covering(lcp: &Lcp, covering: &[f64]) -> Result<(), LcpError> {
    lcp.check_length("covering", covering.len())?;
    match covering.iter().position(|c| !c.is_finite() || *c <= 0.0) {
        Some(index) => Err(LcpError::Covering { index, value: covering[index] }),
        None => Ok(()),
    }
}

/// Number of pivots between two calls of the callback; for a thousand pairs they take some milliseconds.
pub(super) const WATCHED: usize = 64;

/// How a path of almost complementary bases ended.
pub(super) enum End {
    /// The path ended at a complementary basis. An entry (m,) is true if slack and complement are exchanged relative to
    /// the start of the path.
    Complementary(Vec<bool>),
    /// The path ended on a ray with this direction (2m,): slacks first, then their complements.
    Ray(Vec<f64>),
    /// The pivot limit was reached, or rounding made the basis singular.
    Stopped,
    /// The callback cancelled the path.
    Interrupted,
}

pub(super) struct Path {
    pub(super) end: End,
    pub(super) pivots: usize,
}

/// Follows the path of almost complementary bases from the slack basis, with at most `limit` pivots.
pub(super) fn follow_path(
    problem: &CoveredLcp,
    limit: usize,
    watch: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<Path, OutOfMemory> {
    let order = problem.order();
    if problem.q.iter().all(|&q| q >= 0.0) {
        return Ok(Path { end: End::Complementary(vec![false; order]), pivots: 0 });
    }
    if limit == 0 {
        return Ok(Path { end: End::Stopped, pivots: 0 });
    }
    let mut tableau = Tableau::new(problem)?;
    let mut entering = tableau.artificial();
    let mut tied = Vec::new();
    let mut row = first_row(&problem.q, &problem.covering);
    let first = problem.q[row] / problem.covering[row];
    for pivots in 1..=limit {
        let left = tableau.exchange(row, entering)?;
        if left == tableau.artificial() {
            return Ok(Path { end: End::Complementary(tableau.complementary_basis()), pivots });
        }
        if pivots % WATCHED == 0 {
            let left = tableau.row_of(tableau.artificial()).map_or(0.0, |row| tableau.values[row]);
            if !watch(pivots, (left / first).abs()) {
                return Ok(Path { end: End::Interrupted, pivots });
            }
        }
        entering = tableau.complement(left);
        row = match choose(&mut tableau, entering, &mut tied) {
            Ok(Some(row)) => row,
            Ok(None) => return Ok(Path { end: End::Ray(tableau.direction(entering)), pivots }),
            Err(Stuck::Singular) => return Ok(Path { end: End::Stopped, pivots }),
            Err(Stuck::OutOfMemory) => return Err(OutOfMemory),
        };
    }
    Ok(Path { end: End::Stopped, pivots: limit })
}
