//! Forward and backward substitution for one right-hand side, the subtrees of the elimination tree side by side.
//!
//! It is bound by reading L once each way, which one core alone cannot do at the speed of the memory.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::Arch;
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
    pub(super) fn forward(&self, values: &[f64], rhs: &mut [f64]) {
        let done: Vec<Vec<f64>> = {
            let rhs = &*rhs;
            self.subtrees.par_iter().map(|part| part.forward(values, rhs)).collect()
        };
        for (part, vector) in self.subtrees.iter().zip(done) {
            part.put_own(&vector, rhs);
            for (&row, value) in part.rows[part.own..].iter().zip(&vector[part.own..]) {
                rhs[row] += value;
            }
        }
        let vector = self.above.forward(values, rhs);
        self.above.put_own(&vector, rhs);
    }

    /// Overwrites `rhs` with L⁻ᵀ times it.
    pub(super) fn backward(&self, values: &[f64], rhs: &mut [f64]) {
        let vector = self.above.backward(values, rhs);
        self.above.put_own(&vector, rhs);
        let done: Vec<Vec<f64>> = {
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

    fn put_own(&self, vector: &[f64], rhs: &mut [f64]) {
        for (&row, &value) in self.rows[..self.own].iter().zip(vector) {
            rhs[row] = value;
        }
    }

    /// The part's own rows solved, and what they add to the others.
    fn forward(&self, values: &[f64], rhs: &[f64]) -> Vec<f64> {
        let mut vector = vec![0.0; self.rows.len()];
        for (value, &row) in vector.iter_mut().zip(&self.rows[..self.own]) {
            *value = rhs[row];
        }
        let mut dense = vec![0.0; self.tallest];
        for node in &self.supernodes {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let columns = &values[node.values..node.values + node.columns * node.height];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            dense[node.columns..].fill(0.0);
            Arch::new().dispatch(
                #[inline(always)]
                || eliminate(columns, node.columns, dense),
            );
            vector[own].copy_from_slice(&dense[..node.columns]);
            for (&row, value) in below.iter().zip(&dense[node.columns..]) {
                vector[row as usize] += value;
            }
        }
        vector
    }

    /// The part's own rows solved, the others being given.
    fn backward(&self, values: &[f64], rhs: &[f64]) -> Vec<f64> {
        let mut vector: Vec<f64> = self.rows.iter().map(|&row| rhs[row]).collect();
        let mut dense = vec![0.0; self.tallest];
        for node in self.supernodes.iter().rev() {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let columns = &values[node.values..node.values + node.columns * node.height];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            for (&row, value) in below.iter().zip(&mut dense[node.columns..]) {
                *value = vector[row as usize];
            }
            Arch::new().dispatch(
                #[inline(always)]
                || substitute(columns, node.columns, dense),
            );
            vector[own].copy_from_slice(&dense[..node.columns]);
        }
        vector
    }
}

/// Columns taken together, so that the vector is read and written once for all of them.
const TOGETHER: usize = 4;

/// vector ← (L₁⁻¹v₁, v₂ − L₂L₁⁻¹v₁) for the columns (L₁, L₂) of a supernode.
#[inline(always)]
fn eliminate(columns: &[f64], count: usize, vector: &mut [f64]) {
    let height = vector.len();
    let mut j = 0;
    while j + TOGETHER <= count {
        let l: [&[f64]; TOGETHER] = std::array::from_fn(|k| &columns[(j + k) * height..(j + k + 1) * height]);
        for k in 0..TOGETHER {
            let solved = vector[j + k] / l[k][j + k];
            vector[j + k] = solved;
            for i in k + 1..TOGETHER {
                vector[j + i] -= l[k][j + i] * solved;
            }
        }
        let [a, b, c, d] = [vector[j], vector[j + 1], vector[j + 2], vector[j + 3]];
        let tails = l[0][j + 4..].iter().zip(&l[1][j + 4..]).zip(&l[2][j + 4..]).zip(&l[3][j + 4..]);
        for (v, (((p, q), r), s)) in vector[j + 4..].iter_mut().zip(tails) {
            *v -= (a * p + b * q) + (c * r + d * s);
        }
        j += TOGETHER;
    }
    for j in j..count {
        let l = &columns[j * height..(j + 1) * height];
        let solved = vector[j] / l[j];
        vector[j] = solved;
        for (v, p) in vector[j + 1..].iter_mut().zip(&l[j + 1..]) {
            *v -= solved * p;
        }
    }
}

/// v₁ ← L₁⁻ᵀ(v₁ − L₂ᵀv₂) for the columns (L₁, L₂) of a supernode.
#[inline(always)]
fn substitute(columns: &[f64], count: usize, vector: &mut [f64]) {
    let height = vector.len();
    let whole = count - count % TOGETHER;
    for j in (whole..count).rev() {
        let l = &columns[j * height..(j + 1) * height];
        vector[j] = (vector[j] - product(&l[j + 1..], &vector[j + 1..])) / l[j];
    }
    for j in (0..whole).step_by(TOGETHER).rev() {
        let tail = &vector[j + TOGETHER..];
        let l: [&[f64]; TOGETHER] = std::array::from_fn(|k| &columns[(j + k) * height..(j + k + 1) * height]);
        let sums: [f64; TOGETHER] = std::array::from_fn(|k| product(&l[k][j + TOGETHER..], tail));
        for k in (0..TOGETHER).rev() {
            let known: f64 = (k + 1..TOGETHER).map(|i| l[k][j + i] * vector[j + i]).sum();
            vector[j + k] = (vector[j + k] - sums[k] - known) / l[k][j + k];
        }
    }
}

/// Sums side by side, so that none waits for the one before.
#[inline(always)]
fn product(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 16;
    let mut lanes = [0.0; LANES];
    let (whole_a, whole_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = whole_a.remainder().iter().zip(whole_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in whole_a.zip(whole_b) {
        for k in 0..LANES {
            lanes[k] += x[k] * y[k];
        }
    }
    lanes.iter().sum::<f64>() + rest
}
