//! Responses to single load cases and to single contact points. The solution of a combination is a linear combination
//! of these responses.
//!
//! u = u₀ + Σ factor_c u_c + Σ x_i u_i, with u₀ the response without load, u_c the response to load case c, and u_i the
//! response to contact point i. Reactions and displacements of points are the same sums. Each response is in
//! equilibrium: Ku + Gᵀr = f. If each row of G selects a single dof, x_i is the displacement of point i, and load cases
//! act with all points fixed. Otherwise x_i is the force δ·Gu − r of point i, and load cases act on the plate with a
//! spring δ at each point, K̃ = K + Gᵀ diag(δ) G.

use super::error::{SolveError, require_length};
use super::interface::{Form, Interface, Work};
use super::problem::ContactProblem;
use super::residual::largest_force;
use super::tolerances;
use crate::cholesky::FactorError;
use crate::displacement::Displacement;
use crate::residual::residual;
use crate::rows::Springs;
use rayon::prelude::*;

/// The response to one load case or to one contact point, refined with double-double residuals.
#[derive(Clone, Debug, Default)]
pub struct Response {
    pub displacement: Displacement,
    /// Reaction r (m,) of each contact point in this response.
    pub reaction: Vec<f64>,
    /// Displacement Gu (m,) of each contact point in this response.
    pub moved: Vec<f64>,
    pub work: Work,
}

/// Number of responses that are refined together, so that the factor is read once for all of them.
const TOGETHER: usize = 8;
/// Largest number of corrections of each response.
const CORRECTIONS: usize = 8;

/// A response while it is refined.
struct Draft<'a> {
    /// The acting nodal forces `force` (3n,), and `acting`, the reference force for the residual.
    force: Vec<f64>,
    acting: f64,
    springs: &'a Springs,
    /// Stiffness δ (m,) of the springs at the contact points.
    carried: &'a [f64],
    /// The contact point i for which x_i = 1, all other x being 0; `None` in the response to a load case.
    point: Option<usize>,
    response: Response,
    imbalance: Vec<f64>,
    /// Prescribed displacement minus Gu (m,) of each point; empty if displacements of points are not prescribed.
    remaining: Vec<f64>,
    worst: f64,
    settled: bool,
}

/// Computes the responses of a condensed plate.
struct Responses<'a> {
    problem: &'a ContactProblem,
    interface: &'a Interface,
}

impl ContactProblem {
    /// The response without load: held dofs have the values `held_value` (3n,), and bases of springs their prescribed
    /// displacements.
    pub fn rest_response(&self, held_value: &[f64]) -> Result<Response, SolveError> {
        require_length("held_value", held_value.len(), self.plate.dof_count())?;
        let begin = |_, draft: &mut Draft| {
            draft.response.displacement = self.at_rest(held_value).displacement;
        };
        Ok(self.responder()?.responses(1, true, begin, &mut || true)?.remove(0))
    }

    /// The response to each nodal load (3n,), with zero displacement at held dofs and bases of springs. `watch` is
    /// called repeatedly and cancels by returning false.
    pub fn load_responses(
        &self,
        loads: &[Vec<f64>],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Response>, SolveError> {
        loads.iter().try_for_each(|load| require_length("a load", load.len(), self.plate.dof_count()))?;
        let responder = self.responder()?;
        let begin = |i: usize, draft: &mut Draft| {
            draft.force.clone_from(&loads[i]);
            self.plate.bodies().gather(&mut draft.force);
            draft.acting = self.scale.largest(&loads[i]);
            draft.response.work = Work::of(&responder.interface.free_motions, &loads[i]);
        };
        responder.responses(loads.len(), false, begin, watch)
    }

    /// The response to each contact point in the range `points`. `watch` is called repeatedly and cancels by returning
    /// false.
    pub fn point_responses(
        &self,
        points: std::ops::Range<usize>,
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Response>, SolveError> {
        if points.end > self.points.len() {
            return Err(SolveError::Length { name: "points", found: self.points.len(), expected: points.end });
        }
        let responder = self.responder()?;
        let begin = |i: usize, draft: &mut Draft| {
            draft.point = Some(points.start + i);
            if !responder.imposed() {
                draft.acting = 1.0;
                self.points.scatter(points.start + i, 1.0, &mut draft.force);
            }
        };
        responder.responses(points.len(), false, begin, watch)
    }

    fn responder(&self) -> Result<Responses<'_>, SolveError> {
        Ok(Responses { problem: self, interface: self.condensed()? })
    }
}

impl Responses<'_> {
    /// Whether the factors x are displacements of the contact points, which each response then prescribes. Otherwise
    /// they are forces.
    fn imposed(&self) -> bool {
        self.interface.better_form() == Form::Stiffness
    }

    /// Makes `count` responses and refines them; `begin(i, draft)` sets the load of response i. If `on_bases` is true,
    /// the bases of springs have their prescribed displacements, otherwise zero.
    fn responses(
        &self,
        count: usize,
        on_bases: bool,
        begin: impl Fn(usize, &mut Draft) + Sync,
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Response>, SolveError> {
        let none = vec![0.0; self.problem.points.len()];
        let carried = if self.imposed() { &none } else { &self.interface.delta };
        let mut springs = self.problem.springs.clone();
        springs.base.iter_mut().filter(|_| !on_bases).for_each(|base| *base = 0.0);
        let dofs = self.problem.plate.dof_count();
        let draft = |i: usize| {
            let reaction = none.clone();
            let (displacement, work) = (Displacement::zeros(dofs), Work::of(&self.interface.free_motions, &[]));
            let mut draft = Draft {
                force: vec![0.0; dofs],
                acting: 0.0,
                springs: &springs,
                carried,
                point: None,
                response: Response { displacement, reaction, moved: Vec::new(), work },
                imbalance: Vec::new(),
                remaining: Vec::new(),
                worst: 0.0,
                settled: false,
            };
            begin(i, &mut draft);
            draft
        };
        let mut result = Vec::with_capacity(count);
        while result.len() < count {
            if !watch() {
                return Err(SolveError::Cancelled);
            }
            let last = count.min(result.len() + TOGETHER * rayon::current_num_threads());
            let blocks = (result.len()..last).into_par_iter().chunks(TOGETHER);
            let refined = |block: Vec<usize>| self.refined(block.into_iter().map(&draft).collect());
            result.extend(blocks.map(refined).collect::<Result<Vec<_>, _>>()?.into_iter().flatten());
        }
        Ok(result)
    }

    fn refined(&self, mut drafts: Vec<Draft>) -> Result<Vec<Response>, FactorError> {
        for draft in &mut drafts {
            self.judge(draft);
            draft.settled = draft.worst == 0.0 && draft.remaining.iter().all(|&left| left == 0.0);
        }
        for round in 0..CORRECTIONS {
            if drafts.iter().all(|draft| draft.settled) {
                break;
            }
            self.correct_together(&mut drafts, round)?;
        }
        Ok(drafts.into_iter().map(|draft| self.response(draft)).collect())
    }

    /// Computes the residuals of a response (equilibrium, prescribed displacements) and stores them in its `draft`.
    fn judge(&self, draft: &mut Draft) {
        let Response { displacement, reaction, .. } = &draft.response;
        // Before the first correction all displacements are zero, except those of held dofs.
        let moved = displacement.hi.iter().chain(&draft.springs.base).any(|&u| u != 0.0);
        let mut out = if moved {
            residual(&self.problem.plate, draft.springs, &draft.force, displacement)
        } else {
            draft.force.clone()
        };
        if self.imposed() {
            self.problem.points.scatter_all(reaction, -1.0, &mut out);
            let target: Vec<f64> = (0..reaction.len()).map(|i| f64::from(draft.point == Some(i))).collect();
            draft.remaining =
                self.problem.points.travel_from(&target, displacement).iter().map(|beyond| -beyond).collect();
        } else if moved && draft.carried.iter().any(|&slope| slope > 0.0) {
            let travel = self.problem.points.travel_from(&vec![0.0; reaction.len()], displacement);
            let force: Vec<f64> = travel.iter().zip(draft.carried).map(|(travel, slope)| slope * travel).collect();
            self.problem.points.scatter_all(&force, -1.0, &mut out);
        }
        self.problem.release_held(&mut out);
        draft.worst = self.problem.scale.largest(&out);
        draft.imbalance = out;
    }

    /// Corrects every response in `drafts` that has not converged.
    fn correct_together(&self, drafts: &mut [Draft], round: usize) -> Result<(), FactorError> {
        let factor = &self.problem.base.factor;
        let mut open: Vec<&mut Draft> = drafts.iter_mut().filter(|draft| !draft.settled).collect();
        let mut block: Vec<f64> = open.iter().flat_map(|draft| self.problem.pattern.gather(&draft.imbalance)).collect();
        factor.forward(&mut block)?;
        let mut increments = vec![Vec::new(); open.len()];
        for ((column, draft), increment) in block.chunks_exact_mut(factor.len()).zip(&open).zip(&mut increments) {
            *increment = self.interface.impose(&draft.remaining, column);
        }
        factor.backward(&mut block)?;
        for ((column, draft), increment) in block.chunks_exact(factor.len()).zip(&mut open).zip(&increments) {
            let (before, worst) = (draft.response.clone(), draft.worst);
            for (&dof, &value) in self.problem.pattern.numbering.dof.iter().zip(column) {
                if dof < self.problem.held.len() {
                    draft.response.displacement.add(dof, value);
                }
            }
            draft.response.displacement.follow(self.problem.plate.bodies());
            draft.response.reaction.iter_mut().zip(increment).for_each(|(total, part)| *total += part);
            self.judge(draft);
            if round > 0 && !(draft.worst < worst) {
                (draft.response, draft.worst, draft.settled) = (before, worst, true);
            } else {
                let force = largest_force(self.problem, &[], &draft.response.reaction).max(draft.acting);
                draft.settled = draft.worst <= tolerances::RESPONSE * force
                    || (round > 0 && draft.worst > tolerances::PROGRESS * worst);
            }
        }
        Ok(())
    }

    fn response(&self, Draft { mut response, point, .. }: Draft) -> Response {
        response.moved = self.problem.points.travel_from(&vec![0.0; self.problem.points.len()], &response.displacement);
        if !self.imposed() {
            let carried = self.interface.delta.iter().zip(&response.moved).enumerate();
            response.reaction = carried.map(|(i, (k, moved))| k * moved - f64::from(point == Some(i))).collect();
        }
        response
    }
}
