//! Weighted segments in a tree of bounding boxes, which finds the nearest segment to a point and the segments near a
//! box.

use crate::geometry::{Point, between, distance, nearest_share};

#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub a: Point,
    pub b: Point,
    /// Number added to the distance of a point from this segment; [`Tree::least`] returns the least of these sums.
    pub weight: f64,
    pub owner: usize,
}

#[derive(Clone, Copy, Debug)]
pub struct Box2 {
    pub low: Point,
    pub high: Point,
}

impl Box2 {
    pub fn around(points: impl IntoIterator<Item = Point>) -> Box2 {
        let mut result = Box2 { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        for p in points {
            for axis in 0..2 {
                result.low[axis] = result.low[axis].min(p[axis]);
                result.high[axis] = result.high[axis].max(p[axis]);
            }
        }
        result
    }

    pub fn grown(&self, by: f64) -> Box2 {
        Box2 { low: [self.low[0] - by, self.low[1] - by], high: [self.high[0] + by, self.high[1] + by] }
    }

    /// Length of the longer side of the box.
    pub fn extent(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }

    fn meets(&self, other: &Box2) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.high[axis] && self.high[axis] >= other.low[axis])
    }

    fn distance(&self, p: Point) -> f64 {
        let out = |axis: usize| (self.low[axis] - p[axis]).max(p[axis] - self.high[axis]).max(0.0);
        out(0).hypot(out(1))
    }
}

struct Branch {
    bounds: Box2,
    least_weight: f64,
    from: usize,
    to: usize,
    /// Indices of the two nodes into which this node of the tree is divided; zeros for a leaf.
    halves: [usize; 2],
}

pub struct Tree {
    pub segments: Vec<Segment>,
    branches: Vec<Branch>,
}

const LEAF: usize = 4;

impl Tree {
    pub fn new(segments: Vec<Segment>) -> Tree {
        let mut tree = Tree { segments, branches: Vec::new() };
        if !tree.segments.is_empty() {
            tree.grow(0, tree.segments.len());
        }
        tree
    }

    fn grow(&mut self, from: usize, to: usize) -> usize {
        let part = &mut self.segments[from..to];
        let bounds = Box2::around(part.iter().flat_map(|s| [s.a, s.b]));
        let least_weight = part.iter().map(|s| s.weight).fold(f64::INFINITY, f64::min);
        let own = self.branches.len();
        self.branches.push(Branch { bounds, least_weight, from, to, halves: [0; 2] });
        if to - from > LEAF {
            let axis = usize::from(bounds.high[1] - bounds.low[1] > bounds.high[0] - bounds.low[0]);
            let middle = part.len() / 2;
            part.sort_by(|s, t| (s.a[axis] + s.b[axis]).total_cmp(&(t.a[axis] + t.b[axis])));
            let halves = [self.grow(from, from + middle), self.grow(from + middle, to)];
            self.branches[own].halves = halves;
        }
        own
    }

    /// The smallest weight + slope × distance from p over the segments for which `wanted` is true, if it is less than
    /// `bound`. Returns this value, the segment, and the point of the segment nearest to p.
    pub fn least(
        &self,
        p: Point,
        slope: f64,
        bound: f64,
        wanted: impl Fn(&Segment) -> bool,
    ) -> Option<(f64, &Segment, Point)> {
        let mut best: Option<(f64, &Segment, Point)> = None;
        let mut least = bound;
        let mut open = Vec::with_capacity(32);
        if !self.branches.is_empty() {
            open.push((self.bound(0, p, slope), 0));
        }
        while let Some((lower, at)) = open.pop() {
            if lower >= least {
                continue;
            }
            let branch = &self.branches[at];
            if branch.halves == [0; 2] {
                for segment in self.segments[branch.from..branch.to].iter().filter(|s| wanted(s)) {
                    let near = between(segment.a, segment.b, nearest_share(p, segment.a, segment.b));
                    let value = segment.weight + slope * distance(p, near);
                    if value < least {
                        least = value;
                        best = Some((value, segment, near));
                    }
                }
            } else {
                let mut halves = branch.halves.map(|half| (self.bound(half, p, slope), half));
                if halves[0].0 < halves[1].0 {
                    halves.swap(0, 1);
                }
                open.extend(halves);
            }
        }
        best
    }

    fn bound(&self, at: usize, p: Point, slope: f64) -> f64 {
        self.branches[at].least_weight + slope * self.branches[at].bounds.distance(p)
    }

    /// Calls `take` with each segment whose bounding box meets the box `bounds`.
    pub fn meeting(&self, bounds: &Box2, mut take: impl FnMut(&Segment)) {
        let mut open = Vec::with_capacity(32);
        if !self.branches.is_empty() {
            open.push(0);
        }
        while let Some(at) = open.pop() {
            let branch = &self.branches[at];
            if !branch.bounds.meets(bounds) {
                continue;
            }
            if branch.halves == [0; 2] {
                for segment in &self.segments[branch.from..branch.to] {
                    if Box2::around([segment.a, segment.b]).meets(bounds) {
                        take(segment);
                    }
                }
            } else {
                open.extend(branch.halves);
            }
        }
    }

    /// Whether p is inside the closed loops of the segments for which `wanted` is true. Counts the crossings to the
    /// right of p.
    pub fn encloses(&self, p: Point, wanted: impl Fn(&Segment) -> bool) -> bool {
        let right = Box2 { low: p, high: [f64::INFINITY, p[1]] };
        let mut inside = false;
        self.meeting(&right, |segment| {
            let (a, b) = (segment.a, segment.b);
            if (a[1] > p[1]) != (b[1] > p[1])
                && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                && wanted(segment)
            {
                inside = !inside;
            }
        });
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Tree {
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let side = |i: usize| Segment { a: corners[i], b: corners[(i + 1) % 4], weight: i as f64, owner: i };
        Tree::new((0..4).map(side).collect())
    }

    #[test]
    fn the_least_sum_of_weight_and_distance_is_found() {
        let tree = square();
        let (value, segment, near) = tree.least([3.0, 1.5], 1.0, 9.0, |_| true).unwrap();
        assert_eq!((value, segment.owner, near), (1.5, 0, [3.0, 0.0]));
        let (value, segment, _) = tree.least([3.0, 1.5], 1.0, 9.0, |s| s.owner != 0).unwrap();
        assert_eq!((value, segment.owner), (2.0, 1));
        assert!(tree.least([3.0, 1.5], 1.0, 1.0, |_| true).is_none());
    }

    #[test]
    fn points_in_and_out_of_a_square_are_told_apart() {
        let tree = square();
        for (p, inside) in [([1.0, 1.0], true), ([5.0, 1.0], false), ([-1.0, 0.0], false), ([2.0, 4.5], false)] {
            assert_eq!(tree.encloses(p, |_| true), inside, "{p:?}");
        }
    }
}
