//! Assembly of element matrices and springs into the lower triangle of K, with columns in elimination order.

use crate::cholesky::{Graph, Matrix, Reader};
use crate::element::packed;
use crate::ordering::nested_dissection;
use crate::plate::Plate;
use crate::rows::Springs;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Value in [`Numbering::column`] of a dof without a column: a held dof, or a dof of a node that follows a leader.
pub const HELD: usize = usize::MAX;

/// The order of elimination: the column of the factor for each free dof and for each multiplier row.
pub struct Numbering {
    /// Column of each dof ([`HELD`] if the dof has none), then the column of each multiplier row.
    pub column: Vec<usize>,
    /// Dof of each column. For the column of multiplier row i the entry is the number of dofs plus i.
    pub dof: Vec<usize>,
    /// Number of contact dofs. Their columns are the last ones.
    pub trailing: usize,
}

/// A multiplier row g: the force r on the row is an unknown with the equation g·u − compliance · r = 0. A spring on
/// many dofs would couple all of them in K; as a multiplier row it causes less fill. A rigid row has compliance 0.
#[derive(Clone, Debug, Default)]
pub struct MultiplierRow {
    /// Each node of the row, with the coefficients of its three dofs; each node appears once.
    pub row: Vec<(usize, [f64; 3])>,
    /// Compliance of the row, length/force; if it is infinite, the force is zero.
    pub compliance: f64,
}

impl MultiplierRow {
    /// Makes a multiplier row from (dof, coefficient) pairs.
    pub fn new(row: impl Iterator<Item = (usize, f64)>, compliance: f64) -> Self {
        let mut nodes: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        row.for_each(|(dof, coefficient)| nodes.entry(dof / 3).or_default()[dof % 3] += coefficient);
        Self { row: nodes.into_iter().collect(), compliance }
    }
}

impl Numbering {
    /// Numbers the free dofs by nested dissection of the elements and of `pairs` of elements that springs couple. Dofs
    /// marked `trailing` get the last columns.
    pub fn new(plate: &Plate, pairs: &[[u32; 2]], held: &[bool], trailing: &[bool]) -> Self {
        let order = nested_dissection(plate, pairs);
        let free = |wanted: bool| order.iter().copied().filter(move |&dof| !held[dof] && trailing[dof] == wanted);
        let mut dof: Vec<usize> = free(false).collect();
        let leading = dof.len();
        dof.extend(free(true));
        let mut column = vec![HELD; plate.dof_count()];
        for (c, &d) in dof.iter().enumerate() {
            column[d] = c;
        }
        let trailing = dof.len() - leading;
        Self { column, dof, trailing }
    }

    /// As [`Numbering::new`], with multiplier rows. The column of a multiplier row precedes the columns of the row's
    /// last node in elimination order. If the row connects several plates, each plate has such a last node, and the
    /// column precedes those of the earliest of these nodes. Pivots of earlier columns stay positive, since that node
    /// is not yet eliminated and acts as fixed.
    pub fn with_multiplier_rows(
        plate: &Plate,
        pairs: &[[u32; 2]],
        held: &[bool],
        trailing: &[bool],
        multiplier_rows: &[MultiplierRow],
    ) -> Self {
        let mut plain = Self::new(plate, pairs, held, trailing);
        let dofs = plate.dof_count();
        let leading = plain.dof.len() - plain.trailing;
        let first_of = |node: usize| plain.column[3 * node..3 * node + 3].iter().copied().filter(|&c| c != HELD).min();
        let mut placed: Vec<(usize, usize)> = multiplier_rows
            .iter()
            .enumerate()
            .map(|(at, multiplier_row)| {
                let mut last: BTreeMap<usize, usize> = BTreeMap::new();
                for &(node, _) in &multiplier_row.row {
                    let Some(column) = first_of(node) else { continue };
                    let last = last.entry(plate.components().of(node)).or_default();
                    *last = column.max(*last);
                }
                (last.into_values().min().unwrap_or(0).min(leading), dofs + at)
            })
            .collect();
        placed.sort_unstable();
        let mut dof = Vec::with_capacity(plain.dof.len() + multiplier_rows.len());
        let mut placed = placed.into_iter().peekable();
        for (column, &own) in plain.dof.iter().enumerate() {
            while let Some((_, multiplier_row)) = placed.next_if(|&(before, _)| before == column) {
                dof.push(multiplier_row);
            }
            dof.push(own);
        }
        dof.extend(placed.map(|(_, multiplier_row)| multiplier_row));
        plain.column.resize(dofs + multiplier_rows.len(), HELD);
        for (column, &own) in dof.iter().enumerate() {
            plain.column[own] = column;
        }
        Self { dof, ..plain }
    }

    /// Numbers all dofs of a plate as free dofs, in the order of the mesh.
    pub fn natural(plate: &Plate) -> Self {
        let dof: Vec<usize> = (0..plate.dof_count()).collect();
        Self { column: dof.clone(), dof, trailing: 0 }
    }

    pub fn len(&self) -> usize {
        self.dof.len()
    }

    pub fn is_empty(&self) -> bool {
        self.dof.is_empty()
    }
}

/// Lower triangle of a matrix, compressed by columns; the rows within a column are unsorted.
#[derive(Default)]
pub struct LowerTriangle {
    pub column_start: Vec<usize>,
    pub row: Vec<usize>,
    pub value: Vec<f64>,
}

/// Springs on the deflections of one element or of a pair of elements, summed by element or pair.
#[derive(Default)]
pub struct Bedding<'a> {
    /// Pairs of elements that springs couple, including springs of zero stiffness.
    pub pairs: &'a [[u32; 2]],
    /// Σ k g gᵀ of the springs on each element alone, over its eight deflections, as a packed lower triangle. Empty if
    /// there are no springs.
    pub own: Vec<[f64; 36]>,
    /// Σ k g₁g₂ᵀ of the springs on each pair, with g₁ over the deflections of the first element and g₂ over those of
    /// the second. Empty if there are no springs.
    pub across: Vec<[[f64; 8]; 8]>,
}

/// For each node, the elements that contain the node or a follower of it: (index of the element, local node),
/// compressed by node.
struct Incidence {
    start: Vec<usize>,
    at: Vec<(usize, usize)>,
}

impl Incidence {
    fn new(plate: &Plate, elements: impl Iterator<Item = usize> + Clone) -> Self {
        let mut start = vec![0; plate.node_count() + 1];
        for e in elements.clone() {
            for &node in plate.leading(e) {
                start[node + 1] += 1;
            }
        }
        for n in 0..plate.node_count() {
            start[n + 1] += start[n];
        }
        let mut next = start.clone();
        let mut at = vec![(0, 0); start[plate.node_count()]];
        for (place, e) in elements.enumerate() {
            for (i, &node) in plate.leading(e).iter().enumerate() {
                at[next[node]] = (place, i);
                next[node] += 1;
            }
        }
        Self { start, at }
    }

    fn of(&self, node: usize) -> &[(usize, usize)] {
        &self.at[self.start[node]..self.start[node + 1]]
    }
}

/// The matrix K: the sum of element matrices, springs and bedding (springs on deflections), bordered by multiplier
/// rows.
///
/// The terms of an entry are summed each time the entry is read. Every reader gets the same sum.
pub struct Assembly<'a> {
    plate: &'a Plate,
    springs: &'a Springs,
    /// For each element, the indices of the springs on this element alone. The list is empty if K has no springs.
    attached: Vec<Vec<usize>>,
    linked: Linked,
    bedding: &'a Bedding<'a>,
    numbering: &'a Numbering,
    incidence: Incidence,
    /// For each node, the elements of `bedding.pairs` that contain it: (2p + i, local node) for element i of pair p.
    paired: Incidence,
    multiplier_rows: &'a [MultiplierRow],
    /// For each node, the multiplier rows that contain it: (multiplier row, position of the node in this row).
    at_nodes: BTreeMap<usize, Vec<(usize, usize)>>,
    diagonal_shift: f64,
}

impl<'a> Assembly<'a> {
    pub fn new(plate: &'a Plate, springs: &'a Springs, bedding: &'a Bedding, numbering: &'a Numbering) -> Self {
        let mut attached = Vec::new();
        if !springs.rows.is_empty() {
            attached.resize(plate.elements().len(), Vec::new());
        }
        for (spring, &e) in springs.rows.element.iter().enumerate() {
            if !springs.rows.further.contains_key(&spring) {
                attached[e].push(spring);
            }
        }
        Self {
            plate,
            springs,
            attached,
            linked: Linked::new(plate, springs),
            bedding,
            numbering,
            incidence: Incidence::new(plate, 0..plate.elements().len()),
            paired: Incidence::new(plate, bedding.pairs.as_flattened().iter().map(|&e| e as usize)),
            multiplier_rows: &[],
            at_nodes: BTreeMap::new(),
            diagonal_shift: 0.0,
        }
    }

    /// Adds multiplier rows to the matrix; the numbering must have columns for them.
    pub fn has_multiplier(self, multiplier_rows: &'a [MultiplierRow]) -> Self {
        let mut at_nodes: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
        for (at, multiplier_row) in multiplier_rows.iter().enumerate() {
            for (place, &(node, _)) in multiplier_row.row.iter().enumerate() {
                at_nodes.entry(node).or_default().push((at, place));
            }
        }
        Self { multiplier_rows, at_nodes, ..self }
    }

    /// Multiplier rows that contain a node: the column of each, and its coefficients at the node's three dofs. The
    /// coefficients are zero if the compliance is infinite.
    fn multiplier_rows_of(&self, node: usize) -> impl Iterator<Item = (usize, [f64; 3])> {
        let column = |multiplier_row: usize| self.numbering.column[self.plate.dof_count() + multiplier_row];
        let present =
            |multiplier_row: usize| if self.multiplier_rows[multiplier_row].compliance.is_finite() { 1.0 } else { 0.0 };
        let at = self.at_nodes.get(&node).into_iter().flatten();
        at.map(move |&(multiplier_row, place)| {
            (
                column(multiplier_row),
                self.multiplier_rows[multiplier_row].row[place].1.map(|c| present(multiplier_row) * c),
            )
        })
    }

    /// Appends the entries (row, value) of a multiplier's column to `entries`: −compliance on the diagonal, and the
    /// coefficients of dofs with later columns.
    fn multiplier_column(&self, multiplier_row: usize, column: usize, entries: &mut Vec<(usize, f64)>) {
        let MultiplierRow { row, compliance } = &self.multiplier_rows[multiplier_row];
        let (part, own) = if compliance.is_finite() { (1.0, -compliance) } else { (0.0, -1.0) };
        entries.push((column, own));
        for (node, coefficients) in row {
            for (&at, coefficient) in self.numbering.column[3 * node..3 * node + 3].iter().zip(coefficients) {
                if at > column && at != HELD {
                    entries.push((at, part * coefficient));
                }
            }
        }
    }

    /// Multiplies the diagonal entries of K, without those of multiplier rows, by 1 + `part`.
    pub fn diagonal_shift(self, part: f64) -> Self {
        Self { diagonal_shift: part, ..self }
    }

    /// Nodes that elements and springs connect to `node`, including `node` itself. Some nodes appear more than once.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let of_elements = self.incidence.of(node).iter().flat_map(|&(e, _)| *self.plate.leading(e));
        let of_links = self.linked.of(node).flat_map(|(_, link)| link.row.iter().map(|&(n, _)| n));
        of_elements.chain(of_links)
    }

    /// Entries (row, value), below the diagonal, of springs on pairs of elements in the column of a deflection. Some
    /// rows appear more than once.
    fn across(&self, column: usize) -> impl Iterator<Item = (usize, f64)> {
        let Numbering { column: of_dof, dof, .. } = self.numbering;
        let places = if dof[column] % 3 == 0 { self.paired.of(dof[column] / 3) } else { &[] };
        let entries = places.iter().flat_map(move |&(place, local)| {
            let (pair, side) = (place / 2, place % 2);
            let others = self.plate.leading(self.bedding.pairs[pair][1 - side] as usize);
            let sums = self.bedding.across.get(pair);
            let entry = move |sums: &[[f64; 8]; 8], i: usize| if side == 0 { sums[local][i] } else { sums[i][local] };
            (0..8).map(move |i| (of_dof[3 * others[i]], sums.map_or(0.0, |sums| entry(sums, i))))
        });
        entries.filter(move |&(row, _)| row > column && row != HELD)
    }

    /// The lower triangle of K, computed in parallel.
    pub fn lower_triangle(&self) -> LowerTriangle {
        const CHUNK: usize = 4096;
        let columns = self.numbering.len();
        let chunks: Vec<LowerTriangle> = (0..columns.div_ceil(CHUNK))
            .into_par_iter()
            .map_init(
                || (self.reader(), Vec::new()),
                |(read, entries), chunk| {
                    let mut part = LowerTriangle::default();
                    for column in chunk * CHUNK..columns.min((chunk + 1) * CHUNK) {
                        read(column, entries);
                        part.row.extend(entries.iter().map(|entry| entry.0));
                        part.value.extend(entries.iter().map(|entry| entry.1));
                        part.column_start.push(part.row.len());
                    }
                    part
                },
            )
            .collect();
        let total = chunks.iter().map(|part| part.row.len()).sum();
        let mut all =
            LowerTriangle { column_start: vec![0], row: Vec::with_capacity(total), value: Vec::with_capacity(total) };
        for part in chunks {
            let before = all.row.len();
            all.column_start.extend(part.column_start.iter().map(|end| before + end));
            all.row.extend(part.row);
            all.value.extend(part.value);
        }
        all
    }
}

impl Matrix for Assembly<'_> {
    fn graph(&self) -> Graph {
        let Numbering { column, dof, .. } = self.numbering;
        let dofs = self.plate.dof_count();
        let block = |c: usize| if dof[c] < dofs { dof[c] / 3 } else { dof[c] };
        // Columns of a block have equal patterns. Springs on pairs add rows to the column of a deflection only, so a
        // block begins at each deflection and ends before the next one.
        let begins = |c: usize| c == 0 || block(c) != block(c - 1) || (dof[c] < dofs && dof[c] % 3 == 0);
        let first = (0..dof.len()).filter(|&c| begins(c)).chain([dof.len()]).collect();
        Graph::new(first, |c, rows| {
            if let Some(multiplier_row) = dof[c].checked_sub(dofs) {
                let columns =
                    self.multiplier_rows[multiplier_row].row.iter().flat_map(|&(n, _)| &column[3 * n..3 * n + 3]);
                rows.extend(columns.filter(|&&row| row > c && row != HELD));
                return;
            }
            rows.extend(self.multiplier_rows_of(dof[c] / 3).map(|(row, _)| row).filter(|&row| row > c));
            rows.extend(self.across(c).map(|(row, _)| row));
            for n in self.around(dof[c] / 3) {
                let mut last = HELD;
                for &row in &column[3 * n..3 * n + 3] {
                    // One row of each block suffices for the graph. Consecutive columns of a node are in one block, so
                    // the others are skipped.
                    if row > c && row != HELD && row != last.wrapping_add(1) {
                        rows.push(row);
                    }
                    last = row;
                }
            }
        })
    }

    fn is_negative(&self, column: usize) -> bool {
        self.numbering.dof[column] >= self.plate.dof_count()
    }

    fn reader(&self) -> Reader<'_> {
        let mut columns = NodeColumns::new(self);
        Box::new(move |column, entries| {
            let dof = self.numbering.dof[column];
            if let Some(multiplier_row) = dof.checked_sub(self.plate.dof_count()) {
                entries.clear();
                self.multiplier_column(multiplier_row, column, entries);
                return;
            }
            if columns.node != dof / 3 {
                columns.sum(dof / 3);
            }
            entries.clear();
            let multiplier_rows = self.multiplier_rows_of(dof / 3).filter(|&(row, _)| row > column);
            entries.extend(multiplier_rows.map(|(row, coefficients)| (row, coefficients[dof % 3])));
            entries.extend(self.across(column));
            for (&n, block) in columns.neighbours.iter().zip(&columns.block) {
                for (&row, values) in self.numbering.column[3 * n..3 * n + 3].iter().zip(block) {
                    if row == column {
                        entries.push((row, values[dof % 3] * (1.0 + self.diagonal_shift)));
                    } else if row > column && row != HELD {
                        entries.push((row, values[dof % 3]));
                    }
                }
            }
        })
    }
}

/// The three columns of one node in K: the neighbours of the node, and a 3×3 block for each neighbour.
struct NodeColumns<'a> {
    of: &'a Assembly<'a>,
    node: usize,
    slot: Vec<usize>,
    neighbours: Vec<usize>,
    block: Vec<[[f64; 3]; 3]>,
}

impl<'a> NodeColumns<'a> {
    fn new(of: &'a Assembly<'a>) -> Self {
        let slot = vec![usize::MAX; of.plate.node_count()];
        Self { of, node: usize::MAX, slot, neighbours: Vec::new(), block: Vec::new() }
    }

    /// Finds the neighbours of a node, including the node itself. Neighbours whose columns all precede those of the
    /// node are left out.
    fn meet(&mut self, node: usize) {
        for &n in &self.neighbours {
            self.slot[n] = usize::MAX;
        }
        self.neighbours.clear();
        self.node = node;
        let columns = |n: usize| self.of.numbering.column[3 * n..3 * n + 3].iter().filter(|&&c| c != HELD);
        let Some(first) = columns(node).min() else { return };
        for n in self.of.around(node) {
            if self.slot[n] == usize::MAX && columns(n).max() >= Some(first) {
                self.slot[n] = self.neighbours.len();
                self.neighbours.push(n);
            }
        }
    }

    /// Sums the 3×3 blocks of K in the three columns of a node.
    fn sum(&mut self, node: usize) {
        self.meet(node);
        let Assembly { plate, springs, attached, linked, bedding, incidence, .. } = self.of;
        self.block.clear();
        self.block.resize(self.neighbours.len(), [[0.0; 3]; 3]);
        for &(e, local) in incidence.of(node) {
            let lower = plate.element_stiffness(e);
            for (i, &n) in plate.leading(e).iter().enumerate() {
                let Some(block) = self.block.get_mut(self.slot[n]) else { continue };
                // Rows of the packed lower triangle are contiguous, so three neighbouring entries are read at once.
                let mut own = match i.cmp(&local) {
                    Ordering::Greater => {
                        std::array::from_fn(|a| *lower[packed(3 * i + a, 3 * local)..].first_chunk().expect("three"))
                    }
                    Ordering::Less => {
                        let rows: [[f64; 3]; 3] = std::array::from_fn(|b| {
                            *lower[packed(3 * local + b, 3 * i)..].first_chunk().expect("three")
                        });
                        std::array::from_fn(|a| rows.map(|row| row[a]))
                    }
                    Ordering::Equal => {
                        std::array::from_fn(|a| std::array::from_fn(|b| lower[packed(3 * i + a, 3 * i + b)]))
                    }
                };
                if plate.has_followers(e) {
                    onto_leaders(&mut own, plate.arm(e, i), plate.arm(e, local));
                }
                if !plate.is_rigid(e) {
                    (0..9).for_each(|k| block[k / 3][k % 3] += own[k / 3][k % 3]);
                }
                if let Some(bed) = bedding.own.get(e) {
                    block[0][0] += bed[packed(i, local)];
                }
            }
        }
        if plate.has_frames() {
            for (block, &n) in self.block.iter_mut().zip(&self.neighbours) {
                into_frames(block, plate.frame(n), plate.frame(node));
            }
        }
        for (at, link) in linked.of(node) {
            let own = link.row[at].1;
            for (n, row) in &link.row {
                let Some(block) = self.block.get_mut(self.slot[*n]) else { continue };
                for a in 0..3 {
                    for b in 0..3 {
                        block[a][b] += link.stiffness * row[a] * own[b];
                    }
                }
            }
        }
        if attached.is_empty() {
            return;
        }
        for &(e, local) in incidence.of(node) {
            for &spring in &attached[e] {
                let (row, k) = (&springs.rows.coefficient[spring], springs.stiffness[spring]);
                for (i, &n) in plate.leading(e).iter().enumerate() {
                    let Some(block) = self.block.get_mut(self.slot[n]) else { continue };
                    for a in 0..3 {
                        for b in 0..3 {
                            block[a][b] += k * row[3 * i + a] * row[3 * local + b];
                        }
                    }
                }
            }
        }
    }
}

/// Replaces `block`, the 3×3 block of K for a row node and a column node, by B_rowᵀ · block · B_column. B maps the
/// motion of a leader to that of its follower; `row` and `column` are the positions of the two nodes relative to their
/// leaders.
fn onto_leaders(block: &mut [[f64; 3]; 3], row: [f64; 2], column: [f64; 2]) {
    for k in 0..2 {
        (0..3).for_each(|b| block[1 + k][b] += row[k] * block[0][b]);
    }
    for values in block.iter_mut() {
        (0..2).for_each(|k| values[1 + k] += column[k] * values[0]);
    }
}

/// Replaces `block` by T_rowᵀ · block · T_column, where T maps the slopes in a node's rotated frame to slopes in x and
/// y.
fn into_frames(block: &mut [[f64; 3]; 3], row: Option<[f64; 2]>, column: Option<[f64; 2]>) {
    if let Some([c, s]) = row {
        for b in 0..3 {
            let [x, y] = [block[1][b], block[2][b]];
            block[1][b] = c * x + s * y;
            block[2][b] = c * y - s * x;
        }
    }
    if let Some([c, s]) = column {
        for values in block.iter_mut() {
            let [x, y] = [values[1], values[2]];
            values[1] = c * x + s * y;
            values[2] = c * y - s * x;
        }
    }
}

/// A spring on several elements; `row` has each node with the coefficients of its three dofs.
struct Link {
    row: Vec<(usize, [f64; 3])>,
    stiffness: f64,
}

/// Springs on several elements, and the indices of the springs at each node.
#[derive(Default)]
struct Linked {
    links: Vec<Link>,
    /// For each node, the springs that act on it: (index in `links`, position of the node in the spring's row).
    at: BTreeMap<usize, Vec<(usize, usize)>>,
}

impl Linked {
    fn new(plate: &Plate, springs: &Springs) -> Self {
        let mut linked = Self::default();
        for &spring in springs.rows.further.keys() {
            let mut row: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
            for (dof, c) in springs.rows.entries(plate, spring) {
                row.entry(dof / 3).or_default()[dof % 3] += c;
            }
            for (place, &node) in row.keys().enumerate() {
                linked.at.entry(node).or_default().push((linked.links.len(), place));
            }
            linked.links.push(Link { row: row.into_iter().collect(), stiffness: springs.stiffness[spring] });
        }
        linked
    }

    /// Springs on several elements that act on a node: (position of the node in the spring's row, spring).
    fn of(&self, node: usize) -> impl Iterator<Item = (usize, &Link)> {
        self.at.get(&node).into_iter().flatten().map(|&(link, place)| (place, &self.links[link]))
    }
}
