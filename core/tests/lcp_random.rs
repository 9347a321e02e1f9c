//! 10,000 random problems, compared with exact enumeration of the complementary bases; and properties of arbitrary
//! problems.
use proptest::prelude::*;
use rayon::prelude::*;
use signorini_core::lcp::{Lcp, LcpSolution, LcpStatus, LemkeOptions, lemke, lemke_from};

/// Random numbers by Vigna's xorshift64*.
struct Random(u64);

impl Random {
    fn new(seed: usize) -> Self {
        Self((seed as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn integer(&mut self, low: i128, high: i128) -> i128 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let drawn = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33;
        low + i128::from(drawn) % (high - low + 1)
    }

    fn vector(&mut self, length: usize, low: i128, high: i128) -> Vec<i128> {
        (0..length).map(|_| self.integer(low, high)).collect()
    }
}

/// A problem with integer entries, so that its enumeration is exact.
struct Problem {
    matrix: Vec<Vec<i128>>,
    q: Vec<i128>,
}

impl Problem {
    /// A positive semidefinite matrix: G Gᵀ, plus a skew-symmetric part in half of the cases.
    fn semidefinite(random: &mut Random, g: &[Vec<i128>], skew: bool) -> Vec<Vec<i128>> {
        let order = g.len();
        let product = |i: usize, j: usize| g[i].iter().zip(&g[j]).map(|(a, b)| a * b).sum();
        let mut matrix: Vec<Vec<i128>> = (0..order).map(|i| (0..order).map(|j| product(i, j)).collect()).collect();
        for i in 0..order {
            for j in 0..i {
                let part = if skew { random.integer(-3, 3) } else { 0 };
                matrix[i][j] += part;
                matrix[j][i] -= part;
            }
        }
        matrix
    }

    fn positive_definite(random: &mut Random) -> Self {
        let (order, skew) = (random.integer(1, 10) as usize, random.integer(0, 1) == 1);
        let g: Vec<_> = (0..order).map(|_| random.vector(2, -2, 2)).collect();
        let mut matrix = Self::semidefinite(random, &g, skew);
        (0..order).for_each(|i| matrix[i][i] += random.integer(1, 3));
        Self { matrix, q: random.vector(order, -9, 6) }
    }

    fn positive_semidefinite(random: &mut Random) -> Self {
        let (order, skew) = (random.integer(1, 10) as usize, random.integer(0, 1) == 1);
        let rank = random.integer(0, 4) as usize;
        let g: Vec<_> = (0..order).map(|_| random.vector(rank, -2, 2)).collect();
        Self { matrix: Self::semidefinite(random, &g, skew), q: random.vector(order, -4, 8) }
    }

    /// A problem with repeated rows, and a solution in which many pairs have z_i = w_i = 0.
    fn degenerate(random: &mut Random) -> Self {
        let order = random.integer(2, 10) as usize;
        Self::degenerate_of(random, order)
    }

    fn degenerate_of(random: &mut Random, order: usize) -> Self {
        let kinds: Vec<_> = (0..order.div_ceil(2)).map(|_| random.vector(3, -2, 2)).collect();
        let g: Vec<_> =
            (0..order).map(|_| kinds[random.integer(0, kinds.len() as i128 - 1) as usize].clone()).collect();
        let matrix = Self::semidefinite(random, &g, false);
        let z: Vec<_> = (0..order).map(|_| random.integer(-3, 2).max(0)).collect();
        let w = z.iter().map(|&z| if z > 0 { 0 } else { random.integer(-3, 2).max(0) });
        let q = w.zip(&matrix).map(|(w, row)| w - row.iter().zip(&z).map(|(a, z)| a * z).sum::<i128>()).collect();
        Self { matrix, q }
    }

    /// An infeasible problem: there is a v ≥ 0 with vᵀM = 0 and vᵀq < 0.
    fn infeasible(random: &mut Random) -> Self {
        let order = random.integer(1, 10) as usize;
        Self::infeasible_of(random, order)
    }

    fn infeasible_of(random: &mut Random, order: usize) -> Self {
        let v: Vec<i128> = (1..order).map(|_| random.integer(0, 2)).collect();
        let mut g: Vec<_> = (1..order).map(|_| random.vector(3, -1, 1)).collect();
        g.push((0..3).map(|k| -(0..order - 1).map(|i| v[i] * g[i][k]).sum::<i128>()).collect());
        let mut q = random.vector(order - 1, -4, 6);
        let others: i128 = q.iter().zip(&v).map(|(q, v)| q * v).sum();
        q.push(-others - random.integer(1, 3));
        Self { matrix: Self::semidefinite(random, &g, false), q }
    }

    fn is_symmetric(&self) -> bool {
        (0..self.q.len()).all(|i| (0..i).all(|j| self.matrix[i][j] == self.matrix[j][i]))
    }

    fn as_floats(&self) -> (Vec<f64>, Vec<f64>) {
        (self.matrix.concat().iter().map(|&x| x as f64).collect(), self.q.iter().map(|&x| x as f64).collect())
    }

    /// z of the first feasible complementary basis; `None` if there is none.
    fn enumerate(&self) -> Option<Vec<f64>> {
        let order = self.q.len();
        (0_usize..1 << order).find_map(|set| {
            let basic: Vec<usize> = (0..order).filter(|i| set >> i & 1 == 1).collect();
            let (numerators, determinant) = self.basic_numerators(&basic)?;
            let sign = determinant.signum();
            let slack = |i: usize| {
                let product: i128 = basic.iter().zip(&numerators).map(|(&j, z)| self.matrix[i][j] * z).sum();
                product + self.q[i] * determinant
            };
            let feasible = numerators.iter().all(|z| z * sign >= 0) && (0..order).all(|i| slack(i) * sign >= 0);
            feasible.then(|| {
                let mut z = vec![0.0; order];
                basic.iter().zip(&numerators).for_each(|(&j, n)| z[j] = *n as f64 / determinant as f64);
                z
            })
        })
    }

    /// Solves M_αα z_α = −q_α in integers: numerators and the common denominator (Bareiss 1968); None if singular.
    fn basic_numerators(&self, basic: &[usize]) -> Option<(Vec<i128>, i128)> {
        let count = basic.len();
        let row = |&i: &usize| basic.iter().map(|&j| self.matrix[i][j]).chain([-self.q[i]]).collect();
        let mut a: Vec<Vec<i128>> = basic.iter().map(row).collect();
        let mut previous = 1;
        for k in 0..count {
            let pivot_row = (k..count).find(|&i| a[i][k] != 0)?;
            a.swap(k, pivot_row);
            let pivot_row = a[k].clone();
            for i in (0..count).filter(|&i| i != k) {
                let factor = a[i][k];
                for j in 0..=count {
                    a[i][j] = (a[i][j] * pivot_row[k] - factor * pivot_row[j]) / previous;
                }
            }
            previous = pivot_row[k];
        }
        Some((a.iter().map(|row| row[count]).collect(), previous))
    }
}

fn assert_close(found: &[f64], expected: &[f64], seed: usize) {
    let size = expected.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
    let far = found.iter().zip(expected).any(|(a, b)| (a - b).abs() > 1e-12 * size);
    assert!(!far, "problem {seed}: {found:?} is not {expected:?}");
}

fn check(problem: &Problem, solution: &LcpSolution, expected: Option<&[f64]>, seed: usize) {
    let (matrix, q) = problem.as_floats();
    let lcp = Lcp::new(&matrix, &q).unwrap();
    match (solution.status, expected) {
        (LcpStatus::Solved, Some(expected)) => {
            let residuals = lcp.residuals(&solution.z, &solution.w).unwrap();
            assert!(residuals.worst() < 1e-14, "problem {seed}: {residuals:?}");
            for i in 0..q.len() {
                let nonbasic = if solution.basis[i] { solution.w[i] } else { solution.z[i] };
                assert_eq!(nonbasic, 0.0, "problem {seed}: both of pair {i}");
            }
            if problem.is_symmetric() {
                // If M is symmetric and semidefinite, w is the same in all solutions.
                let slack = |i: usize| lcp.row(i).iter().zip(expected).map(|(a, z)| a * z).sum::<f64>() + q[i];
                let w: Vec<f64> = (0..q.len()).map(slack).collect();
                assert_close(&solution.w, &w, seed);
            }
        }
        (LcpStatus::Ray, None) => {
            let proof = lcp.infeasibility(solution.ray.as_ref().unwrap()).unwrap();
            assert!(proof.holds(1e-12), "problem {seed}: {proof:?}");
        }
        (status, expected) => panic!("problem {seed}: {status:?}, but the enumeration found {expected:?}"),
    }
}

/// Solves 2,500 problems by a cold start and by a warm start from an arbitrary basis. Returns the number of problems
/// with a solution.
fn compare(draw: fn(&mut Random) -> Problem) -> usize {
    let solved = |seed: usize| {
        let mut random = Random::new(seed);
        let problem = draw(&mut random);
        let (matrix, q) = problem.as_floats();
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let expected = problem.enumerate();
        let cold = lemke(&lcp, &LemkeOptions::default()).unwrap();
        check(&problem, &cold, expected.as_deref(), seed);
        let basis: Vec<bool> = (0..q.len()).map(|_| random.integer(0, 1) == 1).collect();
        let warm = lemke_from(&lcp, &LemkeOptions::default(), &basis).unwrap();
        check(&problem, &warm, expected.as_deref(), seed);
        usize::from(expected.is_some())
    };
    (0..2500_usize).into_par_iter().map(solved).sum()
}

#[test]
fn positive_definite_problems_have_the_enumerated_solution() {
    assert_eq!(compare(Problem::positive_definite), 2500);
}

#[test]
fn semidefinite_problems_end_in_a_solution_or_a_ray_as_enumerated() {
    let solved = compare(Problem::positive_semidefinite);
    assert!((500..2000).contains(&solved), "{solved} of 2500 have a solution");
}

#[test]
fn degenerate_problems_are_all_solved() {
    assert_eq!(compare(Problem::degenerate), 2500);
}

#[test]
fn infeasible_problems_all_end_in_a_ray() {
    assert_eq!(compare(Problem::infeasible), 0);
}

/// Larger problems than can be enumerated, with more pivots than the tableau collects before an update: rank 3, ties in
/// every pivot.
#[test]
fn large_degenerate_problems_are_solved_and_infeasible_ones_proved() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let order = 40 + 8 * seed;
        let degenerate = Problem::degenerate_of(&mut random, order);
        let infeasible = Problem::infeasible_of(&mut random, order);
        for (problem, status) in [(degenerate, LcpStatus::Solved), (infeasible, LcpStatus::Ray)] {
            let (matrix, q) = problem.as_floats();
            let lcp = Lcp::new(&matrix, &q).unwrap();
            let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
            assert_eq!(solution.status, status, "problem {seed}");
            match &solution.ray {
                Some(ray) => assert!(lcp.infeasibility(ray).unwrap().holds(1e-12), "problem {seed}"),
                None => assert!(lcp.residuals(&solution.z, &solution.w).unwrap().worst() < 1e-13, "problem {seed}"),
            }
        }
    }
}

/// Random M = G Gᵀ + ε I with rows of very different magnitudes, and random q.
fn any_definite() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    (1_usize..40).prop_flat_map(|order| {
        let entries = prop::collection::vec(-1.0..1.0, order * order);
        let units = prop::collection::vec(-8.0..8.0_f64, order);
        (entries, units, prop::collection::vec(-1.0..1.0, order)).prop_map(move |(g, units, q)| {
            let dot = |i: usize, j: usize| (0..order).map(|k| g[i * order + k] * g[j * order + k]).sum::<f64>();
            let unit: Vec<f64> = units.iter().map(|u| 10.0_f64.powf(*u)).collect();
            let entry = |i, j| (dot(i, j) + if i == j { 1e-3 } else { 0.0 }) * unit[i] * unit[j];
            let matrix = (0..order * order).map(|at| entry(at / order, at % order)).collect();
            (matrix, q.iter().zip(&unit).map(|(q, u)| q * u).collect())
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: proptest::test_runner::RngSeed::Fixed(2), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn definite_problems_are_solved_in_any_units((matrix, q) in any_definite()) {
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
        prop_assert_eq!(solution.status, LcpStatus::Solved);
        let residuals = lcp.residuals(&solution.z, &solution.w).unwrap();
        prop_assert!(residuals.worst() < 1e-12, "{:?}", residuals);
    }

    #[test]
    fn warm_start_agrees_with_the_cold_one((matrix, q) in any_definite(), bits in any::<u64>()) {
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let options = LemkeOptions::default();
        let cold = lemke(&lcp, &options).unwrap();
        let basis: Vec<bool> = cold.basis.iter().enumerate().map(|(i, b)| *b != (bits >> i & 1 == 1)).collect();
        let warm = lemke_from(&lcp, &options, &basis).unwrap();
        prop_assert_eq!(&warm.basis, &cold.basis);
        prop_assert_eq!(&warm.z, &cold.z);
        prop_assert_eq!(lemke_from(&lcp, &options, &cold.basis).unwrap().pivots, 0);
    }

    #[test]
    fn the_covering_vector_does_not_change_a_unique_solution((matrix, q) in any_definite(), factor in 0.1..10.0) {
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let covering: Vec<f64> = (0..q.len()).map(|i| factor + matrix[i * q.len() + i].sqrt()).collect();
        let covered = lemke(&lcp, &LemkeOptions { covering: Some(&covering), max_pivots: None }).unwrap();
        prop_assert_eq!(covered.z, lemke(&lcp, &LemkeOptions::default()).unwrap().z);
    }

    #[test]
    fn anything_finite_is_answered(
        (matrix, q) in (1_usize..6).prop_flat_map(|m| {
            let size = prop_oneof![Just(0.0), -3.0..3.0_f64, prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL];
            (prop::collection::vec(size.clone(), m * m), prop::collection::vec(size, m))
        })
    ) {
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
        prop_assert_eq!(solution.ray.is_some(), solution.status == LcpStatus::Ray);
    }
}
