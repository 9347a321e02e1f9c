//! Local element sizes, from the given size, refinements, short sides, arcs and narrow parts of the plate.

use crate::geometry::{Point, between, cross, distance, sub};
use crate::outline::Outline;
use crate::tree::{Box2, Segment, Tree};
use std::f64::consts::TAU;

/// A refinement: elements along the straight line from `from` to `to` have at most the size `size`. If both points are
/// equal, the refinement is at this point.
#[derive(Clone, Copy, Debug)]
pub struct Refinement {
    pub from: Point,
    pub to: Point,
    pub size: f64,
}

pub struct Sizes {
    pub largest: f64,
    finer: Tree,
}

/// Increase of the element size per unit of distance. Sizes of neighbouring elements then differ by at most a factor of
/// 1.3.
const GROWTH: f64 = 0.25;
/// Smallest number of elements along a full circle.
const AROUND: f64 = 12.0;

impl Sizes {
    pub fn new(outline: &Outline, largest: f64, refinements: &[Refinement]) -> Sizes {
        let mut finer: Vec<Segment> = refinements
            .iter()
            .filter(|r| r.size < largest)
            .map(|r| Segment { a: r.from, b: r.to, weight: r.size, owner: 0 })
            .collect();
        for (index, side) in outline.sides.iter().enumerate() {
            let points = side.curve.flattened(1e-2 * largest);
            let own = side.curve.length().min(TAU / AROUND * side.curve.radius());
            for w in points.windows(2) {
                if own < largest {
                    finer.push(Segment { a: w[0], b: w[1], weight: own, owner: 0 });
                }
                narrow(outline, index, w[0], w[1], largest, &mut finer);
            }
        }
        Sizes { largest, finer: Tree::new(finer) }
    }

    pub fn at(&self, p: Point) -> f64 {
        self.finer.least(p, GROWTH, self.largest, |_| true).map_or(self.largest, |(size, ..)| size)
    }

    /// Approximate number of elements of the mesh. Counting stops above `most`.
    pub fn count(&self, outline: &Outline, most: f64) -> f64 {
        let Box2 { low, high } = outline.bounds;
        let mut sum = 0.0;
        let mut open = vec![(low, high)];
        while let Some((low, high)) = open.pop().filter(|_| sum <= most) {
            let middle = between(low, high, 0.5);
            let size = self.at(middle);
            let wide = sub(high, low);
            let cells = wide[0] / size * (wide[1] / size);
            // The number of elements in a box is its area over the squared element size at its middle. This is exact
            // enough in boxes at most eight elements wide, and in boxes with few elements if the element size is
            // constant.
            if wide[0].max(wide[1]) <= 8.0 * size || (!self.is_graded() && cells < 1e-4 * most) {
                sum += if outline.contains(middle) { cells } else { 0.0 };
            } else if wide[0] > wide[1] {
                open.extend([(low, [middle[0], high[1]]), ([middle[0], low[1]], high)]);
            } else {
                open.extend([(low, [high[0], middle[1]]), ([low[0], middle[1]], high)]);
            }
        }
        sum
    }

    /// Whether elements must be smaller than the largest size somewhere in the plate.
    pub fn is_graded(&self) -> bool {
        !self.finer.segments.is_empty()
    }

    /// Numbers of elements, ascending, from the begin of a curve to each of equally spaced points on it. `at(t)` is the
    /// point of the curve at t in [0, 1].
    pub fn counts(&self, at: impl Fn(f64) -> Point, length: f64) -> Vec<f64> {
        let stations = (4.0 * length / self.least_along(&at)).ceil().clamp(4.0, 1e6) as usize;
        let step = length / stations as f64;
        let mut sum = 0.0;
        let mut counts = vec![0.0];
        for i in 0..stations {
            sum += step / self.at(at((i as f64 + 0.5) / stations as f64));
            counts.push(sum);
        }
        counts
    }

    fn least_along(&self, at: &impl Fn(f64) -> Point) -> f64 {
        (0..=16).map(|i| self.at(at(f64::from(i) / 16.0))).fold(f64::INFINITY, f64::min)
    }
}

/// Limits the element size along the chord ab to the width of the plate there, if the opposite outline is near.
fn narrow(outline: &Outline, side: usize, a: Point, b: Point, largest: f64, finer: &mut Vec<Segment>) {
    let (middle, length) = (between(a, b, 0.5), distance(a, b));
    let other = |s: &Segment| s.owner != side && !outline.are_neighbours(side, s.owner);
    let Some((width, _, near)) = outline.chords.least(middle, 1.0, largest + 0.5 * length, other) else {
        return;
    };
    if length > width {
        narrow(outline, side, a, middle, largest, finer);
        narrow(outline, side, middle, b, largest, finer);
    } else if width < largest && cross(sub(b, a), sub(near, middle)) > 0.0 {
        finer.push(Segment { a, b, weight: width, owner: 0 });
    }
}
