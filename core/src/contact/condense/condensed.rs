//! The contact points of a factored plate, and what is asked of them.

use super::forward_rows::ForwardRows;
use super::schur::Schur;
use super::wide_springs::WideSprings;
use crate::cholesky::{Factor, FactorError};
use crate::contact::points::Constraints;
use crate::dense::{Cholesky, Lu, OutOfMemory};
use faer::Mat;
use std::collections::HashSet;
use std::sync::OnceLock;

/// The contact points of a factored plate.
pub struct Condensed {
    /// δ: what the factor carries on top of K, by point.
    pub regularization: Vec<f64>,
    /// C: compliance of each support, 0 where it is rigid.
    pub compliance: Vec<f64>,
    /// Points whose constraint is an equation.
    pub two_sided: Vec<bool>,
    /// Gu of each free rigid motion, one a column.
    pub(super) moves: Mat<f64>,
    /// Where the rows pick single dofs; then the flexibility is made when it is first asked for.
    pub(crate) stiffness: Option<Schur>,
    flexibility: OnceLock<Flexibility>,
}

/// The plate at its contact points by flexibility.
pub(super) struct Flexibility {
    /// G after forward substitution.
    rows: ForwardRows,
    /// P̃ = G K̃⁻¹ Gᵀ.
    pub(super) matrix: Mat<f64>,
}

/// Which of reaction and gap the LCP has for unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Reactions; gaps only where the factor is regularised.
    Dual,
    /// Gaps.
    Stiffness,
}

/// What one load does at the contact points, past the reactions already acting.
pub struct InterfaceResidual {
    /// G K̃⁻¹ r: displacement of the points under the imbalance r; empty where the stiffness serves.
    pub displacement: Vec<f64>,
    /// r condensed onto the contact points; empty where there is no stiffness.
    pub force: Vec<f64>,
    /// What is left of each gap.
    pub remaining: Vec<f64>,
}

/// Work of a load in each free rigid motion, in which the plate's own forces do none, and the sum of the magnitudes it is
/// made of.
#[derive(Clone, Debug, Default)]
pub struct Work {
    pub sum: Vec<f64>,
    pub size: Vec<f64>,
}

/// What the points do in one contact state.
pub struct Response {
    pub reaction: Vec<f64>,
    pub moved: Vec<f64>,
}

/// An LCP w = Mz + q over the one-sided points, row-major, and the way back.
#[derive(Clone)]
pub struct PosedLcp {
    pub matrix: Vec<f64>,
    pub q: Vec<f64>,
    /// Contact point of every row.
    pub point: Vec<usize>,
    /// Whether the row's unknown is the gap rather than the reaction.
    pub gap_is_z: Vec<bool>,
}

/// The linear system of one contact state, factored.
pub struct ContactState {
    pub(super) closed: Vec<bool>,
    pub(super) unknown: Vec<usize>,
    pub(super) factor: StateFactor,
}

pub(super) enum StateFactor {
    Nothing,
    /// S over the points that may move, with the springs of those that are closed.
    Stiffness(Cholesky),
    Flexibility(Lu),
}

impl Condensed {
    /// Of constraints on a factor that ends with the block `trailing`: `rows` are theirs by its columns, `moves` how each
    /// free rigid motion moves them, `springs` what K̃ has beside the factor.
    pub(crate) fn on(
        factor: &Factor,
        trailing: Mat<f64>,
        constraints: &Constraints,
        rows: &[Vec<(usize, f64)>],
        moves: &[Vec<f64>],
        springs: Option<&WideSprings>,
    ) -> Result<Self, FactorError> {
        let flexibility = OnceLock::new();
        let mut stiffness = None;
        if picks_single_dofs(rows) {
            stiffness = Some(Schur::of(factor.len(), trailing, rows, &constraints.regularization)?);
        } else {
            let rows = ForwardRows::of(factor, &trailing, rows)?;
            let mut matrix = rows.products(&rows)?;
            if let Some(springs) = springs {
                matrix -= springs.held(&rows)?;
            }
            flexibility.get_or_init(|| Flexibility { rows, matrix });
        }
        Ok(Self {
            regularization: constraints.regularization.clone(),
            compliance: constraints.compliance.clone(),
            two_sided: constraints.two_sided.clone(),
            moves: Mat::from_fn(rows.len(), moves.len(), |i, k| moves[k][i]),
            stiffness,
            flexibility,
        })
    }

    pub fn len(&self) -> usize {
        self.compliance.len()
    }

    pub fn is_empty(&self) -> bool {
        self.compliance.is_empty()
    }

    /// The form that is better conditioned here.
    pub fn better_form(&self) -> Form {
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

    /// What an imbalance does at the points, after forward substitution; past `remaining` gaps.
    pub(crate) fn interface(
        &self,
        form: Form,
        forward: &[f64],
        remaining: &[f64],
    ) -> Result<InterfaceResidual, OutOfMemory> {
        let force = self.stiffness.as_ref().map_or(Vec::new(), |stiffness| stiffness.condensed_force(forward));
        let displacement = match form {
            Form::Stiffness if self.stiffness.is_some() => Vec::new(),
            _ => self.flexibility()?.rows.dot(forward),
        };
        Ok(InterfaceResidual { displacement, force, remaining: remaining.to_vec() })
    }

    /// Adds forces on the points to a forward-substituted vector.
    pub(crate) fn push(&self, force: &[f64], forward: &mut [f64]) -> Result<(), OutOfMemory> {
        self.flexibility()?.rows.add(force, forward);
        Ok(())
    }

    /// The LCP past `reaction`s already acting, with the free motions imposed.
    pub fn lcp(
        &self,
        form: Form,
        interface: &InterfaceResidual,
        work: &Work,
        reaction: &[f64],
    ) -> Result<PosedLcp, OutOfMemory> {
        let (mut lcp, _) = self.posed(form, std::slice::from_ref(interface), reaction)?;
        let motions = self.impose_motions(&mut lcp)?;
        motions.balance(&mut lcp.q, interface, work);
        Ok(lcp)
    }

    /// The LCP of the first of some interfaces as elimination gives it, and the q of the others, which have its M. Each is
    /// linear in its interface.
    pub(crate) fn posed(
        &self,
        form: Form,
        interfaces: &[InterfaceResidual],
        reaction: &[f64],
    ) -> Result<(PosedLcp, Vec<Vec<f64>>), OutOfMemory> {
        match (form, &self.stiffness) {
            (Form::Stiffness, Some(stiffness)) => self.stiffness_lcp(&stiffness.matrix, interfaces, reaction),
            (Form::Stiffness, None) => self.flexibility_lcp(interfaces, reaction, true),
            (Form::Dual, _) => self.flexibility_lcp(interfaces, reaction, false),
        }
    }

    /// Which points are closed, given which z of the LCP are basic.
    pub fn closed_points(&self, lcp: &PosedLcp, basis: &[bool]) -> Vec<bool> {
        let mut closed = self.two_sided.clone();
        for (r, &i) in lcp.point.iter().enumerate() {
            closed[i] = basis[r] != lcp.gap_is_z[r];
        }
        closed
    }

    /// Which z of the LCP are basic, given which points are closed.
    pub fn basis(&self, lcp: &PosedLcp, closed: &[bool]) -> Vec<bool> {
        lcp.point.iter().zip(&lcp.gap_is_z).map(|(&i, &gap_is_z)| closed[i] != gap_is_z).collect()
    }

    /// Factors the equations of one contact state; `None` if they are singular.
    pub fn state(&self, closed: Vec<bool>) -> Result<Option<ContactState>, OutOfMemory> {
        match &self.stiffness {
            Some(stiffness) => self.stiffness_state(&stiffness.matrix, closed),
            None => self.flexibility_state(closed),
        }
    }

    /// Increments of the reactions of closed points, and displacements of all, in one contact state.
    pub fn solve_state(&self, state: &ContactState, interface: &InterfaceResidual) -> Result<Response, OutOfMemory> {
        match &self.stiffness {
            Some(stiffness) => Ok(self.solve_stiffness_state(&stiffness.matrix, state, interface)),
            None => self.solve_flexibility_state(state, interface),
        }
    }
}

/// Whether every row has one entry and no two rows share a dof.
pub(crate) fn picks_single_dofs(rows: &[Vec<(usize, f64)>]) -> bool {
    let mut taken = HashSet::new();
    rows.iter().all(|row| row.len() == 1 && taken.insert(row[0].0))
}
