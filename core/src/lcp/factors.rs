//! LU factors of a block of a scaled problem.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::Perm;
use faer::{Conj, Mat, MatMut, Par};

use super::tolerances;

/// From this order on dense operations are worth all of rayon's threads.
pub(super) const PARALLEL_ORDER: usize = 400;

pub(super) fn parallelism(order: usize) -> Par {
    if order < PARALLEL_ORDER { Par::Seq } else { Par::rayon(0) }
}

/// P A = L U with partial pivoting.
pub(super) struct Factors {
    lu: Mat<f64>,
    permutation: Perm<usize>,
    parallelism: Par,
}

impl Factors {
    /// None if a pivot counts as zero.
    pub(super) fn of(block: &Mat<f64>) -> Option<Self> {
        let order = block.nrows();
        let parallelism = parallelism(order);
        let mut lu = block.clone();
        let (mut forward, mut backward) = (vec![0; order], vec![0; order]);
        let scratch = factor::lu_in_place_scratch::<usize, f64>(order, order, parallelism, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        factor::lu_in_place(lu.as_mut(), &mut forward, &mut backward, parallelism, stack, Default::default());
        let regular = (0..order).all(|i| lu[(i, i)].abs() > tolerances::PIVOT);
        let permutation = Perm::new_checked(forward.into(), backward.into(), order);
        regular.then_some(Self { lu, permutation, parallelism })
    }

    pub(super) fn solve_in_place(&self, right: MatMut<'_, f64>) {
        let scratch = solve::solve_in_place_scratch::<usize, f64>(self.lu.nrows(), right.ncols(), self.parallelism);
        let mut memory = MemBuffer::new(scratch);
        let (stack, permutation) = (MemStack::new(&mut memory), self.permutation.as_ref());
        let lu = self.lu.as_ref();
        solve::solve_in_place_with_conj(lu, lu, permutation, Conj::No, right, self.parallelism, stack);
    }
}
