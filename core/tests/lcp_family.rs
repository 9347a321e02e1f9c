//! Many problems with the same M, compared with each problem solved alone.
use proptest::prelude::*;
use signorini_core::lcp::{Lcp, LcpFamily, LcpStatus, LemkeOptions, lemke, lemke_from};

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Integer entries cause ties; M = GᵀG has the rank of G.
    #[test]
    fn a_family_ends_where_each_of_its_problems_does(
        (order, rank) in (1usize..8, 1usize..8),
        g in prop::collection::vec(-2..=2i32, 64),
        origin in prop::collection::vec(any::<bool>(), 8),
        loads in prop::collection::vec(prop::collection::vec(-4..=4i32, 8), 4),
    ) {
        let product = |i: usize, j: usize| (0..rank).map(|k| g[i * rank + k] * g[j * rank + k]).sum::<i32>();
        let matrix: Vec<f64> = (0..order * order).map(|at| f64::from(product(at / order, at % order))).collect();
        let loads: Vec<Vec<f64>> =
            loads.iter().map(|load| load[..order].iter().map(|&q| f64::from(q)).collect()).collect();
        let Some(family) = LcpFamily::new(&Lcp::new(&matrix, &loads[0]).unwrap(), &origin[..order]).unwrap() else {
            return Ok(());
        };
        for q in &loads {
            let lcp = Lcp::new(&matrix, q).unwrap();
            let alone = lemke(&lcp, &LemkeOptions::default()).unwrap();
            let found = family.solve(q).unwrap();
            prop_assert_eq!(found.status, alone.status);
            if found.status == LcpStatus::Solved {
                let again = lemke_from(&lcp, &LemkeOptions::default(), &found.basis).unwrap();
                prop_assert_eq!((again.status, again.pivots), (LcpStatus::Solved, 0));
            }
        }
    }
}

#[test]
fn a_load_of_the_wrong_length_is_refused() {
    let lcp = Lcp::new(&[1.0], &[-1.0]).unwrap();
    assert!(LcpFamily::new(&lcp, &[true, false]).is_err());
    let family = LcpFamily::new(&lcp, &[true]).unwrap().unwrap();
    assert!(family.solve(&[1.0, 2.0]).is_err());
    assert!(family.solve(&[f64::NAN]).is_err());
}
