//! The graph of a matrix, in which columns of equal pattern form a block, and the elimination tree of the blocks.

/// Index that means "none", for example as the parent of a root.
pub(super) const NONE: u32 = u32::MAX;

/// Graph of a symmetric matrix. Each vertex is a block: consecutive columns with the same pattern, such as the dofs of
/// a node.
pub struct Graph {
    /// First column of each block, followed by the number of columns.
    pub(super) first: Vec<usize>,
    /// For each block, the index in `below` of its first neighbour.
    start: Vec<usize>,
    /// Neighbours of each block that are eliminated after it, block by block.
    below: Vec<u32>,
}

impl Graph {
    /// Makes the graph. `first` has the first column of each block, followed by the number of columns. `rows(c, list)`
    /// appends the rows of column c, the first column of a block, to the list; rows above the diagonal are ignored.
    pub fn new(first: Vec<usize>, mut rows: impl FnMut(usize, &mut Vec<usize>)) -> Self {
        let count = first.len() - 1;
        let mut block_of = vec![0; first[count]];
        for block in 0..count {
            block_of[first[block]..first[block + 1]].fill(block as u32);
        }
        let mut met = vec![NONE; count];
        let mut start = vec![0];
        let mut below = Vec::new();
        let mut result = Vec::new();
        for block in 0..count {
            result.clear();
            rows(first[block], &mut result);
            for &row in &result {
                let other = block_of[row];
                if other as usize > block && met[other as usize] != block as u32 {
                    met[other as usize] = block as u32;
                    below.push(other);
                }
            }
            start.push(below.len());
        }
        Self { first, start, below }
    }

    pub(super) fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Number of columns in `block`.
    pub(super) fn weight(&self, block: usize) -> usize {
        self.first[block + 1] - self.first[block]
    }

    /// Neighbours of `block` that are eliminated after this block.
    pub(super) fn below(&self, block: usize) -> &[u32] {
        &self.below[self.start[block]..self.start[block + 1]]
    }

    fn transposed(&self) -> (Vec<usize>, Vec<u32>) {
        let mut start = vec![0; self.len() + 1];
        for &other in &self.below {
            start[other as usize + 1] += 1;
        }
        for block in 0..self.len() {
            start[block + 1] += start[block];
        }
        let mut next = start.clone();
        let mut above = vec![0; self.below.len()];
        for block in 0..self.len() {
            for &other in self.below(block) {
                above[next[other as usize]] = block as u32;
                next[other as usize] += 1;
            }
        }
        (start, above)
    }

    /// Parent of each block in the elimination tree (Liu 1990), and number of rows of L below the columns of each
    /// block.
    pub(super) fn elimination_tree(&self) -> (Vec<u32>, Vec<usize>) {
        let (start, above) = self.transposed();
        let mut parent = vec![NONE; self.len()];
        let mut rows = vec![0; self.len()];
        let mut met = vec![NONE; self.len()];
        for block in 0..self.len() {
            met[block] = block as u32;
            for &other in &above[start[block]..start[block + 1]] {
                let mut at = other as usize;
                while met[at] != block as u32 {
                    met[at] = block as u32;
                    rows[at] += self.weight(block);
                    if parent[at] == NONE {
                        parent[at] = block as u32;
                    }
                    at = parent[at] as usize;
                }
            }
        }
        (parent, rows)
    }
}
