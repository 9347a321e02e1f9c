//! Supernodes (columns of L that are eliminated together) in postorder.

use super::error::FactorError;
use super::graph::{Graph, NONE};

/// The pattern of L. The postorder index of a column is its position in the order of elimination.
pub(super) struct Tree {
    /// Matrix column of each postorder index (`column`), and postorder index of each matrix column (`place`).
    pub(super) column: Vec<u32>,
    pub(super) place: Vec<u32>,
    /// First postorder index of each supernode, followed by the number of columns.
    pub(super) begin: Vec<usize>,
    /// Parent of each supernode, or [`NONE`] for a root; children precede their parent.
    pub(super) parent: Vec<u32>,
    /// First child of each supernode (`head`), and the next child of the same parent (`next`).
    head: Vec<u32>,
    next: Vec<u32>,
    /// For each supernode, the index in `below` at which the rows below its columns begin.
    start: Vec<usize>,
    /// Postorder indices of the rows below each supernode's columns, ascending; one supernode after the other.
    below: Vec<u32>,
    /// Number of multiplications and additions of the factorization, without operations on zeros that merging adds.
    pub(super) flops: f64,
}

impl Tree {
    pub(super) fn new(graph: &Graph) -> Result<Self, FactorError> {
        if graph.first[graph.len()] >= NONE as usize {
            return Err(FactorError::OutOfMemory);
        }
        let (parent, rows) = graph.elimination_tree();
        let mut groups = Groups::fundamental(graph, &parent, &rows);
        groups.amalgamate();
        let flops = (0..graph.len())
            .map(|block| (1..=graph.weight(block)).map(|k| ((rows[block] + k) as f64).powi(2)).sum::<f64>())
            .sum();
        Ok(Self { flops, ..groups.in_order(graph) })
    }

    /// Number of columns of the matrix.
    pub(super) fn columns(&self) -> usize {
        self.column.len()
    }

    /// Number of supernodes.
    pub(super) fn len(&self) -> usize {
        self.parent.len()
    }

    pub(super) fn parent(&self, s: usize) -> Option<usize> {
        (self.parent[s] != NONE).then_some(self.parent[s] as usize)
    }

    /// Children of supernode `s`, in postorder.
    pub(super) fn children(&self, s: usize) -> impl Iterator<Item = usize> + '_ {
        siblings(&self.head, &self.next, s)
    }

    /// Number of columns of supernode `s`.
    pub(super) fn width(&self, s: usize) -> usize {
        self.begin[s + 1] - self.begin[s]
    }

    /// Postorder indices of the rows below the columns of supernode `s`.
    pub(super) fn below(&self, s: usize) -> &[u32] {
        &self.below[self.start[s]..self.start[s + 1]]
    }

    /// Estimated time in nanoseconds to eliminate each supernode.
    pub(super) fn work(&self) -> Vec<f64> {
        (0..self.len()).map(|s| cost(self.width(s), self.below(s).len())).collect()
    }

    /// Number of rows of supernode `s`, including the rows of its own columns.
    pub(super) fn height(&self, s: usize) -> usize {
        self.width(s) + self.below(s).len()
    }
}

/// Supernodes as groups of blocks of the graph, before and after children are merged into their parents.
struct Groups {
    group_of: Vec<u32>,
    parent: Vec<u32>,
    /// Number of columns in each group (`width`), and number of rows of L below these columns (`below`).
    width: Vec<usize>,
    below: Vec<usize>,
    /// The group into which each group was merged; the group itself if it was not merged.
    into: Vec<u32>,
}

impl Groups {
    /// Fundamental supernodes: chains of blocks with the same pattern in the elimination tree (Liu, Ng and Peyton
    /// 1993). Children precede their parents.
    fn fundamental(graph: &Graph, tree: &[u32], rows: &[usize]) -> Self {
        let mut children = vec![0_u32; graph.len()];
        let mut only = vec![NONE; graph.len()];
        for block in 0..graph.len() {
            if tree[block] != NONE {
                children[tree[block] as usize] += 1;
                only[tree[block] as usize] = block as u32;
            }
        }
        let mut groups =
            Self { group_of: vec![0; graph.len()], parent: vec![], width: vec![], below: vec![], into: vec![] };
        let mut top = Vec::new();
        for block in 0..graph.len() {
            let child = only[block] as usize;
            if children[block] == 1 && rows[child] == rows[block] + graph.weight(block) {
                let group = groups.group_of[child];
                groups.group_of[block] = group;
                groups.width[group as usize] += graph.weight(block);
                groups.below[group as usize] = rows[block];
                top[group as usize] = block;
            } else {
                groups.group_of[block] = groups.width.len() as u32;
                groups.width.push(graph.weight(block));
                groups.below.push(rows[block]);
                top.push(block);
            }
        }
        let group_of = &groups.group_of;
        let above = |block: usize| if tree[block] == NONE { NONE } else { group_of[tree[block] as usize] };
        groups.parent = top.into_iter().map(above).collect();
        groups.into = (0..groups.width.len() as u32).collect();
        groups
    }

    /// Merges a child group into its parent if this does not increase the sum of [`cost`] over the groups.
    fn amalgamate(&mut self) {
        let (head, next) = children(&self.parent);
        let mut those = Vec::new();
        for group in 0..self.parent.len() {
            those.clear();
            those.extend(siblings(&head, &next, group));
            those.sort_by_key(|&child: &usize| (std::cmp::Reverse(self.width[child]), child));
            for &child in &those {
                let merged = self.width[child] + self.width[group];
                let apart = cost(self.width[child], self.below[child]) + cost(self.width[group], self.below[group]);
                if cost(merged, self.below[group]) <= apart {
                    self.width[group] = merged;
                    self.into[child] = group as u32;
                }
            }
        }
        // `into[group]` is the group into which it is merged; that one has a higher number or is the group itself. In
        // descending order the final group of every higher number is already known.
        for group in (0..self.into.len()).rev() {
            self.into[group] = self.into[self.into[group] as usize];
        }
    }

    fn in_order(&self, graph: &Graph) -> Tree {
        let taken = |group: u32| if group == NONE { NONE } else { self.into[group as usize] };
        let left: Vec<usize> = (0..self.into.len()).filter(|&group| self.into[group] as usize == group).collect();
        let mut number = vec![NONE; self.into.len()];
        for (at, &group) in left.iter().enumerate() {
            number[group] = at as u32;
        }
        let renumbered = |group: u32| if group == NONE { NONE } else { number[taken(group) as usize] };
        let parent: Vec<u32> = left.iter().map(|&group| renumbered(self.parent[group])).collect();
        let order = postorder(&parent);
        let mut at = vec![NONE; order.len()];
        for (s, &group) in order.iter().enumerate() {
            at[group] = s as u32;
        }
        let parent: Vec<u32> =
            order.iter().map(|&group| if parent[group] == NONE { NONE } else { at[parent[group] as usize] }).collect();

        // Number of the supernode that a block belongs to.
        let of = |block: usize| at[renumbered(self.group_of[block]) as usize] as usize;
        let mut first_block = vec![0; order.len() + 1];
        for block in 0..graph.len() {
            first_block[of(block) + 1] += 1;
        }
        for s in 0..order.len() {
            first_block[s + 1] += first_block[s];
        }
        let mut next = first_block.clone();
        let mut blocks = vec![0; graph.len()];
        for block in 0..graph.len() {
            let s = of(block);
            blocks[next[s]] = block;
            next[s] += 1;
        }
        places(graph, &blocks, &first_block, parent)
    }
}

/// Estimated time in nanoseconds to eliminate `width` columns with `below` rows below them and to assemble the update
/// matrix.
///
/// The constants fit times on a core with 55 GFlop/s. Dense kernels are slow with few columns, and each entry is
/// written and read. Zeros in L cost more here than their time, because they take memory: for 160×160 `mitc9`, factors
/// with 39.2M and 41.5M entries take the same time.
fn cost(width: usize, below: usize) -> f64 {
    let (k, m) = (width as f64, below as f64);
    let flops = k * (k * k / 3.0 + k * m + m * m);
    flops / 45.0 * (1.0 + 6.0 / k) + 8.0 * k * (k + m) + 0.5 * m * m + 8.0 * (k + m) + 400.0
}

fn children(parent: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut head = vec![NONE; parent.len()];
    let mut next = vec![NONE; parent.len()];
    for child in (0..parent.len()).rev() {
        if parent[child] != NONE {
            next[child] = std::mem::replace(&mut head[parent[child] as usize], child as u32);
        }
    }
    (head, next)
}

fn siblings<'a>(head: &'a [u32], next: &'a [u32], parent: usize) -> impl Iterator<Item = usize> + 'a {
    let some = |child: u32| (child != NONE).then_some(child as usize);
    std::iter::successors(some(head[parent]), move |&child| some(next[child]))
}

/// Numbers of the groups in postorder: children precede parents, and each subtree is contiguous.
fn postorder(parent: &[u32]) -> Vec<usize> {
    let (head, next) = children(parent);
    let mut order = Vec::with_capacity(parent.len());
    let mut open: Vec<usize> = (0..parent.len()).filter(|&group| parent[group] == NONE).collect();
    // The order is built in reverse: a parent before its children, the last child first.
    while let Some(group) = open.pop() {
        order.push(group);
        open.extend(siblings(&head, &next, group));
    }
    order.reverse();
    order
}

/// The tree with the rows of each supernode. The rows of a supernode are the union of the rows of its columns and of
/// its children, below its columns.
fn places(graph: &Graph, blocks: &[usize], first_block: &[usize], parent: Vec<u32>) -> Tree {
    let mut rank = vec![0_u32; blocks.len()];
    let mut first_place = vec![0_usize; blocks.len() + 1];
    let mut column = Vec::with_capacity(graph.first[graph.len()]);
    for (at, &block) in blocks.iter().enumerate() {
        rank[block] = at as u32;
        column.extend((graph.first[block]..graph.first[block + 1]).map(|c| c as u32));
        first_place[at + 1] = column.len();
    }
    let mut place = vec![0_u32; column.len()];
    for (at, &c) in column.iter().enumerate() {
        place[c as usize] = at as u32;
    }
    let begin: Vec<usize> = first_block.iter().map(|&at| first_place[at]).collect();
    let (head, next) = children(&parent);
    let mut met = vec![NONE; blocks.len()];
    let mut ranks: Vec<u32> = Vec::new();
    let mut rank_start = vec![0];
    let (mut below, mut start) = (Vec::new(), vec![0]);
    let mut result = Vec::new();
    for s in 0..parent.len() {
        let end = first_block[s + 1] as u32;
        result.clear();
        let mut meet = |row: u32| {
            if row >= end && met[row as usize] != s as u32 {
                met[row as usize] = s as u32;
                result.push(row);
            }
        };
        for &block in &blocks[first_block[s]..first_block[s + 1]] {
            graph.below(block).iter().for_each(|&other| meet(rank[other as usize]));
        }
        for child in siblings(&head, &next, s) {
            ranks[rank_start[child]..rank_start[child + 1]].iter().for_each(|&row| meet(row));
        }
        result.sort_unstable();
        ranks.extend_from_slice(&result);
        rank_start.push(ranks.len());
        for &row in &result {
            below.extend((first_place[row as usize]..first_place[row as usize + 1]).map(|at| at as u32));
        }
        start.push(below.len());
    }
    Tree { column, place, begin, parent, head, next, start, below, flops: 0.0 }
}
