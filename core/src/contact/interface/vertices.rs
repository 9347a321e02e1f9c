//! The vertices of the laws of contact points. Each vertex is a row of the linear complementarity problem (LCP).

use crate::contact::graph::Piece;
use crate::contact::points::Points;

/// The rows of the LCP: one for each vertex of the law of each contact point. A row describes the motion of a point
/// past this vertex, away from its first piece.
pub struct Vertices {
    /// The k rows. First are rows whose unknown z is the gap of a point that starts in contact, then rows whose z is the
    /// reaction of a point that starts open, then rows of all other vertices.
    pub rows: Vec<VertexRow>,
    /// For each point (m,), the number of its first piece: the piece of the law on which it starts in the LCP.
    pub(super) base: Vec<u8>,
}

/// A row of the LCP: one vertex of the law of one contact point.
#[derive(Clone, Copy, Debug)]
pub struct VertexRow {
    pub point: usize,
    vertex: u8,
    /// Whether the vertex lies above the first piece of its law, at larger travel or force.
    pub(super) upward: bool,
    /// The row of the next vertex towards the first piece of the law; `None` if the vertex is an end of the first
    /// piece.
    pub(super) before: Option<usize>,
    pub(super) kind: Kind,
}

/// Kind of the unknown z of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The unknown z is the gap of a point that starts in contact.
    Gap,
    /// The unknown z is the reaction of a point that starts open.
    Reaction,
    Other,
}

impl VertexRow {
    /// Whether w of the row is a force. It is if the force depends on the travel on the piece just before the vertex,
    /// seen from the first piece of the law.
    pub fn w_is_a_force(&self, points: &Points) -> bool {
        points.piece(self.point, if self.upward { self.vertex } else { self.vertex + 1 }).holds()
    }

    /// Whether the vertex is an end of the first piece of its law.
    pub(super) fn is_next(&self) -> bool {
        self.before.is_none()
    }

    /// Whether the unknown z of the row is a gap.
    pub fn gap_is_z(&self) -> bool {
        self.kind == Kind::Gap
    }

    pub(super) fn sign(&self) -> f64 {
        if self.upward { 1.0 } else { -1.0 }
    }
}

impl Vertices {
    /// The contact state (pieces of the laws, (m,)) for a basis (k,) of the LCP, which is true where z is basic.
    pub fn pieces(&self, basis: &[bool]) -> Vec<u8> {
        let mut pieces = self.base.clone();
        for (row, _) in self.rows.iter().zip(basis).filter(|(_, basic)| **basic) {
            if row.upward {
                pieces[row.point] += 1;
            } else {
                pieces[row.point] -= 1;
            }
        }
        pieces
    }

    /// The basis (k,) of the LCP, true where z is basic, for a contact state `pieces` (m,).
    pub fn basis(&self, pieces: &[u8]) -> Vec<bool> {
        let passed = |row: &VertexRow| {
            if row.upward { pieces[row.point] > row.vertex } else { pieces[row.point] <= row.vertex }
        };
        self.rows.iter().map(passed).collect()
    }

    /// Number of LCP rows whose z is a gap; these are the first rows.
    pub(super) fn gaps(&self) -> usize {
        self.rows.iter().filter(|row| row.kind == Kind::Gap).count()
    }

    /// Number of LCP rows whose z is a gap or a reaction; the rows of further vertices follow.
    pub(super) fn paired(&self) -> usize {
        self.rows.iter().filter(|row| row.kind != Kind::Other).count()
    }

    /// Force (m,) of each point on the first piece of its law at z = 0 and w = 0 in the LCP.
    pub(super) fn reference_forces(&self, points: &Points) -> Vec<f64> {
        let force = |i: usize| match (points.is_straight(i), points.piece(i, self.base[i]).holds()) {
            (false, true) => points.ends(i, self.base[i])[0].map_or(0.0, |end| end[1]),
            (false, false) => points.piece(i, self.base[i]).force,
            (true, _) => 0.0,
        };
        (0..points.len()).map(force).collect()
    }

    /// For each point the first piece of whose law is between two horizontal pieces: (row of the upper end, row of the
    /// lower end, length of the piece in force).
    pub(super) fn mirrored(&self, points: &Points) -> Vec<(usize, usize, f64)> {
        let upper = self.rows.iter().enumerate().filter(|(_, row)| {
            let flat = row.upward && !points.piece(row.point, row.vertex + 1).holds();
            flat && row.before.is_none() && points.piece(row.point, self.base[row.point]).holds()
        });
        let pair = |(at, row): (usize, &VertexRow)| {
            let lower = self.rows[..self.gaps()].iter().position(|other| other.point == row.point)?;
            let [low, high] = points.ends(row.point, self.base[row.point]);
            Some((at, lower, high?[1] - low?[1]))
        };
        upper.filter_map(pair).collect()
    }
}

impl Vertices {
    pub(super) fn of(points: &Points, base: Vec<u8>) -> Self {
        let mut rows = [Vec::new(), Vec::new(), Vec::new()];
        for i in 0..points.len() {
            let (graph, number) = (points.graph(i), base[i]);
            if graph.is_straight() {
                continue;
            }
            let holds = graph.piece(number).holds();
            for vertex in 0..graph.pieces() as u8 - 1 {
                let upward = vertex >= number;
                let is_next = vertex == number || vertex + 1 == number;
                let beyond = graph.piece(if upward { vertex + 1 } else { vertex });
                let kind = match (is_next, holds, upward) {
                    (true, true, false) if !beyond.holds() => Kind::Gap,
                    (true, false, true) => Kind::Reaction,
                    _ => Kind::Other,
                };
                rows[kind as usize].push(VertexRow { point: i, vertex, upward, before: None, kind });
            }
        }
        let mut rows: Vec<VertexRow> = rows.concat();
        let place: std::collections::HashMap<(usize, u8), usize> =
            rows.iter().enumerate().map(|(at, row)| ((row.point, row.vertex), at)).collect();
        for row in &mut rows {
            let number = base[row.point];
            let (is_next, earlier) = match row.upward {
                true => (row.vertex == number, row.vertex.wrapping_sub(1)),
                false => (row.vertex + 1 == number, row.vertex + 1),
            };
            row.before = if is_next { None } else { Some(place[&(row.point, earlier)]) };
        }
        Self { rows, base }
    }

    pub(super) fn first_pieces(&self, points: &Points) -> Vec<Piece> {
        self.base.iter().enumerate().map(|(i, &number)| points.piece(i, number)).collect()
    }
}

/// Change of [travel, force] of a contact point per unit of the LCP unknown z. The point moves from a vertex of its law
/// along the next piece. On a piece where the force depends on the travel, z is a force; otherwise z is a travel.
pub(super) fn direction(points: &Points, row: &VertexRow) -> [f64; 2] {
    let next = points.piece(row.point, if row.upward { row.vertex + 1 } else { row.vertex });
    let sign = if row.upward { 1.0 } else { -1.0 };
    if next.holds() { [sign * next.compliance(), sign] } else { [sign, 0.0] }
}

/// Length of the piece between the vertex of a row and the vertex before it, as a force or travel like w; 0 if the
/// vertex is an end of the first piece.
pub(super) fn end_length(points: &Points, row: &VertexRow) -> f64 {
    if row.before.is_none() {
        return 0.0;
    }
    let number = if row.upward { row.vertex } else { row.vertex + 1 };
    let [low, high] = points.ends(row.point, number).map(|end| end.expect("a vertex at either end"));
    if points.piece(row.point, number).holds() { high[1] - low[1] } else { high[0] - low[0] }
}
