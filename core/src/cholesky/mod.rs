//! Sparse Cholesky factorization by the multifrontal method. Supernodes of the elimination tree are eliminated with the
//! dense kernels of `faer`. Also forward and backward substitution, and the trailing block of the factor.
//!
//! The matrix is positive definite, or its pivots have known signs: A = L S Lᵀ, S diagonal with entries 1 and −1. A
//! quasi-definite matrix [[K, Gᵀ], [G, −C]], K and C positive definite, has this factor in every order of its columns
//! (R. J. Vanderbei, "Symmetric quasidefinite matrices", SIAM J. Optim. 5, 1995). There is no pivoting, so accuracy
//! depends on the order (Gill, Saunders and Shinnerl 1996). An entry of C that is small relative to G K⁻¹ Gᵀ makes
//! entries of L grow if its column precedes the columns of K that G couples with it. If its column follows them,
//! entries do not grow.

mod buffer;
mod entry;
mod error;
mod front;
mod graph;
mod layout;
mod matrix;
mod merge;
mod numeric;
mod parts;
mod substitution;
mod tree;

use crate::dense;
pub use entry::LANES;
use entry::{Entry, Lanes};
pub use error::FactorError;
use faer::Mat;
pub use graph::Graph;
pub use matrix::{Matrix, Reader};
use numeric::{Plan, WeakestPivot};
use parts::Parts;
use std::sync::Arc;
use substitution::Schedule;
use tree::Tree;

/// Smallest estimated time, in nanoseconds, for which a subtree is divided among threads.
const LEAST: f64 = 3e5;

/// The pattern of L, and plans for the factorization and for the substitution.
#[derive(Clone)]
pub struct Analysis(Arc<Pattern>);

struct Pattern {
    tree: Tree,
    parts: Parts,
    plan: Plan,
    schedule: Schedule,
}

impl Analysis {
    /// Analyses the pattern of a matrix. Returns `OutOfMemory` if 32 bits cannot number its columns.
    pub fn new(matrix: &impl Matrix) -> Result<Self, FactorError> {
        let tree = Tree::new(&matrix.graph())?;
        let parts = Parts::new(&tree.parent, &tree.work(), LEAST);
        let plan = Plan::new(&tree, &parts);
        let schedule = Schedule::new(&tree, &parts);
        Ok(Self(Arc::new(Pattern { tree, parts, plan, schedule })))
    }

    /// Returns an error if the factorization needs more than `room` bytes.
    pub fn require_room(&self, room: usize) -> Result<(), FactorError> {
        let bytes = self.0.plan.bytes(&self.0.parts, rayon::current_num_threads());
        if bytes <= room { Ok(()) } else { Err(FactorError::TooLarge { bytes, room }) }
    }

    /// Factors A = L S Lᵀ on all threads, with the signs S that the matrix gives. The factor is the same to the last
    /// bit for any number of threads.
    pub fn factorize(&self, matrix: &impl Matrix) -> Result<Factor, FactorError> {
        let Pattern { tree, parts, plan, .. } = &*self.0;
        let (values, weakest_pivot) = numeric::factorize(tree, parts, plan, matrix)?;
        let negative = (0..tree.columns()).filter(|&column| matrix.is_negative(column)).map(|column| column as u32);
        Ok(Factor { pattern: self.0.clone(), values, negative: negative.collect(), weakest_pivot })
    }
}

/// Factor A = L S Lᵀ of a matrix whose columns are in elimination order; S is diagonal with entries ±1, the signs of the
/// pivots.
pub struct Factor {
    pattern: Arc<Pattern>,
    /// Entries of L, one array for each part of the elimination tree.
    values: Vec<Vec<f64>>,
    /// Columns with a negative pivot; their entry in S is −1.
    negative: Vec<u32>,
    weakest_pivot: WeakestPivot,
}

impl Factor {
    pub fn len(&self) -> usize {
        self.pattern.tree.columns()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column with the smallest ratio |pivot|/|diagonal entry of A|, and this ratio.
    ///
    /// A ratio near the unit roundoff means that the matrix is singular to working precision. If earlier columns have
    /// the other sign, a pivot may exceed its diagonal entry; the ratio then does not show cancellation.
    pub fn weakest_pivot(&self) -> WeakestPivot {
        self.weakest_pivot
    }

    /// Number of stored entries of L.
    pub fn entries(&self) -> usize {
        self.pattern.plan.entries()
    }

    /// Number of multiplications and additions of the factorization, without operations on zeros that are stored for
    /// speed.
    pub fn flops(&self) -> f64 {
        self.pattern.tree.flops
    }

    /// Overwrites each vector v in `rhs` with S L⁻¹ v; S = 1 if all pivots are positive. `rhs` has one vector, or
    /// several one after the other. [`backward`](Self::backward) then gives A⁻¹ v.
    ///
    /// Each result is the same to the last bit with and without other vectors.
    pub fn forward(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        if rhs.len() != self.len() {
            return self.side_by_side(rhs, |lanes| self.run_forward(lanes));
        }
        self.run_forward(rhs);
        Ok(())
    }

    /// Overwrites each vector v in `rhs` with L⁻ᵀ v. `rhs` has one vector, or several one after the other.
    pub fn backward(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        if rhs.len() != self.len() {
            return self.side_by_side(rhs, |lanes| self.run_backward(lanes));
        }
        self.run_backward(rhs);
        Ok(())
    }

    /// Overwrites each vector v in `rhs` with A⁻¹ v; the vectors are one after the other. Each result is the same to
    /// the last bit for any number of other vectors.
    pub fn solve_side_by_side(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        self.side_by_side(rhs, |lanes| {
            self.run_forward(lanes);
            self.run_backward(lanes);
        })
    }

    fn run_forward<E: Entry>(&self, rhs: &mut [E]) {
        let Pattern { tree, parts, schedule, .. } = &*self.pattern;
        schedule.forward(tree, parts, &self.values, rhs);
        self.negative.iter().for_each(|&column| rhs[column as usize].negate());
    }

    fn run_backward<E: Entry>(&self, rhs: &mut [E]) {
        let Pattern { tree, parts, schedule, .. } = &*self.pattern;
        schedule.backward(tree, parts, &self.values, rhs);
    }

    fn side_by_side(&self, rhs: &mut [f64], solve: impl Fn(&mut [Lanes])) -> Result<(), FactorError> {
        let size = self.len().max(1);
        let mut lanes = Vec::new();
        lanes.try_reserve_exact(size).map_err(|_| FactorError::OutOfMemory)?;
        for vectors in rhs.chunks_mut(LANES * size) {
            lanes.clear();
            lanes.resize(size, Lanes::ZERO);
            for (lane, vector) in vectors.chunks_exact(size).enumerate() {
                lanes.iter_mut().zip(vector).for_each(|(row, value)| row.0[lane] = *value);
            }
            solve(&mut lanes);
            for (lane, vector) in vectors.chunks_exact_mut(size).enumerate() {
                lanes.iter().zip(vector).for_each(|(row, value)| *value = row.0[lane]);
            }
        }
        Ok(())
    }

    /// The last `size` rows and columns of L. They factor the Schur complement of the columns before them.
    ///
    /// The Schur complement is L S Lᵀ, with this block as L and the signs S of the last `size` columns.
    pub fn trailing_block(&self, size: usize) -> Result<Mat<f64>, FactorError> {
        let Pattern { tree, parts, .. } = &*self.pattern;
        let first = self.len() - size;
        let mut block = dense::matrix(size, size, |_, _| 0.0)?;
        let mut values = Vec::new();
        for (part, numbers) in parts.0.iter().zip(&self.values) {
            let mut stored = 0;
            for s in part.supernodes.clone() {
                let (places, width, height) = (tree.begin[s]..tree.begin[s + 1], tree.width(s), tree.height(s));
                for panel in layout::panels(width, height) {
                    for k in 0..panel.count {
                        let rows = places.clone().skip(panel.first + k);
                        let mut rows = rows.chain(tree.below(s).iter().map(|&place| place as usize)).peekable();
                        let Some(column) = rows.peek().and_then(|&at| (tree.column[at] as usize).checked_sub(first))
                        else {
                            continue;
                        };
                        let numbers = &numbers[stored + panel.at..][..panel.count * panel.height];
                        panel.column(numbers, k, &mut values);
                        for (place, &value) in rows.zip(&values) {
                            block[(tree.column[place] as usize - first, column)] = value;
                        }
                    }
                }
                stored += layout::size(width, height);
            }
        }
        Ok(block)
    }
}
