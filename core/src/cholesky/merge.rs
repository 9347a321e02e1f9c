//! What a child leaves is added to the front of its parent.

use pulp::Arch;
use std::ops::Range;

/// Rows that follow one another in the child and in the parent.
pub(super) struct Run {
    from: usize,
    to: usize,
    len: usize,
}

/// A child's lower triangle, by columns, and where its rows are in the parent.
pub(super) struct Child<'a> {
    pub(super) values: &'a [f64],
    pub(super) order: usize,
    /// Its runs among those of all children, and how many of them are columns that the parent eliminates.
    runs: Range<usize>,
    eliminated: usize,
}

impl<'a> Child<'a> {
    /// Of a child with the given rows; `local` says where they are in the parent, which eliminates the first `width` rows.
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

    /// Adds the columns that the parent eliminates to its panel.
    pub(super) fn add_to_panel(&self, runs: &[Run], panel: &mut [f64], height: usize) {
        self.add(&runs[self.runs.clone()], 0..self.eliminated, panel, height, 0);
    }

    /// Adds the others to what the parent leaves, whose rows come after the first `width`.
    pub(super) fn add_to_rest(&self, runs: &[Run], rest: &mut [f64], height: usize, width: usize) {
        self.add(&runs[self.runs.clone()], self.eliminated..self.runs.len(), rest, height - width, width);
    }

    fn add(&self, runs: &[Run], columns: Range<usize>, to: &mut [f64], height: usize, skipped: usize) {
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for index in columns {
                    let run = &runs[index];
                    for k in 0..run.len {
                        let column = run.from + k;
                        let values = &self.values[column * self.order..(column + 1) * self.order];
                        let first = run.to + k - skipped;
                        let sums = &mut to[first * height..(first + 1) * height];
                        add(&mut sums[first..first + run.len - k], &values[column..run.from + run.len]);
                        for other in &runs[index + 1..] {
                            let first = other.to - skipped;
                            add(&mut sums[first..first + other.len], &values[other.from..other.from + other.len]);
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
