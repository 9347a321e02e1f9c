//! The linear complementarity problem of contact points with monotone graphs.
//!
//! Each point starts on one piece. Its unknown x, measured from the piece's first vertex, follows from elimination: x =
//! x₀ + Σ columns z. At an end of the piece, w is the remaining length of the piece, and z the length travelled along
//! the next piece. At each further vertex, w is the length of the piece minus z of the vertex before. Katzenelson
//! (1965) follows a piecewise linear monotone map in this way; for graphs of two pieces, w and z are reaction and gap.

use super::condensed::{CondensedRhs, Form, Interface};
use crate::contact::graph::Piece;
use crate::contact::points::Points;
use crate::dense::{self, Lu, OutOfMemory, row_major};
use faer::Mat;

/// An LCP w = Mz + q, row-major, and the vertex of each row.
#[derive(Clone)]
pub struct PosedLcp {
    pub matrix: Vec<f64>,
    pub q: Vec<f64>,
    pub rows: Vec<VertexRow>,
    /// The first piece of each point.
    base: Vec<u8>,
}

/// A row: one vertex of the graph of a point.
#[derive(Clone, Copy, Debug)]
pub struct VertexRow {
    pub point: usize,
    vertex: u8,
    /// Whether the vertex lies above the first piece.
    upward: bool,
    /// The row of the vertex before it, seen from the first piece.
    before: Option<usize>,
    kind: Kind,
}

/// Kind of unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The gap of a point that starts in contact.
    Gap,
    /// The reaction of a point that starts open.
    Reaction,
    Other,
}

impl VertexRow {
    /// Whether w is a force: on the piece before the vertex the force depends on the travel.
    pub fn w_is_a_force(&self, points: &Points) -> bool {
        points.piece(self.point, if self.upward { self.vertex } else { self.vertex + 1 }).holds()
    }

    /// Whether the vertex is an end of the first piece.
    pub(super) fn is_next(&self) -> bool {
        self.before.is_none()
    }

    /// Whether z is a gap.
    pub fn gap_is_z(&self) -> bool {
        self.kind == Kind::Gap
    }
}

impl PosedLcp {
    /// The contact state for a basis.
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

    /// Number of rows whose unknown is a gap; they come first.
    pub(super) fn gaps(&self) -> usize {
        self.rows.iter().filter(|row| row.kind == Kind::Gap).count()
    }

    /// Number of rows of gaps and reactions; rows of further vertices follow.
    pub(super) fn paired(&self) -> usize {
        self.rows.iter().filter(|row| row.kind != Kind::Other).count()
    }

    /// Force of each point at z = 0 and w = 0.
    pub(super) fn reference_forces(&self, points: &Points) -> Vec<f64> {
        let force = |i: usize| match (points.is_straight(i), points.piece(i, self.base[i]).holds()) {
            (false, true) => points.ends(i, self.base[i])[0].map_or(0.0, |end| end[1]),
            (false, false) => points.piece(i, self.base[i]).force,
            (true, _) => 0.0,
        };
        (0..points.len()).map(force).collect()
    }

    /// Pairs of rows of a piece between two horizontal pieces: (row of the upper end, row of the lower end, length in
    /// force).
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

    /// The basis for a contact state.
    pub fn basis(&self, pieces: &[u8]) -> Vec<bool> {
        let passed = |row: &VertexRow| {
            if row.upward { pieces[row.point] > row.vertex } else { pieces[row.point] <= row.vertex }
        };
        self.rows.iter().map(passed).collect()
    }
}

impl Interface {
    /// Poses the LCP of the first load, and q of the other loads, which share M. All are linear in the load.
    pub(in crate::contact) fn posed(
        &self,
        points: &Points,
        form: Form,
        loads: &[CondensedRhs],
        reaction: &[f64],
    ) -> Result<(PosedLcp, Vec<Vec<f64>>), OutOfMemory> {
        let base = self.first_pieces(points, form);
        let rows = vertex_rows(points, &base);
        // Initial values on the first pieces: x is the increment plus `from`, measured from the vertex.
        let piece: Vec<_> = base.iter().enumerate().map(|(i, &number)| points.piece(i, number)).collect();
        let from = |i: usize| if piece[i].holds() { reaction[i] - piece[i].force } else { 0.0 };
        let direct: Vec<usize> = (0..rows.len()).filter(|&r| rows[r].before.is_none()).collect();
        // z is the length along the next piece.
        let along: Vec<[f64; 2]> = rows.iter().map(|row| direction(points, row)).collect();
        let solved = match (form, &self.stiffness) {
            (Form::Stiffness, Some(_)) => self.columns_by_stiffness(&piece, &rows, &along, loads)?,
            _ => self.columns_by_flexibility(&piece, &rows, &along, loads, reaction)?,
        };
        let sign = |row: &VertexRow| if row.upward { 1.0 } else { -1.0 };
        let entry = |r: usize, c: usize| match rows[r].before {
            // x = x₀ − (columns) z; w is the remaining length of the piece above or below.
            None => sign(&rows[r]) * solved[(rows[r].point, c)],
            Some(before) if before == c => -1.0,
            Some(_) => 0.0,
        };
        let matrix = row_major(rows.len(), rows.len(), entry)?;
        let length = |row: &VertexRow| end_length(points, row);
        let mut first: Vec<f64> = rows.iter().map(length).collect();
        let load = |k: usize, r: usize| -sign(&rows[r]) * solved[(rows[r].point, rows.len() + k)];
        for &r in &direct {
            let i = rows[r].point;
            // The first piece starts at its lower vertex; piece 0 ends at its upper vertex.
            let [low, high] = points.ends(i, base[i]);
            let at = |end: [f64; 2]| if piece[i].holds() { end[1] - piece[i].force } else { end[0] - piece[i].travel };
            let end = if rows[r].upward { high.map(at) } else { low.map(at) }.expect("a vertex at this end");
            first[r] = sign(&rows[r]) * (end - from(i)) + load(0, r);
        }
        let other = |k: usize| -> Vec<f64> {
            let mut q = vec![0.0; rows.len()];
            direct.iter().for_each(|&r| q[r] = load(k, r));
            q
        };
        let others = (1..loads.len()).map(other).collect();
        Ok((PosedLcp { matrix, q: first, rows, base }, others))
    }

    /// H⁻¹ times the columns of all z and of all loads (points, rows + loads), from SΔs + Δr = f̂ with all points in
    /// contact.
    fn columns_by_stiffness(
        &self,
        piece: &[Piece],
        rows: &[VertexRow],
        along: &[[f64; 2]],
        loads: &[CondensedRhs],
    ) -> Result<Mat<f64>, OutOfMemory> {
        let s = &self.stiffness.as_ref().expect("asked for it").matrix;
        let (count, n) = (self.len(), rows.len());
        let held = |load: &CondensedRhs| -> Vec<f64> {
            let travel = self.without_rigid_motion(&load.violation);
            (0..count).map(|i| load.force[i] - (0..count).map(|j| s[(i, j)] * travel[j]).sum::<f64>()).collect()
        };
        let held: Vec<Vec<f64>> = loads.iter().map(held).collect();
        let mut right = dense::matrix(count, n + loads.len(), |i, c| {
            if c >= n {
                return held[c - n][i];
            }
            let j = rows[c].point;
            along[c][0] * s[(i, j)] + if i == j { along[c][1] } else { 0.0 }
        })?;
        if piece.iter().all(|piece| piece.compliance() == 0.0) {
            return Ok(right);
        }
        let coupled = dense::matrix(count, count, |i, j| {
            let through = s[(i, j)] * piece[j].compliance();
            if i == j { 1.0 + through } else { through }
        })?;
        Lu::of(coupled)?.solve_in_place(right.as_mut())?;
        // (I + SC)⁻¹S is symmetric; elimination is symmetric up to rounding.
        let of_point: Vec<Option<usize>> =
            (0..count).map(|i| (0..n).find(|&c| rows[c].point == i && rows[c].kind == Kind::Gap)).collect();
        for i in 0..count {
            for j in 0..i {
                if let (Some(a), Some(b)) = (of_point[i], of_point[j]) {
                    let even = 0.5 * (right[(i, b)] + right[(j, a)]);
                    (right[(i, b)], right[(j, a)]) = (even, even);
                }
            }
        }
        Ok(right)
    }

    /// The same from (I − P̃δ)Δs + P̃Δr = d, with each point on its first piece.
    fn columns_by_flexibility(
        &self,
        piece: &[Piece],
        rows: &[VertexRow],
        along: &[[f64; 2]],
        loads: &[CondensedRhs],
        reaction: &[f64],
    ) -> Result<Mat<f64>, OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let (count, n) = (self.len(), rows.len());
        let column = |i: usize, j: usize| match piece[j].holds() {
            true => self.holding_entry(p, piece[j].compliance(), i, j),
            false => self.travel_entry(p, i, j),
        };
        let is_coupled = |j: usize| match piece[j].holds() {
            true => !self.absorbs(j, piece[j].compliance()),
            false => self.delta[j] > 0.0,
        };
        let (coupled, alone): (Vec<usize>, Vec<usize>) = (0..count).partition(|&j| is_coupled(j));
        // A point that starts on an open piece releases its present reaction.
        let released = |j: usize| if piece[j].holds() { 0.0 } else { reaction[j] - piece[j].force };
        let load = |k: usize, i: usize| -> f64 {
            let CondensedRhs { displacement, violation, .. } = &loads[k];
            let mut sum = displacement[i] - violation[i];
            for j in 0..count {
                sum += p[(i, j)] * self.delta[j] * violation[j];
                if k == 0 {
                    sum += p[(i, j)] * released(j);
                }
            }
            sum
        };
        let entry = |i: usize, c: usize| -> f64 {
            if c >= n {
                return load(c - n, i);
            }
            let (j, [travel, force]) = (rows[c].point, along[c]);
            match force {
                0.0 => travel * self.travel_entry(p, i, j),
                _ => force * self.holding_entry(p, travel / force, i, j),
            }
        };
        let mut all = dense::matrix(count, n + loads.len(), entry)?;
        let mut top = dense::matrix(coupled.len(), n + loads.len(), |r, c| all[(coupled[r], c)])?;
        if !coupled.is_empty() {
            let h = dense::matrix(coupled.len(), coupled.len(), |r, c| column(coupled[r], coupled[c]))?;
            Lu::of(h)?.solve_in_place(top.as_mut())?;
        }
        let across = dense::matrix(alone.len(), coupled.len(), |r, c| column(alone[r], coupled[c]))?;
        let through = dense::product(across.as_ref(), top.as_ref())?;
        for c in 0..all.ncols() {
            coupled.iter().enumerate().for_each(|(r, &i)| all[(i, c)] = top[(r, c)]);
            for (r, &i) in alone.iter().enumerate() {
                let own = if piece[i].holds() { piece[i].compliance() } else { 1.0 };
                all[(i, c)] = (all[(i, c)] - through[(r, c)]) / own;
            }
        }
        Ok(all)
    }
}

/// The vertices of all graphs: gaps of points that start in contact, reactions of points that start open, then all
/// others.
fn vertex_rows(points: &Points, base: &[u8]) -> Vec<VertexRow> {
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
    rows
}

/// Travel and force per unit of z along the next piece; z is a force where it depends on the travel.
fn direction(points: &Points, row: &VertexRow) -> [f64; 2] {
    let next = points.piece(row.point, if row.upward { row.vertex + 1 } else { row.vertex });
    let sign = if row.upward { 1.0 } else { -1.0 };
    if next.holds() { [sign * next.compliance(), sign] } else { [sign, 0.0] }
}

/// Length of the piece before a vertex, in the unit of its z; 0 for the first piece.
fn end_length(points: &Points, row: &VertexRow) -> f64 {
    if row.before.is_none() {
        return 0.0;
    }
    let number = if row.upward { row.vertex } else { row.vertex + 1 };
    let [low, high] = points.ends(row.point, number).map(|end| end.expect("a vertex at either end"));
    if points.piece(row.point, number).holds() { high[1] - low[1] } else { high[0] - low[0] }
}
