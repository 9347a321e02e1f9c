//! The contact points of a factored plate.

use super::forward_rows::ForwardRows;
use super::schur::Schur;
use crate::cholesky::{Factor, FactorError};
use crate::contact::points::Points;
use crate::contact::tolerances;
use crate::dense::OutOfMemory;
use faer::Mat;
use std::collections::HashSet;
use std::sync::OnceLock;

/// The contact points of a factored plate.
pub(in crate::contact) struct Interface {
    /// δ: slope that the factor carries at each point, on top of K.
    pub(in crate::contact) delta: Vec<f64>,
    /// Gu of each free rigid motion, one a column.
    pub(super) moves: Mat<f64>,
    /// Where the rows pick single dofs; then the flexibility is made when it is first asked for.
    pub(super) stiffness: Option<Schur>,
    flexibility: OnceLock<Flexibility>,
}

/// The plate at its contact points by flexibility.
pub(super) struct Flexibility {
    /// G after forward substitution.
    pub(super) rows: ForwardRows,
    /// P̃ = GK̃⁻¹Gᵀ.
    pub(super) matrix: Mat<f64>,
}

/// Which unknowns the complementarity problem has: those of points that are taken to be open first, or to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Reactions; gaps only where the factor carries a slope.
    Dual,
    /// Gaps.
    Stiffness,
}

/// What one load does at the contact points.
pub(in crate::contact) struct Reduced {
    /// After forward substitution.
    pub(in crate::contact) forward: Vec<f64>,
    pub(in crate::contact) at_points: AtPoints,
}

/// GK̃⁻¹f, empty where the stiffness serves; f condensed, empty where there is no stiffness; and by how much points are off
/// their pieces.
#[derive(Clone, Default)]
pub(in crate::contact) struct AtPoints {
    pub(in crate::contact) displacement: Vec<f64>,
    pub(in crate::contact) force: Vec<f64>,
    pub(in crate::contact) violation: Vec<f64>,
}

impl Interface {
    /// On a factor that ends with `trailing` columns of contact dofs: `rows` are the points' by its columns, `borders`
    /// those of its columns that are no dofs, `moves` how each free rigid motion moves the points.
    pub(in crate::contact) fn on(
        factor: &Factor,
        trailing: usize,
        rows: &[Vec<(usize, f64)>],
        borders: &HashSet<usize>,
        delta: Vec<f64>,
        moves: &[Vec<f64>],
    ) -> Result<Self, FactorError> {
        let flexibility = OnceLock::new();
        let block = factor.trailing_block(trailing)?;
        let mut stiffness = None;
        if picks_single_dofs(rows) {
            stiffness = Some(Schur::of(factor.len(), block, rows, &delta)?);
        } else {
            let rows = ForwardRows::of(factor, &block, rows, borders)?;
            let matrix = rows.products(&rows)?;
            flexibility.get_or_init(|| Flexibility { rows, matrix });
        }
        let moves = Mat::from_fn(rows.len(), moves.len(), |i, k| moves[k][i]);
        Ok(Self { delta, moves, stiffness, flexibility })
    }

    pub(in crate::contact) fn len(&self) -> usize {
        self.delta.len()
    }

    /// The form that is better conditioned here.
    pub(in crate::contact) fn better_form(&self) -> Form {
        if self.stiffness.is_some() { Form::Stiffness } else { Form::Dual }
    }

    pub(super) fn flexibility(&self) -> Result<&Flexibility, OutOfMemory> {
        if let (None, Some(stiffness)) = (self.flexibility.get(), &self.stiffness) {
            let rows = stiffness.forward_rows()?;
            let matrix = rows.products(&rows)?;
            self.flexibility.get_or_init(|| Flexibility { rows, matrix });
        }
        Ok(self.flexibility.get().expect("made here or with the factor"))
    }

    /// What an imbalance does at the points, after forward substitution; `violation` goes with it.
    pub(in crate::contact) fn reduced(
        &self,
        form: Form,
        forward: Vec<f64>,
        violation: &[f64],
    ) -> Result<Reduced, OutOfMemory> {
        let force = self.stiffness.as_ref().map_or(Vec::new(), |stiffness| stiffness.condensed_force(&forward));
        let displacement = match form {
            Form::Stiffness if self.stiffness.is_some() => Vec::new(),
            _ => self.flexibility()?.rows.dot(&forward),
        };
        Ok(Reduced { forward, at_points: AtPoints { displacement, force, violation: violation.to_vec() } })
    }

    /// Where the rows pick single dofs: lets the points travel by so much, after forward substitution, and returns the
    /// reactions that make them; else nothing.
    pub(in crate::contact) fn impose(&self, travel: &[f64], forward: &mut [f64]) -> Vec<f64> {
        let Some(stiffness) = &self.stiffness else { return Vec::new() };
        let reaction = stiffness.holding_forces(&stiffness.condensed_force(forward), travel);
        stiffness.prescribe(travel, forward);
        reaction
    }

    /// Whether the factor carries the whole slope of a point with a compliance.
    pub(in crate::contact) fn absorbs(&self, i: usize, compliance: f64) -> bool {
        compliance > 0.0 && (1.0 - self.delta[i] * compliance).abs() < tolerances::interface::ABSORBED
    }

    /// Pieces that points are taken to be on first: holding where all are, where there is no other, or the factor carries a
    /// slope; else open.
    pub(in crate::contact) fn first_pieces(&self, points: &Points, form: Form) -> Vec<u8> {
        let holds = |i: usize| form == Form::Stiffness || points.is_straight(i) || self.delta[i] > 0.0;
        points.pieces_holding(&(0..points.len()).map(holds).collect::<Vec<_>>())
    }
}

/// Whether every row has one entry and no two rows share a dof.
fn picks_single_dofs(rows: &[Vec<(usize, f64)>]) -> bool {
    let mut taken = HashSet::new();
    rows.iter().all(|row| row.len() == 1 && taken.insert(row[0].0))
}
