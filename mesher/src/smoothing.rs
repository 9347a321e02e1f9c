//! Nodes moved to where the elements around them are better shaped.

use crate::geometry::{Curve, Point, add, distance, scale};
use crate::quality::{Corners, count, quality};

/// Where a node may go.
#[derive(Clone, Copy)]
pub enum Freedom {
    None,
    Plane,
    /// Along a curve, at a share of its length, between two others.
    Along(Curve, f64, [f64; 2]),
}

/// Sweeps towards the middle of the neighbours, and sweeps that try directions around the worst nodes.
const SWEEPS: usize = 6;
const SEARCHES: usize = 14;
/// Worst corners above this (72°) are left as they are.
const GOOD: f64 = 0.95;
/// Nodes with a worse corner than this (53°) are moved in every direction to find a better place.
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

/// Tries places around a node, a share of its shortest side away; whether it is moved.
fn search(
    node: usize,
    step: f64,
    mut now: Shape,
    around: &Around,
    points: &mut [Point],
    elements: &[Corners],
    freedom: &mut [Freedom],
) -> bool {
    // Eight directions, the first ones along the axes.
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

/// The elements around each node.
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

    /// The shape of the elements around a node, were it at a place.
    fn shape(&self, node: usize, place: Point, points: &[Point], elements: &[Corners]) -> Shape {
        let (mut worst, mut sum) = (f64::INFINITY, 0.0);
        for &e in self.of(node) {
            let shape = quality(&elements[e], |n| if n == node { place } else { points[n] });
            worst = worst.min(shape);
            sum += shape;
        }
        Shape { worst, mean: sum / self.of(node).len().max(1) as f64 }
    }

    /// The shape of the elements around a node, whose own are known.
    fn known(&self, node: usize, shapes: &[f64]) -> Shape {
        let (mut worst, mut sum) = (f64::INFINITY, 0.0);
        for &e in self.of(node) {
            worst = worst.min(shapes[e]);
            sum += shapes[e];
        }
        Shape { worst, mean: sum / self.of(node).len().max(1) as f64 }
    }

    /// Shapes of the elements around a node that has moved.
    fn update(&self, node: usize, points: &[Point], elements: &[Corners], shapes: &mut [f64]) {
        self.of(node).iter().for_each(|&e| shapes[e] = quality(&elements[e], |n| points[n]));
    }

    /// The middle of the nodes that sides lead to.
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

    /// Hands on the neighbours of a node, those within the plate twice.
    fn neighbours(&self, node: usize, elements: &[Corners], mut take: impl FnMut(usize)) {
        for &e in self.of(node) {
            let n = count(&elements[e]);
            let i = (0..n).find(|&i| elements[e][i] == node).expect("the element is around the node");
            take(elements[e][(i + 1) % n]);
            take(elements[e][(i + n - 1) % n]);
        }
    }
}
