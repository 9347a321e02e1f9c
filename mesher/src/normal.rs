//! The normal form in which a plate is meshed: centred at its bounding box, of extent one, along the given axes,
//! rounded, and ordered by coordinates only. The normal form does not depend on unit, position and order of the input.

use crate::geometry::{Curve, Point, dot, order};
use crate::outline::{Loop, Side};
use crate::sizes::Refinement;
use crate::tree::Box2;
use crate::{Line, MeshOptions};

/// Spacing of the grid to which coordinates are rounded, relative to the extent of the plate. It is much coarser than
/// rounding errors in any unit, and finer than the distance of distinct points.
const GRID: f64 = 1.0 / (1u64 << 40) as f64;
/// Spacing of the grid to which positions of refinements are rounded, relative to the extent. It is coarser than
/// `GRID`, because these positions are computed from distances and have larger rounding errors.
const COARSE: f64 = 1.0 / (1u64 << 30) as f64;

pub struct Normal {
    centre: Point,
    extent: f64,
    axes: [Point; 2],
    /// For each axis, the coordinates of all points of the input: (normal form, original).
    known: [Vec<(f64, f64)>; 2],
}

/// A side of the outline in original coordinates.
pub struct Given {
    pub curve: Curve,
    /// Number of the side in the list of all sides, which are directed with the plate on their left.
    pub number: usize,
    /// Number of the loop in the input, and number of the side in this loop.
    pub of: [usize; 2],
}

impl Normal {
    pub fn new(loops: &[Loop], options: &MeshOptions) -> Normal {
        let mut given: Vec<Point> =
            loops.iter().flat_map(|ring| ring.corners.iter().chain(ring.through.iter().flatten())).copied().collect();
        let Box2 { low, high } = Box2::around(given.iter().copied());
        let centre = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        let extent = Box2 { low, high }.extent();
        given.extend(options.lines.iter().flat_map(|line| line.ends));
        given.extend(&options.points);
        let mut normal = Normal { centre, extent, axes: options.axes, known: [Vec::new(), Vec::new()] };
        normal.known = [0, 1].map(|axis| {
            let mut known: Vec<(f64, f64)> = given.iter().map(|&p| (normal.rounded(p, GRID)[axis], p[axis])).collect();
            known.sort_by(|s, t| s.0.total_cmp(&t.0).then(s.1.total_cmp(&t.1)));
            known.dedup_by_key(|pair| pair.0);
            known
        });
        normal
    }

    fn rounded(&self, p: Point, grid: f64) -> Point {
        [0, 1].map(|axis| ((p[axis] - self.centre[axis]) / self.extent / grid).round() * grid)
    }

    /// Whether the axes are left-handed; then the normal form is mirrored.
    pub fn is_mirrored(&self) -> bool {
        self.axes[0][0] * self.axes[1][1] < self.axes[0][1] * self.axes[1][0]
    }

    fn point(&self, p: Point) -> Point {
        self.along(self.rounded(p, GRID))
    }

    fn along(&self, p: Point) -> Point {
        // Adding 0.0 turns −0.0 into 0.0.
        self.axes.map(|axis| dot(axis, p) + 0.0)
    }

    pub fn size(&self, size: f64) -> f64 {
        // The element size is rounded to the upper 30 of its 53 bits (Dekker 1971), so that it is the same in any unit.
        let size = size / self.extent;
        let wide = f64::from((1 << 23) + 1) * size;
        wide - (wide - size)
    }

    /// Maps a point of the normal form to original coordinates. Coordinates that occur in the input are returned
    /// exactly.
    pub fn back(&self, p: Point) -> Point {
        [0, 1].map(|axis| {
            let (at, known) = (self.axes[0][axis] * p[0] + self.axes[1][axis] * p[1], &self.known[axis]);
            let next = known.partition_point(|pair| pair.0 <= at);
            let (near, slope) = match (next.checked_sub(1).map(|i| known[i]), known.get(next)) {
                (Some(low), Some(&high)) => {
                    (if at - low.0 < high.0 - at { low } else { high }, (high.1 - low.1) / (high.0 - low.0))
                }
                (low, high) => (low.or(high.copied()).expect("an outline has corners"), self.extent),
            };
            near.1 + slope * (at - near.0)
        })
    }

    fn curve(&self, [from, to]: [Point; 2], through: Option<Point>) -> Curve {
        let [from, to] = [from, to].map(|p| self.point(p));
        through.and_then(|p| Curve::arc(from, self.point(p), to)).unwrap_or_else(|| Curve::straight(from, to))
    }

    /// Sides in normal form with the plate on their left, and for each its original side. Each loop begins at its
    /// smallest corner in lexicographic order; holes are ordered by this corner.
    pub fn sides(&self, loops: &[Loop], sides: &[Side]) -> (Vec<Side>, Vec<Given>) {
        let mut rings: Vec<Vec<(Side, Given)>> = Vec::new();
        for (number, side) in sides.iter().enumerate() {
            let curve = if self.is_mirrored() { side.curve.reversed() } else { side.curve };
            let through = loops[side.ring].through[side.number];
            let normal = Side { curve: self.curve([curve.from, curve.to], through), ..side.clone() };
            rings.resize_with(side.ring + 1, Vec::new);
            rings[side.ring].push((normal, Given { curve, number, of: [side.ring, side.number] }));
        }
        for ring in &mut rings {
            if self.is_mirrored() {
                ring.reverse();
            }
            let corner = |i: usize| ring[i].0.curve.from;
            let lowest =
                (1..ring.len()).fold(0, |low, i| if order(&corner(i), &corner(low)).is_lt() { i } else { low });
            ring.rotate_left(lowest);
        }
        rings[1..].sort_by(|one, other| order(&one[0].0.curve.from, &other[0].0.curve.from));
        let (mut own, mut given): (Vec<Side>, Vec<Given>) = (Vec::new(), Vec::new());
        for ring in rings {
            let (first, count) = (own.len(), ring.len());
            for (i, (side, one)) in ring.into_iter().enumerate() {
                let neighbours = [first + (i + count - 1) % count, first + (i + 1) % count];
                own.push(Side { neighbours, ..side });
                given.push(one);
            }
        }
        (own, given)
    }

    /// Lines in normal form, each with its `in_part`, and the same lines in original coordinates. They are ordered by
    /// rank, then by coordinates. Arcs through collinear points are left out.
    pub fn lines(&self, lines: &[Line]) -> (Vec<(Curve, bool)>, Vec<Curve>) {
        let mut result: Vec<(usize, [f64; 6], bool, Curve)> = Vec::new();
        for &Line { mut ends, through, rank, in_part } in lines {
            if order(&self.point(ends[1]), &self.point(ends[0])).is_lt() {
                ends.reverse();
            }
            let [from, to] = ends;
            let curve = through.map_or(Some(Curve::straight(from, to)), |p| Curve::arc(from, p, to));
            let [a, b, c] = [from, to, through.unwrap_or(from)].map(|p| self.point(p));
            result.extend(curve.map(|curve| (rank, [a[0], a[1], b[0], b[1], c[0], c[1]], in_part, curve)));
        }
        result.sort_by(|s, t| s.0.cmp(&t.0).then(order(&s.1, &t.1)));
        let normal = |([a, b, c, d, e, f], in_part, round): ([f64; 6], bool, bool)| {
            let arc = if round { Curve::arc([a, b], [e, f], [c, d]) } else { None };
            (arc.unwrap_or(Curve::straight([a, b], [c, d])), in_part)
        };
        let own = result.iter().map(|&(_, places, in_part, curve)| normal((places, in_part, !curve.is_straight())));
        (own.collect(), result.iter().map(|line| line.3).collect())
    }

    pub fn points(&self, points: &[Point]) -> Vec<Point> {
        let mut result: Vec<Point> = points.iter().map(|&p| self.point(p)).collect();
        result.sort_by(|one, other| order(one, other));
        result
    }

    pub fn refinements(&self, refinements: &[Refinement]) -> Vec<Refinement> {
        let mut result: Vec<[f64; 5]> = Vec::with_capacity(refinements.len());
        for &Refinement { from, to, size } in refinements {
            let mut ends = [from, to].map(|p| self.along(self.rounded(p, COARSE)));
            ends.sort_by(|one, other| order(one, other));
            let [[a, b], [c, d]] = ends;
            result.push([a, b, c, d, self.size(size)]);
        }
        result.sort_by(|one, other| order(one, other));
        result.into_iter().map(|[a, b, c, d, size]| Refinement { from: [a, b], to: [c, d], size }).collect()
    }
}
