//! Adds the update matrices of children to the front of their parent, the dense matrix in which the parent's columns
//! are eliminated (Duff & Reid 1983).

use super::front::TILE;
use crate::vectorized::vectorized;
use std::ops::Range;

/// Consecutive rows of a child's update matrix, from row `from` on, that are consecutive in the parent too, from row
/// `to` on.
pub(super) struct Run {
    from: usize,
    to: usize,
    len: usize,
}

/// Number of entries of a lower triangle that is stored by tiles of `TILE` columns, without the rows above each tile.
pub(super) fn triangle(order: usize) -> usize {
    (0..order).step_by(TILE).map(|first| TILE.min(order - first) * (order - first)).sum()
}

/// Index at which column `at` begins in the storage of [`triangle`], and the first stored row of the column.
fn column(at: usize, order: usize) -> (usize, usize) {
    let first = at - at % TILE;
    // All previous tiles have `TILE` columns, and the columns of each are `TILE` shorter than those of the tile before
    // it.
    let tile = first * order - first * (first - TILE.min(first)) / 2;
    (tile + (at - first) * (order - first), first)
}

/// The update matrix of a child, a lower triangle stored by tiles of columns, and the positions of its rows in the
/// parent.
pub(super) struct Child<'a> {
    pub(super) values: &'a [f64],
    pub(super) order: usize,
    /// Range of this child's runs (consecutive rows) in the list of runs of all children. The parent eliminates the
    /// columns of the first `eliminated` of these runs.
    runs: Range<usize>,
    eliminated: usize,
}

impl<'a> Child<'a> {
    /// Makes the child from the postorder indices `rows` of its update matrix. `local` maps them to rows of the parent,
    /// which eliminates its first `width` columns.
    pub(super) fn new(values: &'a [f64], rows: &[u32], local: &[u32], width: usize, runs: &mut Vec<Run>) -> Self {
        let start = runs.len();
        let mut eliminated = 0;
        for (from, &row) in rows.iter().enumerate() {
            let to = local[row as usize] as usize;
            match runs[start..].last_mut() {
                Some(run) if run.to + run.len == to && to != width => run.len += 1,
                _ => {
                    runs.push(Run { from, to, len: 1 });
                    eliminated += usize::from(to < width);
                }
            }
        }
        Self { values, order: rows.len(), runs: start..runs.len(), eliminated }
    }

    /// Adds the columns that the parent eliminates to the parent's panel.
    pub(super) fn add_to_panel(&self, runs: &[Run], panel: &mut [f64], height: usize) {
        self.add(&runs[self.runs.clone()], 0..self.eliminated, panel, 0, |at| (at * height, 0));
    }

    /// Adds the columns that the parent does not eliminate to the parent's update matrix, whose rows follow the first
    /// `width` rows of the parent.
    pub(super) fn add_to_rest(&self, runs: &[Run], rest: &mut [f64], height: usize, width: usize) {
        let columns = self.eliminated..self.runs.len();
        self.add(&runs[self.runs.clone()], columns, rest, width, |at| column(at, height - width));
    }

    fn add(
        &self,
        runs: &[Run],
        columns: Range<usize>,
        to: &mut [f64],
        skipped: usize,
        place: impl Fn(usize) -> (usize, usize),
    ) {
        vectorized(
            #[inline(always)]
            || {
                for index in columns.clone() {
                    let run = &runs[index];
                    for k in 0..run.len {
                        let (start, first) = column(run.from + k, self.order);
                        let values = &self.values[start..start + self.order - first];
                        let (start, above) = place(run.to + k - skipped);
                        let sums = &mut to[start..];
                        let own = run.to + k - skipped - above;
                        add(
                            &mut sums[own..own + run.len - k],
                            &values[run.from + k - first..run.from + run.len - first],
                        );
                        for other in &runs[index + 1..] {
                            let own = other.to - skipped - above;
                            let from = other.from - first;
                            add(&mut sums[own..own + other.len], &values[from..from + other.len]);
                        }
                    }
                }
            },
        );
    }
}

#[inline(always)]
fn add(sums: &mut [f64], values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_a_triangle_follow_one_another() {
        for order in [1, TILE - 1, TILE, TILE + 1, 3 * TILE + 5] {
            let mut next = 0;
            for at in 0..order {
                let (start, first) = column(at, order);
                assert_eq!((start, first), (next, at - at % TILE));
                next += order - first;
            }
            assert_eq!(next, triangle(order));
        }
    }
}
