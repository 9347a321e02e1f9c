//! The plate condensed onto its contact points, in two forms: by the Schur complement S, or by the flexibility P̃.

use super::forward_rows::ForwardRows;
use super::schur::Schur;
use crate::cholesky::{Factor, FactorError};
use crate::contact::points::Points;
use crate::contact::tolerances;
use crate::dense::OutOfMemory;
use faer::Mat;
use std::collections::HashSet;
use std::sync::OnceLock;

/// The plate condensed onto its contact points.
pub(in crate::contact) struct Interface {
    /// Stiffness δ (m,) that the factored K̃ = K + Gᵀ diag(δ) G includes at the points.
    pub(in crate::contact) delta: Vec<f64>,
    /// Rigid motions, each (3n,), that springs, held dofs and two-sided points leave free.
    pub(in crate::contact) free_motions: Vec<Vec<f64>>,
    /// N (m, f): displacement Gu of each contact point in each of the f free rigid motions.
    pub(super) moves: Mat<f64>,
    /// The Schur complement S; `None` unless each row of G selects a single dof. If S exists, `flexibility` is made
    /// when it is first needed.
    pub(super) stiffness: Option<Schur>,
    flexibility: OnceLock<Flexibility>,
}

/// Matrices of the flexibility form (I − P̃δ)Δs + P̃Δr = d, with increments Δs of travel and Δr of reaction, and the
/// stiffness δ in the factor.
pub(super) struct Flexibility {
    /// The rows of G after forward substitution with the factor of K̃ = K + Gᵀ diag(δ) G.
    pub(super) rows: ForwardRows,
    /// Flexibility P̃ = GK̃⁻¹Gᵀ (m, m) at the contact points, with the factored matrix K̃.
    pub(super) matrix: Mat<f64>,
}

/// The form of the LCP, named by its unknowns z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The unknowns z are reactions, except at points with a stiffness δ > 0 in the factor, where they are gaps.
    Dual,
    /// The unknowns z are gaps at all points.
    Stiffness,
}

/// A load f after forward substitution with the factor, and condensed onto the contact points.
pub(in crate::contact) struct ReducedLoad {
    /// The load after forward substitution, indexed by column of the factor.
    pub(in crate::contact) forward: Vec<f64>,
    pub(in crate::contact) rhs: CondensedRhs,
}

/// Right-hand side at the contact points, each vector (m,). `displacement` is d = GK̃⁻¹f, empty in stiffness form.
/// `force` has the forces f̂ of the load on the points if these are fixed, empty without a Schur complement.
/// `violation` is the distance in travel from each point to the line of its piece of the law.
#[derive(Clone, Default)]
pub(in crate::contact) struct CondensedRhs {
    pub(in crate::contact) displacement: Vec<f64>,
    pub(in crate::contact) force: Vec<f64>,
    pub(in crate::contact) violation: Vec<f64>,
}

impl Interface {
    /// Condenses the plate, from a factor of K̃ = K + Gᵀ diag(δ) G whose last `trailing` columns are contact dofs.
    /// `rows` are the rows of G, indexed by column of the factor; `multiplier_rows` are the columns of the factor that
    /// belong to multipliers.
    pub(in crate::contact) fn on(
        factor: &Factor,
        trailing: usize,
        points: &Points,
        rows: &[Vec<(usize, f64)>],
        multiplier_rows: &HashSet<usize>,
        delta: Vec<f64>,
        free_motions: Vec<Vec<f64>>,
    ) -> Result<Self, FactorError> {
        let flexibility = OnceLock::new();
        let block = factor.trailing_block(trailing)?;
        let mut stiffness = None;
        if picks_single_dofs(rows) {
            stiffness = Some(Schur::of(factor.len(), block, rows, &delta)?);
        } else {
            let rows = ForwardRows::of(factor, &block, rows, multiplier_rows)?;
            let matrix = rows.products(&rows)?;
            flexibility.get_or_init(|| Flexibility { rows, matrix });
        }
        let moves = Mat::from_fn(rows.len(), free_motions.len(), |i, k| points.dot(i, &free_motions[k]));
        Ok(Self { delta, free_motions, moves, stiffness, flexibility })
    }

    pub(in crate::contact) fn len(&self) -> usize {
        self.delta.len()
    }

    /// The better conditioned form of the LCP: `Stiffness` if each row of G selects a single dof, otherwise `Dual`.
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

    /// Condenses a residual onto the contact points; `forward` is the residual after forward substitution. `violation`
    /// (m,) is copied.
    pub(in crate::contact) fn reduced(
        &self,
        form: Form,
        forward: Vec<f64>,
        violation: &[f64],
    ) -> Result<ReducedLoad, OutOfMemory> {
        let force = self.stiffness.as_ref().map_or(Vec::new(), |stiffness| stiffness.condensed_force(&forward));
        let displacement = match form {
            Form::Stiffness if self.stiffness.is_some() => Vec::new(),
            _ => self.flexibility()?.rows.dot(&forward),
        };
        Ok(ReducedLoad { forward, rhs: CondensedRhs { displacement, force, violation: violation.to_vec() } })
    }

    /// Prescribes the displacements `travel` (m,) of the contact points in a forward substituted load, and returns the
    /// reactions (m,) of the points. If a row of G has several dofs, the function returns an empty vector and leaves
    /// `forward` as it is.
    pub(in crate::contact) fn impose(&self, travel: &[f64], forward: &mut [f64]) -> Vec<f64> {
        let Some(stiffness) = &self.stiffness else { return Vec::new() };
        let reaction = stiffness.holding_forces(&stiffness.condensed_force(forward), travel);
        stiffness.prescribe(travel, forward);
        reaction
    }

    /// Whether the stiffness δ that the factor includes at point i equals the stiffness 1/`compliance` of the point.
    pub(in crate::contact) fn absorbs(&self, i: usize, compliance: f64) -> bool {
        compliance > 0.0 && (1.0 - self.delta[i] * compliance).abs() < tolerances::interface::ABSORBED
    }

    /// The first piece (m,) of each point: in the LCP, force and travel of the point are measured from this piece of
    /// its law. In stiffness form, for linear laws, and where the factor includes a stiffness δ > 0, it is the first
    /// piece on which the force depends on the travel. At other points it is the first horizontal piece, on which a
    /// one-sided point is open.
    pub(in crate::contact) fn first_pieces(&self, points: &Points, form: Form) -> Vec<u8> {
        let holds = |i: usize| form == Form::Stiffness || points.is_straight(i) || self.delta[i] > 0.0;
        points.pieces_holding(&(0..points.len()).map(holds).collect::<Vec<_>>())
    }
}

/// Whether every row of G has a single entry and no two rows have the same dof.
fn picks_single_dofs(rows: &[Vec<(usize, f64)>]) -> bool {
    let mut taken = HashSet::new();
    rows.iter().all(|row| row.len() == 1 && taken.insert(row[0].0))
}
