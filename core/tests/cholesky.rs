//! Substitution with a factor: one right-hand side against several side by side.

use signorini_core::assembly::{Numbering, assemble};
use signorini_core::cholesky::{Analysis, Factor};
use signorini_core::element::{Kind, Material, Thickness};
use signorini_core::plate::Plate;
use signorini_core::residual::{Rows, Springs};

/// A strip of square elements, on a spring at the first node of each.
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
    let material = Material { young: 100.0, poisson: 0.3, shear_factor: 5.0 / 6.0 };
    let plate = Plate::new(points, elements, thickness, material, Kind::Mitc9, None).unwrap();
    let coefficient = (0..count).map(|e| plate.interpolation_row(e, -1.0, -1.0, 0).0).collect();
    let rows = Rows { element: (0..count).collect(), coefficient };
    (plate, Springs { rows, stiffness: vec![1.0; count], base: vec![0.0; count] })
}

/// A small factor, whose subtrees are not shared out, and one whose are.
fn factors() -> [Factor; 2] {
    [(3, 2, 0), (40, 20, 400_000)].map(|(columns, rows, entries)| {
        let (plate, springs) = strip(columns, rows);
        let free = vec![false; plate.dof_count()];
        let numbering = Numbering::new(&plate, &free, &free);
        let matrix = assemble(&plate, &springs, &[], &numbering);
        let factor = Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap();
        assert!(factor.entries() > entries);
        factor
    })
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
