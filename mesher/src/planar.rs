//! Divides the sides of the outline, and the lines that element sides follow, into pieces between vertices: the points
//! where sides and lines meet.

use crate::geometry::{Curve, Point, cross, distance, dot, order, scale};
use crate::outline::Outline;
use crate::sizes::Sizes;

/// A piece: the part of a curve between two consecutive vertices.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub curve: Curve,
    /// Fractions of the curve's length at which the piece begins and at which it ends.
    pub span: [f64; 2],
    pub ends: [usize; 2],
    pub of: Source,
}

/// The curve that a piece is part of, with its number: a side of the outline, or a line within the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    Side(usize),
    Line(usize),
}

impl Source {
    pub fn is_side(self) -> bool {
        matches!(self, Source::Side(_))
    }
}

/// A side of the outline, or a line that element sides follow, with the vertices on it.
struct Track {
    curve: Curve,
    of: Source,
    /// Vertices on the curve: (fraction of the curve's length, number of the vertex).
    cuts: Vec<(f64, usize)>,
}

pub struct Planar<'a> {
    outline: &'a Outline,
    sizes: &'a Sizes,
    vertices: Vec<Point>,
    tracks: Vec<Track>,
    /// Largest distance of two points that count as equal.
    same: f64,
}

/// Smallest distance of a line that element sides follow from other lines and vertices, relative to the element size.
pub const NEAR: f64 = 0.55;
/// Sine of the smallest angle (25°) between a line that element sides follow and the curve at which the line ends.
const SLANT: f64 = 0.42;

/// Number of sample points per length `NEAR` · element size, along a line that element sides are to follow.
const STATIONS: f64 = 4.0;

/// Begin or end of a part of a line that is being added; `share` is the fraction of the line's length.
#[derive(Clone, Copy)]
struct Stop {
    share: f64,
    at: Point,
    vertex: Option<usize>,
}

impl<'a> Planar<'a> {
    pub fn new(outline: &'a Outline, sizes: &'a Sizes) -> Planar<'a> {
        let same = 1e-9 * outline.bounds.extent();
        let mut tracks = Vec::new();
        for (index, side) in outline.sides.iter().enumerate() {
            let cuts = vec![(0.0, index), (1.0, side.neighbours[1])];
            tracks.push(Track { curve: side.curve, of: Source::Side(index), cuts });
        }
        let vertices = outline.sides.iter().map(|side| side.curve.from).collect();
        Planar { outline, sizes, vertices, tracks, same }
    }

    /// Makes element sides follow the part of a line that is inside the plate, if it is far enough from all other lines
    /// and vertices. If `in_part`, they follow those parts of the line that are far enough.
    pub fn follow_curve(&mut self, number: usize, line: &Curve, in_part: bool) {
        let length = line.length();
        if !(length > self.same) {
            return;
        }
        let mut shares = vec![0.0, 1.0];
        for side in &self.outline.sides {
            shares.extend(line.crossings(&side.curve).iter().map(|&(share, _)| share));
            let share = line.nearest(side.curve.from);
            if distance(line.at(share), side.curve.from) <= self.same {
                shares.push(share);
            }
        }
        shares.sort_by(f64::total_cmp);
        shares.dedup_by(|t, s| (*t - *s) * length <= self.same);
        for w in shares.windows(2) {
            let middle = line.at(0.5 * (w[0] + w[1]));
            if self.outline.contains(middle) && !self.is_on_outline(middle) {
                self.follow(number, &line.part([w[0], w[1]], line.at(w[0]), line.at(w[1])), in_part);
            }
        }
    }

    /// Makes the point p a vertex if p is in the plate and far enough from vertices and lines.
    pub fn follow_point(&mut self, p: Point) {
        let on = self.track_at(p);
        if !(on.is_some() || self.outline.contains(p)) || self.vertex_at(p).is_some() || !self.has_room(p) {
            return;
        }
        self.vertices.push(p);
        if let Some(track) = on {
            let t = self.tracks[track].curve.nearest(p);
            self.tracks[track].cuts.push((t, self.vertices.len() - 1));
        }
    }

    /// The vertices, and the pieces between them. A vertex without a piece is a point from `follow_point`.
    pub fn finish(mut self) -> (Vec<Point>, Vec<Piece>) {
        // Vertices are numbered by their coordinates, so that the order in which lines were added has no effect.
        let sides = self.outline.sides.len();
        let mut result: Vec<usize> = (0..self.vertices.len()).collect();
        result[sides..].sort_by(|&one, &other| order(&self.vertices[one], &self.vertices[other]));
        let mut number = vec![0; result.len()];
        result.iter().enumerate().for_each(|(new, &old)| number[old] = new);
        let vertices = result.iter().map(|&old| self.vertices[old]).collect();
        let places = |Track { curve, .. }: &Track| [curve.from, curve.at(0.5), curve.to];
        self.tracks[sides..].sort_by(|one, other| order(places(one).as_flattened(), places(other).as_flattened()));
        let mut pieces = Vec::new();
        for track in &mut self.tracks {
            track.cuts.sort_by(|s, t| s.0.total_cmp(&t.0));
            for w in track.cuts.windows(2) {
                pieces.push(Piece {
                    curve: track.curve,
                    span: [w[0].0, w[1].0],
                    ends: [w[0].1, w[1].1].map(|vertex| number[vertex]),
                    of: track.of,
                });
            }
        }
        (vertices, pieces)
    }

    fn follow(&mut self, number: usize, line: &Curve, in_part: bool) {
        let mut stops: Vec<Stop> = Vec::new();
        for (share, at) in [(0.0, line.from), (1.0, line.to)] {
            stops.push(Stop { share, at, vertex: self.vertex_at(at) });
        }
        for (vertex, &at) in self.vertices.iter().enumerate() {
            let share = line.nearest(at);
            if distance(line.at(share), at) <= self.same {
                stops.push(Stop { share, at, vertex: Some(vertex) });
            }
        }
        for track in &self.tracks {
            let met = line.crossings(&track.curve);
            stops.extend(met.into_iter().map(|(share, at)| Stop { share, at, vertex: self.vertex_at(at) }));
        }
        // Stops (ends of parts of the line) at equal points become one stop. It has a vertex if one of them has.
        stops.sort_by(|s, t| s.share.total_cmp(&t.share));
        let mut merged: Vec<Stop> = Vec::new();
        for stop in stops {
            match merged.last_mut() {
                Some(last) if distance(last.at, stop.at) <= 2.0 * self.same => {
                    last.vertex = last.vertex.or(stop.vertex);
                }
                _ => merged.push(stop),
            }
        }
        let stretches =
            merged.windows(2).map(|w| ([w[0], w[1]], line.part([w[0].share, w[1].share], w[0].at, w[1].at)));
        let fresh: Vec<([Stop; 2], Curve)> =
            stretches.filter(|(_, part)| self.track_at(part.at(0.5)).is_none()).collect();
        let fresh = if in_part {
            fresh.iter().flat_map(|(ends, part)| self.with_room(ends, part)).collect()
        } else if fresh.iter().all(|(ends, part)| self.may_follow(ends, part)) {
            fresh
        } else {
            Vec::new()
        };
        for (ends, part) in fresh {
            let ends = ends.map(|stop| self.vertex(stop.at));
            let curve = part.part([0.0, 1.0], self.vertices[ends[0]], self.vertices[ends[1]]);
            self.tracks.push(Track { curve, of: Source::Line(number), cuts: vec![(0.0, ends[0]), (1.0, ends[1])] });
        }
    }

    /// The parts of a line that element sides may follow: the whole line, or the parts that are far enough from other
    /// lines and vertices.
    fn with_room(&self, ends: &[Stop; 2], stretch: &Curve) -> Vec<([Stop; 2], Curve)> {
        if self.may_follow(ends, stretch) {
            return vec![(*ends, *stretch)];
        }
        let near = |at: Point| NEAR * self.sizes.at(at);
        let least = [0.0, 0.5, 1.0].map(|t| near(stretch.at(t))).into_iter().fold(f64::INFINITY, f64::min);
        let count = (STATIONS * stretch.length() / least).ceil() as usize;
        let at = |i: usize| stretch.at(i as f64 / count as f64);
        let clear: Vec<bool> = (0..=count).map(|i| self.has_room(at(i))).collect();
        let stop = |i: usize| Stop { share: i as f64 / count as f64, at: at(i), vertex: None };
        let mut parts: Vec<([Stop; 2], Curve)> = Vec::new();
        let mut begin = 0;
        while let Some(first) = (begin..=count).find(|&i| {
            clear[i]
                && parts.last().is_none_or(|(ends, _): &([Stop; 2], Curve)| distance(ends[1].at, at(i)) >= near(at(i)))
        }) {
            let last = (first..=count).take_while(|&i| clear[i]).last().unwrap_or(first);
            // If only sample points at an end of the line are too near to other lines, the part up to this end is tried
            // first.
            let from =
                if parts.is_empty() { vec![Stop { share: 0.0, ..ends[0] }, stop(first)] } else { vec![stop(first)] };
            let to = if clear[last..].iter().skip(1).any(|&c| c) {
                vec![stop(last)]
            } else {
                vec![Stop { share: 1.0, ..ends[1] }, stop(last)]
            };
            let tried = from.iter().flat_map(|f| to.iter().map(move |t| [*f, *t]));
            let part = |[f, t]: [Stop; 2]| ([f, t], stretch.part([f.share, t.share], f.at, t.at));
            parts.extend(tried.map(part).find(|(ends, part)| self.may_follow(ends, part)));
            begin = last + 1;
        }
        parts
    }

    /// The number of the vertex at a point. If no vertex is there, one is added, also to the side or line through the
    /// point.
    fn vertex(&mut self, at: Point) -> usize {
        if let Some(vertex) = self.vertex_at(at) {
            return vertex;
        }
        let vertex = self.vertices.len();
        if let Some(track) = self.track_at(at) {
            let t = self.tracks[track].curve.nearest(at);
            self.tracks[track].cuts.push((t, vertex));
        }
        self.vertices.push(at);
        vertex
    }

    fn may_follow(&self, [from, to]: &[Stop; 2], part: &Curve) -> bool {
        let near = |at: Point| NEAR * self.sizes.at(at);
        if part.length() < near(part.at(0.5)) {
            return false;
        }
        for stop in [from, to] {
            if stop.vertex.is_none() && !self.has_room(stop.at) {
                return false;
            }
        }
        // Two straight lines that do not cross are nearest at an end of one of them, so only arcs are sampled in
        // between.
        let stations = if part.is_straight() { 0 } else { (4.0 * part.length() / near(part.at(0.5))).ceil() as usize };
        let apart = self.vertices.iter().all(|&v| {
            let off = distance(v, part.at(part.nearest(v)));
            off >= near(v) || distance(v, from.at) <= 2.0 * self.same || distance(v, to.at) <= 2.0 * self.same
        }) && (1..stations)
            .map(|i| part.at(i as f64 / stations as f64))
            .all(|at| distance(at, from.at).min(distance(at, to.at)) < near(at) || self.is_clear(at, near(at)));
        apart
            && [(from.at, part.direction(0.0)), (to.at, scale(part.direction(1.0), -1.0))].into_iter().all(
                |(at, onward)| {
                    self.tracks.iter().all(|track| {
                        let t = track.curve.nearest(at);
                        if distance(track.curve.at(t), at) > 2.0 * self.same {
                            return true;
                        }
                        let direction = track.curve.direction(t);
                        let steep = cross(direction, onward).abs() >= SLANT;
                        // The smallest angle does not apply to a line or side that the new line continues beyond the
                        // end.
                        let length = track.curve.length();
                        steep
                            || (t * length <= 2.0 * self.same && dot(direction, onward) < 0.0)
                            || ((1.0 - t) * length <= 2.0 * self.same && dot(direction, onward) > 0.0)
                    })
                },
            )
    }

    /// Whether a new vertex is far enough from all vertices, and from all sides and lines that do not pass through it.
    fn has_room(&self, at: Point) -> bool {
        let near = NEAR * self.sizes.at(at);
        self.vertices.iter().all(|&v| distance(v, at) >= near) && self.is_clear(at, near)
    }

    /// Whether the point `at` is at least `near` away from all sides and lines that do not pass through it.
    fn is_clear(&self, at: Point, near: f64) -> bool {
        self.tracks.iter().all(|track| {
            let off = distance(track.curve.at(track.curve.nearest(at)), at);
            off <= self.same || off >= near
        })
    }

    fn vertex_at(&self, p: Point) -> Option<usize> {
        self.vertices.iter().position(|&v| distance(v, p) <= self.same)
    }

    fn track_at(&self, p: Point) -> Option<usize> {
        self.tracks.iter().position(|track| distance(track.curve.at(track.curve.nearest(p)), p) <= self.same)
    }

    fn is_on_outline(&self, p: Point) -> bool {
        self.track_at(p).is_some_and(|track| self.tracks[track].of.is_side())
    }
}
