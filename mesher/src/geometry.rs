//! Points, straight lines and arcs in the plane.

use std::cmp::Ordering;
use std::f64::consts::TAU;

pub type Point = [f64; 2];

pub fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub fn scale(a: Point, by: f64) -> Point {
    [a[0] * by, a[1] * by]
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

pub fn distance(a: Point, b: Point) -> f64 {
    norm(sub(a, b))
}

/// The point a + t (b − a) on the line through a and b.
pub fn between(a: Point, b: Point, t: f64) -> Point {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// Twice the area of the triangle a, b, c; positive if the corners are counter-clockwise.
pub fn turn(a: Point, b: Point, c: Point) -> f64 {
    cross(sub(b, a), sub(c, a))
}

/// The t in [0, 1] for which a + t (b − a) is nearest to p.
pub fn nearest_share(p: Point, a: Point, b: Point) -> f64 {
    let along = sub(b, a);
    let square = dot(along, along);
    if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// The two points nearest to each other, one on the segment ab, one on the segment cd.
pub fn nearest_points(a: Point, b: Point, c: Point, d: Point) -> (Point, Point) {
    if cross_each_other(a, b, c, d) {
        let along = sub(b, a);
        let t = cross(sub(c, a), sub(d, c)) / cross(along, sub(d, c));
        let at = between(a, b, t);
        return (at, at);
    }
    let on = |p: Point, a: Point, b: Point| between(a, b, nearest_share(p, a, b));
    let pairs = [(a, on(a, c, d)), (b, on(b, c, d)), (on(c, a, b), c), (on(d, a, b), d)];
    let mut best = pairs[0];
    for pair in &pairs[1..] {
        if distance(pair.0, pair.1) < distance(best.0, best.1) {
            best = *pair;
        }
    }
    best
}

fn cross_each_other(a: Point, b: Point, c: Point, d: Point) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

/// Centre of the circle through three points. Its coordinates are not finite if the points are collinear.
pub fn circumcentre(a: Point, b: Point, c: Point) -> Point {
    let (u, v) = (sub(b, a), sub(c, a));
    let (uu, vv, area) = (dot(u, u), dot(v, v), 2.0 * cross(u, v));
    add(a, [(v[1] * uu - u[1] * vv) / area, (u[0] * vv - v[0] * uu) / area])
}

/// Lexicographic order of two points, or of two lists of coordinates of equal length.
pub fn order(one: &[f64], other: &[f64]) -> Ordering {
    let unequal = one.iter().zip(other).map(|(a, b)| a.total_cmp(b)).find(|result| result.is_ne());
    unequal.unwrap_or(Ordering::Equal)
}

/// A straight line or an arc between two points.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    pub from: Point,
    pub to: Point,
    round: Option<Round>,
}

#[derive(Clone, Copy, Debug)]
struct Round {
    centre: Point,
    radius: f64,
    start: f64,
    /// Signed central angle of the arc, positive counter-clockwise.
    sweep: f64,
}

impl Curve {
    pub fn straight(from: Point, to: Point) -> Curve {
        Curve { from, to, round: None }
    }

    /// The arc from one point through another to a third. `None` if the points are collinear or two of them coincide.
    pub fn arc(from: Point, through: Point, to: Point) -> Option<Curve> {
        // An arc whose rise over its chord is smaller than this, relative to the chord, counts as a straight line.
        const FLAT: f64 = 1e-7;
        let bend = turn(from, through, to);
        let (a, b, c) = (distance(from, through), distance(through, to), distance(from, to));
        if !(bend.abs() > FLAT * a.max(b).max(c).powi(2) && a.min(b).min(c) > FLAT * a.max(b).max(c)) {
            return None;
        }
        let centre = circumcentre(from, through, to);
        let angle = |p: Point| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let turned = (angle(to) - angle(from)).rem_euclid(TAU);
        let sweep = if bend > 0.0 { turned } else { turned - TAU };
        let round = Round { centre, radius: distance(centre, from), start: angle(from), sweep };
        Some(Curve { from, to, round: Some(round) })
    }

    pub fn is_straight(&self) -> bool {
        self.round.is_none()
    }

    /// Radius of the arc; infinite for a straight line.
    pub fn radius(&self) -> f64 {
        self.round.map_or(f64::INFINITY, |round| round.radius)
    }

    pub fn length(&self) -> f64 {
        self.round.map_or_else(|| distance(self.from, self.to), |round| round.radius * round.sweep.abs())
    }

    /// The point of the curve at the fraction t of its length.
    pub fn at(&self, t: f64) -> Point {
        if t == 0.0 {
            return self.from;
        }
        if t == 1.0 {
            return self.to;
        }
        match self.round {
            None => between(self.from, self.to, t),
            Some(round) => {
                let (sin, cos) = (round.start + t * round.sweep).sin_cos();
                add(round.centre, [round.radius * cos, round.radius * sin])
            }
        }
    }

    /// Unit tangent of the curve at the fraction t of its length.
    pub fn direction(&self, t: f64) -> Point {
        match self.round {
            None => scale(sub(self.to, self.from), 1.0 / distance(self.from, self.to)),
            Some(round) => {
                let (sin, cos) = (round.start + t * round.sweep).sin_cos();
                scale([-sin, cos], round.sweep.signum())
            }
        }
    }

    pub fn reversed(&self) -> Curve {
        let round = self.round.map(|round| Round { start: round.start + round.sweep, sweep: -round.sweep, ..round });
        Curve { from: self.to, to: self.from, round }
    }

    /// The image of the curve under `map`, which rotates the plane by the angle `turned` and translates it.
    pub fn mapped(&self, map: impl Fn(Point) -> Point, turned: f64) -> Curve {
        let round = self.round.map(|round| Round { centre: map(round.centre), start: round.start + turned, ..round });
        Curve { from: map(self.from), to: map(self.to), round }
    }

    /// Fraction of the curve's length at which the curve is nearest to p.
    pub fn nearest(&self, p: Point) -> f64 {
        let Some(round) = self.round else {
            return nearest_share(p, self.from, self.to);
        };
        let angle = (p[1] - round.centre[1]).atan2(p[0] - round.centre[0]);
        let t = ((angle - round.start) * round.sweep.signum()).rem_euclid(TAU) / round.sweep.abs();
        if t <= 1.0 {
            t
        } else if distance(p, self.from) <= distance(p, self.to) {
            0.0
        } else {
            1.0
        }
    }

    /// Fractions of this curve's length at which it meets the segment from a to b, ascending; empty for parallel lines.
    pub fn meets(&self, a: Point, b: Point) -> Vec<f64> {
        let along = sub(b, a);
        let Some(round) = self.round else {
            let own = sub(self.to, self.from);
            let area = cross(own, along);
            if area.abs() <= 1e-9 * norm(own) * norm(along) {
                return Vec::new();
            }
            let (t, s) = (cross(sub(a, self.from), along) / area, cross(sub(a, self.from), own) / area);
            return if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s) { vec![t] } else { Vec::new() };
        };
        let unit = scale(along, 1.0 / norm(along));
        let offset = sub(a, round.centre);
        let (height, foot) = (cross(unit, offset), -dot(unit, offset));
        if height.abs() >= round.radius {
            return Vec::new();
        }
        let half = (round.radius * round.radius - height * height).sqrt();
        let mut result = Vec::new();
        for s in [foot - half, foot + half] {
            if (0.0..=norm(along)).contains(&s) {
                let p = add(a, scale(unit, s));
                let t = self.nearest(p);
                if distance(self.at(t), p) <= 1e-9 * round.radius {
                    result.push(t);
                }
            }
        }
        result.sort_by(f64::total_cmp);
        result
    }

    /// Fractions of this curve's length at which it meets the curve `other`, and the common points; empty for parallel
    /// lines.
    pub fn crossings(&self, other: &Curve) -> Vec<(f64, Point)> {
        let points: Vec<Point> = match (self.round, other.round) {
            (None, _) => other.meets(self.from, self.to).into_iter().map(|t| other.at(t)).collect(),
            (Some(_), None) => self.meets(other.from, other.to).into_iter().map(|t| self.at(t)).collect(),
            (Some(one), Some(two)) => {
                let axis = sub(two.centre, one.centre);
                let apart = norm(axis);
                let foot = 0.5 * (apart + (one.radius - two.radius) * (one.radius + two.radius) / apart);
                let square = one.radius * one.radius - foot * foot;
                // Circles without two common points: `foot` is not finite if they are concentric, `square` is negative
                // if they are separate or nested.
                if !(square > 0.0 && foot.is_finite()) {
                    return Vec::new();
                }
                let along = scale(axis, 1.0 / apart);
                let middle = add(one.centre, scale(along, foot));
                [square.sqrt(), -square.sqrt()].map(|h| add(middle, [-h * along[1], h * along[0]])).to_vec()
            }
        };
        let slack = 1e-9 * self.radius().min(other.radius());
        let on = |curve: &Curve, p: Point| slack.is_infinite() || distance(curve.at(curve.nearest(p)), p) <= slack;
        let those = points.into_iter().filter(|&p| on(self, p) && on(other, p));
        those.map(|p| (self.nearest(p), p)).collect()
    }

    /// The part of the curve between two fractions of its length. `from` and `to` are the exact end points of this
    /// part.
    pub fn part(&self, [begin, end]: [f64; 2], from: Point, to: Point) -> Curve {
        let round = self.round.map(|round| {
            let start = round.start + begin * round.sweep;
            Round { start, sweep: (end - begin) * round.sweep, ..round }
        });
        Curve { from, to, round }
    }

    /// A second common point of this curve and `next`, which begins where this curve ends. `None` without such a point,
    /// or if the point is both the start of this curve and the end of `next`.
    pub fn meets_next(&self, next: &Curve) -> Option<Point> {
        let corner = self.to;
        // The second point is the mirror image of the first in the line through both centres, or, if one curve is
        // straight, in the perpendicular from the centre onto this line.
        let again = match (self.round, next.round) {
            (None, None) => return None,
            (Some(one), Some(other)) => {
                let axis = sub(other.centre, one.centre);
                let off = cross(axis, sub(corner, one.centre)) / dot(axis, axis);
                add(corner, scale([axis[1], -axis[0]], 2.0 * off))
            }
            (Some(round), None) | (None, Some(round)) => {
                let line = if self.round.is_none() { self } else { next };
                let along = line.direction(0.5);
                add(corner, scale(along, 2.0 * dot(sub(round.centre, corner), along)))
            }
        };
        let same = 1e-9 * self.length().max(next.length());
        let on = |curve: &Curve| distance(curve.at(curve.nearest(again)), again) <= same;
        let elsewhere = distance(again, corner) > same;
        let at_far_ends = distance(again, self.from) <= same && distance(again, next.to) <= same;
        (elsewhere && !at_far_ends && on(self) && on(next)).then_some(again)
    }

    /// Points along the curve, including its ends. The chords between them are at most `rise` away from the curve.
    pub fn flattened(&self, rise: f64) -> Vec<Point> {
        let count = match self.round {
            None => 1.0,
            // A full turn has at least twelve chords, so that a small circle does not become a triangle.
            Some(round) => (round.sweep.abs() / (8.0 * rise / round.radius).sqrt().min(TAU / 12.0)).ceil(),
        };
        (0..=count as usize).map(|i| self.at(i as f64 / count)).collect()
    }

    /// Twice the signed area between the curve and the point `about`.
    pub fn moment(&self, about: Point) -> f64 {
        let chord = cross(sub(self.from, about), sub(self.to, about));
        chord + self.round.map_or(0.0, |round| round.radius * round.radius * (round.sweep - round.sweep.sin()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_runs_through_its_three_points() {
        for (through, length) in [([0.0, 1.0], 1.0), ([0.0, -1.0], 1.0)] {
            let arc = Curve::arc([-1.0, 0.0], through, [1.0, 0.0]).unwrap();
            assert!(distance(arc.at(0.5), through) < 1e-14);
            assert!((arc.length() - length * TAU / 2.0).abs() < 1e-14);
            assert!((arc.nearest(scale(through, 3.0)) - 0.5).abs() < 1e-14);
            let back = arc.reversed();
            assert!(distance(back.at(0.25), arc.at(0.75)) < 1e-14);
        }
        assert!(Curve::arc([0.0, 0.0], [1.0, 1e-9], [2.0, 0.0]).is_none());
    }

    #[test]
    fn four_arcs_enclose_the_area_of_a_circle() {
        let corners = [[3.0, 1.0], [2.0, 2.0], [1.0, 1.0], [2.0, 0.0]];
        let area: f64 = (0..4)
            .map(|i| {
                let middle = 0.125 * TAU + i as f64 * 0.25 * TAU;
                let through = [2.0 + middle.cos(), 1.0 + middle.sin()];
                0.5 * Curve::arc(corners[i], through, corners[(i + 1) % 4]).unwrap().moment([0.0; 2])
            })
            .sum();
        assert!((area - 0.5 * TAU).abs() < 1e-13);
    }

    #[test]
    fn a_line_meets_an_arc_where_they_cross() {
        let arc = Curve::arc([-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]).unwrap();
        let met = arc.meets([-2.0, 0.5], [2.0, 0.5]);
        assert_eq!(met.len(), 2);
        assert!(met.iter().all(|&t| (arc.at(t)[1] - 0.5).abs() < 1e-14));
        assert!(arc.meets([-2.0, -0.5], [2.0, -0.5]).is_empty());
    }
}
