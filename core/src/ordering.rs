//! Nested dissection by the geometry of the mesh (George 1973), which gives the order of elimination.
//!
//! A cell is an element or a pair of coupled elements. Cells are divided at the median of their centroids along the
//! longer side of their bounding box. The nodes that both halves share are the separator; it is numbered after both
//! halves, which are divided in the same manner. A pair contains only the deflections of its nodes. So the deflection
//! and the slopes of a node are separate parts.

use crate::plate::Plate;

/// Largest number of cells (elements or pairs of elements) in a leaf of the dissection tree.
const LEAF: usize = 2;

/// The dofs in elimination order, without the dofs of nodes that follow a leader. `pairs` are pairs of coupled
/// elements.
pub fn nested_dissection(plate: &Plate, pairs: &[[u32; 2]]) -> Vec<usize> {
    let mut centroids: Vec<[f64; 2]> = (0..plate.elements().len()).map(|e| plate.centroid(e)).collect();
    for pair in pairs {
        let [p, q] = pair.map(|e| centroids[e as usize]);
        centroids.push([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
    }
    let mut cells: Vec<usize> = (0..centroids.len()).collect();
    let mut all = Dissection {
        plate,
        pairs,
        centroids,
        seen: vec![0; 2 * plate.node_count()],
        stamp: 0,
        placed: vec![false; 2 * plate.node_count()],
        order: Vec::with_capacity(2 * plate.node_count()),
    };
    all.split(&mut cells);
    let dofs = |part: usize| {
        if part % 2 == 0 { 3 * (part / 2)..3 * (part / 2) + 1 } else { 3 * (part / 2) + 1..3 * (part / 2) + 3 }
    };
    all.order.into_iter().flat_map(dofs).collect()
}

/// Working data of the dissection. Node n has two parts: its deflection is part 2n, its slopes are part 2n + 1.
struct Dissection<'a> {
    plate: &'a Plate,
    /// Pairs of coupled elements. The cell numbers of pairs follow those of the elements.
    pairs: &'a [[u32; 2]],
    centroids: Vec<[f64; 2]>,
    seen: Vec<usize>,
    stamp: usize,
    placed: Vec<bool>,
    order: Vec<usize>,
}

impl<'a> Dissection<'a> {
    /// The parts in a cell: deflections and slopes of the nodes of an element, or deflections of the nodes of a pair.
    fn parts(&self, cell: usize) -> impl Iterator<Item = usize> + use<'a> {
        let plate = self.plate;
        let (elements, own) = match cell.checked_sub(plate.elements().len()) {
            None => ([Some(cell), None], 2),
            Some(pair) => (self.pairs[pair].map(|e| Some(e as usize)), 1),
        };
        let nodes = elements.into_iter().flatten().flat_map(|e| *plate.leading(e));
        nodes.flat_map(move |node| 2 * node..2 * node + own)
    }

    fn split(&mut self, cells: &mut [usize]) {
        if cells.len() <= LEAF {
            let parts = self.unplaced(cells);
            self.place(&parts);
            return;
        }
        let axis = self.longer_side(cells);
        let middle = cells.len() / 2;
        let centroids = &self.centroids;
        cells.select_nth_unstable_by(middle, |&a, &b| {
            let key = |cell: usize| (centroids[cell][axis], centroids[cell][1 - axis]);
            let ((p, q), (r, s)) = (key(a), key(b));
            p.total_cmp(&r).then(q.total_cmp(&s)).then(a.cmp(&b))
        });
        let (left, right) = cells.split_at_mut(middle);
        let separator = self.shared(left, right, 1 - axis);
        self.split(left);
        self.split(right);
        self.order.extend_from_slice(&separator);
    }

    fn longer_side(&self, cells: &[usize]) -> usize {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for &cell in cells {
            for a in 0..2 {
                low[a] = low[a].min(self.centroids[cell][a]);
                high[a] = high[a].max(self.centroids[cell][a]);
            }
        }
        usize::from(high[1] - low[1] > high[0] - low[0])
    }

    /// Parts (deflection or slopes of a node) that are in cells of both halves and in no earlier separator, ordered
    /// along the cut. They are marked as placed.
    fn shared(&mut self, left: &[usize], right: &[usize], along: usize) -> Vec<usize> {
        self.stamp += 1;
        for &cell in left {
            for part in self.parts(cell) {
                self.seen[part] = self.stamp;
            }
        }
        let mut shared = Vec::new();
        for &cell in right {
            for part in self.parts(cell) {
                if self.seen[part] == self.stamp && !self.placed[part] {
                    self.placed[part] = true;
                    shared.push(part);
                }
            }
        }
        shared.sort_unstable_by(|&a, &b| {
            let [p, q] = [a, b].map(|part| self.plate.point(part / 2)[along]);
            p.total_cmp(&q).then(a.cmp(&b))
        });
        shared
    }

    fn unplaced(&self, cells: &[usize]) -> Vec<usize> {
        let mut parts: Vec<usize> =
            cells.iter().flat_map(|&cell| self.parts(cell)).filter(|&part| !self.placed[part]).collect();
        // Parts (deflection or slopes of a node) in one cell only come first, since their elimination causes no fill.
        parts.sort_unstable();
        let count = |part: usize| parts.iter().filter(|&&other| other == part).count();
        let mut unique: Vec<(usize, usize)> = parts.iter().map(|&part| (count(part), part)).collect();
        unique.sort_unstable();
        unique.dedup();
        unique.into_iter().map(|(_, part)| part).collect()
    }

    fn place(&mut self, parts: &[usize]) {
        for &part in parts {
            self.placed[part] = true;
            self.order.push(part);
        }
    }
}
