//! Laws of contact points as monotone graphs r(s): a nondecreasing polyline of force r over travel s (Moreau 1965;
//! Rockafellar 1970, section 24).
//!
//! A point that is open or yields is on a horizontal piece of its graph, a point in rigid contact on a vertical piece.
//! The state of a point is the index of its piece. The equations of a state need only the lines of these pieces.

use std::fmt;

/// The travel at which a piece has no force is a difference of two terms. It counts as zero if it is smaller than this,
/// relative to one of the terms.
const DRAWN: f64 = 1e-12;

/// The law of a contact point: a nondecreasing polyline of force r over travel s.
///
/// ```
/// use signorini_core::contact::Graph;
/// let soil = Graph::new(vec![[0.0, 0.0], [0.01, 5.0]], [0.0, 0.0]).unwrap(); // it crushes at 5
/// assert_eq!((soil.pieces(), soil.piece(1).slope), (3, 500.0));
/// assert!(Graph::new(vec![[0.0, 0.0], [0.01, -5.0]], [0.0, 0.0]).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Vertices [s, r], at least one. If the graph has one piece, its line passes through the only vertex.
    vertices: Vec<[f64; 2]>,
    /// Pieces of the polyline, in order of increasing travel.
    pieces: Vec<Piece>,
}

/// The line of a piece: r − `force` = `slope` (s − `travel`), or s = `travel` where the slope is infinite. (`travel`,
/// `force`) is the point of the piece with r = 0, if the piece has such a point. Small forces then keep their digits
/// even if the law has a large limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    pub travel: f64,
    pub force: f64,
    pub slope: f64,
}

/// Reasons why a polyline is not a valid law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphError {
    NoVertex,
    NotFinite,
    /// The vertex with this index has less travel or less force than the vertex before it, or equals it.
    Falls(usize),
    /// The slope before the first or after the last vertex is negative.
    NegativeSlope,
    /// The graph has more pieces than a `u8` can number.
    TooManyPieces,
}

impl fmt::Display for GraphError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoVertex => write!(f, "a law needs at least one vertex"),
            Self::NotFinite => write!(f, "a law's vertices must be finite, and its slopes must not be NaN"),
            Self::Falls(vertex) => write!(f, "a law must not fall, but it does at vertex {vertex}"),
            Self::NegativeSlope => write!(f, "a law's slopes must not be negative"),
            Self::TooManyPieces => write!(f, "a law has at most {} pieces", u8::MAX),
        }
    }
}

impl std::error::Error for GraphError {}

impl Graph {
    /// Makes the graph through `vertices` [s, r]. `ends` has the slope before the first vertex and the slope after the
    /// last.
    pub fn new(vertices: Vec<[f64; 2]>, ends: [f64; 2]) -> Result<Self, GraphError> {
        if vertices.is_empty() {
            return Err(GraphError::NoVertex);
        }
        if vertices.len() >= usize::from(u8::MAX) {
            return Err(GraphError::TooManyPieces);
        }
        if vertices.iter().flatten().any(|value| !value.is_finite()) || ends.iter().any(|slope| slope.is_nan()) {
            return Err(GraphError::NotFinite);
        }
        if ends.iter().any(|&slope| slope < 0.0) {
            return Err(GraphError::NegativeSlope);
        }
        let falls = |pair: &[[f64; 2]]| pair[1][0] < pair[0][0] || pair[1][1] < pair[0][1] || pair[0] == pair[1];
        if let Some(before) = vertices.windows(2).position(falls) {
            return Err(GraphError::Falls(before + 1));
        }
        let inner = vertices.windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        let slopes = std::iter::once(ends[0]).chain(inner).chain([ends[1]]).collect();
        Ok(Self::of(vertices, slopes))
    }

    /// Makes a one-sided law: r = 0 for s ≤ 0, r = `stiffness` s for s > 0. An infinite stiffness is rigid contact.
    pub fn one_sided(stiffness: f64) -> Self {
        Self::of(vec![[0.0, 0.0]], vec![0.0, stiffness])
    }

    /// Makes the linear law r = `stiffness` s, which has a single piece.
    pub fn two_sided(stiffness: f64) -> Self {
        Self::of(vec![[0.0, 0.0]], vec![stiffness])
    }

    fn of(vertices: Vec<[f64; 2]>, slopes: Vec<f64>) -> Self {
        let line = |(number, &slope): (usize, &f64)| {
            let [travel, force] = vertices[number.saturating_sub(1)];
            let is_last = number + 1 == slopes.len();
            let has_none = (number == 0 || force <= 0.0) && (is_last || vertices[number][1] >= 0.0);
            if !(slope > 0.0 && has_none) {
                return Piece { travel, force, slope };
            }
            let (base, back) = match vertices.get(number).filter(|_| number > 0 && slope.is_finite()) {
                // The piece's line has r = 0 at s = `base` − `back`. Each of the two is a multiple of the travel of one
                // vertex, so that their difference is exactly zero for vertices symmetric about the origin.
                Some(&[next, above]) => (travel * (above / (above - force)), next * (force / (above - force))),
                None => (travel, force / slope),
            };
            let is_none = (base - back).abs() <= DRAWN * base.abs();
            Piece { travel: if is_none { 0.0 } else { base - back }, force: 0.0, slope }
        };
        let pieces = slopes.iter().enumerate().map(line).collect();
        Self { vertices, pieces }
    }

    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// Whether the law is linear: its graph has a single piece, so that the state of the point never changes.
    pub fn is_straight(&self) -> bool {
        self.pieces.len() == 1
    }

    pub fn piece(&self, number: u8) -> Piece {
        self.pieces[usize::from(number)]
    }

    /// Lower and upper end [s, r] of piece `number`; an end is `None` where the piece is unbounded.
    pub fn ends(&self, number: u8) -> [Option<[f64; 2]>; 2] {
        if self.is_straight() {
            return [None, None];
        }
        let number = usize::from(number);
        [number.checked_sub(1).map(|at| self.vertices[at]), self.vertices.get(number).copied()]
    }

    /// Index of the steepest piece; the first of these if several are equally steep.
    pub fn steepest(&self) -> u8 {
        let steeper = |most: usize, at: usize| if self.pieces[at].slope > self.pieces[most].slope { at } else { most };
        (1..self.pieces.len()).fold(0, steeper) as u8
    }

    /// Index of the piece at the augmented travel s + σr: travel s, force r, augmentation compliance σ = `compliance`.
    pub fn piece_at(&self, compliance: f64, augmented_travel: f64) -> u8 {
        if self.is_straight() {
            return 0;
        }
        self.vertices.iter().take_while(|[travel, force]| augmented_travel > travel + compliance * force).count() as u8
    }

    /// Force r at the augmented travel s + σr (travel s, augmentation compliance σ = `compliance`), and the derivative
    /// of r with respect to s + σr. This is the Yosida regularization of the graph.
    pub fn force_at(&self, compliance: f64, augmented_travel: f64) -> (f64, f64) {
        let piece = self.piece(self.piece_at(compliance, augmented_travel));
        let slope = piece.in_series(compliance);
        (piece.force + slope * (augmented_travel - piece.travel - compliance * piece.force), slope)
    }
}

impl Piece {
    /// Whether the slope of the piece is positive, so that the force depends on the travel.
    pub fn holds(self) -> bool {
        self.slope > 0.0
    }

    /// Compliance 1/slope of the piece; 0 for rigid and for horizontal pieces.
    pub fn compliance(self) -> f64 {
        if self.slope > 0.0 { 1.0 / self.slope } else { 0.0 }
    }

    /// Stiffness of the piece in series with a compliance: 1/(1/slope + compliance).
    pub fn in_series(self, compliance: f64) -> f64 {
        if self.slope == 0.0 { 0.0 } else { 1.0 / (1.0 / self.slope + compliance) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_regularized_graph_is_the_graph_in_series_with_a_spring() {
        // The pieces of this law are, in order: open, elastic, rigid, yielding.
        let graph = Graph::new(vec![[0.0, 0.0], [1.0, 2.0], [1.0, 5.0]], [0.0, 0.0]).unwrap();
        let compliance = 0.1;
        for (augmented_travel, number, force, slope) in
            [(-1.0, 0, 0.0, 0.0), (0.6, 1, 1.0, 1.0 / 0.6), (1.3, 2, 3.0, 10.0), (9.0, 3, 5.0, 0.0)]
        {
            assert_eq!(graph.piece_at(compliance, augmented_travel), number);
            let result = graph.force_at(compliance, augmented_travel);
            assert!(
                (result.0 - force).abs() < 1e-12 && (result.1 - slope).abs() < 1e-12,
                "{augmented_travel}: {result:?}"
            );
        }
    }

    #[test]
    fn a_piece_is_measured_from_where_it_has_no_force() {
        let both = Graph::new(vec![[-1.0, -1e6], [1.0, 1e6]], [0.0, 0.0]).unwrap();
        assert_eq!([0, 1, 2].map(|number| both.piece(number).force), [-1e6, 0.0, 1e6]);
        assert_eq!(both.force_at(0.0, 1e-300).0, 1e-294);
        let drawn = Graph::new(vec![[-6.02e-5, -12670.0], [6.02e-5, 12670.0]], [0.0, 0.0]).unwrap();
        assert_eq!(drawn.piece(1).travel, 0.0);
        let through = Graph::new(vec![[-0.00071, -37.701], [0.00028, 14.868]], [0.0, 1.0]).unwrap();
        assert_eq!(through.piece(1).travel, 0.0);
        let rigid = Graph::new(vec![[0.0, -5.0], [0.0, 5.0]], [0.0, 0.0]).unwrap();
        assert_eq!(rigid.piece(1), Piece { travel: 0.0, force: 0.0, slope: f64::INFINITY });
        let bent = Graph::new(vec![[-1.0, -3.0], [1.0, 1.0], [2.0, 5.0]], [1.0, 4.0]).unwrap();
        assert_eq!([0, 1, 2, 3].map(|number| bent.piece(number).force), [-3.0, 0.0, 1.0, 5.0]);
        assert_eq!(bent.piece(1).travel, 0.5);
    }

    #[test]
    fn what_is_no_law_is_refused() {
        let of = |vertices: &[[f64; 2]], ends| Graph::new(vertices.to_vec(), ends).unwrap_err();
        assert_eq!(of(&[], [0.0, 1.0]), GraphError::NoVertex);
        assert_eq!(of(&[[0.0, f64::NAN]], [0.0, 1.0]), GraphError::NotFinite);
        assert_eq!(of(&[[0.0, 0.0], [1.0, -1.0]], [0.0, 1.0]), GraphError::Falls(1));
        assert_eq!(of(&[[0.0, 0.0]], [0.0, -1.0]), GraphError::NegativeSlope);
    }
}
