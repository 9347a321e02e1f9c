//! Factors, compared with dense arithmetic, for different numbers of threads, and for one and several right-hand sides.

use signorini_core::assembly::{Assembly, Bedding, LowerTriangle, Numbering};
use signorini_core::cholesky::{Analysis, Factor, FactorError, Graph, Matrix, Reader};
use signorini_core::element::{Kind, Material, Thickness};
use signorini_core::plate::Plate;
use signorini_core::rows::{Rows, Springs};

/// A matrix that stores its lower triangle.
struct Stored {
    /// First column of each block, and the number of columns at the end.
    blocks: Vec<usize>,
    lower: LowerTriangle,
}

impl Stored {
    fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> {
        let LowerTriangle { column_start, row, value } = &self.lower;
        (column_start[column]..column_start[column + 1]).map(|at| (row[at], value[at]))
    }
}

impl Matrix for Stored {
    fn graph(&self) -> Graph {
        Graph::new(self.blocks.clone(), |column, rows| rows.extend(self.column(column).map(|entry| entry.0)))
    }

    fn reader(&self) -> Reader<'_> {
        Box::new(|column, entries| {
            entries.clear();
            entries.extend(self.column(column));
        })
    }
}

/// A strip of square elements with a spring at the first node of each element.
fn strip(columns: usize, rows: usize) -> (Plate, Springs) {
    let wide = 2 * columns + 1;
    let mut number = vec![usize::MAX; wide * (2 * rows + 1)];
    let mut points = Vec::new();
    for k in (0..number.len()).filter(|k| k % wide % 2 == 0 || k / wide % 2 == 0) {
        number[k] = points.len();
        points.push([0.5 * (k % wide) as f64, 0.5 * (k / wide) as f64]);
    }
    let nodes = [0, 2, 2 * wide + 2, 2 * wide, 1, wide + 2, 2 * wide + 1, wide];
    let corner = |e: usize| 2 * (e / columns) * wide + 2 * (e % columns);
    let elements: Vec<[usize; 8]> =
        (0..rows * columns).map(|e| nodes.map(|offset| number[corner(e) + offset])).collect();
    let count = elements.len();
    let thickness = Thickness::Constant(0.5);
    let material = Material::isotropic(100.0, 0.3, 5.0 / 6.0);
    let plate = Plate::new(points, elements, thickness, material, Kind::Mitc9, None).unwrap();
    let coefficient = (0..count).map(|e| plate.interpolation_row(e, -1.0, -1.0, 0).0).collect();
    let rows = Rows { element: (0..count).collect(), coefficient, ..Rows::default() };
    (plate, Springs { rows, stiffness: vec![1.0; count], base: vec![0.0; count] })
}

/// A small matrix, whose subtrees are not divided among threads, and a larger one, whose subtrees are.
fn matrices() -> [Stored; 2] {
    [(3, 2), (40, 20)].map(|(columns, rows)| {
        let (plate, springs) = strip(columns, rows);
        let free = vec![false; plate.dof_count()];
        let numbering = Numbering::new(&plate, &[], &free, &free);
        let blocks = (0..=numbering.len()).step_by(3).collect();
        Stored { blocks, lower: Assembly::new(&plate, &springs, &Bedding::default(), &numbering).lower_triangle() }
    })
}

fn factors() -> [Factor; 2] {
    matrices().map(|matrix| Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap())
}

/// A sparse matrix that is positive definite by diagonal dominance. Each column has `links` entries below the diagonal,
/// within groups of `group` columns. They are in random order, and some are sums of two entries.
fn random(size: usize, links: usize, group: usize, seed: u64) -> Stored {
    let mut state = seed;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    let mut diagonal = vec![1.0; size];
    let mut columns = vec![Vec::new(); size];
    for column in 0..size {
        let left = size.min((column / group + 1) * group) - column - 1;
        for _ in 0..links.min(left) {
            let (row, value) = (column + 1 + next(left), next(200) as f64 / 100.0 - 1.0);
            columns[column].push((row, value));
            diagonal[column] += f64::abs(value);
            diagonal[row] += f64::abs(value);
        }
    }
    let mut matrix = LowerTriangle { column_start: vec![0], row: vec![], value: vec![] };
    for (column, mut entries) in columns.into_iter().enumerate() {
        entries.insert(entries.len() / 2, (column, diagonal[column]));
        matrix.row.extend(entries.iter().map(|entry| entry.0));
        matrix.value.extend(entries.iter().map(|entry| entry.1));
        matrix.column_start.push(matrix.row.len());
    }
    Stored { blocks: (0..=size).collect(), lower: matrix }
}

/// K times a vector.
fn product(matrix: &Stored, vector: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; vector.len()];
    for column in 0..vector.len() {
        for (row, value) in matrix.column(column) {
            out[row] += value * vector[column];
            if row != column {
                out[column] += value * vector[row];
            }
        }
    }
    out
}

#[test]
fn any_pattern_is_solved() {
    let shapes = [
        (1, 0, 1),
        (2, 1, 2),
        (50, 0, 1),
        (300, 3, 7),
        (120, 60, 120),
        (700, 2, 700),
        (900, 5, 300),
        (4000, 1, 4000),
        (20_000, 2, 40),
    ];
    for (seed, (size, links, group)) in shapes.into_iter().enumerate() {
        let matrix = random(size, links, group, seed as u64);
        let factor = Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap();
        assert_eq!(factor.len(), size);
        let expected = right(&factor, seed);
        let mut found = product(&matrix, &expected);
        factor.forward(&mut found).unwrap();
        factor.backward(&mut found).unwrap();
        assert!(expected.iter().zip(&found).all(|(x, y)| (x - y).abs() < 1e-9), "{size} {links} {group}");
        // L Lᵀ of the trailing block is the Schur complement. L⁻ᵀ of a vector whose leading entries are zero needs only
        // this block.
        let trailing = size.min(5);
        let block = factor.trailing_block(trailing).unwrap();
        let mut unit = vec![0.0; size];
        unit[size - 1] = 1.0;
        factor.backward(&mut unit).unwrap();
        for i in 0..trailing {
            let sum: f64 = (i..trailing).map(|k| block[(k, i)] * unit[size - trailing + k]).sum();
            assert!((sum - f64::from(i == trailing - 1)).abs() < 1e-12);
        }
    }
}

#[test]
fn an_empty_matrix_has_an_empty_factor() {
    let matrix = random(0, 0, 1, 0);
    let factor = Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap();
    assert!(factor.is_empty());
    factor.forward(&mut []).unwrap();
    assert_eq!(factor.trailing_block(0).unwrap().nrows(), 0);
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let [small, large] = matrices();
    for matrix in [small, large, random(30_000, 2, 300, 1), random(1500, 12, 1500, 2)] {
        let bits = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let factor = Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap();
                let mut one = right(&factor, 1);
                factor.forward(&mut one).unwrap();
                factor.backward(&mut one).unwrap();
                let mut more: Vec<f64> = (0..9).flat_map(|seed| right(&factor, seed)).collect();
                factor.solve_side_by_side(&mut more).unwrap();
                one.append(&mut more);
                one.into_iter().map(f64::to_bits).collect::<Vec<u64>>()
            })
        });
        assert!(bits[0] == bits[1] && bits[0] == bits[2]);
    }
}

#[test]
fn a_pivot_that_fails_is_named() {
    for mut matrix in matrices() {
        let analysis = Analysis::new(&matrix).unwrap();
        let size = matrix.lower.column_start.len() - 1;
        for column in [0, 1, size / 3, size / 2, size - 7, size - 1] {
            let start = matrix.lower.column_start[column];
            let at = start + matrix.column(column).position(|(row, _)| row == column).unwrap();
            for wrong in [-1.0, f64::NAN] {
                let right = std::mem::replace(&mut matrix.lower.value[at], wrong);
                assert_eq!(analysis.factorize(&matrix).err(), Some(FactorError::NotPositiveDefinite { column }));
                matrix.lower.value[at] = right;
            }
        }
        let factor = analysis.factorize(&matrix).unwrap();
        assert!(factor.weakest_pivot().1 > 1e-8);

        // Reduces the last diagonal entry, so that its pivot is 1e-9 of the value before.
        let start = matrix.lower.column_start[size - 1];
        assert_eq!(matrix.lower.column_start[size], start + 1);
        let pivot = factor.trailing_block(1).unwrap()[(0, 0)].powi(2);
        matrix.lower.value[start] -= (1.0 - 1e-9) * pivot;
        let (column, part) = analysis.factorize(&matrix).unwrap().weakest_pivot();
        let expected = 1e-9 * pivot / matrix.lower.value[start];
        assert!(column == size - 1 && (part - expected).abs() < 1e-4 * expected, "{column} {part} {expected}");
    }
}

fn right(factor: &Factor, seed: usize) -> Vec<f64> {
    (0..factor.len()).map(|i| ((37 * (i + seed)) % 101) as f64 - 50.0).collect()
}

#[test]
fn right_hand_sides_side_by_side_are_solved_like_one_alone() {
    for factor in factors() {
        for count in [2, 8, 19] {
            let mut all: Vec<f64> = (0..count).flat_map(|seed| right(&factor, seed)).collect();
            factor.forward(&mut all).unwrap();
            for (seed, found) in all.chunks(factor.len()).enumerate() {
                let mut one = right(&factor, seed);
                factor.forward(&mut one).unwrap();
                assert_close(&one, found);
            }
            factor.backward(&mut all).unwrap();
            for (seed, found) in all.chunks(factor.len()).enumerate() {
                let mut one = right(&factor, seed);
                factor.forward(&mut one).unwrap();
                factor.backward(&mut one).unwrap();
                assert_close(&one, found);
            }
        }
    }
}

#[test]
fn a_right_hand_side_has_the_same_bits_whatever_stands_beside_it() {
    for factor in factors() {
        let solved = |seeds: &[usize]| {
            let mut all: Vec<f64> = seeds.iter().flat_map(|&seed| right(&factor, seed)).collect();
            factor.forward(&mut all).unwrap();
            factor.backward(&mut all).unwrap();
            all
        };
        let (few, many) = (solved(&[5, 3]), solved(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 3]));
        let at = |all: &[f64], place: usize| all[place * factor.len()..(place + 1) * factor.len()].to_vec();
        assert_eq!(at(&few, 0), at(&many, 4));
        assert_eq!(at(&few, 1), at(&many, 2));
        assert_eq!(at(&few, 1), at(&many, 9));
    }
}

fn assert_close(a: &[f64], b: &[f64]) {
    let size = b.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(size > 1.0 && a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-11 * size));
}
