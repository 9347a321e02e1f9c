//! What the plate does under each load case and at each contact point alone: every combination is a sum of these.
//!
//! u = u₀ + Σ factor_c u_c + Σ x_i u_i, and the reactions and displacements of the points likewise, each term in
//! equilibrium by itself: Ku + Gᵀ·reaction = f. Where the rows pick single dofs, x is the points' displacement and the
//! cases act with all points held; else x is the force δ·Gu − reaction, and the cases act on K̃.

use super::condense::{Form, Work};
use super::problem::{ContactProblem, with_regularization};
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::residual::{Displacement, Springs, residual};
use rayon::prelude::*;

/// One term of the sum, refined with the double-double residual.
#[derive(Clone, Debug, Default)]
pub struct Response {
    pub displacement: Displacement,
    /// Force of every contact point, against its row.
    pub reaction: Vec<f64>,
    /// Displacement Gu of every contact point.
    pub moved: Vec<f64>,
    pub work: Work,
}

/// What acts.
#[derive(Clone, Copy)]
enum Action<'a> {
    /// No load: held dofs at their values (3n,), springs on their bases.
    Rest(&'a [f64]),
    /// A nodal load (3n,), held dofs and bases at zero.
    Load(&'a [f64]),
    /// x_i = 1.
    Point(usize),
}

/// Responses refined together, so that the factor is read once for all of them.
const TOGETHER: usize = 8;
/// At most this many corrections.
const CORRECTIONS: usize = 8;

/// A response that is being refined.
struct Draft<'a> {
    action: Action<'a>,
    displacement: Displacement,
    reaction: Vec<f64>,
    imbalance: Vec<f64>,
    /// What is left of the displacements to be imposed on the points; empty where none are.
    remaining: Vec<f64>,
    worst: f64,
    settled: bool,
}

impl ContactProblem {
    /// The response to no load, with the held dofs at `held_value` (3n,).
    pub fn rest_response(&self, held_value: &[f64]) -> Result<Response, FactorError> {
        Ok(self.responses(&[Action::Rest(held_value)], &mut || true)?.remove(0))
    }

    /// The responses to nodal loads (3n,) each. `watch` is asked now and then and ends it by returning false; then
    /// responses are missing.
    pub fn load_responses(
        &self,
        loads: &[Vec<f64>],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Response>, FactorError> {
        self.responses(&loads.iter().map(|load| Action::Load(load)).collect::<Vec<_>>(), watch)
    }

    /// The responses of some contact points; `watch` as for [`ContactProblem::load_responses`].
    pub fn point_responses(
        &self,
        points: std::ops::Range<usize>,
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Response>, FactorError> {
        self.responses(&points.map(Action::Point).collect::<Vec<_>>(), watch)
    }

    fn responses(&self, actions: &[Action], watch: &mut dyn FnMut() -> bool) -> Result<Vec<Response>, FactorError> {
        let mut found = Vec::with_capacity(actions.len());
        for actions in actions.chunks(TOGETHER * rayon::current_num_threads()) {
            if !watch() {
                break;
            }
            let blocks: Result<Vec<_>, _> = actions.par_chunks(TOGETHER).map(|block| self.refined(block)).collect();
            found.extend(blocks?.into_iter().flatten());
        }
        Ok(found)
    }

    fn imposed(&self) -> bool {
        self.base.condensed.better_form() == Form::Stiffness
    }

    fn refined(&self, actions: &[Action]) -> Result<Vec<Response>, FactorError> {
        let springs =
            if self.imposed() { self.springs.clone() } else { with_regularization(&self.springs, &self.constraints) };
        let still = Springs { base: vec![0.0; springs.base.len()], ..springs.clone() };
        let own = |action: Action| if matches!(action, Action::Rest(_)) { &springs } else { &still };
        let mut drafts: Vec<Draft> = actions.iter().map(|&action| self.draft(action, own(action))).collect();
        for round in 0..CORRECTIONS {
            if drafts.iter().all(|draft| draft.settled) {
                break;
            }
            self.correct_together(&mut drafts, round, &own)?;
        }
        Ok(drafts.into_iter().map(|draft| self.response(draft)).collect())
    }

    fn draft<'a>(&self, action: Action<'a>, springs: &Springs) -> Draft<'a> {
        let count = self.constraints.rows.len();
        let mut displacement = Displacement::zeros(self.plate.dof_count());
        if let Action::Rest(held_value) = action {
            for (dof, _) in self.held.iter().enumerate().filter(|(_, held)| **held) {
                displacement.hi[dof] = held_value[dof];
            }
        }
        let mut draft = Draft {
            action,
            displacement,
            reaction: vec![0.0; count],
            imbalance: Vec::new(),
            remaining: Vec::new(),
            worst: 0.0,
            settled: false,
        };
        self.judge(&mut draft, springs);
        draft.settled = draft.worst == 0.0 && draft.remaining.iter().all(|&left| left == 0.0);
        draft
    }

    /// What is out of balance, and what is left to impose.
    fn judge(&self, draft: &mut Draft, springs: &Springs) {
        let mut force = match draft.action {
            Action::Load(load) => load.to_vec(),
            _ => vec![0.0; self.plate.dof_count()],
        };
        if let (Action::Point(i), false) = (draft.action, self.imposed()) {
            self.constraints.rows.scatter(&self.plate, i, 1.0, &mut force);
        }
        // Before the first correction nothing has moved but what is held.
        let moved = draft.displacement.hi.iter().any(|&u| u != 0.0) || springs.base.iter().any(|&base| base != 0.0);
        let mut out = if moved { residual(&self.plate, springs, &force, &draft.displacement) } else { force };
        if self.imposed() {
            let downward: Vec<f64> = draft.reaction.iter().map(|r| -r).collect();
            self.spread(&downward, &mut out);
            let target = |i: usize| if matches!(draft.action, Action::Point(j) if j == i) { 1.0 } else { 0.0 };
            let left = |i: usize| -self.constraints.rows.beyond(&self.plate, i, &draft.displacement, target(i));
            draft.remaining = (0..draft.reaction.len()).map(left).collect();
        }
        self.release_held(&mut out);
        draft.worst = self.scale.largest(&out);
        draft.imbalance = out;
    }

    /// One correction of every draft that is not settled.
    fn correct_together<'s>(
        &self,
        drafts: &mut [Draft],
        round: usize,
        springs: &impl Fn(Action) -> &'s Springs,
    ) -> Result<(), FactorError> {
        let open: Vec<usize> = (0..drafts.len()).filter(|&d| !drafts[d].settled).collect();
        let size = self.base.factor.len();
        let leading = size - self.numbering.trailing;
        let mut block: Vec<f64> = open.iter().flat_map(|&d| self.gather(&drafts[d].imbalance)).collect();
        self.base.factor.forward(&mut block)?;
        let mut increments = Vec::new();
        if self.imposed() {
            for (column, &d) in block.chunks_exact_mut(size).zip(&open) {
                let force = self.base.condensed.condensed_force(&column[leading..]);
                increments.push(self.base.condensed.holding_forces(&force, &drafts[d].remaining));
                column[leading..].copy_from_slice(&self.base.condensed.prescribing(&drafts[d].remaining));
            }
        }
        self.base.factor.backward(&mut block)?;
        for (at, (column, &d)) in block.chunks_exact(size).zip(&open).enumerate() {
            let draft = &mut drafts[d];
            let before = (draft.displacement.clone(), draft.reaction.clone(), draft.worst);
            for (&dof, &value) in self.numbering.dof.iter().zip(column) {
                draft.displacement.add(dof, value);
            }
            if let Some(increment) = increments.get(at) {
                draft.reaction.iter_mut().zip(increment).for_each(|(total, part)| *total += part);
            }
            self.judge(draft, springs(draft.action));
            if round > 0 && !(draft.worst < before.2) {
                (draft.displacement, draft.reaction, draft.worst) = before;
                draft.settled = true;
            } else {
                let force = self.size(draft);
                draft.settled = draft.worst <= tolerances::RESPONSE * force
                    || (round > 0 && draft.worst > tolerances::PROGRESS * before.2);
            }
        }
        Ok(())
    }

    fn response(&self, draft: Draft) -> Response {
        let rows = &self.constraints.rows;
        let moved = (0..rows.len()).map(|i| rows.beyond(&self.plate, i, &draft.displacement, 0.0));
        let moved: Vec<f64> = moved.collect();
        let mut reaction = draft.reaction;
        if !self.imposed() {
            let push = |i: usize| if matches!(draft.action, Action::Point(j) if j == i) { 1.0 } else { 0.0 };
            let carried = &self.base.condensed.regularization;
            reaction = (0..rows.len()).map(|i| carried[i] * moved[i] - push(i)).collect();
        }
        let work = match draft.action {
            Action::Load(load) => self.work(load),
            _ => self.work(&[]),
        };
        Response { displacement: draft.displacement, reaction, moved, work }
    }

    /// The largest force of a draft.
    fn size(&self, draft: &Draft) -> f64 {
        let load = match draft.action {
            Action::Load(load) => load,
            _ => &[],
        };
        let pushed = if matches!(draft.action, Action::Point(_)) && draft.remaining.is_empty() { 1.0 } else { 0.0 };
        self.largest_force(load, &draft.reaction).max(pushed)
    }
}
