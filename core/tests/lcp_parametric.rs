//! Parametric paths: the basis of every segment solves the problem there, and no segment is missing.
use proptest::prelude::*;
use signorini_core::lcp::{Lcp, LcpStatus, LemkeOptions, ParametricEnd, lemke, lemke_from, parametric};

/// G Gᵀ plus a skew-symmetric part, row-major: positive semidefinite, and singular if G has few columns.
fn semidefinite(order: usize, rank: usize, g: &[i32], skew: &[i32]) -> Vec<f64> {
    let mut matrix = vec![0.0; order * order];
    for i in 0..order {
        for j in 0..order {
            let product: i32 = (0..rank).map(|k| g[i * rank + k] * g[j * rank + k]).sum();
            let part = match i.cmp(&j) {
                std::cmp::Ordering::Less => skew[i * order + j],
                std::cmp::Ordering::Equal => 0,
                std::cmp::Ordering::Greater => -skew[j * order + i],
            };
            matrix[i * order + j] = f64::from(product + part);
        }
    }
    matrix
}

fn moved(q: &[f64], direction: &[f64], t: f64) -> Vec<f64> {
    q.iter().zip(direction).map(|(q, d)| q + t * d).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    /// Integer entries cause ties, so several variables often reach zero together.
    #[test]
    fn every_segment_is_solved_by_its_basis_and_beyond_the_last_is_nothing(
        (order, rank) in (1usize..8, 0usize..8),
        g in prop::collection::vec(-2..=2i32, 64),
        skew in prop::collection::vec(-2..=2i32, 64),
        twist in any::<bool>(),
        q in prop::collection::vec(-3..=6i32, 8),
        direction in prop::collection::vec(-3..=3i32, 8),
    ) {
        let skew: Vec<i32> = skew.iter().map(|s| if twist { *s } else { 0 }).collect();
        let matrix = semidefinite(order, rank, &g, &skew);
        let q: Vec<f64> = q[..order].iter().map(|&x| f64::from(x)).collect();
        let direction: Vec<f64> = direction[..order].iter().map(|&x| f64::from(x)).collect();
        let options = LemkeOptions::default();
        let lcp = Lcp::new(&matrix, &q).unwrap();
        let first = lemke(&lcp, &options).unwrap();
        prop_assume!(first.status == LcpStatus::Solved);
        let path = parametric(&lcp, &direction, &first.basis, f64::INFINITY, &mut |_| true).unwrap();
        prop_assert!(path.end != ParametricEnd::Stopped);
        let mut reached = 0.0;
        for segment in &path.segments {
            prop_assert_eq!(segment.from, reached);
            prop_assert!(segment.to > segment.from);
            reached = segment.to;
            let to = if segment.to.is_finite() { segment.to } else { 2.0 * segment.from + 5.0 };
            for part in [0.01, 0.5, 0.99] {
                let there = moved(&q, &direction, segment.from + part * (to - segment.from));
                let found = lemke_from(&Lcp::new(&matrix, &there).unwrap(), &options, &segment.basis).unwrap();
                prop_assert_eq!((found.status, found.pivots), (LcpStatus::Solved, 0));
            }
        }
        match path.end {
            ParametricEnd::Infeasible => {
                let beyond = moved(&q, &direction, reached * (1.0 + 1e-6) + 1e-6);
                let found = lemke(&Lcp::new(&matrix, &beyond).unwrap(), &options).unwrap();
                prop_assert_eq!(found.status, LcpStatus::Ray);
            }
            _ => prop_assert!(reached.is_infinite()),
        }
    }
}

#[test]
fn a_direction_of_the_wrong_length_is_refused() {
    let lcp = Lcp::new(&[1.0], &[1.0]).unwrap();
    assert!(parametric(&lcp, &[1.0, 2.0], &[false], 1.0, &mut |_| true).is_err());
    assert!(parametric(&lcp, &[f64::NAN], &[false], 1.0, &mut |_| true).is_err());
    assert!(parametric(&lcp, &[1.0], &[], 1.0, &mut |_| true).is_err());
}

#[test]
fn a_matrix_that_is_not_semidefinite_may_turn_the_path_back() {
    // w = 1 − t − z: at t = 1 the slack is zero, and z can increase only if t decreases.
    let lcp = Lcp::new(&[-1.0], &[1.0]).unwrap();
    let path = parametric(&lcp, &[-1.0], &[false], f64::INFINITY, &mut |_| true).unwrap();
    assert_eq!((path.end, path.segments.len()), (ParametricEnd::Stopped, 1));
}
