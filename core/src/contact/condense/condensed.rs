//! The contact points of a factored plate, and what is asked of them.

use crate::dense::{self, Cholesky, Lu, OutOfMemory};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par};
use std::sync::OnceLock;

/// The contact points of a factored plate.
pub struct Condensed {
    /// L of the Schur complement of K̃ onto the contact dofs.
    pub(super) trailing: Mat<f64>,
    /// Entries of each row on the contact dofs.
    pub(super) rows: Vec<Vec<(usize, f64)>>,
    /// δ: what the factor carries on top of K, by point.
    pub regularization: Vec<f64>,
    /// C: compliance of each support, 0 where it is rigid.
    pub compliance: Vec<f64>,
    /// Points whose constraint is an equation.
    pub two_sided: Vec<bool>,
    /// Gu of each free rigid motion, one a column.
    pub(super) moves: Mat<f64>,
    /// S, where the rows pick single dofs.
    pub(super) stiffness: Option<Mat<f64>>,
    pub(super) flexibility: OnceLock<Mat<f64>>,
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
    /// r condensed onto the contact points; zero where the flexibility serves.
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
    /// `trailing` is the factor's last block, `rows` the contact rows over its dofs, `moves` how each free rigid motion
    /// moves the points.
    pub fn new(
        trailing: Mat<f64>,
        rows: Vec<Vec<(usize, f64)>>,
        regularization: Vec<f64>,
        compliance: Vec<f64>,
        two_sided: Vec<bool>,
        moves: &[Vec<f64>],
    ) -> Result<Self, OutOfMemory> {
        let stiffness = if picks_single_dofs(&rows, trailing.nrows()) {
            let product = dense::product(trailing.as_ref(), trailing.transpose())?;
            Some(dense::matrix(rows.len(), rows.len(), |i, j| {
                let ((p, a), (q, b)) = (rows[i][0], rows[j][0]);
                let carried = if i == j { regularization[i] } else { 0.0 };
                0.5 * (product[(p, q)] + product[(q, p)]) / (a * b) - carried
            })?)
        } else {
            None
        };
        let moves = Mat::from_fn(rows.len(), moves.len(), |i, k| moves[k][i]);
        let flexibility = OnceLock::new();
        Ok(Self { trailing, rows, regularization, compliance, two_sided, moves, stiffness, flexibility })
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

    /// Forces on the points, from the last part of a forward-substituted right-hand side: f̂ = L z.
    ///
    /// Zero where the rows do not pick single dofs.
    pub fn condensed_force(&self, forward: &[f64]) -> Vec<f64> {
        if self.stiffness.is_none() {
            return vec![0.0; self.len()];
        }
        let on_dof = |i: usize| (0..=i).map(|j| self.trailing[(i, j)] * forward[j]).sum::<f64>();
        self.rows.iter().map(|row| on_dof(row[0].0) / row[0].1).collect()
    }

    /// Forces f̂ − S y that hold the points at displacements y under the forces f̂; where the rows pick single dofs.
    pub(crate) fn holding_forces(&self, force: &[f64], moved: &[f64]) -> Vec<f64> {
        let Some(stiffness) = &self.stiffness else { return force.to_vec() };
        let of_motion = |i: usize| (0..self.len()).map(|j| stiffness[(i, j)] * moved[j]).sum::<f64>();
        force.iter().enumerate().map(|(i, f)| f - of_motion(i)).collect()
    }

    /// The last part of a forward-substituted vector whose back substitution moves the points by `moved`: z = Lᵀu.
    pub fn prescribing(&self, moved: &[f64]) -> Vec<f64> {
        let mut on_dofs = vec![0.0; self.trailing.nrows()];
        for (row, y) in self.rows.iter().zip(moved) {
            on_dofs[row[0].0] = y / row[0].1;
        }
        let size = on_dofs.len();
        (0..size).map(|i| (i..size).map(|j| self.trailing[(j, i)] * on_dofs[j]).sum()).collect()
    }

    /// Gu of what back substitution makes of a forward-substituted vector, given its last part: contact rows live there.
    pub(crate) fn moved(&self, forward: &[f64]) -> Vec<f64> {
        let mut on_dofs = Mat::from_fn(forward.len(), 1, |i, _| forward[i]);
        solve_upper_triangular_in_place(self.trailing.transpose(), on_dofs.as_mut(), Par::Seq);
        self.rows.iter().map(|row| row.iter().map(|&(dof, c)| c * on_dofs[(dof, 0)]).sum()).collect()
    }

    /// The last part of a vector Gᵀ·force after forward substitution; the rest of it is zero.
    pub(crate) fn forwarded(&self, force: &[f64]) -> Vec<f64> {
        let mut on_dofs = Mat::<f64>::zeros(self.trailing.nrows(), 1);
        for (row, force) in self.rows.iter().zip(force) {
            row.iter().for_each(|&(dof, c)| on_dofs[(dof, 0)] += c * force);
        }
        solve_lower_triangular_in_place(self.trailing.as_ref(), on_dofs.as_mut(), Par::Seq);
        (0..on_dofs.nrows()).map(|i| on_dofs[(i, 0)]).collect()
    }

    /// The LCP past `reaction`s already acting, with the free motions imposed.
    pub fn lcp(
        &self,
        form: Form,
        interface: &InterfaceResidual,
        work: &Work,
        reaction: &[f64],
    ) -> Result<PosedLcp, OutOfMemory> {
        let mut lcp = self.posed(form, interface, reaction)?;
        let motions = self.impose_motions(&mut lcp)?;
        motions.balance(&mut lcp.q, interface, work);
        Ok(lcp)
    }

    /// The LCP as elimination gives it: M does not depend on the interface, and q is linear in it.
    pub(crate) fn posed(
        &self,
        form: Form,
        interface: &InterfaceResidual,
        reaction: &[f64],
    ) -> Result<PosedLcp, OutOfMemory> {
        match (form, &self.stiffness) {
            (Form::Stiffness, Some(stiffness)) => self.stiffness_lcp(stiffness, interface, reaction),
            (Form::Stiffness, None) => self.flexibility_lcp(interface, reaction, true),
            (Form::Dual, _) => self.flexibility_lcp(interface, reaction, false),
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
            Some(stiffness) => self.stiffness_state(stiffness, closed),
            None => self.flexibility_state(closed),
        }
    }

    /// Increments of the reactions of closed points, and displacements of all, in one contact state.
    pub fn solve_state(&self, state: &ContactState, interface: &InterfaceResidual) -> Result<Response, OutOfMemory> {
        match &self.stiffness {
            Some(stiffness) => Ok(self.solve_stiffness_state(stiffness, state, interface)),
            None => self.solve_flexibility_state(state, interface),
        }
    }
}

/// Whether every row has one entry and no two rows share a dof.
fn picks_single_dofs(rows: &[Vec<(usize, f64)>], dofs: usize) -> bool {
    let mut taken = vec![false; dofs];
    rows.iter().all(|row| row.len() == 1 && !std::mem::replace(&mut taken[row[0].0], true))
}
