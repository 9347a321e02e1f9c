//! Linear combinations of many vectors, and extremes of these sums and of fields computed from them.
//!
//! Each sum adds the vectors in their order, so that it is the same to the last bit with and without other sums.

use crate::fields::{Formula, Lanes, TILE};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

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

/// Sum of `term(0)` to `term(count − 1)`. Terms are computed in parallel and added in order, so that the sum is the
/// same to the last bit for any number of threads. A thread computes at least `least` consecutive terms.
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

/// Envelope of one field (n,) in many combinations: the largest and smallest value of each entry, and the numbers of
/// the combinations that attain them.
pub struct Envelope<'a> {
    pub largest: &'a mut [f64],
    pub largest_by: &'a mut [i64],
    pub smallest: &'a mut [f64],
    pub smallest_by: &'a mut [i64],
}

impl<'a> Envelope<'a> {
    /// Divides the envelope into chunks of `size` entries.
    fn chunks(self, size: usize) -> impl Iterator<Item = Self> {
        let largest = self.largest.chunks_mut(size).zip(self.largest_by.chunks_mut(size));
        let smallest = self.smallest.chunks_mut(size).zip(self.smallest_by.chunks_mut(size));
        largest.zip(smallest).map(|((largest, largest_by), (smallest, smallest_by))| Self {
            largest,
            largest_by,
            smallest,
            smallest_by,
        })
    }

    /// Updates the envelope from entry `from` on with the values of combination `who`. `high` and `low` are the largest
    /// and the smallest values of these entries until now.
    #[inline(always)]
    fn take(&mut self, from: usize, values: &Lanes, high: &mut Lanes, low: &mut Lanes, who: i64) {
        let mut beyond = false;
        for i in 0..TILE {
            beyond |= (values[i] > high[i]) | (values[i] < low[i]);
        }
        if beyond {
            // An incomplete tile repeats its last entry in the remaining lanes; these lanes are skipped.
            for i in 0..TILE.min(self.largest.len() - from) {
                if values[i] > high[i] {
                    (self.largest[from + i], self.largest_by[from + i], high[i]) = (values[i], who, values[i]);
                }
                if values[i] < low[i] {
                    (self.smallest[from + i], self.smallest_by[from + i], low[i]) = (values[i], who, values[i]);
                }
            }
        }
    }
}

/// Largest and smallest entry of a field in one combination, and the indices of these entries.
#[derive(Clone, Copy, Debug)]
pub struct Peak {
    pub largest: f64,
    pub largest_at: usize,
    pub smallest: f64,
    pub smallest_at: usize,
}

/// Entries that are excluded from the extremes of a sum. `class` (n,) is the class of each entry; `sums` (k, `classes`)
/// is true where a sum excludes all entries of a class.
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
    /// The larger maximum and the smaller minimum of two peaks, with their indices. If both values are equal, `self`
    /// has priority.
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

/// Fields of which envelopes are made. All `formulas` have the same inputs; `wanted` (f,) has the indices of the fields
/// in the list of values of all formulas. `thickness` (n,) is the thickness at each entry.
pub struct Fields<'a> {
    pub formulas: &'a [Formula],
    pub wanted: &'a [usize],
    pub thickness: &'a [f64],
}

/// Updates the envelopes of f fields with k combinations, and returns the extremes (f, k) of each field and combination.
///
/// Each of the `inputs` has vectors (b, n); the arguments of the formulas are sums of these vectors with coefficients
/// (k, b). `who` (k,) has the numbers of the combinations. Sums and values are computed tile by tile and not stored.
pub fn envelop(
    coefficients: &[f64],
    inputs: &[&[f64]],
    fields: &Fields,
    who: &[i64],
    envelopes: Vec<Envelope>,
    left_out: LeftOut,
) -> Vec<Vec<Peak>> {
    let length = left_out.class.len();
    let count = coefficients.len() / who.len().max(1);
    // Vectors whose coefficients are zero in all sums are skipped.
    let used: Vec<usize> =
        (0..count).filter(|&b| coefficients.iter().skip(b).step_by(count).any(|c| *c != 0.0)).collect();
    let rows: Vec<f64> = coefficients.chunks_exact(count.max(1)).flat_map(|row| used.iter().map(|&b| row[b])).collect();
    let mut shares: Vec<Vec<Envelope>> = (0..length.div_ceil(SHARE)).map(|_| Vec::new()).collect();
    for envelope in envelopes {
        shares.iter_mut().zip(envelope.chunks(SHARE)).for_each(|(share, part)| share.push(part));
    }
    let peaks: Vec<Vec<Vec<Peak>>> = shares
        .into_par_iter()
        .enumerate()
        .map(|(share, mut envelopes)| {
            let mut peaks = vec![vec![NO_PEAK; who.len()]; fields.wanted.len()];
            let mut tile = vec![[0.0; TILE]; used.len() * inputs.len()];
            let start = share * SHARE;
            for from in (0..SHARE.min(length - start)).step_by(TILE) {
                let first = start + from;
                let width = TILE.min(length - first);
                for (input, vectors) in inputs.iter().zip(tile.chunks_exact_mut(used.len().max(1))) {
                    for (lanes, &b) in vectors.iter_mut().zip(&used) {
                        fill(lanes, &input[b * length + first..b * length + first + width]);
                    }
                }
                let mut thickness = [0.0; TILE];
                fill(&mut thickness, &fields.thickness[first..first + width]);
                let (vectors, envelopes, peaks) = (&tile[..], &mut envelopes[..], &mut peaks[..]);
                let within = Within { first, from, width };
                let inputs = inputs.len();
                Arch::new().dispatch(Tile {
                    rows: &rows,
                    vectors,
                    inputs,
                    fields,
                    thickness,
                    who,
                    within,
                    envelopes,
                    peaks,
                    left_out,
                });
            }
            peaks
        })
        .collect();
    let merged = |f: usize, k: usize| peaks.iter().fold(NO_PEAK, |peak, share| peak.or(share[f][k]));
    (0..fields.wanted.len()).map(|f| (0..who.len()).map(|k| merged(f, k)).collect()).collect()
}

/// Copies the entries of a tile. If the last tile is incomplete, its last entry is repeated.
fn fill(lanes: &mut Lanes, source: &[f64]) {
    lanes[..source.len()].copy_from_slice(source);
    lanes[source.len()..].fill(source[source.len() - 1]);
}

/// Range of entries of a tile: index of the first entry in the whole vector (`first`) and in its parallel chunk
/// (`from`), and number of entries.
#[derive(Clone, Copy)]
struct Within {
    first: usize,
    from: usize,
    width: usize,
}

/// One tile: [`TILE`] consecutive entries of every vector. The same entries of all sums are computed with it.
struct Tile<'a, 'b> {
    rows: &'a [f64],
    vectors: &'a [Lanes],
    inputs: usize,
    fields: &'a Fields<'a>,
    thickness: Lanes,
    who: &'a [i64],
    within: Within,
    envelopes: &'a mut [Envelope<'b>],
    peaks: &'a mut [Vec<Peak>],
    left_out: LeftOut<'a>,
}

impl WithSimd for Tile<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Tile { rows, vectors, inputs, fields, thickness, who, within, envelopes, peaks, left_out } = self;
        let (Within { first, from, width }, count) = (within, vectors.len() / inputs);
        let mut bounds = vec![([f64::NEG_INFINITY; TILE], [f64::INFINITY; TILE]); envelopes.len()];
        for ((high, low), envelope) in bounds.iter_mut().zip(envelopes.iter()) {
            fill(high, &envelope.largest[from..from + width]);
            fill(low, &envelope.smallest[from..from + width]);
        }
        let mut sums = vec![[0.0; TILE]; inputs];
        let mut values = vec![[0.0; TILE]; fields.formulas.iter().map(|formula| formula.values()).sum()];
        for (k, &who) in who.iter().enumerate() {
            let row = &rows[k * count..(k + 1) * count];
            for (at, sum) in sums.iter_mut().enumerate() {
                let registers = S::as_simd_f64s(vectors[at * count..(at + 1) * count].as_flattened()).0;
                let out = S::as_mut_simd_f64s(sum).0;
                let mut from = 0;
                while from + 4 <= out.len() {
                    sum_strip::<S, 4>(simd, row, registers, from, out);
                    from += 4;
                }
                while from < out.len() {
                    sum_strip::<S, 1>(simd, row, registers, from, out);
                    from += 1;
                }
            }
            let mut rest = &mut values[..];
            for formula in fields.formulas {
                let (own, others) = rest.split_at_mut(formula.values());
                formula.apply(&sums, &thickness, own);
                rest = others;
            }
            let each = fields.wanted.iter().zip(&mut bounds).zip(envelopes.iter_mut()).zip(peaks.iter_mut());
            for (((&wanted, (high, low)), envelope), peaks) in each {
                let (values, peak) = (&values[wanted], &mut peaks[k]);
                let mut beyond = false;
                for value in values {
                    beyond |= (*value > peak.largest) | (*value < peak.smallest);
                }
                if beyond {
                    left_out.look(k, first, &values[..width], peak);
                }
                envelope.take(from, values, high, low, who);
            }
        }
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
    use crate::fields::Bars;

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
            let envelope = Envelope {
                largest: &mut largest,
                largest_by: &mut largest_by,
                smallest: &mut smallest,
                smallest_by: &mut smallest_by,
            };
            let fields = Fields { formulas: &[Formula::Sum], wanted: &[0], thickness: &vec![0.0; length] };
            // In sums with odd index, every third entry is excluded from the extremes.
            let class: Vec<i64> = (0..length as i64).map(|i| i64::from(i % 3 == 2)).collect();
            let sums_without: Vec<bool> = (0..combinations).flat_map(|k| [false, k % 2 == 1]).collect();
            let left_out = LeftOut { class: &class, sums: &sums_without, classes: 2 };
            let peaks = envelop(&coefficients, &[&vectors], &fields, &who, vec![envelope], left_out).remove(0);
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
    fn envelopes_of_fields_are_those_of_the_fields_of_sums() {
        let (count, combinations, length) = (7, 30, 1041);
        let inputs: Vec<Vec<f64>> = (1..4).map(|seed| numbers(count * length, seed)).collect();
        let coefficients = numbers(combinations * count, 9);
        let distance = [0.1, 0.2, 0.3, 0.15];
        let (deepest, least, most, plain) = (0.36, 0.0013, 0.04, 1e-9);
        let bars = Bars { distance, block: 20.0, yield_stress: 400.0, deepest, least, most, plain };
        let formulas = [Formula::Principal, Formula::Design, Formula::Face, Formula::Steel(bars)];
        let wanted = [0, 1, 2, 5, 8, 12, 14, 15, 17];
        let thickness: Vec<f64> = numbers(length, 4).iter().map(|t| 1.5 + 0.5 * t).collect();
        let sums: Vec<Vec<f64>> = inputs.iter().map(|of| superpose(&coefficients, of, count)).collect();
        let values: Vec<Vec<f64>> = (0..combinations)
            .map(|k| {
                let each = (0..length).flat_map(|i| sums.iter().map(move |sum| sum[k * length + i]));
                let of: Vec<f64> = each.collect();
                let found = formulas.map(|formula| (formula.values(), formula.of(&of, &thickness)));
                (0..length).flat_map(|i| found.iter().flat_map(move |(c, v)| v[i * c..(i + 1) * c].to_vec())).collect()
            })
            .collect();
        let mut bounds = vec![(vec![f64::NEG_INFINITY; length], vec![-1; length]); 2 * wanted.len()];
        let envelopes = bounds
            .chunks_exact_mut(2)
            .map(|pair| {
                let (high, low) = pair.split_at_mut(1);
                low[0].0.fill(f64::INFINITY);
                let ((largest, largest_by), (smallest, smallest_by)) = (&mut high[0], &mut low[0]);
                Envelope { largest, largest_by, smallest, smallest_by }
            })
            .collect();
        let who: Vec<i64> = (0..combinations as i64).collect();
        let (class, sums) = (vec![0; length], vec![false; combinations]);
        let left_out = LeftOut { class: &class, sums: &sums, classes: 1 };
        let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let fields = Fields { formulas: &formulas, wanted: &wanted, thickness: &thickness };
        let peaks = envelop(&coefficients, &inputs, &fields, &who, envelopes, left_out);
        let of = |k: usize, i: usize, f: usize| values[k][i * 18 + wanted[f]];
        for f in 0..wanted.len() {
            let (largest, by) = &bounds[2 * f];
            for i in 0..length {
                assert_eq!(largest[i], (0..combinations).map(|k| of(k, i, f)).fold(f64::NEG_INFINITY, f64::max));
                assert_eq!(
                    bounds[2 * f + 1].0[i],
                    (0..combinations).map(|k| of(k, i, f)).fold(f64::INFINITY, f64::min)
                );
                assert_eq!(of(by[i] as usize, i, f), largest[i]);
            }
            for (k, peak) in peaks[f].iter().enumerate() {
                assert_eq!(peak.largest, (0..length).map(|i| of(k, i, f)).fold(f64::NEG_INFINITY, f64::max));
                assert_eq!(peak.smallest, of(k, peak.smallest_at, f));
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
