//! Orderings, assembly and factorization, compared with dense sums.
use faer::Mat;
use proptest::prelude::*;
use signorini_core::assembly::{Assembly, Bedding, HELD, LowerTriangle, Numbering};
use signorini_core::cholesky::{Analysis, FactorError};
use signorini_core::contact::{Graph, Points};
use signorini_core::element::{DOFS, Kind, Layered, Material, Thickness, packed};
use signorini_core::ordering::nested_dissection;
use signorini_core::plate::Plate;
use signorini_core::rows::Springs;

/// A grid of nx × ny elements; nodes are moved a little at random and have random frames.
fn plate(nx: usize, ny: usize, seed: u64) -> Plate {
    let (columns, rows) = (2 * nx + 1, 2 * ny + 1);
    let noise = |k: usize| ((k as f64 + 0.37 * seed as f64) * 12.9898).sin();
    let mut number = vec![usize::MAX; columns * rows];
    let (mut points, mut frames) = (Vec::new(), Vec::new());
    for k in (0..columns * rows).filter(|k| k % columns % 2 == 0 || k / columns % 2 == 0) {
        number[k] = points.len();
        points.push([0.5 * (k % columns) as f64 + 0.04 * noise(k), 0.5 * (k / columns) as f64 + 0.04 * noise(k + 7)]);
        let angle = if k % 3 == 0 { noise(k + 3) } else { 0.0 };
        frames.push([angle.cos(), angle.sin()]);
    }
    let corner = |e: usize| 2 * (e / nx) * columns + 2 * (e % nx);
    let nodes = [0, 2, 2 * columns + 2, 2 * columns, 1, columns + 2, 2 * columns + 1, columns];
    let elements: Vec<_> = (0..nx * ny).map(|e| nodes.map(|offset| number[corner(e) + offset])).collect();
    let at_points = (0..13 * elements.len()).map(|k| 0.2 + 0.02 * noise(k + 11)).collect();
    let thickness = Thickness::Varying { at_points, layered: Layered::default() };
    let material = Material::isotropic(1000.0, 0.3, 5.0 / 6.0);
    Plate::new(points, elements, thickness, material, Kind::Mitc9, Some(frames)).unwrap()
}

fn springs(plate: &Plate, seed: u64) -> Springs {
    let mut out = Springs::default();
    for e in (0..plate.elements().len()).chain([0]) {
        let xi = ((e as u64 + seed) as f64).sin();
        out.rows.element.push(e);
        out.rows.coefficient.push(plate.interpolation_row(e, xi, -0.3 * xi, e % 3).0);
        out.stiffness.push(10.0 + e as f64);
        out.base.push(0.0);
    }
    // The first spring also has coefficients in a distant element, if there is one: its nodes are no neighbours in the
    // mesh.
    let last = plate.elements().len() - 1;
    if !plate.elements()[last].iter().any(|node| plate.elements()[0].contains(node)) {
        out.rows.further.insert(0, vec![(last, plate.interpolation_row(last, 0.2, 0.4, 0).0)]);
    }
    out
}

/// Dense sum of the springs and of the element matrices, which T transforms into the frames of the nodes.
fn dense(plate: &Plate, springs: &Springs) -> Mat<f64> {
    let mut k = Mat::zeros(plate.dof_count(), plate.dof_count());
    for (e, nodes) in plate.elements().iter().enumerate() {
        let lower = plate.element_stiffness(e);
        let mut turn = Mat::<f64>::identity(DOFS, DOFS);
        for (i, &node) in nodes.iter().enumerate() {
            let [c, s] = plate.frame(node).unwrap_or([1.0, 0.0]);
            turn[(3 * i + 1, 3 * i + 1)] = c;
            turn[(3 * i + 1, 3 * i + 2)] = -s;
            turn[(3 * i + 2, 3 * i + 1)] = s;
            turn[(3 * i + 2, 3 * i + 2)] = c;
        }
        let full = Mat::from_fn(DOFS, DOFS, |i, j| lower[packed(i, j)]);
        add(&mut k, nodes, &(turn.transpose() * full * &turn));
    }
    for (spring, stiffness) in springs.stiffness.iter().enumerate() {
        let row: Vec<(usize, f64)> = springs.rows.entries(plate, spring).collect();
        for &(i, own) in &row {
            row.iter().for_each(|&(j, other)| k[(i, j)] += stiffness * own * other);
        }
    }
    k
}

fn add(k: &mut Mat<f64>, nodes: &[usize; 8], block: &Mat<f64>) {
    let dof = |i: usize| 3 * nodes[i / 3] + i % 3;
    for i in 0..DOFS {
        for j in 0..DOFS {
            k[(dof(i), dof(j))] += block[(i, j)];
        }
    }
}

fn marks(count: usize, seed: u64, part: u64) -> Vec<bool> {
    (0..count as u64).map(|i| (i * 2_654_435_761 + seed * 40_503) % 97 < part).collect()
}

fn unpacked(lower: &LowerTriangle) -> Mat<f64> {
    let n = lower.column_start.len() - 1;
    let mut out = Mat::zeros(n, n);
    for column in 0..n {
        for at in lower.column_start[column]..lower.column_start[column + 1] {
            assert!(lower.row[at] >= column);
            out[(lower.row[at], column)] += lower.value[at];
            if lower.row[at] > column {
                out[(column, lower.row[at])] += lower.value[at];
            }
        }
    }
    out
}

fn largest(m: &Mat<f64>) -> f64 {
    (0..m.ncols()).flat_map(|j| (0..m.nrows()).map(move |i| m[(i, j)].abs())).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn dissection_is_a_permutation(nx in 1usize..9, ny in 1usize..9, seed in 0u64..100) {
        let plate = plate(nx, ny, seed);
        let last = plate.elements().len() as u32 - 1;
        let mut order = nested_dissection(&plate, &[[0, last], [last / 2, last]]);
        order.sort_unstable();
        prop_assert!(order.into_iter().eq(0..plate.dof_count()));
    }

    #[test]
    fn numbering_leaves_out_held_dofs_and_puts_contact_dofs_last(nx in 1usize..6, ny in 1usize..6, seed in 0u64..100) {
        let plate = plate(nx, ny, seed);
        let (held, contact) = (marks(plate.dof_count(), seed, 20), marks(plate.dof_count(), seed + 1, 15));
        let numbering = Numbering::new(&plate, &[], &held, &contact);
        let free = held.iter().filter(|h| !**h).count();
        prop_assert_eq!(numbering.len(), free);
        for (dof, &column) in numbering.column.iter().enumerate() {
            prop_assert_eq!(column == HELD, held[dof]);
            if column != HELD {
                prop_assert_eq!(numbering.dof[column], dof);
                prop_assert_eq!(column >= free - numbering.trailing, contact[dof]);
            }
        }
    }

    #[test]
    fn the_sparse_sum_is_the_dense_one(nx in 1usize..5, ny in 1usize..4, seed in 0u64..100) {
        let plate = plate(nx, ny, seed);
        let springs = springs(&plate, seed);
        let held = marks(plate.dof_count(), seed, 15);
        let numbering = Numbering::new(&plate, &[], &held, &marks(plate.dof_count(), seed + 2, 20));
        let sparse = unpacked(&Assembly::new(&plate, &springs, &Bedding::default(), &numbering).lower_triangle());
        let all = dense(&plate, &springs);
        let expected = Mat::from_fn(numbering.len(), numbering.len(), |i, j| all[(numbering.dof[i], numbering.dof[j])]);
        prop_assert!(largest(&(sparse - &expected)) <= 1e-12 * largest(&expected));
    }

    /// Springs couple two distant elements, or two that share an edge.
    #[test]
    fn bedding_of_two_elements_is_the_sum_of_its_springs(nx in 2usize..5, ny in 1usize..4, seed in 0u64..100) {
        let plate = plate(nx, ny, seed);
        let mut springs = Springs::default();
        let deflections = |e: usize, xi: f64, nodes: &[usize]| {
            let row = plate.interpolation_row(e, xi, 0.4 * xi, 0).0;
            std::array::from_fn(|j| if j % 3 == 0 && !nodes.contains(&plate.elements()[e][j / 3]) { row[j] } else { 0.0 })
        };
        let mut points = Points::default();
        let law = points.add_graph(Graph::two_sided(1.0));
        for (i, [first, second]) in [[0, nx * ny - 1], [1, 0], [0, nx * ny - 1], [0, 0]].into_iter().enumerate() {
            let xi = ((i as u64 + seed) as f64).sin();
            springs.rows.element.push(first);
            springs.rows.coefficient.push(deflections(first, xi, &[]));
            if first != second {
                let others = deflections(second, -xi, &plate.elements()[first]).map(|c: f64| -c);
                springs.rows.further.insert(i, vec![(second, others)]);
            }
            springs.stiffness.push(10.0 + i as f64);
            points.push_row(&plate, &springs.rows, i, law, 0.0, springs.stiffness[i]);
        }
        let bedding = points.bedding(&plate, &springs.stiffness);
        let held = marks(plate.dof_count(), seed, 15);
        let numbering = Numbering::new(&plate, bedding.pairs, &held, &marks(plate.dof_count(), seed + 2, 20));
        let sparse = unpacked(&Assembly::new(&plate, &Springs::default(), &bedding, &numbering).lower_triangle());
        let all = dense(&plate, &springs);
        let expected = Mat::from_fn(numbering.len(), numbering.len(), |i, j| all[(numbering.dof[i], numbering.dof[j])]);
        prop_assert!(largest(&(sparse - &expected)) <= 1e-12 * largest(&expected));
    }

    #[test]
    fn factors_solve_and_end_in_the_schur_complement(nx in 1usize..5, ny in 1usize..4, seed in 0u64..100) {
        let plate = plate(nx, ny, seed);
        let springs = springs(&plate, seed);
        let mut held = marks(plate.dof_count(), seed, 10);
        held[..9].fill(true);
        let numbering = Numbering::new(&plate, &[], &held, &marks(plate.dof_count(), seed + 2, 20));
        let none = Bedding::default();
        let matrix = Assembly::new(&plate, &springs, &none, &numbering);
        let (full, factor) = (unpacked(&matrix.lower_triangle()), Analysis::new(&matrix).unwrap().factorize(&matrix).unwrap());
        let n = numbering.len();
        let right = Mat::from_fn(n, 1, |i, _| (i as f64 + seed as f64).sin());
        let mut x = right.col_as_slice(0).to_vec();
        factor.forward(&mut x).unwrap();
        factor.backward(&mut x).unwrap();
        let solution = Mat::from_fn(n, 1, |i, _| x[i]);
        let size = largest(&full) * largest(&solution);
        prop_assert!(largest(&(&full * &solution - right)) <= 1e-13 * size);

        // Dense Gaussian elimination of the leading dofs leaves the Schur complement.
        let mut schur = full.clone();
        let first = n - numbering.trailing;
        for k in 0..first {
            for i in k + 1..n {
                let ratio = schur[(i, k)] / schur[(k, k)];
                for j in k + 1..n {
                    let change = ratio * schur[(k, j)];
                    schur[(i, j)] -= change;
                }
            }
        }
        let block = factor.trailing_block(numbering.trailing).unwrap();
        let product = &block * block.transpose();
        for i in 0..numbering.trailing {
            for j in 0..numbering.trailing {
                let error = (product[(i, j)] - schur[(first + i, first + j)]).abs();
                prop_assert!(error <= 1e-10 * largest(&full));
            }
        }
    }
}

#[test]
fn a_plate_that_springs_push_has_no_factor() {
    let plate = plate(2, 2, 1);
    let numbering = Numbering::natural(&plate);
    let mut springs = springs(&plate, 1);
    springs.stiffness.fill(-1e4);
    let none = Bedding::default();
    let matrix = Assembly::new(&plate, &springs, &none, &numbering);
    let found = Analysis::new(&matrix).unwrap().factorize(&matrix);
    assert!(matches!(found, Err(FactorError::NotPositiveDefinite { .. })));
}
