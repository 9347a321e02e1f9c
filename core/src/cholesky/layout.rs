//! Storage of a supernode's columns of L in one array: panels of up to `PANEL` columns, each without the rows above its
//! first pivot.
//!
//! A panel has the rows of its pivots first, then the rows below them in blocks of `ROWS` rows. Each block is stored
//! column by column.

/// Largest number of columns in a panel.
pub(super) const PANEL: usize = 8;
/// Largest number of rows in a block of a panel.
pub(super) const ROWS: usize = 8;

/// A panel: `count` consecutive columns of a supernode.
pub(super) struct Panel {
    /// First column of the panel, relative to the supernode. The first stored row has the same index.
    pub(super) first: usize,
    pub(super) count: usize,
    /// Number of stored rows of the panel.
    pub(super) height: usize,
    /// Index of the panel's first value in the array of the supernode.
    pub(super) at: usize,
}

impl Panel {
    /// Copies column `k` of the panel, from its pivot down, from `numbers` (the values of the panel) to `to`.
    pub(super) fn column(&self, numbers: &[f64], k: usize, to: &mut Vec<f64>) {
        to.clear();
        let (own, below) = numbers.split_at(self.count * self.count);
        to.extend_from_slice(&own[k * self.count + k..(k + 1) * self.count]);
        for block in below.chunks(ROWS * self.count) {
            let rows = block.len() / self.count;
            to.extend_from_slice(&block[k * rows..(k + 1) * rows]);
        }
    }
}

/// Divides a supernode with `width` columns and `height` rows into panels.
pub(super) fn panels(width: usize, height: usize) -> impl DoubleEndedIterator<Item = Panel> {
    (0..width).step_by(PANEL).map(move |first| Panel {
        first,
        count: PANEL.min(width - first),
        height: height - first,
        // All previous panels have PANEL columns; the columns of each panel are PANEL shorter than those of the
        // previous one.
        at: first * height - first * (first - PANEL.min(first)) / 2,
    })
}

/// Number of f64 values that are stored for a supernode with `width` columns and `height` rows.
pub(super) fn size(width: usize, height: usize) -> usize {
    panels(width, height).next_back().map_or(0, |last| last.at + last.count * last.height)
}

/// Appends the columns of a supernode, each of length `height`, to `to` in the storage by panels.
pub(super) fn store(columns: &[f64], height: usize, to: &mut Vec<f64>) {
    let width = columns.len() / height;
    for panel in panels(width, height) {
        let columns = &columns[panel.first * height..(panel.first + panel.count) * height];
        let below = panel.first + panel.count;
        for column in columns.chunks_exact(height) {
            to.extend_from_slice(&column[panel.first..below]);
        }
        for row in (below..height).step_by(ROWS) {
            let rows = ROWS.min(height - row);
            let mut block = [0.0; PANEL * ROWS];
            for (column, to) in columns.chunks_exact(height).zip(block.chunks_exact_mut(rows)) {
                to.copy_from_slice(&column[row..row + rows]);
            }
            to.extend_from_slice(&block[..panel.count * rows]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_follow_one_another() {
        for (width, height) in [(1, 1), (3, 9), (8, 8), (9, 9), (24, 30), (35, 200)] {
            let mut at = 0;
            for panel in panels(width, height) {
                assert_eq!((panel.at, panel.height), (at, height - panel.first));
                at += panel.count * panel.height;
            }
            assert_eq!(at, size(width, height));
        }
    }

    #[test]
    fn columns_are_found_as_they_were_stored() {
        for (width, height) in [(1, 1), (3, 9), (8, 8), (9, 17), (24, 30), (35, 200)] {
            let columns: Vec<f64> = (0..width * height).map(|at| at as f64).collect();
            let (mut stored, mut column) = (Vec::new(), Vec::new());
            store(&columns, height, &mut stored);
            assert_eq!(stored.len(), size(width, height));
            for panel in panels(width, height) {
                for k in 0..panel.count {
                    panel.column(&stored[panel.at..][..panel.count * panel.height], k, &mut column);
                    let first = panel.first + k;
                    assert_eq!(column, columns[first * height + first..(first + 1) * height]);
                }
            }
        }
    }
}
