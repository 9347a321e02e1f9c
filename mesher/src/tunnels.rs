//! Merges remaining triangles in pairs, by changing the quadrilaterals between the two triangles of a pair.

use crate::geometry::{Point, between, cross, distance, scale};
use crate::planar::Piece;
use crate::quality::{Corners, count, quality};
use crate::seeding::Chord;
use crate::sizes::Sizes;
use crate::triangles::NONE;
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Smallest quality, before smoothing, of a triangle in an intermediate step (10°).
const LEAST_TRIANGLE: f64 = 0.2;
/// Largest length of a new side relative to the element size there. Three equilateral triangles in a row have a long
/// side of 2.
const LONG: f64 = 2.1;
/// Largest number of quadrilaterals between two triangles that are merged (`FAR`), and largest number of positions of
/// the moved triangle that a search visits (`LOOKS`).
const FAR: usize = 12;
const LOOKS: usize = 1000;
/// Cost of moving the triangle by one quadrilateral, in addition to the cost of the shape of the new quadrilateral.
const STEP: f64 = 0.05;

/// Replaces pairs of triangles, and the quadrilaterals between the two, by quadrilaterals only.
///
/// A triangle and an adjacent quadrilateral form a pentagon. It can be divided again with the triangle at another
/// corner; in this way the triangle moves towards another triangle. Chords of the outline and of lines are kept. Before
/// smoothing, all new quadrilaterals have at least the quality `least`.
pub fn join(elements: &mut Vec<Corners>, points: &[Point], chords: &Chords, sizes: &Sizes, least: f64) {
    let mut open: Vec<usize> = (0..elements.len()).filter(|&e| count(&elements[e]) == 3).collect();
    if open.len() < 2 {
        return;
    }
    let mut beside = HashMap::with_capacity_and_hasher(4 * elements.len(), Default::default());
    for (e, corners) in elements.iter().enumerate() {
        sides(corners).for_each(|side| {
            beside.insert(side, e);
        });
    }
    let mut gone = HashSet::default();
    open.retain(|&start| {
        if gone.contains(&start) {
            return false;
        }
        let search = Search { elements, points, beside: &beside, chords, sizes, least };
        if let Some((end, made)) = search.run(start) {
            for (e, _) in &made {
                sides(&elements[*e]).for_each(|side| {
                    beside.remove(&side);
                });
            }
            sides(&elements[end]).for_each(|side| {
                beside.remove(&side);
            });
            for &(e, corners) in &made {
                elements[e] = corners;
                sides(&corners).for_each(|side| {
                    beside.insert(side, e);
                });
            }
            gone.insert(end);
        }
        true
    });
    let mut e = 0;
    elements.retain(|_| {
        e += 1;
        !gone.contains(&(e - 1))
    });
}

/// Element sides along the outline and along lines, in both directions. A side along an arc has the unit tangent of the
/// arc at its first node.
pub struct Chords(HashMap<[usize; 2], Option<Point>>);

impl Chords {
    pub fn new(chords: &[Chord], pieces: &[Piece]) -> Chords {
        let both = chords.iter().flat_map(|chord| {
            let curve = &pieces[chord.piece].curve;
            let ([a, b], [s, t]) = (chord.ends, chord.span);
            let leaving = (!curve.is_straight()).then(|| [curve.direction(s), scale(curve.direction(t), -1.0)]);
            [([a, b], leaving.map(|l| l[0])), ([b, a], leaving.map(|l| l[1]))]
        });
        Chords(both.collect())
    }
}

fn sides(corners: &Corners) -> impl Iterator<Item = [usize; 2]> + use<> {
    let (corners, n) = (*corners, count(corners));
    (0..n).map(move |i| [corners[i], corners[(i + 1) % n]])
}

/// State of a search: the moved triangle, and the quadrilateral `behind` that the last step of the triangle creates.
struct Stop {
    triangle: [usize; 3],
    before: usize,
    steps: usize,
    /// The element into which the triangle moved in the last step.
    into: usize,
    behind: Corners,
}

struct Search<'a> {
    elements: &'a [Corners],
    points: &'a [Point],
    beside: &'a HashMap<[usize; 2], usize>,
    chords: &'a Chords,
    sizes: &'a Sizes,
    least: f64,
}

struct Next(f64, usize);

impl PartialEq for Next {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Next {}

impl PartialOrd for Next {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Next {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl Search<'_> {
    /// The best triangle to merge with the triangle `start`, and (element, new corners) for each element along the
    /// path, including `start`.
    fn run(&self, start: usize) -> Option<(usize, Vec<(usize, Corners)>)> {
        let [a, b, c, _] = self.elements[start];
        let mut stops = vec![Stop { triangle: [a, b, c], before: NONE, steps: 0, into: start, behind: [NONE; 4] }];
        let mut queue = BinaryHeap::from([Reverse(Next(0.0, 0))]);
        let mut seen = HashSet::default();
        let mut best: Option<(f64, usize, usize, Corners)> = None;
        while let Some(Reverse(Next(cost, at))) = queue.pop() {
            if best.as_ref().is_some_and(|result| result.0 <= cost) || stops.len() > LOOKS {
                break;
            }
            let mut name = stops[at].triangle;
            name.sort_unstable();
            if !seen.insert(name) {
                continue;
            }
            for i in 0..3 {
                let [apex, p, q] = [0, 1, 2].map(|k| stops[at].triangle[(i + k) % 3]);
                let Some(&n) = self.beside.get(&[q, p]) else {
                    continue;
                };
                if self.chords.0.contains_key(&[p, q]) || self.passed(&stops, at, n) {
                    continue;
                }
                let other = self.elements[n];
                let m = count(&other);
                let first = (0..m).find(|&k| other[k] == q).expect("the side is the element's");
                // Corners of the polygon that the triangle and its neighbour form, beginning with the apex of the
                // triangle.
                let mut ring = vec![apex, p];
                ring.extend((2..m).map(|k| other[(first + k) % m]));
                ring.push(q);
                if ring[2..ring.len() - 1].contains(&apex) {
                    continue;
                }
                if m == 3 {
                    let made = [ring[0], ring[1], ring[2], ring[3]];
                    let shape = self.shape(&made);
                    let sum = cost + price(shape);
                    if shape >= self.least && best.as_ref().is_none_or(|result| sum < result.0) {
                        best = Some((sum, at, n, made));
                    }
                } else if stops[at].steps < FAR {
                    for tip in 1..5 {
                        let [l, t, r, u, v] = [4, 0, 1, 2, 3].map(|k| ring[(tip + k) % 5]);
                        let triangle = [l, t, r];
                        let behind = [r, u, v, l];
                        let shape = self.shape(&behind);
                        if shape >= self.least
                            && self.shape(&[l, t, r, NONE]) >= self.least.min(LEAST_TRIANGLE)
                            && self.is_short(l, r)
                        {
                            let sum = cost + STEP + price(shape);
                            queue.push(Reverse(Next(sum, stops.len())));
                            let steps = stops[at].steps + 1;
                            stops.push(Stop { triangle, before: at, steps, into: n, behind });
                        }
                    }
                }
            }
        }
        let (_, mut at, end, mut made) = best?;
        let mut changed = Vec::new();
        while at != NONE {
            // The new quadrilateral of each step replaces the element into which the triangle moved in this step. The
            // last step comes first here, and `start` last.
            changed.push((stops[at].into, made));
            made = stops[at].behind;
            at = stops[at].before;
        }
        Some((end, changed))
    }

    /// Quality of an element. At a corner between chords of two arcs, the angle between the arcs counts.
    fn shape(&self, corners: &Corners) -> f64 {
        let n = count(corners);
        let mut least = quality(corners, |node| self.points[node]);
        if least < self.least.min(LEAST_TRIANGLE) {
            return least;
        }
        for i in 0..n {
            let [before, at, after] = [n - 1, 0, 1].map(|k| corners[(i + k) % n]);
            let leaving = |to: usize| self.chords.0.get(&[at, to]).copied().flatten();
            if let (Some(u), Some(v)) = (leaving(after), leaving(before)) {
                least = least.min(cross(u, v));
            }
        }
        least
    }

    fn is_short(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|node| self.points[node]);
        distance(a, b) <= LONG * self.sizes.at(between(a, b, 0.5))
    }

    /// Whether the path of the search to the state `at` has passed through `element`.
    fn passed(&self, stops: &[Stop], mut at: usize, element: usize) -> bool {
        while at != NONE {
            if stops[at].into == element {
                return true;
            }
            at = stops[at].before;
        }
        false
    }
}

fn price(shape: f64) -> f64 {
    (1.0 - shape).powi(2)
}
