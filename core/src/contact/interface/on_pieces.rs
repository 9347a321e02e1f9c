//! The equations of the condensed plate for a fixed contact state.

use super::condensed::{CondensedRhs, Interface};
use crate::contact::graph::Piece;
use crate::contact::points::Points;
use crate::dense::{self, Cholesky, Lu, OutOfMemory};
use faer::{Mat, MatMut, MatRef};

/// Increments of reaction and of travel (m,) of the contact points.
pub(in crate::contact) struct Response {
    pub(in crate::contact) reaction: Vec<f64>,
    pub(in crate::contact) travel: Vec<f64>,
}

/// The condensed equations of a contact state, factored.
pub(in crate::contact) struct OnPieces {
    piece: Vec<Piece>,
    /// Contact points whose column in the equations has more than one entry. Only their equations are factored.
    coupled: Vec<usize>,
    factor: Made,
}

enum Made {
    Nothing,
    /// Schur complement S plus the stiffness of the pieces of the laws on the diagonal, for the points that are not on
    /// rigid pieces.
    Stiffness(Cholesky),
    Flexibility(Lu),
}

impl Interface {
    /// Factors the equations of the contact state `pieces`; `None` if they are singular.
    pub(in crate::contact) fn on_pieces(
        &self,
        points: &Points,
        pieces: &[u8],
    ) -> Result<Option<OnPieces>, OutOfMemory> {
        let piece: Vec<Piece> = pieces.iter().enumerate().map(|(i, &number)| points.piece(i, number)).collect();
        let is_coupled = |i: usize| match (&self.stiffness, piece[i].holds()) {
            (Some(_), _) => piece[i].slope.is_finite(),
            (None, true) => !self.absorbs(i, piece[i].compliance()),
            (None, false) => self.delta[i] > 0.0,
        };
        let coupled: Vec<usize> = (0..self.len()).filter(|&i| is_coupled(i)).collect();
        if coupled.is_empty() {
            return Ok(Some(OnPieces { piece, coupled, factor: Made::Nothing }));
        }
        let size = coupled.len();
        let factor = if let Some(stiffness) = &self.stiffness {
            let entry = |r: usize, c: usize| {
                let (i, j) = (coupled[r], coupled[c]);
                stiffness.matrix[(i, j)] + if i == j { piece[i].slope } else { 0.0 }
            };
            Cholesky::of(dense::matrix(size, size, entry)?)?.map(Made::Stiffness)
        } else {
            let p = self.flexibility()?.matrix.as_ref();
            let entry = |r: usize, c: usize| self.column(p, &piece, coupled[r], coupled[c]);
            let factor = Lu::of(dense::matrix(size, size, entry)?)?;
            factor.has_pivots_above(0.0).then_some(Made::Flexibility(factor))
        };
        Ok(factor.map(|factor| OnPieces { piece, coupled, factor }))
    }

    /// Increments of reaction and travel of the contact points for the right-hand side `right`.
    pub(in crate::contact) fn solve_on(&self, on: &OnPieces, right: &CondensedRhs) -> Result<Response, OutOfMemory> {
        match &self.stiffness {
            Some(stiffness) => Ok(solve_by_stiffness(&stiffness.matrix, on, right)),
            None => self.solve_by_flexibility(on, right),
        }
    }

    /// Applies the increments of travel and reaction of the contact points to a forward substituted load.
    pub(in crate::contact) fn follow(&self, response: &Response, forward: &mut [f64]) -> Result<(), OutOfMemory> {
        match &self.stiffness {
            Some(stiffness) => stiffness.prescribe(&response.travel, forward),
            None => {
                let carried = self.delta.iter().zip(&response.travel).map(|(delta, travel)| delta * travel);
                let push: Vec<f64> = carried.zip(&response.reaction).map(|(carried, r)| carried - r).collect();
                self.flexibility()?.rows.add(&push, forward);
            }
        }
        Ok(())
    }

    /// Entry (i, j) of I − P̃δ, the coefficient of the travel of point j: flexibility P̃ = `p`, stiffness δ in the
    /// factor.
    pub(super) fn travel_entry(&self, p: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let through = -p[(i, j)] * self.delta[j];
        if i == j { 1.0 + through } else { through }
    }

    /// Entry (i, j) of (I − P̃δ)c + P̃, the coefficient of the reaction of point j: flexibility P̃, stiffness δ in the
    /// factor, compliance c of point j. The force of this point depends on its travel.
    pub(super) fn holding_entry(&self, p: MatRef<'_, f64>, compliance: f64, i: usize, j: usize) -> f64 {
        let absorbed = self.absorbs(j, compliance);
        let through = if absorbed { 0.0 } else { p[(i, j)] * (1.0 - self.delta[j] * compliance) };
        if i == j { through + compliance } else { through }
    }

    /// Coefficient of the unknown of point j (reaction or travel) in the equation of point i.
    fn column(&self, p: MatRef<'_, f64>, piece: &[Piece], i: usize, j: usize) -> f64 {
        match piece[j].holds() {
            true => self.holding_entry(p, piece[j].compliance(), i, j),
            false => self.travel_entry(p, i, j),
        }
    }

    fn solve_by_flexibility(&self, on: &OnPieces, right: &CondensedRhs) -> Result<Response, OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let OnPieces { piece, coupled, factor } = on;
        let count = self.len();
        let violation = |j: usize| if piece[j].holds() { right.violation[j] } else { 0.0 };
        let rest = |i: usize| {
            let carried = (0..count).map(|j| p[(i, j)] * self.delta[j] * violation(j));
            right.displacement[i] - violation(i) + carried.sum::<f64>()
        };
        let rest: Vec<f64> = (0..count).map(rest).collect();
        let mut unknown = vec![0.0; count];
        let mut solved: Vec<f64> = coupled.iter().map(|&i| rest[i]).collect();
        if let Made::Flexibility(factor) = factor {
            factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut solved, coupled.len(), 1))?;
        }
        let mut is_coupled = vec![false; count];
        for (&i, &value) in coupled.iter().zip(&solved) {
            (unknown[i], is_coupled[i]) = (value, true);
        }
        for i in (0..count).filter(|&i| !is_coupled[i]) {
            let of_others = coupled.iter().zip(&solved).map(|(&j, value)| self.column(p, piece, i, j) * value);
            let own = if piece[i].holds() { piece[i].compliance() } else { 1.0 };
            unknown[i] = (rest[i] - of_others.sum::<f64>()) / own;
        }
        let reaction: Vec<f64> = (0..count).map(|i| if piece[i].holds() { unknown[i] } else { 0.0 }).collect();
        let travel = |i: usize| match piece[i].holds() {
            true => right.violation[i] + piece[i].compliance() * reaction[i],
            false => unknown[i],
        };
        Ok(Response { travel: (0..count).map(travel).collect(), reaction })
    }
}

fn solve_by_stiffness(stiffness: &Mat<f64>, on: &OnPieces, right: &CondensedRhs) -> Response {
    let OnPieces { piece, coupled, factor } = on;
    let count = piece.len();
    let is_rigid = |i: usize| piece[i].slope.is_infinite();
    let mut travel: Vec<f64> = (0..count).map(|i| if is_rigid(i) { right.violation[i] } else { 0.0 }).collect();
    let held = |i: usize, travel: &[f64]| (0..count).map(|j| stiffness[(i, j)] * travel[j]).sum::<f64>();
    if let Made::Stiffness(factor) = factor {
        let mut solved = Mat::from_fn(coupled.len(), 1, |r, _| {
            let i = coupled[r];
            let spring = if piece[i].holds() { piece[i].slope * right.violation[i] } else { 0.0 };
            right.force[i] + spring - held(i, &travel)
        });
        factor.solve_in_place(solved.as_mut());
        for (r, &i) in coupled.iter().enumerate() {
            travel[i] = solved[(r, 0)];
        }
    }
    let reaction = |i: usize| match (piece[i].holds(), is_rigid(i)) {
        (false, _) => 0.0,
        (_, true) => right.force[i] - held(i, &travel),
        (_, false) => piece[i].slope * (travel[i] - right.violation[i]),
    };
    Response { reaction: (0..count).map(reaction).collect(), travel }
}
