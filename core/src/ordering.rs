//! Nested dissection from the mesh's own geometry (George 1973).
//!
//! Elements are split at the median of their centroids along the longer side of their bounding box; the nodes that
//! both halves share are the separator and are numbered after both; and so on down.

use crate::plate::Plate;

/// Elements in a part that is not split further.
const LEAF: usize = 2;

/// Nodes in elimination order: every node that has dofs of its own appears once.
pub fn nested_dissection(plate: &Plate) -> Vec<usize> {
    let centroids: Vec<[f64; 2]> = (0..plate.elements().len()).map(|e| plate.centroid(e)).collect();
    let mut parts = Dissection {
        plate,
        centroids,
        seen: vec![0; plate.node_count()],
        stamp: 0,
        placed: vec![false; plate.node_count()],
        order: Vec::with_capacity(plate.node_count()),
    };
    let mut elements: Vec<usize> = (0..plate.elements().len()).collect();
    parts.split(&mut elements);
    parts.order
}

struct Dissection<'a> {
    plate: &'a Plate,
    centroids: Vec<[f64; 2]>,
    seen: Vec<usize>,
    stamp: usize,
    placed: Vec<bool>,
    order: Vec<usize>,
}

impl Dissection<'_> {
    fn split(&mut self, elements: &mut [usize]) {
        if elements.len() <= LEAF {
            let nodes = self.unplaced(elements);
            self.place(&nodes);
            return;
        }
        let axis = self.longer_side(elements);
        let middle = elements.len() / 2;
        let centroids = &self.centroids;
        elements.select_nth_unstable_by(middle, |&a, &b| {
            let key = |e: usize| (centroids[e][axis], centroids[e][1 - axis]);
            let ((p, q), (r, s)) = (key(a), key(b));
            p.total_cmp(&r).then(q.total_cmp(&s)).then(a.cmp(&b))
        });
        let (left, right) = elements.split_at_mut(middle);
        let separator = self.shared(left, right, 1 - axis);
        self.split(left);
        self.split(right);
        self.order.extend_from_slice(&separator);
    }

    fn longer_side(&self, elements: &[usize]) -> usize {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for &e in elements {
            for a in 0..2 {
                low[a] = low[a].min(self.centroids[e][a]);
                high[a] = high[a].max(self.centroids[e][a]);
            }
        }
        usize::from(high[1] - low[1] > high[0] - low[0])
    }

    /// Nodes of both halves that no earlier separator took, in order along the cut; they are taken.
    fn shared(&mut self, left: &[usize], right: &[usize], along: usize) -> Vec<usize> {
        self.stamp += 1;
        for &e in left {
            for &node in self.plate.leading(e) {
                self.seen[node] = self.stamp;
            }
        }
        let mut nodes = Vec::new();
        for &e in right {
            for &node in self.plate.leading(e) {
                if self.seen[node] == self.stamp && !self.placed[node] {
                    self.placed[node] = true;
                    nodes.push(node);
                }
            }
        }
        nodes.sort_unstable_by(|&a, &b| {
            let [p, q] = [a, b].map(|n| self.plate.point(n)[along]);
            p.total_cmp(&q).then(a.cmp(&b))
        });
        nodes
    }

    fn unplaced(&self, elements: &[usize]) -> Vec<usize> {
        let mut nodes: Vec<usize> =
            elements.iter().flat_map(|&e| *self.plate.leading(e)).filter(|&n| !self.placed[n]).collect();
        // Nodes of one element only go first: they fill nothing.
        nodes.sort_unstable();
        let count = |n: usize| nodes.iter().filter(|&&m| m == n).count();
        let mut unique: Vec<(usize, usize)> = nodes.iter().map(|&n| (count(n), n)).collect();
        unique.sort_unstable();
        unique.dedup();
        unique.into_iter().map(|(_, n)| n).collect()
    }

    fn place(&mut self, nodes: &[usize]) {
        for &node in nodes {
            self.placed[node] = true;
            self.order.push(node);
        }
    }
}
