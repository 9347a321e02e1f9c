//! Forward and backward substitution, parallel over the parts of the elimination tree.
//!
//! The time is that of reading L once in each direction. One core cannot use the full memory bandwidth. Several
//! right-hand sides are solved together, so that L is read once for all of them.

use super::entry::Entry;
use super::layout;
use super::parts::Parts;
use super::tree::Tree;
use std::ops::Range;
use std::sync::OnceLock;

/// For each part of the elimination tree, the data for forward and backward substitution.
pub(super) struct Schedule(Vec<Share>);

/// The data of one part for substitution: its supernodes in elimination order, and the rows in which their columns have
/// entries.
struct Share {
    supernodes: Vec<Supernode>,
    /// Postorder indices of the columns that the part eliminates.
    own: Range<usize>,
    /// Number of rows of the part: its own rows, then the rows that belong to parts above and in which it has entries.
    rows: usize,
    /// For each row that belongs to a part above, the position of this row in the rows of the parent part.
    above: Vec<u32>,
    /// The rows below each supernode's columns, as positions in the rows of the part, one supernode after the other.
    below: Vec<u32>,
    /// Largest number of rows in a supernode of the part.
    tallest: usize,
}

struct Supernode {
    /// Index, in the part's array of entries of L, of the supernode's first entry.
    values: usize,
    columns: usize,
    height: usize,
    /// Position of the supernode's first column in the rows of the part.
    first: usize,
    /// Index in `Share::below` at which the rows below the supernode's columns begin.
    below: usize,
}

impl Schedule {
    pub(super) fn new(tree: &Tree, parts: &Parts) -> Self {
        let mut shares: Vec<Share> = Vec::new();
        let mut foreign: Vec<Vec<u32>> = Vec::new();
        let mut local = vec![u32::MAX; tree.columns()];
        for part in &parts.0 {
            let (share, places) = Share::new(tree, part.supernodes.clone(), &mut local);
            shares.push(share);
            foreign.push(places);
        }
        for (index, part) in parts.0.iter().enumerate() {
            let own = shares[index].own.clone();
            for (row, place) in own.clone().enumerate() {
                local[place] = row as u32;
            }
            for (row, &place) in foreign[index].iter().enumerate() {
                local[place as usize] = (own.len() + row) as u32;
            }
            for &child in &part.children {
                shares[child].above = foreign[child].iter().map(|&place| local[place as usize]).collect();
            }
        }
        Self(shares)
    }

    /// Overwrites the right-hand side `rhs` with L⁻¹ · `rhs`.
    pub(super) fn forward<E: Entry>(&self, tree: &Tree, parts: &Parts, values: &[Vec<f64>], rhs: &mut [E]) {
        let done: Vec<OnceLock<Vec<E>>> = self.0.iter().map(|_| OnceLock::new()).collect();
        let given = &*rhs;
        parts.bottom_up(|index| {
            let share = &self.0[index];
            let mut vector = Vec::with_capacity(share.rows);
            vector.extend(tree.column[share.own.clone()].iter().map(|&column| given[column as usize]));
            vector.resize(share.rows, E::ZERO);
            for &child in &parts.0[index].children {
                let (child, other) = (&self.0[child], done[child].get().map_or(&[][..], |result| result));
                for (&row, &value) in child.above.iter().zip(other.get(child.own.len()..).unwrap_or_default()) {
                    vector[row as usize].add(value);
                }
            }
            share.forward(&values[index], &mut vector);
            done[index].get_or_init(|| vector);
        });
        self.put(tree, &done, rhs);
    }

    /// Overwrites the right-hand side `rhs` with L⁻ᵀ · `rhs`.
    pub(super) fn backward<E: Entry>(&self, tree: &Tree, parts: &Parts, values: &[Vec<f64>], rhs: &mut [E]) {
        let done: Vec<OnceLock<Vec<E>>> = self.0.iter().map(|_| OnceLock::new()).collect();
        let given = &*rhs;
        parts.top_down(|index| {
            let share = &self.0[index];
            let mut vector = Vec::with_capacity(share.rows);
            vector.extend(tree.column[share.own.clone()].iter().map(|&column| given[column as usize]));
            if let Some(known) = done.get(parts.0[index].parent as usize).and_then(OnceLock::get) {
                vector.extend(share.above.iter().map(|&row| known[row as usize]));
            }
            share.backward(&values[index], &mut vector);
            done[index].get_or_init(|| vector);
        });
        self.put(tree, &done, rhs);
    }

    fn put<E: Entry>(&self, tree: &Tree, done: &[OnceLock<Vec<E>>], rhs: &mut [E]) {
        for (share, result) in self.0.iter().zip(done) {
            for (&column, &value) in tree.column[share.own.clone()].iter().zip(result.get().into_iter().flatten()) {
                rhs[column as usize] = value;
            }
        }
    }
}

impl Share {
    /// Returns the data of a part with the given supernodes, and the postorder indices of its rows that belong to parts
    /// above. At these indices `local` must be `u32::MAX` on entry and is `u32::MAX` again on return.
    fn new(tree: &Tree, supernodes: Range<usize>, local: &mut [u32]) -> (Self, Vec<u32>) {
        let own = tree.begin[supernodes.start]..tree.begin[supernodes.end];
        let mut share =
            Self { supernodes: vec![], own: own.clone(), rows: 0, above: vec![], below: vec![], tallest: 0 };
        let mut foreign = Vec::new();
        let mut values = 0;
        for s in supernodes {
            let (columns, height) = (tree.width(s), tree.height(s));
            let below = share.below.len();
            share.supernodes.push(Supernode { values, columns, height, first: tree.begin[s] - own.start, below });
            share.tallest = share.tallest.max(height);
            values += layout::size(columns, height);
            for &place in tree.below(s) {
                if (place as usize) < own.end {
                    share.below.push((place as usize - own.start) as u32);
                    continue;
                }
                if local[place as usize] == u32::MAX {
                    local[place as usize] = (own.len() + foreign.len()) as u32;
                    foreign.push(place);
                }
                share.below.push(local[place as usize]);
            }
        }
        for &place in &foreign {
            local[place as usize] = u32::MAX;
        }
        share.rows = own.len() + foreign.len();
        (share, foreign)
    }

    /// Solves for the part's own rows and adds their contributions to the rows of parts above. Supernodes with a zero
    /// right-hand side are skipped.
    fn forward<E: Entry>(&self, values: &[f64], vector: &mut [E]) {
        let mut dense = vec![E::ZERO; self.tallest];
        for node in &self.supernodes {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            if vector[own.clone()].iter().all(E::is_zero) {
                continue;
            }
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            dense[node.columns..].fill(E::ZERO);
            for panel in layout::panels(node.columns, node.height) {
                let columns = &values[node.values + panel.at..][..panel.count * panel.height];
                E::eliminate(columns, panel.count, &mut dense[panel.first..]);
            }
            vector[own].copy_from_slice(&dense[..node.columns]);
            for (&row, &value) in below.iter().zip(&dense[node.columns..]) {
                vector[row as usize].add(value);
            }
        }
    }

    /// Solves for the part's own rows; `vector` already has the solution in the rows of parts above.
    fn backward<E: Entry>(&self, values: &[f64], vector: &mut [E]) {
        let mut dense = vec![E::ZERO; self.tallest];
        for node in self.supernodes.iter().rev() {
            let below = &self.below[node.below..node.below + node.height - node.columns];
            let own = node.first..node.first + node.columns;
            let dense = &mut dense[..node.height];
            dense[..node.columns].copy_from_slice(&vector[own.clone()]);
            for (&row, value) in below.iter().zip(&mut dense[node.columns..]) {
                *value = vector[row as usize];
            }
            for panel in layout::panels(node.columns, node.height).rev() {
                let columns = &values[node.values + panel.at..][..panel.count * panel.height];
                E::substitute(columns, panel.count, &mut dense[panel.first..]);
            }
            vector[own].copy_from_slice(&dense[..node.columns]);
        }
    }
}
