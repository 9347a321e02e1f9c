//! Division of the supernodes into parts, each run by one thread: groups of whole subtrees, and single supernodes above
//! them.
//!
//! The division, and the order in which the results of parts are summed, do not depend on the number of threads.

use super::graph::NONE;
use rayon::Scope;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Largest work of a part of the elimination tree, relative to the work of all parts: small enough for machines with
/// many threads.
const PART: f64 = 1.0 / 32.0;

/// A part: a range of consecutive supernodes, with the part's parent and children in the tree of parts.
pub(super) struct Part {
    pub(super) supernodes: Range<usize>,
    /// Supernodes of this part whose parents are in another part.
    pub(super) roots: Vec<usize>,
    /// The part that contains the parents of `roots`; [`NONE`] if the roots have no parent.
    pub(super) parent: u32,
    /// Parts whose `parent` is this part, in order.
    pub(super) children: Vec<usize>,
}

pub(super) struct Parts(pub(super) Vec<Part>);

impl Parts {
    /// Divides a postordered elimination tree into parts. `work` is the estimated time of each supernode.
    ///
    /// Subtrees with less work than `least` are not divided, since starting threads would cost more.
    pub(super) fn new(parent: &[u32], work: &[f64], least: f64) -> Self {
        let count = parent.len();
        let mut whole = work.to_vec();
        let mut first: Vec<usize> = (0..count).collect();
        for s in 0..count {
            if parent[s] != NONE {
                let above = parent[s] as usize;
                whole[above] += whole[s];
                first[above] = first[above].min(first[s]);
            }
        }
        let total: f64 = work.iter().sum();
        let limit = if total < 4.0 * least { f64::INFINITY } else { least.max(PART * total) };
        let mut parts: Vec<Part> = Vec::new();
        // The work of the last part, and the parent of its roots. A sibling subtree may join the last part; `None` if
        // none may.
        let mut open: Option<(f64, u32)> = None;
        for s in 0..count {
            if whole[s] > limit {
                parts.push(Part::new(s..s + 1));
                open = None;
            } else if parent[s] == NONE || whole[parent[s] as usize] > limit {
                match (open, parts.last_mut()) {
                    (Some((held, above)), Some(last)) if above == parent[s] && held + whole[s] <= limit => {
                        last.supernodes.end = s + 1;
                        open = Some((held + whole[s], above));
                    }
                    _ => {
                        parts.push(Part::new(first[s]..s + 1));
                        open = Some((whole[s], parent[s]));
                    }
                }
            }
        }
        let mut part_of = vec![0; count];
        for (index, part) in parts.iter().enumerate() {
            part_of[part.supernodes.clone()].fill(index);
        }
        for index in 0..parts.len() {
            let range = parts[index].supernodes.clone();
            let outside = |s: &usize| parent[*s] == NONE || parent[*s] as usize >= range.end;
            let roots: Vec<usize> = range.clone().filter(outside).collect();
            if let Some(&root) = roots.first().filter(|&&root| parent[root] != NONE) {
                let above = part_of[parent[root] as usize];
                parts[index].parent = above as u32;
                parts[above].children.push(index);
            }
            parts[index].roots = roots;
        }
        Self(parts)
    }

    /// Runs `work` on all parts, in parallel; a part runs after its children.
    pub(super) fn bottom_up(&self, work: impl Fn(usize) + Sync) {
        if let [_] = self.0[..] {
            return work(0);
        }
        let pending: Vec<AtomicUsize> = self.0.iter().map(|part| AtomicUsize::new(part.children.len())).collect();
        let leaves: Vec<usize> = (0..self.0.len()).filter(|&index| self.0[index].children.is_empty()).collect();
        leaves.into_par_iter().with_max_len(1).for_each(|mut index| {
            loop {
                work(index);
                match self.0[index].parent {
                    NONE => break,
                    above if pending[above as usize].fetch_sub(1, Ordering::AcqRel) == 1 => index = above as usize,
                    _ => break,
                }
            }
        });
    }

    /// Runs `work` on all parts, in parallel; a part runs after its parent.
    pub(super) fn top_down(&self, work: impl Fn(usize) + Sync) {
        if let [_] = self.0[..] {
            return work(0);
        }
        rayon::scope(|scope| {
            for index in (0..self.0.len()).filter(|&index| self.0[index].parent == NONE) {
                let work = &work;
                scope.spawn(move |scope| self.down_from(scope, index, work));
            }
        });
    }

    fn down_from<'s>(&'s self, scope: &Scope<'s>, mut index: usize, work: &'s (impl Fn(usize) + Sync)) {
        loop {
            work(index);
            let [others @ .., last] = &self.0[index].children[..] else { return };
            for &other in others {
                scope.spawn(move |scope| self.down_from(scope, other, work));
            }
            index = *last;
        }
    }
}

impl Part {
    fn new(supernodes: Range<usize>) -> Self {
        Self { supernodes, roots: Vec::new(), parent: NONE, children: Vec::new() }
    }
}
