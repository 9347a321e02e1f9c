//! Shape quality of elements, measured by the sines of their corner angles.

use crate::geometry::{Point, cross, dot, sub, turn};
use crate::triangles::NONE;

/// Corners of a quadrilateral, counter-clockwise. A triangle has three corners and then `NONE`.
pub type Corners = [usize; 4];

pub fn count(corners: &Corners) -> usize {
    if corners[3] == NONE { 3 } else { 4 }
}

/// Quality of an element: the smallest sine of its corner angles, for a triangle divided by sin 60°. It is 1 for
/// rectangles and equilateral triangles, and negative if a corner is reentrant.
pub fn quality(corners: &Corners, at: impl Fn(usize) -> Point) -> f64 {
    if corners[3] == NONE {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(at);
        let (u, v, w) = (sub(b, a), sub(c, b), sub(a, c));
        let (u2, v2, w2) = (dot(u, u), dot(v, v), dot(w, w));
        // In a triangle the smallest sine is at the corner between the two longest sides.
        let longest = u2 * v2 * w2 / u2.min(v2).min(w2);
        return cross(u, v) / longest.sqrt() / 0.866_025_403_784_438_6;
    }
    let p = corners.map(at);
    let mut least = f64::INFINITY;
    for i in 0..4 {
        let (u, v) = (sub(p[(i + 1) % 4], p[i]), sub(p[(i + 3) % 4], p[i]));
        least = least.min(cross(u, v) / (dot(u, u) * dot(v, v)).sqrt());
    }
    least
}

/// The smallest corner angle of an element, in degrees.
pub fn least_angle(corners: &Corners, at: impl Fn(usize) -> Point) -> f64 {
    let n = count(corners);
    let mut least = f64::INFINITY;
    for i in 0..n {
        let p = at(corners[i]);
        let (u, v) = (sub(at(corners[(i + 1) % n]), p), sub(at(corners[(i + n - 1) % n]), p));
        least = least.min(cross(u, v).atan2(dot(u, v)).rem_euclid(std::f64::consts::TAU));
    }
    least.to_degrees()
}

pub fn area(corners: &Corners, at: impl Fn(usize) -> Point) -> f64 {
    let [a, b, c] = [at(corners[0]), at(corners[1]), at(corners[2])];
    let first = 0.5 * turn(a, b, c);
    if corners[3] == NONE { first } else { first + 0.5 * turn(a, c, at(corners[3])) }
}
