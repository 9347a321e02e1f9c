//! The multifrontal method (Duff & Reid 1983): each supernode's update matrix is added to the front of its parent.

use super::buffer::Buffer;
use super::error::FactorError;
use super::graph::NONE;
use super::matrix::{Matrix, Reader};
use super::merge::{Child, Run, triangle};
use super::parts::Parts;
use super::tree::Tree;
use super::{front, layout};
use faer::dyn_stack::MemBuffer;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Sizes of the factor and of its workspace, determined from the pattern. A size without unit is a number of f64
/// values.
pub(super) struct Plan {
    /// Number of entries of L in each part of the elimination tree.
    entries: Vec<usize>,
    /// For each part of the elimination tree, the number of entries in the update matrices that it leaves to its parent
    /// part.
    left: Vec<usize>,
    /// For each part, the largest sizes of its two stacks of update matrices: one for supernodes of even depth, one for
    /// supernodes of odd depth.
    ///
    /// A supernode pushes its update matrix on one stack while the matrices of its children are on top of the other
    /// stack.
    stacks: Vec<[usize; 2]>,
    odd: Vec<bool>,
    /// For each part, the size of its largest panel, including the upper triangle of the panel.
    panels: Vec<usize>,
}

impl Plan {
    pub(super) fn new(tree: &Tree, parts: &Parts) -> Self {
        let mut odd = vec![false; tree.len()];
        for s in (0..tree.len()).rev() {
            if let Some(parent) = tree.parent(s) {
                odd[s] = !odd[parent];
            }
        }
        let mut plan = Self { entries: Vec::new(), left: Vec::new(), stacks: Vec::new(), odd, panels: Vec::new() };
        for part in &parts.0 {
            let (mut tops, mut stacks, mut panel) = ([0; 2], [0; 2], 0);
            for s in part.supernodes.clone() {
                let side = usize::from(plan.odd[s]);
                if !part.roots.contains(&s) {
                    tops[side] += left(tree, s);
                    stacks[side] = tops[side].max(stacks[side]);
                }
                if part.children.is_empty() {
                    tops[1 - side] -= tree.children(s).map(|child| left(tree, child)).sum::<usize>();
                }
                panel = (tree.width(s) * tree.height(s)).max(panel);
            }
            plan.stacks.push(stacks);
            plan.panels.push(panel);
            let size = |s: usize| layout::size(tree.width(s), tree.height(s));
            plan.entries.push(part.supernodes.clone().map(size).sum());
            plan.left.push(part.roots.iter().map(|&root| left(tree, root)).sum());
        }
        plan
    }

    /// Peak memory in bytes: L, update matrices that wait for their parents, and the workspace of each thread.
    pub(super) fn bytes(&self, parts: &Parts, threads: usize) -> usize {
        // Largest size of the update matrices that are stored at a time in each part and all parts below it: `all` if
        // all these parts run at once, `ordered` if one thread runs them in order.
        let (mut all, mut ordered) = (vec![0; self.left.len()], vec![0; self.left.len()]);
        let (mut at_roots, mut most_ordered) = (0, 0);
        for (index, part) in parts.0.iter().enumerate() {
            let (mut below, mut given) = (0, 0);
            for &child in &part.children {
                below += all[child];
                ordered[index] = ordered[index].max(given + ordered[child]);
                given += self.left[child];
            }
            all[index] = below.max(given + self.left[index]);
            ordered[index] = ordered[index].max(given + self.left[index]);
            if part.parent == NONE {
                at_roots += all[index];
                most_ordered = most_ordered.max(ordered[index]);
            }
        }
        let waiting = at_roots.min(threads * most_ordered);
        let most = |(stacks, panel): (&[usize; 2], &usize)| stacks.iter().sum::<usize>() + panel;
        let workspace = self.stacks.iter().zip(&self.panels).map(most).max().unwrap_or(0);
        size_of::<f64>() * (self.entries() + waiting + threads * workspace)
    }

    /// Number of entries of L that are stored.
    pub(super) fn entries(&self) -> usize {
        self.entries.iter().sum()
    }
}

/// Number of entries in the update matrix of supernode `s`.
fn left(tree: &Tree, s: usize) -> usize {
    triangle(tree.below(s).len())
}

/// The column of the matrix with the smallest ratio |pivot|/|diagonal entry|, and this ratio.
pub(super) type WeakestPivot = (usize, f64);

const NO_PIVOT: WeakestPivot = (0, f64::INFINITY);

/// The pair (column, ratio) with the smaller ratio. If the ratios are equal, the pair with the earlier column.
fn weaker(one: WeakestPivot, other: WeakestPivot) -> WeakestPivot {
    if one.1 < other.1 || (one.1 == other.1 && one.0 <= other.0) { one } else { other }
}

/// The entries of L, one array for each part, and the weakest pivot.
///
/// Returns an error if a pivot does not have the sign that the matrix gives. If this occurs in several parts, the error
/// names the earliest column.
pub(super) fn factorize(
    tree: &Tree,
    parts: &Parts,
    plan: &Plan,
    matrix: &dyn Matrix,
) -> Result<(Vec<Vec<f64>>, WeakestPivot), FactorError> {
    let job = Job {
        tree,
        parts,
        plan,
        matrix,
        workspaces: Mutex::default(),
        spare: Mutex::default(),
        done: parts.0.iter().map(|_| Mutex::new(None)).collect(),
    };
    parts.bottom_up(|index| {
        let result = job.eliminate(index);
        *lock(&job.done[index]) = Some(result);
    });
    let done = job.done.into_iter().map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    let mut failed = None;
    let (mut all, mut weakest) = (Vec::new(), NO_PIVOT);
    for result in done {
        match result {
            Some(Ok(done)) => {
                weakest = weaker(weakest, done.weakest);
                all.push(done.values);
            }
            Some(Err(error)) => failed = Some(worse(failed, error)),
            None => {}
        }
    }
    failed.map_or(Ok((all, weakest)), Err)
}

/// The more severe of two errors: lack of memory, then the earlier column with a wrong pivot. The result does not
/// depend on which error occurred first.
fn worse(one: Option<FactorError>, other: FactorError) -> FactorError {
    match (one, other) {
        (Some(FactorError::NotPositiveDefinite { column: a }), FactorError::NotPositiveDefinite { column: b }) => {
            FactorError::NotPositiveDefinite { column: a.min(b) }
        }
        (Some(one), FactorError::NotPositiveDefinite { .. }) => one,
        (_, other) => other,
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Result of the elimination of a part: the part's entries of L, and its weakest pivot.
struct Done {
    values: Vec<f64>,
    weakest: WeakestPivot,
    /// Update matrices of the roots of this part of the elimination tree, stored one after the other for the parents.
    left: Buffer,
}

/// Workspace that one thread uses for the elimination.
struct Workspace<'a> {
    read: Reader<'a>,
    /// Entries (row, value) of the column that was read last.
    entries: Vec<(usize, f64)>,
    /// Diagonal entries of the matrix in the columns of the current supernode.
    diagonal: Vec<f64>,
    /// Signs of the pivots in the columns of the current supernode.
    signs: Vec<f64>,
    /// For each postorder index, its row in the current supernode.
    local: Vec<u32>,
    scratch: MemBuffer,
    runs: Vec<Run>,
}

struct Job<'a> {
    tree: &'a Tree,
    parts: &'a Parts,
    plan: &'a Plan,
    matrix: &'a dyn Matrix,
    workspaces: Mutex<Vec<Workspace<'a>>>,
    /// Buffers of update matrices that are no longer needed, for reuse.
    spare: Mutex<Vec<Buffer>>,
    done: Vec<Mutex<Option<Result<Done, FactorError>>>>,
}

impl<'a> Job<'a> {
    fn workspace(&self) -> Result<Workspace<'a>, FactorError> {
        if let Some(workspace) = lock(&self.workspaces).pop() {
            return Ok(workspace);
        }
        let mut local = Vec::new();
        local.try_reserve_exact(self.tree.columns()).map_err(|_| FactorError::OutOfMemory)?;
        local.resize(self.tree.columns(), 0);
        let scratch = front::scratch().ok_or(FactorError::OutOfMemory)?;
        Ok(Workspace {
            read: self.matrix.reader(),
            entries: Vec::new(),
            diagonal: Vec::new(),
            signs: Vec::new(),
            local,
            scratch,
            runs: Vec::new(),
        })
    }

    /// The smallest spare buffer of at least `len` numbers, or a new buffer. A spare buffer has arbitrary content.
    fn buffer(&self, len: usize) -> Result<Buffer, FactorError> {
        if len == 0 {
            return Buffer::new(0);
        }
        let mut spare = lock(&self.spare);
        let fits = (0..spare.len()).filter(|&at| spare[at].len() >= len).min_by_key(|&at| spare[at].len());
        match fits {
            Some(at) => Ok(spare.swap_remove(at)),
            None => {
                // Fronts become larger towards the root: a buffer that is too small now is no longer needed.
                spare.clear();
                Buffer::new(len)
            }
        }
    }

    fn eliminate(&self, index: usize) -> Result<Done, FactorError> {
        let part = &self.parts.0[index];
        let mut given = Vec::new();
        let mut failed = None;
        for &child in &part.children {
            match lock(&self.done[child]).as_mut() {
                Some(Ok(done)) => given.push(std::mem::replace(&mut done.left, Buffer::new(0)?)),
                Some(Err(error)) => failed = Some(worse(failed, *error)),
                None => {}
            }
        }
        if let Some(error) = failed {
            return Err(error);
        }
        let mut workspace = self.workspace()?;
        let mut done = Done { values: Vec::new(), weakest: NO_PIVOT, left: self.buffer(self.plan.left[index])? };
        done.values.try_reserve_exact(self.plan.entries[index]).map_err(|_| FactorError::OutOfMemory)?;
        let [even, odd] = self.plan.stacks[index];
        let mut stacks = [self.buffer(even)?, self.buffer(odd)?];
        let mut panel = self.buffer(self.plan.panels[index])?;
        let result = self.supernodes(index, &given, &mut workspace, &mut stacks, &mut panel, &mut done);
        lock(&self.workspaces).push(workspace);
        lock(&self.spare).extend(given.into_iter().chain(stacks).chain([panel]));
        result.map(|()| done)
    }

    fn supernodes(
        &self,
        index: usize,
        given: &[Buffer],
        workspace: &mut Workspace<'_>,
        stacks: &mut [Buffer; 2],
        panel: &mut [f64],
        done: &mut Done,
    ) -> Result<(), FactorError> {
        let (tree, part) = (self.tree, &self.parts.0[index]);
        let Workspace { read, entries, diagonal, signs, local, scratch, runs } = workspace;
        let (mut tops, mut out) = ([0; 2], 0);
        for s in part.supernodes.clone() {
            let (width, height) = (tree.width(s), tree.height(s));
            let side = usize::from(self.plan.odd[s]);
            let [even, odd] = &mut *stacks;
            let (mine, theirs) = if side == 0 { (even, &*odd) } else { (odd, &*even) };
            for (row, place) in (tree.begin[s]..tree.begin[s + 1]).enumerate() {
                local[place] = row as u32;
            }
            for (row, &place) in tree.below(s).iter().enumerate() {
                local[place as usize] = (width + row) as u32;
            }
            runs.clear();
            let mut children = Vec::new();
            if part.children.is_empty() {
                tops[1 - side] -= tree.children(s).map(|child| left(tree, child)).sum::<usize>();
                let mut rest = &theirs[tops[1 - side]..];
                for child in tree.children(s) {
                    let values;
                    (values, rest) = rest.split_at(left(tree, child));
                    children.push(Child::new(values, tree.below(child), local, width, runs));
                }
            } else {
                for (&from, given) in part.children.iter().zip(given) {
                    let mut rest = &given[..];
                    for &child in &self.parts.0[from].roots {
                        let values;
                        (values, rest) = rest.split_at(left(tree, child));
                        children.push(Child::new(values, tree.below(child), local, width, runs));
                    }
                }
            }
            let panel = &mut panel[..width * height];
            panel.fill(0.0);
            diagonal.clear();
            signs.clear();
            let columns = &tree.column[tree.begin[s]..tree.begin[s + 1]];
            for (k, (&column, values)) in columns.iter().zip(panel.chunks_exact_mut(height)).enumerate() {
                read(column as usize, entries);
                for &(row, value) in &*entries {
                    values[local[tree.place[row] as usize] as usize] += value;
                }
                diagonal.push(values[k]);
                signs.push(if self.matrix.is_negative(column as usize) { -1.0 } else { 1.0 });
            }
            children.iter().for_each(|child| child.add_to_panel(runs, panel, height));
            front::eliminate(panel, height, signs, scratch)
                .map_err(|at| FactorError::NotPositiveDefinite { column: columns[at] as usize })?;
            for (k, (&column, diagonal)) in columns.iter().zip(&*diagonal).enumerate() {
                let part = panel[k * (height + 1)].powi(2) / diagonal.abs();
                done.weakest = weaker(done.weakest, (column as usize, part));
            }
            let size = left(tree, s);
            let rest = if part.roots.contains(&s) {
                out += size;
                &mut done.left[out - size..out]
            } else {
                tops[side] += size;
                &mut mine[tops[side] - size..tops[side]]
            };
            front::write_update(panel, height, signs, rest);
            children.iter().for_each(|child| child.add_to_rest(runs, rest, height, width));
            layout::store(panel, height, &mut done.values);
        }
        Ok(())
    }
}
