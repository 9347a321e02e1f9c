//! Scaling by powers of two, which changes no digit and no pivot.
use super::problem::Lcp;

/// w = Mz + q + d z₀ with a covering vector d > 0: what a Lemke path starts from. M is m×m, row-major.
pub(super) struct CoveredLcp {
    pub(super) matrix: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) covering: Vec<f64>,
}

impl CoveredLcp {
    pub(super) fn order(&self) -> usize {
        self.q.len()
    }
}

/// z = σ D z′, w = σ D⁻¹ w′ with M′ = DMD, q′ = Dq/σ: a symmetric scaling keeps M in its class.
///
/// D brings the largest entry of every row and column pair of M to about one (Ruiz 2001), σ the largest of q.
pub(super) struct Scaling {
    diagonal: Vec<f64>,
    load: f64,
}

const PASSES: usize = 4;

/// D is kept within 2^±LIMIT, so that its products stay finite.
const LIMIT: f64 = 400.0;

impl Scaling {
    pub(super) fn of(lcp: &Lcp) -> Self {
        let order = lcp.order();
        let mut diagonal = vec![1.0_f64; order];
        for _ in 0..PASSES {
            let mut largest = vec![0.0_f64; order];
            for i in 0..order {
                for (j, a) in lcp.row(i).iter().enumerate() {
                    let scaled = a.abs() * diagonal[i] * diagonal[j];
                    largest[i] = largest[i].max(scaled);
                    largest[j] = largest[j].max(scaled);
                }
            }
            for (d, a) in diagonal.iter_mut().zip(&largest) {
                if *a > 0.0 && a.is_finite() {
                    *d /= a.sqrt();
                }
            }
        }
        for d in &mut diagonal {
            *d = d.log2().clamp(-LIMIT, LIMIT).round().exp2();
        }
        let load = power_of_two(lcp.q().iter().zip(&diagonal).map(|(a, d)| (a * d).abs()));
        Self { diagonal, load }
    }

    pub(super) fn scale(&self, lcp: &Lcp, covering: Option<&[f64]>) -> CoveredLcp {
        let d = &self.diagonal;
        let rows = d.iter().enumerate();
        let matrix = rows.flat_map(|(i, di)| lcp.row(i).iter().zip(d).map(move |(a, dj)| a * di * dj)).collect();
        let q = lcp.q().iter().zip(d).map(|(a, di)| a * di / self.load).collect();
        let mut cover: Vec<f64> = match covering {
            Some(c) => c.iter().zip(d).map(|(a, di)| a * di).collect(),
            None => d.clone(),
        };
        let size = power_of_two(cover.iter().copied());
        cover.iter_mut().for_each(|c| *c = (*c / size).max(f64::MIN_POSITIVE));
        CoveredLcp { matrix, q, covering: cover }
    }

    pub(super) fn unscale_z(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.diagonal).for_each(|(x, d)| *x *= d * self.load);
    }

    pub(super) fn unscale_w(&self, w: &mut [f64]) {
        w.iter_mut().zip(&self.diagonal).for_each(|(x, d)| *x *= self.load / d);
    }
}

/// The power of two at or below the largest of `sizes`; 1 if that is zero.
fn power_of_two(sizes: impl Iterator<Item = f64>) -> f64 {
    let largest = sizes.fold(0.0, f64::max);
    if largest > 0.0 && largest.is_finite() { largest.log2().floor().exp2() } else { 1.0 }
}
