//! The outline of a plate and of its holes. Sides are checked and directed so that the plate is on their left.

use crate::geometry::{Curve, Point, cross, distance, dot, nearest_points};
use crate::tree::{Box2, Segment, Tree};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// A closed line: an outline or a hole. Side i runs from corner i to corner i + 1, the last side to the first corner.
#[derive(Clone, Debug, Default)]
pub struct Loop {
    pub corners: Vec<Point>,
    /// For each side, a point on its arc between the corners; `None` for a straight side.
    pub through: Vec<Option<Point>>,
    /// For each side, its name; several sides may have the same name.
    pub names: Vec<String>,
}

/// Reason why no mesh was made, and the side that causes it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshError {
    pub message: String,
    /// Number of the loop (0 is the outline), and number of the side in this loop.
    pub side: Option<(usize, usize)>,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for MeshError {}

#[derive(Clone, Debug)]
pub struct Side {
    /// The curve of the side, with the plate on its left.
    pub curve: Curve,
    pub name: String,
    pub ring: usize,
    /// Number of the side in the loop of the input.
    pub number: usize,
    /// Indices of the sides before and after this side in the loop.
    pub neighbours: [usize; 2],
}

pub struct Outline {
    pub sides: Vec<Side>,
    /// Chords along all sides. The `owner` of a chord is the index of its side.
    pub chords: Tree,
    pub bounds: Box2,
}

/// Smallest length of a side and smallest distance of two sides, relative to the element size. Smaller ones would
/// require thousands of elements.
const NARROW: f64 = 1e-3;
/// Smallest angle at a corner of the outline, in radians (one degree). Elements in a sharper corner would be useless.
const SHARP: f64 = 0.017_452;

/// The sides of all loops, with the plate on their left. The first loop is the outline, all others are holes.
pub fn sides(loops: &[Loop]) -> Result<Vec<Side>, MeshError> {
    let mut sides: Vec<Side> = Vec::new();
    for (ring, given) in loops.iter().enumerate() {
        let count = given.corners.len();
        let first = sides.len();
        for number in 0..count {
            let curve = curve(given, number).map_err(|message| MeshError { message, side: Some((ring, number)) })?;
            sides.push(Side { curve, name: given.names[number].clone(), ring, number, neighbours: [0; 2] });
        }
        let round = area(&sides[first..]);
        if (round > 0.0) != (ring == 0) {
            sides[first..].reverse();
            sides[first..].iter_mut().for_each(|side| side.curve = side.curve.reversed());
        }
        for i in 0..count {
            sides[first + i].neighbours = [first + (i + count - 1) % count, first + (i + 1) % count];
        }
    }
    Ok(sides)
}

/// The area on the left of the sides: that of the outline minus that of the holes.
pub fn area(sides: &[Side]) -> f64 {
    let about = sides[0].curve.from;
    0.5 * sides.iter().map(|side| side.curve.moment(about)).sum::<f64>()
}

impl Outline {
    /// Makes the outline from its sides; `size` is the element size.
    pub fn new(sides: Vec<Side>, size: f64) -> Outline {
        let mut chords = Vec::new();
        for (owner, side) in sides.iter().enumerate() {
            let points = side.curve.flattened(0.1 * NARROW * size);
            chords.extend(points.windows(2).map(|w| Segment { a: w[0], b: w[1], weight: 0.0, owner }));
        }
        let bounds = Box2::around(chords.iter().flat_map(|s| [s.a, s.b]));
        Outline { sides, chords: Tree::new(chords), bounds }
    }

    /// Returns an error unless the outline can be meshed by elements of the given size.
    pub fn require(&self, size: f64) -> Result<(), MeshError> {
        self.require_corners(NARROW * size)?;
        self.require_simple(NARROW * size)?;
        self.require_nested(self.sides.last().map_or(0, |side| side.ring + 1))
    }

    pub fn contains(&self, p: Point) -> bool {
        self.chords.encloses(p, |_| true)
    }

    pub fn are_neighbours(&self, one: usize, other: usize) -> bool {
        self.sides[one].neighbours.contains(&other)
    }

    /// The smallest interior angle at a corner of the outline or of a hole, in degrees.
    pub fn sharpest(&self) -> f64 {
        let inside = |side: &Side| {
            let (inward, onward) = (side.curve.direction(1.0), self.sides[side.neighbours[1]].curve.direction(0.0));
            PI - cross(inward, onward).atan2(dot(inward, onward))
        };
        self.sides.iter().map(inside).fold(TAU, f64::min).to_degrees()
    }

    fn fault(&self, side: usize, message: String) -> MeshError {
        MeshError { message, side: Some((self.sides[side].ring, self.sides[side].number)) }
    }

    fn require_corners(&self, narrow: f64) -> Result<(), MeshError> {
        for (index, side) in self.sides.iter().enumerate() {
            let length = side.curve.length();
            if length < narrow {
                return Err(self.fault(
                    index,
                    format!(
                        "{} is only {} long at {}, less than a thousandth of the element size. Make its two corners \
                         one.",
                        side.name,
                        number(length),
                        place(side.curve.from)
                    ),
                ));
            }
            let (inward, onward) = (side.curve.direction(1.0), self.sides[side.neighbours[1]].curve.direction(0.0));
            if dot(inward, onward) < 0.0 && cross(inward, onward).abs() < SHARP {
                return Err(self.fault(
                    index,
                    format!(
                        "The corner of {} at {} is sharper than one degree: the outline folds back on itself. Leave \
                         the corner out, or blunt it.",
                        self.both(index, side.neighbours[1]),
                        place(side.curve.to)
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Returns an error if sides cross, touch or nearly touch.
    fn require_simple(&self, narrow: f64) -> Result<(), MeshError> {
        let touching = 1e-9 * self.bounds.extent();
        let mut worst: Option<(f64, usize, usize, Point)> = None;
        for (index, side) in self.sides.iter().enumerate() {
            let next = side.neighbours[1];
            if let Some(at) = side.curve.meets_next(&self.sides[next].curve) {
                worst = Some((0.0, index, next, at));
            }
        }
        for one in &self.chords.segments {
            self.chords.meeting(&Box2::around([one.a, one.b]).grown(narrow), |other| {
                if other.owner <= one.owner {
                    return;
                }
                let adjoin = self.are_neighbours(one.owner, other.owner);
                if adjoin && (one.b == other.a || one.a == other.b) {
                    return;
                }
                let (p, q) = nearest_points(one.a, one.b, other.a, other.b);
                let apart = distance(p, q);
                let least = if adjoin { touching } else { narrow.max(touching) };
                let key = (apart, one.owner, other.owner);
                if apart < least && worst.is_none_or(|w| key < (w.0, w.1, w.2)) {
                    worst = Some((apart, one.owner, other.owner, p));
                }
            });
        }
        let Some((apart, one, other, at)) = worst else {
            return Ok(());
        };
        let names = self.both(one, other);
        let message = if apart >= touching {
            format!(
                "{names} come within {} of each other at {}, less than a thousandth of the element size. Move them \
                 apart or join them.",
                number(apart),
                place(at)
            )
        } else if self.sides[one].ring == self.sides[other].ring {
            format!(
                "{names} cross or touch at {}. Give the corners in order around the outline, each once; where two \
                 parts meet in a point or along a line, make them one outline.",
                place(at)
            )
        } else {
            format!(
                "{names} cross or touch at {}. A hole must lie within the plate, away from its outline and from other \
                 holes: let the outline itself run around an opening at the edge, and make holes that meet one hole.",
                place(at)
            )
        };
        let key = |side: usize| (self.sides[side].ring, self.sides[side].number);
        Err(MeshError { message, side: Some(key(one).max(key(other))) })
    }

    /// Returns an error if a hole is outside the outline or inside another hole. Sides must have been checked not to
    /// meet.
    fn require_nested(&self, rings: usize) -> Result<(), MeshError> {
        for (index, side) in self.sides.iter().enumerate() {
            if side.ring == 0 || self.sides[..index].iter().any(|before| before.ring == side.ring) {
                continue;
            }
            let corner = side.curve.from;
            if !self.chords.encloses(corner, |s| self.sides[s.owner].ring == 0) {
                let message = format!(
                    "{} at {} is not inside the outline. Move it into the plate, or leave it out.",
                    side.name,
                    place(corner)
                );
                return Err(self.fault(index, message));
            }
            for ring in (1..rings).filter(|&ring| ring != side.ring) {
                if self.chords.encloses(corner, |s| self.sides[s.owner].ring == ring) {
                    let other = self.sides.iter().find(|s| s.ring == ring).expect("every loop has sides");
                    let message = format!(
                        "{} at {} is inside {}. Leave the inner one out.",
                        side.name,
                        place(corner),
                        other.name
                    );
                    return Err(self.fault(index, message));
                }
            }
        }
        Ok(())
    }

    fn both(&self, one: usize, other: usize) -> String {
        let key = |side: usize| (self.sides[side].ring, self.sides[side].number);
        let (one, other) = if key(one) <= key(other) { (one, other) } else { (other, one) };
        let (one, other) = (&self.sides[one].name, &self.sides[other].name);
        if one == other { format!("Two parts of {one}") } else { format!("{one} and {other}") }
    }
}

fn curve(given: &Loop, number: usize) -> Result<Curve, String> {
    let (from, to) = (given.corners[number], given.corners[(number + 1) % given.corners.len()]);
    let name = &given.names[number];
    match given.through[number] {
        None if from == to => Err(format!("{name} has no length: both its corners are {}. Give it once.", place(from))),
        None => Ok(Curve::straight(from, to)),
        Some(through) => Curve::arc(from, through, to).ok_or_else(|| {
            format!(
                "{name} is no arc: {}, {} and {} are on one line, or two of them are one point. Leave out `through`, \
                 or give a point off the chord.",
                place(from),
                place(through),
                place(to)
            )
        }),
    }
}

/// `value` as text with at most six digits.
pub fn number(value: f64) -> String {
    let short: f64 = format!("{value:.5e}").parse().expect("a number that was written can be read");
    if short != 0.0 && !(1e-5..1e15).contains(&short.abs()) { format!("{short:e}") } else { short.to_string() }
}

pub fn place(p: Point) -> String {
    format!("[{}, {}]", number(p[0]), number(p[1]))
}

/// The angle in [0, π/2) for which the straight sides along it or perpendicular to it have the largest total length.
/// The second value is the angle from there to a second direction of sides, if there is one that is neither near 0° nor
/// near 90°.
pub fn directions(sides: &[Side]) -> (f64, Option<f64>) {
    use std::f64::consts::{FRAC_PI_2, PI};
    // Sides have equal directions if their angles differ by less than this, in radians: the rounding of their corners.
    const SAME: f64 = 1e-6;
    // Cosines of angles between lattice directions: `FLATTEST` of 40°, the smallest allowed angle; `SQUARE` of the
    // smallest angle that counts as 90°.
    const FLATTEST: f64 = 0.766;
    const SQUARE: f64 = 0.01;
    let longest = |period: f64, wanted: &dyn Fn(f64) -> bool| {
        let mut result: Vec<(f64, f64)> = Vec::new();
        for side in sides.iter().filter(|side| side.curve.is_straight()) {
            let [x, y] = side.curve.direction(0.5);
            let angle = y.atan2(x).rem_euclid(period);
            let apart = |a: f64| (a - angle).rem_euclid(period).min((angle - a).rem_euclid(period));
            match result.iter_mut().find(|(other, _)| apart(*other) < SAME) {
                Some((_, length)) => *length += side.curve.length(),
                None if wanted(angle) => result.push((angle, side.curve.length())),
                None => {}
            }
        }
        let mut best: Option<(f64, f64)> = None;
        for (angle, length) in result {
            if best.is_none_or(|(_, most)| length > most * (1.0 + SAME)) {
                best = Some((angle, length));
            }
        }
        best.map(|(angle, _)| angle)
    };
    let first = longest(FRAC_PI_2, &|_| true).unwrap_or(0.0);
    // If the sides are along the axes except for rounding, the plate is not rotated.
    let first = if (1e-12..FRAC_PI_2 - 1e-12).contains(&first) { first } else { 0.0 };
    let slant = |angle: f64| (angle - first).cos().abs();
    let second = longest(PI, &|angle| slant(angle) > SQUARE && slant(angle) < FLATTEST);
    (first, second.map(|angle| (angle - first).rem_euclid(PI)))
}

/// The point p rotated about the origin by an angle with the given cosine and sine.
pub fn turned(p: Point, [cos, sin]: [f64; 2]) -> Point {
    let [x, y] = p;
    [cos * x - sin * y, sin * x + cos * y]
}
