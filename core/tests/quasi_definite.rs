//! Quasi-definite matrices [[K, Gᵀ], [G, −C]], with columns of K and −C mixed in one order, compared with dense
//! arithmetic.

use faer::Mat;
use faer::linalg::solvers::Solve;
use proptest::prelude::*;
use signorini_core::cholesky::{Analysis, Factor, FactorError, Graph, Matrix, Reader};
use std::ops::Range;

/// Columns of the lower triangle in elimination order, and whether their pivots are negative.
struct Saddle {
    /// First column of each block, and the number of columns at the end.
    blocks: Vec<usize>,
    columns: Vec<Vec<(usize, f64)>>,
    negative: Vec<bool>,
}

impl Matrix for Saddle {
    fn graph(&self) -> Graph {
        Graph::new(self.blocks.clone(), |column, rows| rows.extend(self.columns[column].iter().map(|entry| entry.0)))
    }

    fn reader(&self) -> Reader<'_> {
        Box::new(|column, entries| entries.clone_from(&self.columns[column]))
    }

    fn is_negative(&self, column: usize) -> bool {
        self.negative[column]
    }
}

/// Position of a constraint in the elimination order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// At a random position.
    Any,
    /// After the last column that it couples.
    Behind,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    size: (usize, usize),
    constraints: usize,
    /// Magnitude of the entries of C; those of K and G are about 1.
    compliance: f64,
    place: Place,
    /// Whether nodes are in nested dissection order; if not, in random order.
    dissected: bool,
    seed: u64,
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() * end as f64) as usize
    }
}

/// Appends the nodes of a part of the grid in nested dissection order: both halves, then the nodes that separate them.
fn dissect(x: Range<usize>, y: Range<usize>, wide: usize, order: &mut Vec<usize>) {
    if x.len() < 2 && y.len() < 2 || x.is_empty() || y.is_empty() {
        order.extend(x.flat_map(|x| y.clone().map(move |y| y * wide + x)));
    } else if x.len() >= y.len() {
        let cut = x.start + x.len() / 2;
        dissect(x.start..cut, y.clone(), wide, order);
        dissect(cut + 1..x.end, y.clone(), wide, order);
        order.extend(y.map(|y| y * wide + cut));
    } else {
        let cut = y.start + y.len() / 2;
        dissect(x.clone(), y.start..cut, wide, order);
        dissect(x.clone(), cut + 1..y.end, wide, order);
        order.extend(x.map(|x| cut * wide + x));
    }
}

impl Saddle {
    /// Makes the matrix from (row, column, value) of the lower triangle, each pair once. `place` is the elimination
    /// index of each column.
    fn new(entries: &[(usize, usize, f64)], place: &[usize], is_negative: impl Fn(usize) -> bool) -> Self {
        let size = place.len();
        let (mut columns, mut negative) = (vec![Vec::new(); size], vec![false; size]);
        for &(i, j, value) in entries {
            let (i, j) = (place[i], place[j]);
            columns[i.min(j)].push((i.max(j), value));
        }
        (0..size).for_each(|k| negative[place[k]] = is_negative(k));
        Self { blocks: (0..=size).collect(), columns, negative }
    }

    /// K couples the nodes of a grid with their neighbours; each constraint couples a few nodes near each other.
    fn on_grid(shape: Shape) -> Self {
        let Shape { size: (wide, high), constraints, compliance, place, dissected, seed } = shape;
        let mut random = Random(seed);
        let nodes = wide * high;
        let mut rank: Vec<f64> = (0..nodes).map(|_| random.next()).collect();
        if dissected {
            let mut order = Vec::new();
            dissect(0..wide, 0..high, wide, &mut order);
            order.iter().enumerate().for_each(|(at, &node)| rank[node] = at as f64 / nodes as f64);
        }
        let mut entries = Vec::new();
        let mut diagonal = vec![0.0; nodes];
        for node in 0..nodes {
            let right = (node % wide + 1 < wide).then_some(node + 1);
            for other in right.into_iter().chain((node + wide < nodes).then_some(node + wide)) {
                let value = random.next() - 0.5;
                entries.push((node, other, value));
                diagonal[node] += value.abs();
                diagonal[other] += value.abs();
            }
        }
        entries.extend((0..nodes).map(|node| (node, node, diagonal[node] + 0.05 + random.next())));
        for row in nodes..nodes + constraints {
            let corner = (random.below(wide), random.below(high));
            let (mut those, mut last) = (Vec::new(), 0.0);
            for _ in 0..1 + random.below(6) {
                let (x, y) = (corner.0 + random.below(3), corner.1 + random.below(3));
                let node = y.min(high - 1) * wide + x.min(wide - 1);
                if !those.contains(&node) {
                    those.push(node);
                    last = f64::max(last, rank[node]);
                    entries.push((row, node, 2.0 * random.next() - 1.0));
                }
            }
            rank.push(if place == Place::Any { random.next() } else { last });
            entries.push((row, row, -compliance * (1.0 + random.next())));
            if row > nodes {
                entries.push((row, row - 1, compliance * (random.next() - 0.5)));
            }
        }
        // Nodes precede constraints of the same rank.
        let mut order: Vec<usize> = (0..rank.len()).collect();
        order.sort_by(|&a, &b| rank[a].total_cmp(&rank[b]));
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, &k)| place[k] = at);
        Self::new(&entries, &place, |k| k >= nodes)
    }

    /// A dense matrix, whose columns are one supernode.
    fn full(size: usize, is_negative: impl Fn(usize) -> bool) -> Self {
        let mut random = Random(size as u64);
        let mut entries = Vec::new();
        for j in 0..size {
            let sign = if is_negative(j) { -1.0 } else { 1.0 };
            entries.push((j, j, sign * size as f64));
            for i in j + 1..size {
                let weight = if is_negative(i) == is_negative(j) { 1.0 } else { 20.0 };
                entries.push((i, j, weight * (random.next() - 0.5)));
            }
        }
        let place: Vec<usize> = (0..size).collect();
        Self { blocks: vec![0, size], ..Self::new(&entries, &place, is_negative) }
    }

    fn len(&self) -> usize {
        self.columns.len()
    }

    fn dense(&self) -> Mat<f64> {
        let mut matrix = Mat::zeros(self.len(), self.len());
        for (j, column) in self.columns.iter().enumerate() {
            for &(i, value) in column {
                matrix[(i, j)] = value;
                matrix[(j, i)] = value;
            }
        }
        matrix
    }

    fn factor(&self) -> Factor {
        Analysis::new(self).unwrap().factorize(self).unwrap()
    }

    fn right(&self, seed: usize) -> Vec<f64> {
        (0..self.len()).map(|i| ((37 * (i + seed)) % 101) as f64 - 50.0).collect()
    }

    /// Largest entry of A x − b relative to ‖A‖ ‖x‖ + ‖b‖; norms are the largest entries.
    fn residual(&self, x: &[f64], b: &[f64]) -> f64 {
        let (mut residual, mut sums) = (b.to_vec(), vec![0.0; b.len()]);
        for (j, column) in self.columns.iter().enumerate() {
            for &(i, value) in column {
                residual[i] -= value * x[j];
                sums[i] += value.abs();
                if i != j {
                    residual[j] -= value * x[i];
                    sums[j] += value.abs();
                }
            }
        }
        largest(&residual) / (largest(&sums) * largest(x) + largest(b))
    }
}

fn largest(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Checks solutions for one and several right-hand sides, in one call and by forward and backward substitution.
fn check_solves(matrix: &Saddle, factor: &Factor, accuracy: f64) {
    let size = matrix.len();
    let mut one = matrix.right(0);
    factor.forward(&mut one).unwrap();
    factor.backward(&mut one).unwrap();
    assert!(matrix.residual(&one, &matrix.right(0)) <= accuracy);
    let given: Vec<f64> = (0..9).flat_map(|seed| matrix.right(seed)).collect();
    let (mut at_once, mut in_steps) = (given.clone(), given.clone());
    factor.solve_side_by_side(&mut at_once).unwrap();
    factor.forward(&mut in_steps).unwrap();
    factor.backward(&mut in_steps).unwrap();
    assert!(at_once == in_steps);
    for (x, b) in at_once.chunks(size).zip(given.chunks(size)) {
        assert!(matrix.residual(x, b) <= accuracy);
    }
}

fn shape() -> impl Strategy<Value = Shape> {
    let place = prop_oneof![Just(Place::Any), Just(Place::Behind)];
    (1_usize..20, 1_usize..20, 0.0..0.6, -10.0..2.0, place, any::<bool>(), any::<u64>()).prop_map(
        |(wide, high, part, exponent, place, dissected, seed)| {
            // If constraints are at random positions, entries grow with the ratio of K to C.
            let exponent = if place == Place::Any { f64::max(exponent, -5.0) } else { exponent };
            let constraints = (part * (wide * high) as f64) as usize;
            Shape { size: (wide, high), constraints, compliance: 10_f64.powf(exponent), place, dissected, seed }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn quasi_definite_matrices_are_solved_in_any_order(shape in shape()) {
        let matrix = Saddle::on_grid(shape);
        let factor = matrix.factor();
        let well_conditioned = shape.compliance >= 1e-2;
        let accurate = well_conditioned || shape.place == Place::Behind;
        let accuracy = if accurate { 1e-12 } else { 1e-10 };
        check_solves(&matrix, &factor, accuracy);
        let part = factor.weakest_pivot().1;
        prop_assert!(part > 0.0 && part.is_finite());

        let dense = matrix.dense();
        if well_conditioned {
            let mut found = matrix.right(1);
            factor.forward(&mut found).unwrap();
            factor.backward(&mut found).unwrap();
            let right = matrix.right(1);
            let expected = dense.partial_piv_lu().solve(Mat::from_fn(right.len(), 1, |i, _| right[i]));
            let size = expected.norm_max();
            prop_assert!((0..right.len()).all(|i| (found[i] - expected[(i, 0)]).abs() <= 1e-9 * size));
        }

        // L S Lᵀ of the trailing block is the Schur complement, the inverse of the last rows and columns of A⁻¹.
        let (size, trailing) = (matrix.len(), matrix.len().min(7));
        let block = factor.trailing_block(trailing).unwrap();
        let sign = |k: usize| if matrix.negative[size - trailing + k] { -1.0 } else { 1.0 };
        let complement = Mat::from_fn(trailing, trailing, |i, j| {
            (0..=i.min(j)).map(|k| sign(k) * block[(i, k)] * block[(j, k)]).sum::<f64>()
        });
        for column in 0..trailing {
            let mut unit = vec![0.0; size];
            unit[size - trailing + column] = 1.0;
            factor.forward(&mut unit).unwrap();
            factor.backward(&mut unit).unwrap();
            let last = &unit[size - trailing..];
            for i in 0..trailing {
                let sum: f64 = (0..trailing).map(|k| complement[(i, k)] * last[k]).sum();
                let size = 1.0 + complement.norm_max() * largest(last);
                prop_assert!((sum - f64::from(i == column)).abs() <= accuracy * size);
            }
        }
    }
}

#[test]
fn supernodes_wider_than_a_block_may_have_both_signs() {
    for size in [64, 65, 150, 400, 1200] {
        for matrix in [
            Saddle::full(size, |k| k % 2 == 1),
            Saddle::full(size, |k| (60..70).contains(&k)),
            Saddle::full(size, |k| k / 64 == 0),
            Saddle::full(size, |_| true),
        ] {
            check_solves(&matrix, &matrix.factor(), 1e-13);
        }
    }
}

#[test]
fn a_sign_that_is_wrong_is_refused_with_its_column() {
    let shape =
        Shape { size: (30, 20), constraints: 150, compliance: 0.1, place: Place::Behind, dissected: true, seed: 3 };
    for mut matrix in [Saddle::on_grid(shape), Saddle::full(200, |k| k % 3 == 0)] {
        let analysis = Analysis::new(&matrix).unwrap();
        assert!(analysis.factorize(&matrix).is_ok());
        for column in 0..matrix.len() {
            matrix.negative[column] ^= true;
            assert_eq!(analysis.factorize(&matrix).err(), Some(FactorError::NotPositiveDefinite { column }));
            matrix.negative[column] ^= true;
        }
        for column in [0, 1, matrix.len() / 2, matrix.len() - 1] {
            let at = matrix.columns[column].iter().position(|&(row, _)| row == column).unwrap();
            for wrong in [f64::NAN, f64::INFINITY * matrix.columns[column][at].1] {
                let right = std::mem::replace(&mut matrix.columns[column][at].1, wrong);
                if wrong.is_nan() || matrix.negative[column] {
                    assert_eq!(analysis.factorize(&matrix).err(), Some(FactorError::NotPositiveDefinite { column }));
                }
                matrix.columns[column][at].1 = right;
            }
        }
    }
}

/// The pivot of a column of −C is 1e-9 of the diagonal entry.
#[test]
fn the_weakest_pivot_may_be_negative() {
    // [[−2, 1], [1, c]] has the second pivot c + 1/2.
    let c = -0.5 * (1.0 + 1e-9);
    let matrix = Saddle {
        blocks: vec![0, 1, 2],
        columns: vec![vec![(0, -2.0), (1, 1.0)], vec![(1, c)]],
        negative: vec![true; 2],
    };
    let (column, part) = matrix.factor().weakest_pivot();
    assert!(column == 1 && (part - 1e-9).abs() < 1e-14, "{column} {part}");
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let shape =
        Shape { size: (130, 120), constraints: 4000, compliance: 1e-6, place: Place::Behind, dissected: true, seed: 1 };
    for matrix in [Saddle::on_grid(shape), Saddle::full(900, |k| k % 5 == 0)] {
        let bits = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let factor = matrix.factor();
                check_solves(&matrix, &factor, 1e-12);
                let mut one = matrix.right(1);
                factor.forward(&mut one).unwrap();
                factor.backward(&mut one).unwrap();
                one.into_iter().map(f64::to_bits).collect::<Vec<u64>>()
            })
        });
        assert!(bits[0] == bits[1] && bits[0] == bits[2]);
    }
}
