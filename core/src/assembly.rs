//! Element matrices and springs to the lower triangle of K, already in elimination order.

use crate::element::packed;
use crate::ordering::nested_dissection;
use crate::plate::Plate;
use crate::residual::Springs;
use rayon::prelude::*;

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

/// One column at a time: dense values with the list of rows touched.
struct Accumulator {
    value: Vec<f64>,
    touched: Vec<bool>,
    rows: Vec<usize>,
}

impl Accumulator {
    fn new(size: usize) -> Self {
        Self { value: vec![0.0; size], touched: vec![false; size], rows: Vec::with_capacity(128) }
    }

    fn add(&mut self, row: usize, value: f64) {
        if !self.touched[row] {
            self.touched[row] = true;
            self.rows.push(row);
        }
        self.value[row] += value;
    }

    fn clear(&mut self) {
        for &row in &self.rows {
            self.value[row] = 0.0;
            self.touched[row] = false;
        }
        self.rows.clear();
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

/// Assembles K with the springs added, in parallel over columns; the sums do not depend on the number of threads.
pub fn assemble(plate: &Plate, springs: &Springs, numbering: &Numbering) -> LowerTriangle {
    let incidence = Incidence::new(plate);
    let attached = attached_springs(plate, springs);
    let columns = numbering.len();
    const CHUNK: usize = 4096;

    let counts: Vec<Vec<usize>> = (0..columns.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(
            || Accumulator::new(columns),
            |accumulator, chunk| {
                let range = chunk * CHUNK..columns.min((chunk + 1) * CHUNK);
                range
                    .map(|column| {
                        visit(plate, numbering, &incidence, column, |_, _, row, _| accumulator.add(row, 0.0));
                        let count = accumulator.rows.len();
                        accumulator.clear();
                        count
                    })
                    .collect()
            },
        )
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
    pieces.into_par_iter().for_each_init(
        || Accumulator::new(columns),
        |accumulator, (range, row_piece, value_piece)| {
            let mut next = 0;
            for column in range {
                visit(plate, numbering, &incidence, column, |e, j, row, i| {
                    accumulator.add(row, entry(plate, e, i, j));
                    for &spring in attached.get(e).map_or(&[][..], Vec::as_slice) {
                        let r = &springs.rows.coefficient[spring];
                        accumulator.add(row, springs.stiffness[spring] * r[i] * r[j]);
                    }
                });
                for &r in &accumulator.rows {
                    row_piece[next] = r;
                    value_piece[next] = accumulator.value[r];
                    next += 1;
                }
                accumulator.clear();
            }
        },
    );
    LowerTriangle { column_start, row, value }
}

/// Calls `each(element, local column dof, row, local row dof)` for every element entry in or below the diagonal.
fn visit(
    plate: &Plate,
    numbering: &Numbering,
    incidence: &Incidence,
    column: usize,
    mut each: impl FnMut(usize, usize, usize, usize),
) {
    let dof = numbering.dof[column];
    for &(e, local) in incidence.of(dof / 3) {
        let j = 3 * local + dof % 3;
        for (n, &node) in plate.elements()[e].iter().enumerate() {
            for a in 0..3 {
                let row = numbering.column[3 * node + a];
                if row != HELD && row >= column {
                    each(e, j, row, 3 * n + a);
                }
            }
        }
    }
}

/// Entry (i, j) of an element matrix in the nodes' frames.
fn entry(plate: &Plate, e: usize, i: usize, j: usize) -> f64 {
    let lower = plate.element_stiffness(e);
    if !plate.has_frames() {
        return lower[packed(i, j)];
    }
    let nodes = &plate.elements()[e];
    let parts = |k: usize| -> [(usize, f64); 2] {
        match plate.frame(nodes[k / 3]) {
            Some([c, s]) if k % 3 == 1 => [(k, c), (k + 1, s)],
            Some([c, s]) if k % 3 == 2 => [(k - 1, -s), (k, c)],
            _ => [(k, 1.0), (k, 0.0)],
        }
    };
    let mut sum = 0.0;
    for (p, a) in parts(i) {
        for (q, b) in parts(j) {
            if a != 0.0 && b != 0.0 {
                sum += a * b * lower[packed(p, q)];
            }
        }
    }
    sum
}

/// Springs by element; empty where there are none.
fn attached_springs(plate: &Plate, springs: &Springs) -> Vec<Vec<usize>> {
    if springs.rows.is_empty() {
        return Vec::new();
    }
    let mut attached = vec![Vec::new(); plate.elements().len()];
    for (spring, &e) in springs.rows.element.iter().enumerate() {
        attached[e].push(spring);
    }
    attached
}
