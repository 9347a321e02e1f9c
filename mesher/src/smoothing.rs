//! Moves nodes to improve the shape of the elements around them.

use crate::geometry::{Curve, Point, add, distance, scale};
use crate::quality::{Corners, count, quality};

/// How a node may move.
#[derive(Clone, Copy)]
pub enum Freedom {
    None,
    Plane,
    /// The node may move along a curve. It is at this fraction of the curve's length, which stays between the two
    /// bounds.
    Along(Curve, f64, [f64; 2]),
}

/// Number of sweeps that move nodes towards the mean of their neighbours (`SWEEPS`), then number of sweeps that try
/// several directions for nodes of badly shaped elements (`SEARCHES`).
const SWEEPS: usize = 6;
const SEARCHES: usize = 14;
/// If all elements around a node have a quality above this (corners of 72°), the node is not moved.
const GOOD: f64 = 0.95;
/// If an element around a node has a quality below this (corners of 55°), the node is tried in every direction.
const POOR: f64 = 0.82;

pub fn smooth(points: &mut [Point], elements: &[Corners], freedom: &mut [Freedom]) {
    let around = Around::new(points.len(), elements);
    let mut shapes: Vec<f64> = elements.iter().map(|corners| quality(corners, |n| points[n])).collect();
    let mut active: Vec<usize> = (0..points.len()).filter(|&n| !matches!(freedom[n], Freedom::None)).collect();
    for _ in 0..SWEEPS {
        active.retain(|&node| {
            let now = around.known(node, &shapes);
            if now.worst > GOOD {
                return false;
            }
            if let Freedom::Plane = freedom[node] {
                let middle = around.middle(node, points, elements);
                for part in [1.0, 0.5] {
                    let at = add(scale(points[node], 1.0 - part), scale(middle, part));
                    let then = around.shape(node, at, points, elements);
                    if then.score() > now.score() + 1e-6 {
                        points[node] = at;
                        around.update(node, points, elements, &mut shapes);
                        break;
                    }
                }
            }
            true
        });
    }
    let mut step = 0.2;
    for _ in 0..SEARCHES {
        active.clear();
        active.extend((0..points.len()).filter(|&n| !matches!(freedom[n], Freedom::None)));
        for &node in &active {
            let now = around.known(node, &shapes);
            if now.worst < POOR && search(node, step, now, &around, points, elements, freedom) {
                around.update(node, points, elements, &mut shapes);
            }
        }
        step *= 0.82;
    }
}

/// Tries positions around a node, at `step` times the length of its shortest side. Returns whether the node was moved.
fn search(
    node: usize,
    step: f64,
    mut now: Shape,
    around: &Around,
    points: &mut [Point],
    elements: &[Corners],
    freedom: &mut [Freedom],
) -> bool {
    // Eight unit vectors, the first four along the axes.
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const DIRECTIONS: [Point; 8] =
        [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [D, D], [-D, D], [-D, -D], [D, -D]];
    let reach = step * around.shortest(node, points, elements);
    let from = points[node];
    match freedom[node] {
        Freedom::None => {}
        Freedom::Plane => {
            for direction in DIRECTIONS {
                let at = add(from, scale(direction, reach));
                let then = around.shape(node, at, points, elements);
                if then.score() > now.score() + 1e-6 {
                    (points[node], now) = (at, then);
                }
            }
        }
        Freedom::Along(curve, t, [low, high]) => {
            for share in [t - reach / curve.length(), t + reach / curve.length()] {
                if share > low && share < high {
                    let at = curve.at(share);
                    let then = around.shape(node, at, points, elements);
                    if then.score() > now.score() + 1e-6 {
                        (points[node], now) = (at, then);
                        freedom[node] = Freedom::Along(curve, share, [low, high]);
                    }
                }
            }
        }
    }
    points[node] != from
}

#[derive(Clone, Copy)]
struct Shape {
    worst: f64,
    mean: f64,
}

impl Shape {
    fn score(self) -> f64 {
        0.9 * self.worst + 0.1 * self.mean
    }
}

/// For each node, the elements around it, compressed by node.
struct Around {
    starts: Vec<usize>,
    elements: Vec<usize>,
}

impl Around {
    fn new(nodes: usize, elements: &[Corners]) -> Around {
        let mut starts = vec![0; nodes + 1];
        for corners in elements {
            corners[..count(corners)].iter().for_each(|&node| starts[node + 1] += 1);
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut around = vec![0; starts[nodes]];
        for (e, corners) in elements.iter().enumerate() {
            for &node in &corners[..count(corners)] {
                around[next[node]] = e;
                next[node] += 1;
            }
        }
        Around { starts, elements: around }
    }

    fn of(&self, node: usize) -> &[usize] {
        &self.elements[self.starts[node]..self.starts[node + 1]]
    }

    /// Worst and mean quality that the elements around a node would have if the node were at `place`.
    fn shape(&self, node: usize, place: Point, points: &[Point], elements: &[Corners]) -> Shape {
        let (mut worst, mut sum) = (f64::INFINITY, 0.0);
        for &e in self.of(node) {
            let shape = quality(&elements[e], |n| if n == node { place } else { points[n] });
            worst = worst.min(shape);
            sum += shape;
        }
        Shape { worst, mean: sum / self.of(node).len().max(1) as f64 }
    }

    /// Worst and mean of the stored qualities `shapes` of the elements around a node.
    fn known(&self, node: usize, shapes: &[f64]) -> Shape {
        let (mut worst, mut sum) = (f64::INFINITY, 0.0);
        for &e in self.of(node) {
            worst = worst.min(shapes[e]);
            sum += shapes[e];
        }
        Shape { worst, mean: sum / self.of(node).len().max(1) as f64 }
    }

    /// Updates the stored qualities `shapes` of the elements around a node that has moved.
    fn update(&self, node: usize, points: &[Point], elements: &[Corners], shapes: &mut [f64]) {
        self.of(node).iter().for_each(|&e| shapes[e] = quality(&elements[e], |n| points[n]));
    }

    /// Mean position of the neighbours of a node.
    fn middle(&self, node: usize, points: &[Point], elements: &[Corners]) -> Point {
        let (mut sum, mut number) = ([0.0; 2], 0.0);
        self.neighbours(node, elements, |n| {
            sum = add(sum, points[n]);
            number += 1.0;
        });
        scale(sum, 1.0 / number)
    }

    fn shortest(&self, node: usize, points: &[Point], elements: &[Corners]) -> f64 {
        let mut least = f64::INFINITY;
        self.neighbours(node, elements, |n| least = least.min(distance(points[n], points[node])));
        least
    }

    /// Calls `take` with each neighbour of a node. A neighbour occurs twice if the side to it belongs to two elements.
    fn neighbours(&self, node: usize, elements: &[Corners], mut take: impl FnMut(usize)) {
        for &e in self.of(node) {
            let n = count(&elements[e]);
            let i = (0..n).find(|&i| elements[e][i] == node).expect("the element is around the node");
            take(elements[e][(i + 1) % n]);
            take(elements[e][(i + n - 1) % n]);
        }
    }
}
