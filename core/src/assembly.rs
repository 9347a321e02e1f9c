//! Element matrices and springs to the lower triangle of K, already in elimination order.

use crate::cholesky::{Graph, Matrix, Reader};
use crate::element::packed;
use crate::ordering::nested_dissection;
use crate::plate::Plate;
use crate::rows::Springs;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Marks a dof that is held and has no column.
pub const HELD: usize = usize::MAX;

/// Which column of the factor each free dof has.
pub struct Numbering {
    /// Column of every dof, or [`HELD`].
    pub column: Vec<usize>,
    /// Dof of every column.
    pub dof: Vec<usize>,
    /// How many of the last columns are contact dofs.
    pub trailing: usize,
}

impl Numbering {
    /// Nested dissection, with the dofs marked `trailing` moved behind all others.
    pub fn new(plate: &Plate, held: &[bool], trailing: &[bool]) -> Self {
        let order = nested_dissection(plate);
        let free = |wanted: bool| {
            order
                .iter()
                .flat_map(|&node| 3 * node..3 * node + 3)
                .filter(move |&dof| !held[dof] && trailing[dof] == wanted)
        };
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

    /// Every dof free, in the mesh's own order.
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

/// Lower triangle by columns; rows within a column are in no particular order.
#[derive(Default)]
pub struct LowerTriangle {
    pub column_start: Vec<usize>,
    pub row: Vec<usize>,
    pub value: Vec<f64>,
}

/// Where a node sits: (element, local node) pairs, compressed by node.
struct Incidence {
    start: Vec<usize>,
    at: Vec<(usize, usize)>,
}

impl Incidence {
    fn new(plate: &Plate) -> Self {
        let mut start = vec![0; plate.node_count() + 1];
        for nodes in plate.elements() {
            for &node in nodes {
                start[node + 1] += 1;
            }
        }
        for n in 0..plate.node_count() {
            start[n + 1] += start[n];
        }
        let mut next = start.clone();
        let mut at = vec![(0, 0); 8 * plate.elements().len()];
        for (e, nodes) in plate.elements().iter().enumerate() {
            for (i, &node) in nodes.iter().enumerate() {
                at[next[node]] = (e, i);
                next[node] += 1;
            }
        }
        Self { start, at }
    }

    fn of(&self, node: usize) -> &[(usize, usize)] {
        &self.at[self.start[node]..self.start[node + 1]]
    }
}

/// K: element matrices, springs, and bedding over the deflections of each element (packed; empty without).
///
/// It is summed whenever it is read; the sums do not depend on who reads.
pub struct Assembly<'a> {
    plate: &'a Plate,
    springs: &'a Springs,
    /// Springs over single elements, by element; empty where there are none.
    attached: Vec<Vec<usize>>,
    linked: Linked,
    bedding: &'a [[f64; 36]],
    numbering: &'a Numbering,
    incidence: Incidence,
    thick_only: bool,
    firmer: f64,
}

impl<'a> Assembly<'a> {
    pub fn new(plate: &'a Plate, springs: &'a Springs, bedding: &'a [[f64; 36]], numbering: &'a Numbering) -> Self {
        let mut attached = Vec::new();
        if !springs.rows.is_empty() {
            attached.resize(plate.elements().len(), Vec::new());
        }
        for (spring, &e) in springs.rows.element.iter().enumerate() {
            if !springs.rows.further.contains_key(&spring) {
                attached[e].push(spring);
            }
        }
        let (incidence, linked) = (Incidence::new(plate), Linked::new(plate, springs));
        Self { plate, springs, attached, linked, bedding, numbering, incidence, thick_only: false, firmer: 0.0 }
    }

    /// Without thin elements; where those are the entries stand, as zeros.
    pub fn thick_only(self) -> Self {
        Self { thick_only: true, ..self }
    }

    /// With every dof stiffer by a part of its own.
    pub fn firmer(self, part: f64) -> Self {
        Self { firmer: part, ..self }
    }

    /// Neighbours of a node, itself among them, some of them more than once.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let of_elements = self.incidence.of(node).iter().flat_map(|&(e, _)| self.plate.elements()[e]);
        let of_links = self.linked.of(node).flat_map(|(_, link)| link.row.iter().map(|&(n, _)| n));
        of_elements.chain(of_links)
    }

    /// All of it, summed in parallel.
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
        let first = (0..dof.len()).filter(|&c| c == 0 || dof[c] / 3 != dof[c - 1] / 3).chain([dof.len()]).collect();
        Graph::new(first, |c, rows| {
            for n in self.around(dof[c] / 3) {
                let mut last = HELD;
                for &row in &column[3 * n..3 * n + 3] {
                    // Of columns that follow one another the first stands for all.
                    if row > c && row != HELD && row != last.wrapping_add(1) {
                        rows.push(row);
                    }
                    last = row;
                }
            }
        })
    }

    fn reader(&self) -> Reader<'_> {
        let mut columns = NodeColumns::new(self);
        Box::new(move |column, entries| {
            let dof = self.numbering.dof[column];
            if columns.node != dof / 3 {
                columns.sum(dof / 3);
            }
            entries.clear();
            for (&n, block) in columns.neighbours.iter().zip(&columns.block) {
                for (&row, values) in self.numbering.column[3 * n..3 * n + 3].iter().zip(block) {
                    if row == column {
                        entries.push((row, values[dof % 3] * (1.0 + self.firmer)));
                    } else if row > column && row != HELD {
                        entries.push((row, values[dof % 3]));
                    }
                }
            }
        })
    }
}

/// The three columns of one node: its neighbours and the 3×3 block that each shares with it.
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

    /// Finds a node's neighbours, itself among them, without those whose columns all come before its own.
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

    /// Sums the blocks of a node's columns.
    fn sum(&mut self, node: usize) {
        self.meet(node);
        let Assembly { plate, springs, attached, linked, bedding, incidence, thick_only, .. } = self.of;
        self.block.clear();
        self.block.resize(self.neighbours.len(), [[0.0; 3]; 3]);
        for &(e, local) in incidence.of(node) {
            if *thick_only && plate.is_thin(e) {
                continue;
            }
            let lower = plate.element_stiffness(e);
            for (i, &n) in plate.elements()[e].iter().enumerate() {
                let Some(block) = self.block.get_mut(self.slot[n]) else { continue };
                // In the packed triangle the entries of a row follow one another.
                match i.cmp(&local) {
                    Ordering::Greater => {
                        for a in 0..3 {
                            let row = &lower[packed(3 * i + a, 3 * local)..][..3];
                            (0..3).for_each(|b| block[a][b] += row[b]);
                        }
                    }
                    Ordering::Less => {
                        for b in 0..3 {
                            let row = &lower[packed(3 * local + b, 3 * i)..][..3];
                            (0..3).for_each(|a| block[a][b] += row[a]);
                        }
                    }
                    Ordering::Equal => {
                        for a in 0..3 {
                            (0..3).for_each(|b| block[a][b] += lower[packed(3 * i + a, 3 * i + b)]);
                        }
                    }
                }
                if let Some(bed) = bedding.get(e) {
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
                for (i, &n) in plate.elements()[e].iter().enumerate() {
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

/// T_rowᵀ · block · T_column, T the turn of a node's slopes.
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

/// A spring over several elements: its row by nodes.
struct Link {
    row: Vec<(usize, [f64; 3])>,
    stiffness: f64,
}

/// Springs over several elements, and where nodes have them.
#[derive(Default)]
struct Linked {
    links: Vec<Link>,
    /// (link, place in its row) pairs of every node.
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

    /// The springs of a node, and its place in the row of each.
    fn of(&self, node: usize) -> impl Iterator<Item = (usize, &Link)> {
        self.at.get(&node).into_iter().flatten().map(|&(link, place)| (place, &self.links[link]))
    }
}
