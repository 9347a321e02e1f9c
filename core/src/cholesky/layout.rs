//! How a supernode's columns of L are stored: a few side by side, without the rows above them.

/// Columns stored side by side, each as long as the first.
const PANEL: usize = 8;

/// Some of a supernode's columns, stored by columns one after the other.
pub(super) struct Panel {
    /// First of them, which is also the first row stored.
    pub(super) first: usize,
    pub(super) count: usize,
    /// Rows stored.
    pub(super) height: usize,
    /// Where they begin among the supernode's numbers.
    pub(super) at: usize,
}

/// The panels of a supernode.
pub(super) fn panels(width: usize, height: usize) -> impl DoubleEndedIterator<Item = Panel> {
    (0..width).step_by(PANEL).map(move |first| Panel {
        first,
        count: PANEL.min(width - first),
        height: height - first,
        // Every panel before is whole, and its columns are PANEL shorter than those before it.
        at: first * height - first * (first - PANEL.min(first)) / 2,
    })
}

/// Numbers that a supernode has.
pub(super) fn size(width: usize, height: usize) -> usize {
    panels(width, height).next_back().map_or(0, |last| last.at + last.count * last.height)
}

/// Copies a supernode's columns, each `height` long, and returns how many numbers that took.
pub(super) fn store(columns: &[f64], height: usize, to: &mut [f64]) -> usize {
    let width = columns.len() / height;
    for panel in panels(width, height) {
        let to = &mut to[panel.at..panel.at + panel.count * panel.height];
        let columns = columns[panel.first * height..].chunks_exact(height);
        for (column, to) in columns.zip(to.chunks_exact_mut(panel.height)) {
            to.copy_from_slice(&column[panel.first..]);
        }
    }
    size(width, height)
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
}
