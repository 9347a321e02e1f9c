//! Midside nodes, which are on arcs where element sides follow arcs, and the final mesh.

use crate::Mesh;
use crate::geometry::{Curve, Point, add, between, cross, scale, sub};
use crate::normal::{Given, Normal};
use crate::outline::turned;
use crate::planar::{Piece, Source};
use crate::quality::{Corners, area, count, least_angle, quality};
use crate::seeding::Seeds;
use crate::smoothing::Freedom;
use crate::triangles::NONE;

pub struct Quadratic {
    /// Corners of elements (those at corners of the outline first), then midside nodes.
    points: Vec<Point>,
    elements: Vec<[usize; 8]>,
    /// Each element side on the outline: (corner, midside node, corner), and the index of the outline side.
    sides: Vec<([usize; 3], usize)>,
    corners: Vec<Corners>,
    /// Indices of the elements with a curved side.
    curved: Vec<usize>,
    /// (source, node) of the corners on lines and outline sides (`on`, lines first), and of the midside nodes on arcs
    /// (`bent`). The source is the line or outline side.
    on: Vec<(Source, usize)>,
    bent: Vec<(Source, usize)>,
}

impl Quadratic {
    pub fn new(pieces: &[Piece], seeds: &Seeds, elements: &[Corners], freedom: &[Freedom]) -> Quadratic {
        let mut number = vec![NONE; seeds.points.len()];
        elements.iter().flatten().filter(|&&node| node != NONE).for_each(|&node| number[node] = 0);
        let mut points = Vec::new();
        for (node, new) in number.iter_mut().enumerate().filter(|(_, new)| **new == 0) {
            *new = points.len();
            points.push(seeds.points[node]);
        }
        let corners: Vec<Corners> =
            elements.iter().map(|e| e.map(|node| if node == NONE { NONE } else { number[node] })).collect();

        // Sides of all elements: (corners, element, number of the side in the element). They are sorted, so that a side
        // common to two elements is found twice in succession.
        let mut halves: Vec<([usize; 2], usize, usize)> = Vec::with_capacity(4 * corners.len());
        for (e, own) in corners.iter().enumerate() {
            let n = count(own);
            for i in 0..n {
                let (a, b) = (own[i], own[(i + 1) % n]);
                halves.push(([a.min(b), a.max(b)], e, i));
            }
        }
        halves.sort_unstable();
        let mut nodes: Vec<[usize; 8]> = corners
            .iter()
            .map(|own| {
                // A triangle repeats its third corner, also as the midside node of its collapsed side.
                let mut all = [own[2]; 8];
                all[..count(own)].copy_from_slice(&own[..count(own)]);
                all
            })
            .collect();
        let mut middles: Vec<([usize; 2], usize)> = Vec::with_capacity(halves.len() / 2 + 8);
        for &(ends, e, i) in &halves {
            if middles.last().is_none_or(|last| last.0 != ends) {
                middles.push((ends, points.len()));
                points.push(between(points[ends[0]], points[ends[1]], 0.5));
            }
            let place = if i == 2 && corners[e][3] == NONE { 7 } else { 4 + i };
            nodes[e][place] = middles[middles.len() - 1].1;
        }

        let share = |node: usize, vertex: f64| match freedom[node] {
            Freedom::Along(_, t, _) => t,
            _ => vertex,
        };
        let (mut sides, mut curved, mut on, mut bent) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for chord in &seeds.chords {
            let Piece { curve, of, .. } = pieces[chord.piece];
            let [a, b] = chord.ends.map(|end| number[end]);
            on.extend([(of, a), (of, b)]);
            if !of.is_side() && curve.is_straight() {
                continue;
            }
            let result = middles
                .binary_search_by(|middle| middle.0.cmp(&[a.min(b), a.max(b)]))
                .expect("chords are sides of elements");
            let (ends, middle) = middles[result];
            if !curve.is_straight() {
                let [from, to] = [0, 1].map(|end| share(chord.ends[end], chord.span[end]));
                points[middle] = curve.at(0.5 * (from + to));
                bent.push((of, middle));
                let first = halves.partition_point(|half| half.0 < ends);
                curved.extend(halves[first..].iter().take_while(|half| half.0 == ends).map(|half| half.1));
            }
            if let Source::Side(side) = of {
                sides.push(([a, middle, b], side));
            }
        }
        curved.sort_unstable();
        curved.dedup();
        on.sort_by(|one, other| other.cmp(one));
        on.dedup();
        Quadratic { points, elements: nodes, sides, corners, curved, on, bent }
    }

    /// Centres of the elements that are inverted or, because of an arc, nearly inverted.
    pub fn folded(&self) -> Vec<Point> {
        // Smallest allowed Jacobian, relative to that of the same element with straight sides.
        const LEFT: f64 = 0.2;
        let mut result = Vec::new();
        let flat = (0..self.corners.len()).filter(|&e| !(quality(&self.corners[e], |n| self.points[n]) > 1e-3));
        let bent = self.curved.iter().copied().filter(|&e| !(self.least_share(e) > LEFT));
        for e in flat.chain(bent) {
            let n = count(&self.corners[e]);
            let sum = self.corners[e][..n].iter().fold([0.0; 2], |s, &node| add(s, self.points[node]));
            result.push(scale(sum, 1.0 / n as f64));
        }
        result
    }

    /// Smallest ratio of an element's Jacobian to the Jacobian of the same element with straight sides, over a grid of
    /// 5 × 5 points.
    fn least_share(&self, e: usize) -> f64 {
        let n = count(&self.corners[e]);
        let at = |i: usize| self.points[self.elements[e][i]];
        let middle = |i: usize| at(if n == 3 && i == 2 { 7 } else { 4 + i });
        let bulge = |i: usize| sub(middle(i), between(at(i), at((i + 1) % n), 0.5));
        let mut least = f64::INFINITY;
        let mut station = |u: [Point; 2], v: [Point; 2]| least = least.min(cross(v[0], v[1]) / cross(u[0], u[1]));
        for i in 0..=4 {
            for j in 0..=4 {
                if n == 4 {
                    let (x, y) = (0.5 * f64::from(i) - 1.0, 0.5 * f64::from(j) - 1.0);
                    let along = |s: f64, p: Point, q: Point| scale(sub(q, p), 0.25 * (1.0 + s));
                    let u = [
                        add(along(-y, at(0), at(1)), along(y, at(3), at(2))),
                        add(along(-x, at(0), at(3)), along(x, at(1), at(2))),
                    ];
                    let (low_x, high_x, low_y, high_y) =
                        (0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.5 * (1.0 - y), 0.5 * (1.0 + y));
                    let (bend_x, bend_y) = (1.0 - x * x, 1.0 - y * y);
                    let by_x = [-2.0 * x * low_y, 0.5 * bend_y, -2.0 * x * high_y, -0.5 * bend_y];
                    let by_y = [-0.5 * bend_x, -2.0 * y * high_x, 0.5 * bend_x, -2.0 * y * low_x];
                    let mut v = u;
                    for k in 0..4 {
                        v = [add(v[0], scale(bulge(k), by_x[k])), add(v[1], scale(bulge(k), by_y[k]))];
                    }
                    station(u, v);
                } else if i + j <= 4 {
                    let (x, y) = (0.25 * f64::from(i), 0.25 * f64::from(j));
                    let z = 1.0 - x - y;
                    let u = [sub(at(1), at(0)), sub(at(2), at(0))];
                    let by_x = [4.0 * (z - x), 4.0 * y, -4.0 * y];
                    let by_y = [-4.0 * x, 4.0 * x, 4.0 * (z - y)];
                    let mut v = u;
                    for k in 0..3 {
                        v = [add(v[0], scale(bulge(k), by_x[k])), add(v[1], scale(bulge(k), by_y[k]))];
                    }
                    station(u, v);
                }
            }
        }
        least
    }

    /// Area of quadrilaterals divided by the whole area, and the smallest corner angle in degrees.
    pub fn measures(&self) -> (f64, f64) {
        let at = |n: usize| self.points[n];
        let (mut whole, mut four, mut least) = (0.0, 0.0, f64::INFINITY);
        for corners in &self.corners {
            let own = area(corners, at);
            whole += own;
            four += if count(corners) == 4 { own } else { 0.0 };
            least = least.min(least_angle(corners, at));
        }
        (four / whole, least)
    }

    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// The mesh in original coordinates. `back` has cosine and sine of the rotation from the mesh to the normal form.
    /// `sides` and `lines` are the original curves.
    pub fn finish(self, sides: &[Given], lines: &[Curve], normal: &Normal, back: [f64; 2]) -> Mesh {
        let (quadrilaterals, least_angle) = self.measures();
        let mut points: Vec<Point> = self.points.iter().map(|&p| normal.back(turned(p, back))).collect();
        let given = |of: Source| match of {
            Source::Side(side) => &sides[side].curve,
            Source::Line(line) => &lines[line],
        };
        // Rounding moves nodes away from the original curves, so they are projected back. A node at the crossing of two
        // curves is projected onto each in turn, twice.
        for (of, node) in [&self.on[..], &self.on, &self.bent].concat() {
            let curve = given(of);
            points[node] = curve.at(curve.nearest(points[node]));
        }
        for (corner, side) in sides.iter().enumerate() {
            points[corner] = side.curve.from;
        }
        let mut straight = vec![true; points.len()];
        self.bent.iter().for_each(|&(_, middle)| straight[middle] = false);
        for (element, corners) in self.elements.iter().zip(&self.corners) {
            let n = count(corners);
            for i in 0..n {
                let middle = element[if n == 3 && i == 2 { 7 } else { 4 + i }];
                if straight[middle] {
                    points[middle] = scale(add(points[corners[i]], points[corners[(i + 1) % n]]), 0.5);
                }
            }
        }
        let (mut elements, mut outer) = (self.elements, self.sides);
        if normal.is_mirrored() {
            for element in &mut elements {
                let other_way =
                    if element[2] == element[3] { [1, 0, 2, 3, 4, 7, 6, 5] } else { [0, 3, 2, 1, 7, 6, 5, 4] };
                *element = other_way.map(|i| element[i]);
            }
            outer.reverse();
            outer.iter_mut().for_each(|(nodes, _)| nodes.reverse());
        }
        outer.sort_by_key(|&(_, side)| sides[side].number);
        let of = |&(_, side): &([usize; 3], usize)| sides[side].of;
        Mesh {
            points,
            elements,
            side_of: outer.iter().map(of).collect(),
            sides: outer.into_iter().map(|(nodes, _)| nodes).collect(),
            least_angle,
            quadrilaterals,
        }
    }
}
