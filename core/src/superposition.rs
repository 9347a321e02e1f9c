//! Linear combinations of many vectors, and extremes of these sums.
//!
//! Each sum adds the vectors in their order, so that its bits do not depend on other sums.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Number of entries in a tile, whose sums stay in registers.
const TILE: usize = 16;
/// Number of entries of an envelope in one parallel chunk.
const SHARE: usize = 1024;

/// Product (k, n) of coefficients (k, b) and vectors (b, n), all row-major; `count` is b.
pub fn superpose(coefficients: &[f64], vectors: &[f64], count: usize) -> Vec<f64> {
    let length = vectors.len() / count.max(1);
    if length == 0 || count == 0 {
        return Vec::new();
    }
    let mut out = vec![0.0; coefficients.len() / count * length];
    out.par_chunks_mut(length).with_min_len(16).zip(coefficients.par_chunks(count)).for_each(|(sum, row)| {
        Arch::new().dispatch(Superpose { sum, row, vectors });
    });
    out
}

/// Sum of `count` terms. They are computed in parallel and added in order, so that the bits do not depend on the number
/// of threads. A thread computes at least `least` consecutive terms.
pub fn sum_in_order(count: usize, least: usize, term: impl Fn(usize) -> f64 + Send + Sync) -> f64 {
    let terms: Vec<f64> = (0..count).into_par_iter().with_min_len(least).map(term).collect();
    terms.iter().sum()
}

struct Superpose<'a> {
    sum: &'a mut [f64],
    row: &'a [f64],
    vectors: &'a [f64],
}

impl WithSimd for Superpose<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let length = self.sum.len();
        let (sum, sum_end) = S::as_mut_simd_f64s(self.sum);
        for (vector, factor) in self.vectors.chunks_exact(length).zip(self.row) {
            let (vector, end) = S::as_simd_f64s(vector);
            let broad = simd.splat_f64s(*factor);
            for (s, v) in sum.iter_mut().zip(vector) {
                *s = simd.mul_add_f64s(broad, *v, *s);
            }
            sum_end.iter_mut().zip(end).for_each(|(s, v)| *s = factor.mul_add(*v, *s));
        }
    }
}

/// Envelope of many sums (n,): the largest and smallest value of each entry, and the numbers of the combinations that
/// attain them.
pub struct Envelope<'a> {
    pub largest: &'a mut [f64],
    pub largest_by: &'a mut [i64],
    pub smallest: &'a mut [f64],
    pub smallest_by: &'a mut [i64],
}

/// Largest and smallest entry of a sum, and the indices of these entries.
#[derive(Clone, Copy, Debug)]
pub struct Peak {
    pub largest: f64,
    pub largest_at: usize,
    pub smallest: f64,
    pub smallest_at: usize,
}

/// Entries that are excluded from the extremes of a sum. `class` (n,) is the class of each entry; `sums` (k, `classes`)
/// is true where a sum excludes a class.
#[derive(Clone, Copy)]
pub struct LeftOut<'a> {
    pub class: &'a [i64],
    pub sums: &'a [bool],
    pub classes: usize,
}

impl LeftOut<'_> {
    /// Updates the extremes `peak` of a sum with the entries from index `first` on that are not excluded.
    ///
    /// The function is rarely called and kept out of the loop over sums.
    #[cold]
    #[inline(never)]
    fn look(&self, sum: usize, first: usize, entries: &[f64], peak: &mut Peak) {
        let without = &self.sums[sum * self.classes..][..self.classes];
        for (at, &s) in (first..).zip(entries) {
            if (s > peak.largest || s < peak.smallest) && !without[self.class[at] as usize] {
                *peak = peak.or(Peak { largest: s, largest_at: at, smallest: s, smallest_at: at });
            }
        }
    }
}

const NO_PEAK: Peak = Peak { largest: f64::NEG_INFINITY, largest_at: 0, smallest: f64::INFINITY, smallest_at: 0 };

impl Peak {
    /// The extremes over the entries of both peaks. If values are equal, the index is that of `self`.
    fn or(self, other: Self) -> Self {
        let (largest, largest_at) = if other.largest > self.largest {
            (other.largest, other.largest_at)
        } else {
            (self.largest, self.largest_at)
        };
        let (smallest, smallest_at) = if other.smallest < self.smallest {
            (other.smallest, other.smallest_at)
        } else {
            (self.smallest, self.smallest_at)
        };
        Self { largest, largest_at, smallest, smallest_at }
    }
}

/// Updates an envelope with the sums of vectors (b, n) with coefficients (k, b), and returns the extremes of each sum.
/// `who` (k,) has the numbers of the combinations. Sums are computed tile by tile and not stored.
pub fn envelop(
    coefficients: &[f64],
    vectors: &[f64],
    who: &[i64],
    envelope: &mut Envelope,
    left_out: LeftOut,
) -> Vec<Peak> {
    let length = envelope.largest.len();
    let count = coefficients.len() / who.len().max(1);
    // Vectors whose coefficients are zero in all sums are skipped.
    let used: Vec<usize> =
        (0..count).filter(|&b| coefficients.iter().skip(b).step_by(count).any(|c| *c != 0.0)).collect();
    let rows: Vec<f64> = coefficients.chunks_exact(count.max(1)).flat_map(|row| used.iter().map(|&b| row[b])).collect();
    let shares = envelope
        .largest
        .par_chunks_mut(SHARE)
        .zip(envelope.largest_by.par_chunks_mut(SHARE))
        .zip(envelope.smallest.par_chunks_mut(SHARE).zip(envelope.smallest_by.par_chunks_mut(SHARE)))
        .enumerate();
    let peaks: Vec<Vec<Peak>> = shares
        .map(|(share, ((largest, largest_by), (smallest, smallest_by)))| {
            let mut peaks = vec![NO_PEAK; who.len()];
            let mut tile = vec![0.0; used.len() * TILE];
            for from in (0..largest.len()).step_by(TILE) {
                let width = TILE.min(largest.len() - from);
                let first = share * SHARE + from;
                for (row, &b) in tile.chunks_exact_mut(TILE).zip(&used) {
                    let source = &vectors[b * length + first..b * length + first + width];
                    row[..width].copy_from_slice(source);
                    // If the last tile is incomplete, its last entry is repeated.
                    row[width..].fill(source[width - 1]);
                }
                let part = from..from + width;
                let mut bounds = Envelope {
                    largest: &mut largest[part.clone()],
                    largest_by: &mut largest_by[part.clone()],
                    smallest: &mut smallest[part.clone()],
                    smallest_by: &mut smallest_by[part],
                };
                let (vectors, envelope, peaks) = (&tile[..], &mut bounds, &mut peaks[..]);
                Arch::new().dispatch(Tile { rows: &rows, vectors, who, first, envelope, peaks, left_out });
            }
            peaks
        })
        .collect();
    let merged = |k: usize| peaks.iter().fold(NO_PEAK, |peak, share| peak.or(share[k]));
    (0..who.len()).map(merged).collect()
}

/// One tile: [`TILE`] consecutive entries of every vector. The same entries of all sums are computed with it.
struct Tile<'a, 'b> {
    rows: &'a [f64],
    vectors: &'a [f64],
    who: &'a [i64],
    first: usize,
    envelope: &'a mut Envelope<'b>,
    peaks: &'a mut [Peak],
    left_out: LeftOut<'a>,
}

impl WithSimd for Tile<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Tile { rows, vectors, who, first, envelope, peaks, left_out } = self;
        let (width, count) = (envelope.largest.len(), vectors.len() / TILE);
        let (mut high, mut low) = ([f64::NEG_INFINITY; TILE], [f64::INFINITY; TILE]);
        high[..width].copy_from_slice(envelope.largest);
        low[..width].copy_from_slice(envelope.smallest);
        for (k, peak) in peaks.iter_mut().enumerate() {
            let mut sum = [0.0; TILE];
            let row = &rows[k * count..(k + 1) * count];
            let registers = S::as_simd_f64s(vectors).0;
            let out = S::as_mut_simd_f64s(&mut sum).0;
            let mut from = 0;
            while from + 4 <= out.len() {
                sum_strip::<S, 4>(simd, row, registers, from, out);
                from += 4;
            }
            while from < out.len() {
                sum_strip::<S, 1>(simd, row, registers, from, out);
                from += 1;
            }
            let (bounds_high, bounds_low) = (S::as_simd_f64s(&high).0, S::as_simd_f64s(&low).0);
            let (mut most, mut least) = (out[0], out[0]);
            let mut beyond = simd.splat_f64s(f64::NEG_INFINITY);
            for ((s, h), l) in out.iter().zip(bounds_high).zip(bounds_low) {
                most = simd.max_f64s(most, *s);
                least = simd.min_f64s(least, *s);
                beyond = simd.max_f64s(beyond, simd.sub_f64s(*s, *h));
                beyond = simd.max_f64s(beyond, simd.sub_f64s(*l, *s));
            }
            let (largest, smallest) = (simd.reduce_max_f64s(most), simd.reduce_min_f64s(least));
            if largest > peak.largest || smallest < peak.smallest {
                left_out.look(k, first, &sum[..width], peak);
            }
            if simd.reduce_max_f64s(beyond) > 0.0 {
                for i in 0..width {
                    if sum[i] > high[i] {
                        (high[i], envelope.largest_by[i]) = (sum[i], who[k]);
                    }
                    if sum[i] < low[i] {
                        (low[i], envelope.smallest_by[i]) = (sum[i], who[k]);
                    }
                }
            }
        }
        envelope.largest.copy_from_slice(&high[..width]);
        envelope.smallest.copy_from_slice(&low[..width]);
    }
}

/// Computes N SIMD registers of a sum of vectors, from register `from` on.
#[inline(always)]
fn sum_strip<S: Simd, const N: usize>(simd: S, row: &[f64], vectors: &[S::f64s], from: usize, out: &mut [S::f64s]) {
    let mut sums = [simd.splat_f64s(0.0); N];
    for (factor, vector) in row.iter().zip(vectors.chunks_exact(out.len())) {
        let factor = simd.splat_f64s(*factor);
        for (sum, v) in sums.iter_mut().zip(&vector[from..from + N]) {
            *sum = simd.mul_add_e_f64s(factor, *v, *sum);
        }
    }
    out[from..from + N].copy_from_slice(&sums);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers from a fixed seed, for tests.
    fn numbers(count: usize, mut seed: u64) -> Vec<f64> {
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn a_sum_has_the_same_bits_on_any_number_of_threads() {
        let terms = numbers(100_000, 5);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sum_in_order(terms.len(), 1024, |i| terms[i])).to_bits()
        };
        let one = on(1);
        assert!((2..5).all(|threads| on(threads) == one));
    }

    #[test]
    fn the_envelope_is_that_of_the_sums() {
        let (count, combinations) = (5, 40);
        for length in [1, 31, 32, 1500] {
            let vectors = numbers(count * length, 1);
            let mut coefficients = numbers(combinations * count, 2);
            coefficients.iter_mut().skip(3).step_by(count).for_each(|c| *c = 0.0);
            let sums = superpose(&coefficients, &vectors, count);
            let who: Vec<i64> = (100..100 + combinations as i64).collect();
            let (mut largest, mut smallest) = (vec![f64::NEG_INFINITY; length], vec![f64::INFINITY; length]);
            let (mut largest_by, mut smallest_by) = (vec![-1; length], vec![-1; length]);
            let mut envelope = Envelope {
                largest: &mut largest,
                largest_by: &mut largest_by,
                smallest: &mut smallest,
                smallest_by: &mut smallest_by,
            };
            // In sums with odd numbers, every third entry is excluded from the extremes.
            let class: Vec<i64> = (0..length as i64).map(|i| i64::from(i % 3 == 2)).collect();
            let sums_without: Vec<bool> = (0..combinations).flat_map(|k| [false, k % 2 == 1]).collect();
            let left_out = LeftOut { class: &class, sums: &sums_without, classes: 2 };
            let peaks = envelop(&coefficients, &vectors, &who, &mut envelope, left_out);
            for i in 0..length {
                let column: Vec<f64> = (0..combinations).map(|k| sums[k * length + i]).collect();
                assert!(column.iter().all(|s| *s <= largest[i] && *s >= smallest[i]));
                assert_eq!(column[(largest_by[i] - 100) as usize], largest[i]);
                assert_eq!(column[(smallest_by[i] - 100) as usize], smallest[i]);
            }
            for (k, (peak, sum)) in peaks.iter().zip(sums.chunks(length)).enumerate() {
                let counts = |i: usize| class[i] == 0 || k % 2 == 0;
                assert!((0..length).all(|i| !counts(i) || (sum[i] <= peak.largest && sum[i] >= peak.smallest)));
                assert!(counts(peak.largest_at) && counts(peak.smallest_at));
                assert_eq!((sum[peak.largest_at], sum[peak.smallest_at]), (peak.largest, peak.smallest));
            }
        }
    }

    #[test]
    fn a_sum_does_not_depend_on_its_neighbours() {
        let (vectors, coefficients) = (numbers(7 * 100, 3), numbers(50 * 7, 4));
        let together = superpose(&coefficients, &vectors, 7);
        for (row, sum) in coefficients.chunks(7).zip(together.chunks(100)) {
            assert_eq!(superpose(row, &vectors, 7), sum);
        }
    }
}
