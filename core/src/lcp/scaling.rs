//! Scaling of linear complementarity problems by powers of two, which causes no rounding.
use std::borrow::Cow;

use super::kernels::{LANES, largest_size};
use super::problem::Lcp;
use crate::dense::{OutOfMemory, room};
use crate::vectorized::vectorized;

/// The scaled problem w = M′z + q + d z₀ with M′_ij = u_i M_ij u_j; `units` is u and `covering` is d, each (m,).
pub(super) struct CoveredLcp<'a> {
    pub(super) matrix: Cow<'a, [f64]>,
    pub(super) units: Cow<'a, [f64]>,
    pub(super) q: Vec<f64>,
    pub(super) covering: Vec<f64>,
}

impl CoveredLcp<'_> {
    pub(super) fn order(&self) -> usize {
        self.q.len()
    }

    /// Entry (i, j) of the scaled matrix M′.
    pub(super) fn entry(&self, i: usize, j: usize) -> f64 {
        self.matrix[i * self.order() + j] * self.units[i] * self.units[j]
    }

    pub(super) fn into_owned(self) -> Result<CoveredLcp<'static>, OutOfMemory> {
        let mut matrix = room(self.matrix.len())?;
        matrix.extend_from_slice(&self.matrix);
        Ok(CoveredLcp {
            matrix: Cow::Owned(matrix),
            units: Cow::Owned(self.units.into_owned()),
            q: self.q,
            covering: self.covering,
        })
    }

    /// Copies column j of M′ to `target`; for j = m, with m the order, copies the covering vector.
    pub(super) fn copy_column(&self, j: usize, target: &mut [f64]) {
        let order = self.order();
        if j == order {
            target[..order].copy_from_slice(&self.covering);
            return;
        }
        let column = self.matrix[j..].iter().step_by(order);
        for ((target, entry), unit) in target.iter_mut().zip(column).zip(self.units.iter()) {
            *target = entry * unit * self.units[j];
        }
    }
}

/// The scaling z = σ D z′, w = σ D⁻¹ w′ with M′ = DMD and q′ = Dq/σ. It is symmetric, so M′ is semidefinite or
/// copositive if M is.
///
/// D (`diagonal`) makes the largest entry in row and column i of M′ about 1, for each i. σ (`load`) makes the most
/// negative entry of q′ about −1. If the diagonal has the largest entries of M, as in a semidefinite M, D follows from
/// the diagonal. If not, rows and columns are equilibrated together (Ruiz 2001).
pub(super) struct Scaling {
    diagonal: Vec<f64>,
    load: f64,
}

/// Largest number of passes over M in the equilibration of rows and columns.
const PASSES: usize = 4;

/// Equilibration of rows and columns ends if the largest entry of each is within this factor of 1.
const EVEN: f64 = 4.0;

/// Entries of the diagonal scaling D are between 2⁻⁴⁰⁰ and 2⁴⁰⁰, so that products with them stay finite.
const LEAST: f64 = 1.0 / MOST;
const MOST: f64 = f64::from_bits((1023 + 400) << 52);

impl Scaling {
    pub(super) fn of(lcp: &Lcp) -> Self {
        let order = lcp.order();
        let mut diagonal: Vec<f64> = (0..order).map(|i| even_factor(lcp.row(i)[i].abs())).collect();
        for _ in 0..PASSES {
            let largest = largest_entries(lcp, &diagonal);
            if largest.iter().all(|&a| a == 0.0 || (a >= EVEN.recip() && a <= EVEN)) {
                break;
            }
            diagonal.iter_mut().zip(&largest).for_each(|(d, a)| *d = (*d * even_factor(*a)).clamp(LEAST, MOST));
        }
        let load = load_of(lcp.q(), &diagonal);
        Self { diagonal, load }
    }

    pub(super) fn scale<'a>(&'a self, lcp: &Lcp<'a>, covering: Option<&[f64]>) -> CoveredLcp<'a> {
        let d = &self.diagonal;
        let mut cover: Vec<f64> = match covering {
            Some(c) => c.iter().zip(d).map(|(a, di)| a * di).collect(),
            None => d.clone(),
        };
        let size = power_of_two(cover.iter().copied());
        cover.iter_mut().for_each(|c| *c = (*c / size).max(f64::MIN_POSITIVE));
        CoveredLcp {
            matrix: Cow::Borrowed(lcp.matrix()),
            units: Cow::Borrowed(d),
            q: self.scale_q(lcp.q()),
            covering: cover,
        }
    }

    /// The scaled problem with the vector `direction` (m,), of any signs, as covering vector. The second value is the t
    /// that corresponds to 1 in the scaled problem.
    pub(super) fn scale_along<'a>(&'a self, lcp: &Lcp<'a>, direction: &[f64]) -> (CoveredLcp<'a>, f64) {
        let mut scaled = self.scale(lcp, None);
        let size = power_of_two(direction.iter().zip(&self.diagonal).map(|(a, d)| (a * d).abs()));
        scaled.covering = direction.iter().zip(&self.diagonal).map(|(a, d)| a * d / size).collect();
        (scaled, self.load / size)
    }

    /// The scaled vector D q/σ (m,), with σ computed from this q.
    pub(super) fn scale_q(&self, q: &[f64]) -> Vec<f64> {
        let load = load_of(q, &self.diagonal);
        q.iter().zip(&self.diagonal).map(|(a, d)| a * d / load).collect()
    }

    /// Direction (m,) of z, in the original scale, on a ray of the problem transformed to the basis `origin`. It is
    /// scaled to a largest entry of 1.
    pub(super) fn unscaled_ray(&self, origin: &[bool], direction: &[f64]) -> Vec<f64> {
        let (slack, complement) = direction.split_at(origin.len());
        let mut ray: Vec<f64> =
            origin.iter().enumerate().map(|(i, &basic)| if basic { slack[i] } else { complement[i] }).collect();
        self.unscale_z(&mut ray);
        let largest = ray.iter().fold(0.0_f64, |a, x| a.max(*x));
        ray.iter_mut().for_each(|x| *x /= largest);
        ray
    }

    pub(super) fn unscale_z(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.diagonal).for_each(|(x, d)| *x *= d * self.load);
    }

    pub(super) fn unscale_w(&self, w: &mut [f64]) {
        w.iter_mut().zip(&self.diagonal).for_each(|(x, d)| *x *= self.load / d);
    }
}

/// The scale σ of q: a power of two near the magnitude of the most negative entry of Dq, or near the largest entry if
/// none is negative. A large positive q_i, such as a wide gap, must not reduce the other entries.
fn load_of(q: &[f64], diagonal: &[f64]) -> f64 {
    let scaled = || q.iter().zip(diagonal).map(|(a, d)| a * d);
    let short = power_of_two(scaled().filter(|a| *a < 0.0).map(f64::abs));
    if scaled().any(|a| a < 0.0) { short } else { power_of_two(scaled()) }
}

/// For each i, the largest entry |D_i M_ij D_j| of the scaled matrix in row i or column i.
fn largest_entries(lcp: &Lcp, diagonal: &[f64]) -> Vec<f64> {
    let order = lcp.order();
    let mut largest = vec![0.0_f64; order];
    let mut sizes = vec![0.0; order.next_multiple_of(LANES)];
    vectorized(
        #[inline(always)]
        || {
            for (i, di) in diagonal.iter().enumerate() {
                for (((c, size), a), d) in largest.iter_mut().zip(&mut sizes).zip(lcp.row(i)).zip(diagonal) {
                    *size = a.abs() * di * d;
                    *c = if *size > *c { *size } else { *c };
                }
                largest[i] = largest[i].max(largest_size(&sizes));
            }
        },
    );
    largest
}

/// The power of two f near 1/√size, so that ½ ≤ f² size < 2; 1 if `size` is zero or not finite.
fn even_factor(size: f64) -> f64 {
    if size <= 0.0 || !size.is_finite() {
        return 1.0;
    }
    let exponent = (size.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 + (-exponent).div_euclid(2)) as u64) << 52).clamp(LEAST, MOST)
}

/// The largest power of two up to the largest of `sizes`; 1 if all are zero or one is not finite.
fn power_of_two(sizes: impl Iterator<Item = f64>) -> f64 {
    let largest = sizes.fold(0.0, f64::max);
    if largest > 0.0 && largest.is_finite() { largest.log2().floor().exp2() } else { 1.0 }
}
