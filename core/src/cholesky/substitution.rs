//! Forward and backward substitution, the subtrees of the elimination tree side by side.
//!
//! It is bound by reading L once each way, which one core alone cannot do at the speed of the memory, and which several
//! right-hand sides share.

use super::entry::Entry;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use rayon::prelude::*;

/// Subtrees are split until none holds more than this part of L.
const PART: usize = 16;
/// Factors with fewer entries are not shared out: starting threads would cost more.
const SMALL: usize = 400_000;
const ABOVE: usize = usize::MAX;

/// Which supernodes are worked on together: disjoint subtrees, and what is above them.
pub(super) struct Schedule {
    subtrees: Vec<Part>,
    above: Part,
}

/// Supernodes in elimination order, over the rows that they touch.
#[derive(Default)]
struct Part {
    supernodes: Vec<Supernode>,
    /// Row of the matrix of each local one; the first `own` are the supernodes' columns.
    rows: Vec<usize>,
    own: usize,
    /// Local rows below each supernode's columns, one supernode after the other.
    below: Vec<u32>,
    /// Most rows of a supernode.
    tallest: usize,
}

struct Supernode {
    /// Where its columns begin in L.
    values: usize,
    columns: usize,
    height: usize,
    /// Local row of its first column.
    first: usize,
    /// Where its rows begin in `below`.
    below: usize,
}

impl Schedule {
    pub(super) fn new(symbolic: &SymbolicSupernodalCholesky<usize>) -> Self {
        let count = symbolic.n_supernodes();
        let (begin, end) = (symbolic.supernode_begin(), symbolic.supernode_end());
        let mut supernode_of = vec![0; symbolic.nrows()];
        for s in 0..count {
            supernode_of[begin[s]..end[s]].fill(s);
        }
        let parent: Vec<usize> = (0..count)
            .map(|s| symbolic.supernode(s).pattern().iter().min().map_or(ABOVE, |&row| supernode_of[row]))
            .collect();
        let mut part = vec![ABOVE; count];
        let roots = subtrees(symbolic, &parent);
        for (index, &root) in roots.iter().enumerate() {
            part[root] = index;
        }
        for s in (0..count).rev() {
            if part[s] == ABOVE && parent[s] != ABOVE {
                part[s] = part[parent[s]];
            }
        }
        let mut local = vec![u32::MAX; symbolic.nrows()];
        let mut members = vec![Vec::new(); roots.len() + 1];
        for s in 0..count {
            members[part[s].min(roots.len())].push(s);
        }
        let mut parts: Vec<Part> = members.iter().map(|those| Part::new(symbolic, those, &mut local)).collect();
        let above = parts.pop().unwrap_or_default();
        Self { subtrees: parts, above }
    }

    /// Overwrites `rhs` with L⁻¹ times it.
    pub(super) fn forward<E: Entry>(&self, values: &[f64], rhs: &mut [E]) {
        let done: Vec<Vec<E>> = {
            let rhs = &*rhs;
            self.subtrees.par_iter().map(|part| part.forward(values, rhs)).collect()
        };
        for (part, vector) in self.subtrees.iter().zip(done) {
            part.put_own(&vector, rhs);
            for (&row, &value) in part.rows[part.own..].iter().zip(&vector[part.own..]) {
                rhs[row].add(value);
            }
        }
        let vector = self.above.forward(values, rhs);
        self.above.put_own(&vector, rhs);
    }

    /// Overwrites `rhs` with L⁻ᵀ times it.
    pub(super) fn backward<E: Entry>(&self, values: &[f64], rhs: &mut [E]) {
        let vector = self.above.backward(values, rhs);
        self.above.put_own(&vector, rhs);
        let done: Vec<Vec<E>> = {
            let rhs = &*rhs;
            self.subtrees.par_iter().map(|part| part.backward(values, rhs)).collect()
        };
        for (part, vector) in self.subtrees.iter().zip(done) {
            part.put_own(&vector, rhs);
        }
    }
}

/// Roots of disjoint subtrees of about equal size.
fn subtrees(symbolic: &SymbolicSupernodalCholesky<usize>, parent: &[usize]) -> Vec<usize> {
    let start = symbolic.col_ptr_for_val();
    let total = symbolic.len_val();
    if total < SMALL {
        return Vec::new();
    }
    let mut weight: Vec<usize> = (0..parent.len()).map(|s| start[s + 1] - start[s]).collect();
    let mut children = vec![Vec::new(); parent.len()];
    let mut open = Vec::new();
    for s in 0..parent.len() {
        match parent[s] {
            ABOVE => open.push(s),
            above => {
                weight[above] += weight[s];
                children[above].push(s);
            }
        }
    }
    let mut roots = Vec::new();
    while let Some(s) = open.pop() {
        if weight[s] * PART <= total {
            roots.push(s);
        } else {
            open.extend_from_slice(&children[s]);
        }
    }
    roots
}

impl Part {
    /// `local` is all `u32::MAX` and is left so.
    fn new(symbolic: &SymbolicSupernodalCholesky<usize>, members: &[usize], local: &mut [u32]) -> Self {
        let (begin, end) = (symbolic.supernode_begin(), symbolic.supernode_end());
        let mut part = Self::default();
        for &s in members {
            for column in begin[s]..end[s] {
                local[column] = part.rows.len() as u32;
                part.rows.push(column);
            }
        }
        part.own = part.rows.len();
        for &s in members {
            let pattern = symbolic.supernode(s).pattern();
            let columns = end[s] - begin[s];
            part.supernodes.push(Supernode {
                values: symbolic.col_ptr_for_val()[s],
                columns,
                height: columns + pattern.len(),
                first: local[begin[s]] as usize,
                below: part.below.len(),
            });
            part.tallest = part.tallest.max(columns + pattern.len());
            for &row in pattern {
                if local[row] == u32::MAX {
                    local[row] = part.rows.len() as u32;
                    part.rows.push(row);
                }
                part.below.push(local[row]);
            }
        }
        for &row in &part.rows {
            local[row] = u32::MAX;
        }
        part
    }

    fn put_own<E: Entry>(&self, vector: &[E], rhs: &mut [E]) {
        for (&row, &value) in self.rows[..self.own].iter().zip(vector) {
            rhs[row] = value;
        }
    }

    /// The part's own rows solved, and what they add to the others.
    fn forward<E: Entry>(&self, values: &[f64], rhs: &[E]) -> Vec<E> {
        let mut vector = vec![E::ZERO; self.rows.len()];
        for (value, &row) in vector.iter_mut().zip(&self.rows[..self.own]) {
            *value = rhs[row];
        }
        let mut dense = vec![E::ZERO; self.tallest];
        for node in &self.supernodes {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let columns = &values[node.values..node.values + node.columns * node.height];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            dense[node.columns..].fill(E::ZERO);
            E::eliminate(columns, node.columns, dense);
            vector[own].copy_from_slice(&dense[..node.columns]);
            for (&row, &value) in below.iter().zip(&dense[node.columns..]) {
                vector[row as usize].add(value);
            }
        }
        vector
    }

    /// The part's own rows solved, the others being given.
    fn backward<E: Entry>(&self, values: &[f64], rhs: &[E]) -> Vec<E> {
        let mut vector: Vec<E> = self.rows.iter().map(|&row| rhs[row]).collect();
        let mut dense = vec![E::ZERO; self.tallest];
        for node in self.supernodes.iter().rev() {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let columns = &values[node.values..node.values + node.columns * node.height];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            for (&row, value) in below.iter().zip(&mut dense[node.columns..]) {
                *value = vector[row as usize];
            }
            E::substitute(columns, node.columns, dense);
            vector[own].copy_from_slice(&dense[..node.columns]);
        }
        vector
    }
}
