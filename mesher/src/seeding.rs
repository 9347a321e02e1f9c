//! Initial nodes: along the outline and the lines that element sides follow, and inside the plate on a lattice, which
//! is finer where elements must be smaller.

use crate::geometry::{Curve, Point, add, between, distance};
use crate::outline::Outline;
use crate::planar::{NEAR, Piece};
use crate::sizes::Sizes;
use crate::tree::{Box2, Segment, Tree};

/// Initial nodes, and the chords between consecutive nodes along the outline and along lines.
pub struct Seeds {
    pub points: Vec<Point>,
    /// Number of fixed nodes. They are the vertices and come first in `points`.
    pub fixed_points: usize,
    /// For each node that may slide along a piece of the outline or of a line: the piece, and the fraction of its
    /// curve's length. `None` for other nodes.
    pub on: Vec<Option<(usize, f64)>>,
    pub chords: Vec<Chord>,
    /// Nodes on the outline and on lines, and the chords between these nodes, in a tree for distances from them.
    fixed: Tree,
}

#[derive(Clone, Copy, Debug)]
pub struct Chord {
    pub ends: [usize; 2],
    pub piece: usize,
    /// Fractions of the piece's curve length at which the chord begins and ends.
    pub span: [f64; 2],
}

/// Largest element side relative to the element size. A longer side is halved, since its halves are nearer to this
/// size.
const LONG: f64 = 1.42;

/// The way in which nodes are placed inside the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Style {
    /// Nodes on a square lattice.
    Square,
    /// Nodes on a square lattice, and one element size away from curves that are oblique to the lattice.
    Lined,
    /// Nodes on a square lattice only where elements have their largest size. Refinement of triangles adds the other
    /// nodes.
    Loose,
    /// Nodes on a lattice whose two directions enclose this angle in radians, which is not 90°.
    Skew(f64),
}

pub fn seed(outline: &Outline, sizes: &Sizes, vertices: Vec<Point>, pieces: &[Piece], style: Style) -> (Seeds, Grid) {
    let grid = Grid::new(outline, sizes, pieces, style);
    let mut seeds = Seeds {
        on: vec![None; vertices.len()],
        fixed_points: vertices.len(),
        points: vertices,
        chords: Vec::new(),
        fixed: Tree::new(Vec::new()),
    };
    for (index, piece) in pieces.iter().enumerate() {
        seeds.sample(index, piece, &grid.stations(piece, sizes));
    }
    let segment = |chord: &Chord| {
        let [a, b] = chord.ends.map(|end| seeds.points[end]);
        Segment { a, b, weight: 0.0, owner: chord.piece }
    };
    let mut fixed: Vec<Segment> = seeds.chords.iter().map(segment).collect();
    fixed.extend(seeds.points.iter().map(|&p| Segment { a: p, b: p, weight: 0.0, owner: usize::MAX }));
    seeds.fixed = Tree::new(fixed);
    if style == Style::Lined {
        seeds.line(outline, sizes, pieces, &grid);
    }
    for p in grid.lattice(sizes) {
        let wanted = style != Style::Loose || sizes.at(p) > 0.75 * sizes.largest;
        if wanted && outline.contains(p) && seeds.is_free(p, sizes.at(p)) {
            seeds.points.push(p);
            seeds.on.push(None);
        }
    }
    (seeds, grid)
}

impl Seeds {
    /// Whether a point is far enough from the outline and all lines to be a node of elements of the given size.
    pub fn is_free(&self, p: Point, size: f64) -> bool {
        // 1e-6 allows for the rounding of the distance of a lattice line from the outline and from lines.
        self.fixed.least(p, 1.0, (NEAR - 1e-6) * size, |_| true).is_none()
    }

    /// Adds nodes one element size away from the nodes on those curves that are oblique to the lattice.
    fn line(&mut self, outline: &Outline, sizes: &Sizes, pieces: &[Piece], grid: &Grid) {
        let mut beside: Vec<Point> = Vec::new();
        for (node, on) in self.on.iter().enumerate() {
            let Some((piece, t)) = *on else {
                continue;
            };
            let Piece { curve, of, .. } = &pieces[piece];
            if grid.axis_along(curve).is_some() {
                continue;
            }
            let [x, y] = curve.direction(t);
            let depth = sizes.at(self.points[node]);
            for left in if of.is_side() { [1.0].iter() } else { [1.0, -1.0].iter() } {
                let p = add(self.points[node], [-left * depth * y, left * depth * x]);
                let crowded = beside.iter().rev().any(|&q| distance(p, q) < 0.7 * depth);
                if !crowded && outline.contains(p) && self.fixed.least(p, 1.0, 0.8 * depth, |_| true).is_none() {
                    beside.push(p);
                }
            }
        }
        let mut fixed = std::mem::take(&mut self.fixed.segments);
        fixed.extend(beside.iter().map(|&p| Segment { a: p, b: p, weight: 0.0, owner: usize::MAX }));
        self.fixed = Tree::new(fixed);
        self.on.resize(self.on.len() + beside.len(), None);
        self.points.extend(beside);
    }

    fn sample(&mut self, index: usize, piece: &Piece, stations: &[f64]) {
        let (mut last, mut from) = (piece.ends[0], piece.span[0]);
        for &t in stations {
            self.points.push(piece.curve.at(t));
            self.on.push(Some((index, t)));
            let node = self.points.len() - 1;
            self.chords.push(Chord { ends: [last, node], piece: index, span: [from, t] });
            (last, from) = (node, t);
        }
        self.chords.push(Chord { ends: [last, piece.ends[1]], piece: index, span: [from, piece.span[1]] });
    }
}

/// The lattice: coordinates of its lines in a sheared plane, in which the two lattice directions are the axes.
pub struct Grid {
    lines: [Vec<f64>; 2],
    /// Cosine and sine of the angle between the two lattice directions.
    second: [f64; 2],
    /// Largest difference of two coordinates that count as equal.
    level: f64,
}

impl Grid {
    pub fn new(outline: &Outline, sizes: &Sizes, pieces: &[Piece], style: Style) -> Grid {
        let second = if let Style::Skew(angle) = style { [angle.cos(), angle.sin()] } else { [0.0, 1.0] };
        let mut grid = Grid { lines: [Vec::new(), Vec::new()], second, level: 1e-9 * outline.bounds.extent() };
        let bounds = Box2::around(outline.chords.segments.iter().map(|s| grid.flat(s.a)));
        grid.lines = [0, 1].map(|axis| {
            // Straight pieces along the other axis, as pairs of their coordinate along this axis and their length.
            let mut lines: Vec<(f64, f64)> = vec![(bounds.low[axis], 0.0), (bounds.high[axis], 0.0)];
            for piece in pieces.iter().filter(|piece| grid.axis_along(&piece.curve) == Some(1 - axis)) {
                let length = piece.curve.length() * (piece.span[1] - piece.span[0]);
                lines.push((grid.flat(piece.curve.from)[axis], length));
            }
            lines.sort_by(|s, t| s.0.total_cmp(&t.0));
            let mut merged: Vec<(f64, f64)> = Vec::new();
            for (at, length) in lines {
                match merged.last_mut() {
                    Some(last) if at - last.0 <= grid.level => last.1 += length,
                    _ => merged.push((at, length)),
                }
            }
            merged.sort_by(|s, t| t.1.total_cmp(&s.1).then(s.0.total_cmp(&t.0)));
            let mut chosen: Vec<f64> = Vec::new();
            for (at, _) in merged {
                if chosen.iter().all(|other| (other - at).abs() >= NEAR * sizes.largest) {
                    chosen.push(at);
                }
            }
            chosen.sort_by(f64::total_cmp);
            let mut filled = Vec::new();
            for w in chosen.windows(2) {
                let count = ((w[1] - w[0]) / sizes.largest - 1e-6).ceil().max(1.0);
                filled.extend((0..count as usize).map(|i| w[0] + (w[1] - w[0]) * (i as f64 / count)));
            }
            filled.extend(chosen.last());
            filled
        });
        grid
    }

    /// Maps a point of the plate to the sheared plane.
    fn flat(&self, p: Point) -> Point {
        let [cos, sin] = self.second;
        [p[0] - p[1] * cos / sin, p[1] / sin]
    }

    /// Maps a point of the sheared plane back to the plate.
    fn real(&self, p: Point) -> Point {
        let [cos, sin] = self.second;
        [p[0] + p[1] * cos, p[1] * sin]
    }

    /// The lattice direction (0 or 1) to which a straight curve is parallel; `None` if it is parallel to neither.
    fn axis_along(&self, curve: &Curve) -> Option<usize> {
        let (from, to) = (self.flat(curve.from), self.flat(curve.to));
        (0..2).find(|&axis| curve.is_straight() && (to[1 - axis] - from[1 - axis]).abs() <= self.level)
    }

    /// Whether the line through the points a and b is parallel to a lattice direction.
    pub fn is_along(&self, a: Point, b: Point) -> bool {
        self.axis_along(&Curve::straight(a, b)).is_some()
    }

    /// Fractions of a piece's curve length at which nodes are placed between the ends of the piece.
    fn stations(&self, piece: &Piece, sizes: &Sizes) -> Vec<f64> {
        let [from, to] = piece.span;
        let Some(axis) = self.axis_along(&piece.curve) else {
            return even(&piece.curve, from, to, sizes);
        };
        let (a, b) = (self.flat(piece.curve.from)[axis], self.flat(piece.curve.to)[axis]);
        let share = |x: f64| (x - a) / (b - a);
        let (low, high) = (a + from * (b - a), a + to * (b - a));
        let (low, high) = (low.min(high), low.max(high));
        let mut lines = Vec::new();
        for w in self.lines[axis].windows(2).filter(|w| w[1] > low && w[0] < high) {
            halve(w[0], w[1], &|x: f64| sizes.at(piece.curve.at(share(x))), &mut lines);
        }
        lines.extend(self.lines[axis].last());
        let room = |x: f64| NEAR * sizes.at(piece.curve.at(share(x)));
        lines.retain(|&x| x - low >= room(x) && high - x >= room(x));
        let mut shares: Vec<f64> = lines.into_iter().map(share).collect();
        shares.sort_by(f64::total_cmp);
        let mut stations = Vec::new();
        let mut last = from;
        for next in shares.into_iter().chain([to]) {
            let length = piece.curve.length() * (next - last);
            if length > LONG * sizes.at(piece.curve.at(0.5 * (last + next))) {
                stations.extend(even(&piece.curve, last, next, sizes));
            }
            stations.push(next);
            last = next;
        }
        stations.pop();
        stations
    }

    /// Points of the lattice. A lattice cell is halved until it has about the element size that `sizes` gives there.
    fn lattice(&self, sizes: &Sizes) -> Vec<Point> {
        let [x, y] = &self.lines;
        let mut points = Vec::new();
        for v in y.windows(2) {
            for u in x.windows(2) {
                quarter([u[0], v[0]], [u[1], v[1]], &|p| sizes.at(self.real(p)), &mut points);
            }
        }
        points.sort_by(|p, q| p[1].total_cmp(&q[1]).then(p[0].total_cmp(&q[0])));
        points.dedup();
        points.into_iter().map(|p| self.real(p)).collect()
    }
}

/// Halves an interval until its parts have at most 1.42 times the element size there. Appends the begin of each part to
/// `result`.
fn halve(low: f64, high: f64, size: &impl Fn(f64) -> f64, result: &mut Vec<f64>) {
    let middle = 0.5 * (low + high);
    if high - low > LONG * size(middle) {
        halve(low, middle, size, result);
        halve(middle, high, size, result);
    } else {
        result.push(low);
    }
}

fn quarter(low: Point, high: Point, sizes: &impl Fn(Point) -> f64, points: &mut Vec<Point>) {
    let middle = between(low, high, 0.5);
    let size = LONG * sizes(middle);
    match [high[0] - low[0] > size, high[1] - low[1] > size] {
        [false, false] => points.extend([low, [high[0], low[1]], high, [low[0], high[1]]]),
        [true, false] => {
            quarter(low, [middle[0], high[1]], sizes, points);
            quarter([middle[0], low[1]], high, sizes, points);
        }
        [false, true] => {
            quarter(low, [high[0], middle[1]], sizes, points);
            quarter([low[0], middle[1]], high, sizes, points);
        }
        [true, true] => {
            quarter(low, middle, sizes, points);
            quarter([middle[0], low[1]], [high[0], middle[1]], sizes, points);
            quarter([low[0], middle[1]], [middle[0], high[1]], sizes, points);
            quarter(middle, high, sizes, points);
        }
    }
}

/// Fractions of a curve's length that divide its part from `from` to `to` into element sides. The ratio of side length
/// to element size is the same for all these sides.
fn even(curve: &Curve, from: f64, to: f64, sizes: &Sizes) -> Vec<f64> {
    let at = |t: f64| curve.at(from + t * (to - from));
    let counts = sizes.counts(at, curve.length() * (to - from));
    let sum = counts[counts.len() - 1];
    let parts = (sum - 1e-6).ceil().max(1.0) as usize;
    let mut stations = Vec::with_capacity(parts);
    let mut i = 0;
    for part in 1..parts {
        let wanted = sum * part as f64 / parts as f64;
        while counts[i + 1] < wanted {
            i += 1;
        }
        let share = (i as f64 + (wanted - counts[i]) / (counts[i + 1] - counts[i])) / (counts.len() - 1) as f64;
        stations.push(from + share * (to - from));
    }
    stations
}
