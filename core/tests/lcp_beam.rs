//! A free beam that rests on one-sided supports only. M is its stiffness matrix, singular and with a condition of n⁴; z
//! are the lift-offs at the n points, w the reactions. There is equilibrium if and only if the resultant of the load
//! points down and passes between the ends.
use signorini_core::lcp::{Lcp, LcpStatus, LemkeOptions, lemke};

fn stiffness(points: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; points * points];
    for start in 0..points - 2 {
        for (i, a) in [1.0, -2.0, 1.0].into_iter().enumerate() {
            for (j, b) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                matrix[(start + i) * points + start + j] += a * b * (points as f64).powi(3);
            }
        }
    }
    matrix
}

fn outcome(load: &[f64]) -> LcpStatus {
    let matrix = stiffness(load.len());
    let lcp = Lcp::new(&matrix, load).unwrap();
    let solution = lemke(&lcp, &LemkeOptions::default()).unwrap();
    match &solution.ray {
        Some(ray) => assert!(lcp.infeasibility(ray).unwrap().holds(1e-11)),
        None => {
            assert!(lcp.residuals(&solution.z, &solution.w).unwrap().worst() < 1e-13);
            let total: f64 = load.iter().sum();
            let carried: f64 = solution.w.iter().sum();
            assert!((carried - total).abs() < 1e-9 * load.iter().map(|f| f.abs()).sum::<f64>());
        }
    }
    solution.status
}

const SIZES: [usize; 3] = [20, 100, 300];

/// A downward load of 1 per point, and an upward load in two waves.
fn waves(points: usize) -> Vec<f64> {
    let at = |i: usize| i as f64 / points as f64;
    (0..points).map(|i| 1.0 + 3.0 * (7.0 * at(i)).cos() * (-at(i)).exp()).collect()
}

#[test]
fn stands_where_the_resultant_passes_between_the_ends() {
    for points in SIZES {
        assert_eq!(outcome(&waves(points)), LcpStatus::Solved, "{points} points");
    }
}

#[test]
fn tips_where_the_resultant_passes_beyond_an_end() {
    for points in SIZES {
        let mut load = vec![-0.1; points];
        load[0] = -5.0;
        load[points - 1] = 0.1 * points as f64 + 6.0;
        assert!(load.iter().sum::<f64>() > 0.0);
        assert_eq!(outcome(&load), LcpStatus::Ray, "{points} points");
    }
}

#[test]
fn flies_where_the_resultant_points_up() {
    for points in SIZES {
        let mut load = waves(points);
        let mean = load.iter().sum::<f64>() / points as f64;
        load.iter_mut().for_each(|f| *f -= mean + 0.1);
        assert_eq!(outcome(&load), LcpStatus::Ray, "{points} points");
    }
}
