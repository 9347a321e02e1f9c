//! Element matrices and springs to the lower triangle of K, already in elimination order.

use crate::element::packed;
use crate::ordering::nested_dissection;
use crate::plate::Plate;
use crate::residual::Springs;
use rayon::prelude::*;
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
pub struct LowerTriangle {
    pub column_start: Vec<usize>,
    pub row: Vec<usize>,
    pub value: Vec<f64>,
}

impl LowerTriangle {
    /// Adds a part of its own to every diagonal entry.
    pub fn stiffen_diagonal(&mut self, part: f64) {
        for column in 0..self.column_start.len() - 1 {
            for at in self.column_start[column]..self.column_start[column + 1] {
                if self.row[at] == column {
                    self.value[at] *= 1.0 + part;
                }
            }
        }
    }
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

/// The three columns of one node: its neighbours and the 3×3 block that each shares with it.
struct NodeColumns<'a> {
    plate: &'a Plate,
    springs: &'a Springs,
    attached: &'a [Vec<usize>],
    linked: &'a Linked,
    bedding: &'a [[f64; 36]],
    incidence: &'a Incidence,
    /// Whether thin elements are left out.
    thick_only: bool,
    node: usize,
    slot: Vec<usize>,
    neighbours: Vec<usize>,
    block: Vec<[[f64; 3]; 3]>,
}

impl<'a> NodeColumns<'a> {
    fn new(
        plate: &'a Plate,
        springs: &'a Springs,
        attached: &'a [Vec<usize>],
        linked: &'a Linked,
        bedding: &'a [[f64; 36]],
        incidence: &'a Incidence,
        thick_only: bool,
    ) -> Self {
        let slot = vec![usize::MAX; plate.node_count()];
        Self {
            plate,
            springs,
            attached,
            linked,
            bedding,
            incidence,
            thick_only,
            node: usize::MAX,
            slot,
            neighbours: Vec::new(),
            block: Vec::new(),
        }
    }

    /// Finds a node's neighbours, itself among them.
    fn meet(&mut self, node: usize) {
        for &n in &self.neighbours {
            self.slot[n] = usize::MAX;
        }
        self.neighbours.clear();
        self.node = node;
        let of_elements = self.incidence.of(node).iter().flat_map(|&(e, _)| self.plate.elements()[e]);
        let of_links = self.linked.of(node).flat_map(|(_, link)| link.row.iter().map(|&(n, _)| n));
        for n in of_elements.chain(of_links) {
            if self.slot[n] == usize::MAX {
                self.slot[n] = self.neighbours.len();
                self.neighbours.push(n);
            }
        }
    }

    /// Sums the blocks of a node's columns.
    fn sum(&mut self, node: usize) {
        self.meet(node);
        self.block.clear();
        self.block.resize(self.neighbours.len(), [[0.0; 3]; 3]);
        for &(e, local) in self.incidence.of(node) {
            if self.thick_only && self.plate.is_thin(e) {
                continue;
            }
            let lower = self.plate.element_stiffness(e);
            for (i, &n) in self.plate.elements()[e].iter().enumerate() {
                let block = &mut self.block[self.slot[n]];
                for a in 0..3 {
                    for b in 0..3 {
                        block[a][b] += lower[packed(3 * i + a, 3 * local + b)];
                    }
                }
                if let Some(bed) = self.bedding.get(e) {
                    block[0][0] += bed[packed(i, local)];
                }
            }
        }
        if self.plate.has_frames() {
            for (block, &n) in self.block.iter_mut().zip(&self.neighbours) {
                into_frames(block, self.plate.frame(n), self.plate.frame(node));
            }
        }
        for (at, link) in self.linked.of(node) {
            let own = link.row[at].1;
            for (n, row) in &link.row {
                let block = &mut self.block[self.slot[*n]];
                for a in 0..3 {
                    for b in 0..3 {
                        block[a][b] += link.stiffness * row[a] * own[b];
                    }
                }
            }
        }
        if self.attached.is_empty() {
            return;
        }
        for &(e, local) in self.incidence.of(node) {
            for &spring in &self.attached[e] {
                let (row, k) = (&self.springs.rows.coefficient[spring], self.springs.stiffness[spring]);
                for (i, &n) in self.plate.elements()[e].iter().enumerate() {
                    let block = &mut self.block[self.slot[n]];
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

/// Assembles K with springs and bedding added (over the deflections of each element, packed; empty without), in parallel over columns; the sums do not depend on the number of threads.
pub fn assemble(plate: &Plate, springs: &Springs, bedding: &[[f64; 36]], numbering: &Numbering) -> LowerTriangle {
    assemble_some(plate, springs, bedding, numbering, false)
}

/// As [`assemble`], without thin elements and bedding; where those are the entries stand, as zeros.
pub fn assemble_thick(plate: &Plate, springs: &Springs, numbering: &Numbering) -> LowerTriangle {
    assemble_some(plate, springs, &[], numbering, true)
}

fn assemble_some(
    plate: &Plate,
    springs: &Springs,
    bedding: &[[f64; 36]],
    numbering: &Numbering,
    thick_only: bool,
) -> LowerTriangle {
    const CHUNK: usize = 4096;
    let incidence = Incidence::new(plate);
    let attached = attached_springs(plate, springs);
    let linked = Linked::new(plate, springs);
    let columns = numbering.len();
    let start = || NodeColumns::new(plate, springs, &attached, &linked, bedding, &incidence, thick_only);
    let below = |node: usize, column: usize| {
        (0..3).filter(move |&a| {
            let row = numbering.column[3 * node + a];
            row != HELD && row >= column
        })
    };

    let counts: Vec<Vec<usize>> = (0..columns.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(start, |node_columns, chunk| {
            (chunk * CHUNK..columns.min((chunk + 1) * CHUNK))
                .map(|column| {
                    let node = numbering.dof[column] / 3;
                    if node_columns.node != node {
                        node_columns.meet(node);
                    }
                    node_columns.neighbours.iter().map(|&n| below(n, column).count()).sum()
                })
                .collect()
        })
        .collect();
    let mut column_start = Vec::with_capacity(columns + 1);
    column_start.push(0);
    let mut total = 0;
    for count in counts.into_iter().flatten() {
        total += count;
        column_start.push(total);
    }

    let mut row = vec![0; total];
    let mut value = vec![0.0; total];
    let mut pieces = Vec::new();
    let (mut row_rest, mut value_rest) = (row.as_mut_slice(), value.as_mut_slice());
    for first in (0..columns).step_by(CHUNK) {
        let last = columns.min(first + CHUNK);
        let size = column_start[last] - column_start[first];
        let (row_piece, row_tail) = row_rest.split_at_mut(size);
        let (value_piece, value_tail) = value_rest.split_at_mut(size);
        pieces.push((first..last, row_piece, value_piece));
        (row_rest, value_rest) = (row_tail, value_tail);
    }
    pieces.into_par_iter().for_each_init(start, |node_columns, (range, row_piece, value_piece)| {
        let mut next = 0;
        for column in range {
            let dof = numbering.dof[column];
            if node_columns.node != dof / 3 {
                node_columns.sum(dof / 3);
            }
            for (&n, block) in node_columns.neighbours.iter().zip(&node_columns.block) {
                for a in below(n, column) {
                    row_piece[next] = numbering.column[3 * n + a];
                    value_piece[next] = block[a][dof % 3];
                    next += 1;
                }
            }
        }
    });
    LowerTriangle { column_start, row, value }
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

/// Springs over single elements, by element; empty where there are none.
fn attached_springs(plate: &Plate, springs: &Springs) -> Vec<Vec<usize>> {
    if springs.rows.is_empty() {
        return Vec::new();
    }
    let mut attached = vec![Vec::new(); plate.elements().len()];
    for (spring, &e) in springs.rows.element.iter().enumerate() {
        if !springs.rows.further.contains_key(&spring) {
            attached[e].push(spring);
        }
    }
    attached
}
