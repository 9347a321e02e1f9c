//! Linear complementarity problems with known solutions, named after their sources.
use signorini_core::lcp::{Lcp, LcpError, LcpSolution, LcpStatus, LemkeOptions, lemke, lemke_from};

fn solve(matrix: &[f64], q: &[f64]) -> LcpSolution {
    let lcp = Lcp::new(matrix, q).unwrap();
    let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
    if solution.status == LcpStatus::Solved {
        let residuals = lcp.residuals(&solution.z, &solution.w).unwrap();
        assert!(residuals.worst() < 1e-14, "{residuals:?}");
    }
    solution
}

fn assert_close(found: &[f64], expected: &[f64]) {
    let size = expected.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
    let far = found.iter().zip(expected).any(|(a, b)| (a - b).abs() > 1e-14 * size);
    assert!(!far && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

/// Lower triangular matrix: 1 on the diagonal, 2 below.
fn unit_lower(n: usize) -> Vec<f64> {
    let entry = |i: usize, j: usize| f64::from(u8::from(i == j) + 2 * u8::from(i > j));
    (0..n * n).map(|at| entry(at / n, at % n)).collect()
}

fn murty(n: usize) -> (Vec<f64>, Vec<f64>) {
    let power = |k: usize| 2.0_f64.powi(i32::try_from(k).unwrap());
    (unit_lower(n), (1..=n).map(|i| power(n + 1 - i) - power(n + 1)).collect())
}

fn fathi(n: usize) -> (Vec<f64>, Vec<f64>) {
    let l = unit_lower(n);
    let entry = |i: usize, j: usize| (0..n).map(|k| l[i * n + k] * l[j * n + k]).sum();
    ((0..n * n).map(|at| entry(at / n, at % n)).collect(), vec![-1.0; n])
}

#[test]
fn murty_takes_two_to_the_n_pivots() {
    for n in 1..=12 {
        let (matrix, q) = murty(n);
        let solution = solve(&matrix, &q);
        let mut expected = vec![0.0; n];
        expected[0] = f64::from(1_u32 << n);
        assert_eq!(solution.z, expected);
        assert_eq!(solution.pivots, 1 << n, "n = {n}");
    }
}

#[test]
fn fathi_takes_two_to_the_n_pivots() {
    for n in 1..=12 {
        let (matrix, q) = fathi(n);
        let solution = solve(&matrix, &q);
        let mut expected = vec![0.0; n];
        expected[0] = 1.0;
        assert_close(&solution.z, &expected);
        assert_eq!(solution.pivots, 1 << n, "n = {n}");
    }
}

#[test]
fn ben_gharbia_and_gilbert_where_plain_newton_min_cycles() {
    let solution = solve(&[1.0, 0.0, 2.0, 2.0, 1.0, 0.0, 0.0, 2.0, 1.0], &[1.0; 3]);
    assert_eq!((solution.z, solution.w, solution.pivots), (vec![0.0; 3], vec![1.0; 3], 0));
}

#[test]
fn symmetric_problem_of_order_three() {
    let solution = solve(&[60.0, 26.0, 37.0, 26.0, 36.0, 29.0, 37.0, 29.0, 30.0], &[-1.0; 3]);
    assert_close(&solution.z, &[0.0, 1.0 / 239.0, 7.0 / 239.0]);
    assert_eq!(solution.basis, [false, true, true]);
}

#[test]
fn degenerate_problem_of_order_four() {
    let matrix = [11.0, 0.0, 10.0, -1.0, 0.0, 11.0, 10.0, -1.0, 10.0, 10.0, 21.0, -1.0, 1.0, 1.0, 1.0, 0.0];
    let solution = solve(&matrix, &[50.0, 50.0, 23.0, -6.0]);
    assert_close(&solution.z, &[3.0, 3.0, 0.0, 83.0]);
    assert_close(&solution.w, &[0.0; 4]);
}

#[test]
fn solution_that_is_not_unique() {
    let solution = solve(&[1.0; 4], &[-1.0; 2]);
    assert_close(&[solution.z[0] + solution.z[1]], &[1.0]);
}

#[test]
fn ray_where_no_point_is_feasible() {
    let (matrix, q) = ([1.0, -1.0, -1.0, 1.0], [-1.0; 2]);
    let solution = solve(&matrix, &q);
    assert_eq!(solution.status, LcpStatus::Ray);
    assert!(solution.z.iter().chain(&solution.w).all(|x| x.is_nan()));
    assert!(solution.basis.iter().all(|basic| !basic));
    let ray = solution.ray.unwrap();
    assert_close(&ray, &[1.0, 1.0]);
    assert!(Lcp::new(&matrix, &q).unwrap().infeasibility(&ray).unwrap().holds(1e-14));
}

/// A P-matrix on which principal pivoting cycles without Murty's least-index rule. In Lemke's first ratio test all
/// ratios tie.
#[test]
fn cyclic_problem_of_kostreva() {
    let solution = solve(&[1.0, 2.0, 0.0, 0.0, 1.0, 2.0, 2.0, 0.0, 1.0], &[-1.0; 3]);
    assert_close(&solution.z, &[1.0 / 3.0; 3]);
}

/// A bimatrix game, matching pennies with costs A, B > 0: M = [[0, A], [Bᵀ, 0]], q = −e. M is copositive but not
/// copositive-plus, so Lemke's ray does not prove infeasibility (Cottle, Pang & Stone 1992, section 4.4). The proof
/// check must fail.
#[test]
fn ray_of_a_bimatrix_game_proves_nothing() {
    let matrix = [0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, 1.0, 2.0, 1.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0];
    let lcp = Lcp::new(&matrix, &[-1.0; 4]).unwrap();
    assert!(lcp.residuals(&[1.0 / 3.0; 4], &[0.0; 4]).unwrap().worst() < 1e-15);
    let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
    assert_eq!(solution.status, LcpStatus::Ray);
    assert!(!lcp.infeasibility(&solution.ray.unwrap()).unwrap().holds(1e-10));
}

#[test]
fn no_unknowns_are_solved() {
    let solution = solve(&[], &[]);
    assert_eq!((solution.status, solution.z.len()), (LcpStatus::Solved, 0));
}

#[test]
fn solution_is_the_same_in_any_units() {
    let matrix = [60.0, 26.0, 37.0, 26.0, 36.0, 29.0, 37.0, 29.0, 30.0];
    let units = [3e-90, 7e40, 1e-3];
    let scaled: Vec<f64> = (0..9).map(|at| matrix[at] * units[at / 3] * units[at % 3]).collect();
    let q: Vec<f64> = units.iter().map(|u| -1e80 * u).collect();
    let solution = solve(&scaled, &q);
    let z: Vec<f64> = solution.z.iter().zip(units).map(|(z, u)| z * u * 1e-80).collect();
    assert_close(&z, &[0.0, 1.0 / 239.0, 7.0 / 239.0]);
}

#[test]
fn slack_that_is_far_from_used_up_hides_nothing() {
    let (matrix, q) = fathi(6);
    let alone = solve(&matrix, &q);
    let mut beside: Vec<f64> = matrix.chunks(6).flat_map(|row| row.iter().copied().chain([0.0])).collect();
    beside.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    for slack in [1.0, 1e6, 1e12, 1e18] {
        let q: Vec<f64> = q.iter().copied().chain([slack]).collect();
        let solution = solve(&beside, &q);
        assert_eq!((&solution.z[..6], solution.w[6]), (&alone.z[..], slack));
    }
}

#[test]
fn pivot_limit_claims_nothing() {
    let (matrix, q) = murty(5);
    let lcp = Lcp::new(&matrix, &q).unwrap();
    for limit in [0, 1, 31] {
        let options = LemkeOptions { max_pivots: Some(limit), ..LemkeOptions::default() };
        let solution = lemke(&lcp, &options).unwrap();
        assert_eq!((solution.status, solution.pivots), (LcpStatus::PivotLimit, limit));
        assert!(solution.z.iter().all(|z| z.is_nan()) && solution.ray.is_none());
    }
    let options = LemkeOptions { max_pivots: Some(32), ..LemkeOptions::default() };
    assert_eq!(lemke(&lcp, &options).unwrap().status, LcpStatus::Solved);
}

#[test]
fn warm_start_at_the_solution_makes_no_pivot() {
    let (matrix, q) = murty(8);
    let cold = solve(&matrix, &q);
    let lcp = Lcp::new(&matrix, &q).unwrap();
    let warm = lemke_from(&lcp, &LemkeOptions::default(), &cold.basis).unwrap();
    assert_eq!((warm.pivots, warm.z), (0, cold.z));
}

#[test]
fn warm_start_at_a_singular_basis_falls_back_to_the_cold_start() {
    let lcp = Lcp::new(&[1.0; 4], &[-1.0; 2]).unwrap();
    let solution = lemke_from(&lcp, &LemkeOptions::default(), &[true, true]).unwrap();
    assert_eq!(solution.status, LcpStatus::Solved);
    assert_close(&[solution.z[0] + solution.z[1]], &[1.0]);
}

#[test]
fn errors_name_the_entry() {
    let nan = f64::NAN;
    let messages = [
        (Lcp::new(&[1.0; 3], &[1.0; 2]).unwrap_err(), "M has 3 entries; q has 2, so M needs 2 x 2"),
        (Lcp::new(&[1.0, 0.0, nan, 1.0], &[1.0; 2]).unwrap_err(), "M[1, 0] is NaN; every entry must be finite"),
        (Lcp::new(&[1.0; 4], &[1.0, f64::INFINITY]).unwrap_err(), "q[1] is inf; every entry must be finite"),
    ];
    for (error, message) in messages {
        assert_eq!(error.to_string(), message);
    }
    let lcp = Lcp::new(&[1.0, 0.0, 0.0, 1.0], &[-1.0; 2]).unwrap();
    let cover =
        |covering: &[f64]| lemke(&lcp, &LemkeOptions { covering: Some(covering), max_pivots: None }).unwrap_err();
    assert_eq!(cover(&[1.0]), LcpError::Length { name: "covering", found: 1, order: 2 });
    for value in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(cover(&[1.0, value]), LcpError::Covering { index: 1, value });
    }
    let basis = lemke_from(&lcp, &LemkeOptions::default(), &[true]).unwrap_err();
    assert_eq!(basis.to_string(), "basis has 1 entries; M is 2 x 2, so it needs 2");
    assert!(lcp.residuals(&[0.0], &[0.0; 2]).is_err() && lcp.residuals(&[0.0; 2], &[0.0]).is_err());
    assert!(lcp.infeasibility(&[0.0]).is_err());
}

#[test]
fn residuals_catch_each_fault() {
    let lcp = Lcp::new(&[2.0, 0.0, 0.0, 2.0], &[-2.0, 4.0]).unwrap();
    let judge = |z: [f64; 2], w: [f64; 2]| lcp.residuals(&z, &w).unwrap();
    assert_eq!(judge([1.0, 0.0], [0.0, 4.0]).worst(), 0.0);
    assert_eq!(judge([1.0, -0.5], [0.0, 3.0]).negative_z, 0.5);
    // s = (3, 4), W = 1.5, √(2W) = √3.
    assert_eq!(judge([0.5, 0.0], [-1.0, 4.0]).negative_w, 1.0 / (3.0 + 3.0_f64.sqrt()));
    // s = (6, 4), W = 12.
    assert_eq!(judge([2.0, 0.0], [2.0, 4.0]).complementarity, 4.0 / 12.0);
    // s = (4, 4), W = 4.
    assert_eq!(judge([1.0, 0.0], [0.0, 3.0]).equation, 1.0 / (4.0 + 8.0_f64.sqrt()));
    assert!(judge([f64::NAN, 0.0], [0.0, 4.0]).worst().is_nan());
    assert!(judge([1.0, 0.0], [0.0, f64::NAN]).worst().is_nan());
}
