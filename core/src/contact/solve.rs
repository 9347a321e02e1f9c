//! Solution of a contact problem under one load or several loads.

use super::backend::Backend;
use super::error::{SolveError, require_length};
use super::finders::{by_active_set, by_lemke, posed_from, solve_together, solved_and_factored};
use super::fixed_state;
use super::interface::{Form, LcpTemplate, Work};
use super::load::Load;
use super::points::PointState;
use super::problem::ContactProblem;
use super::residual::Residual;
use super::scale::largest;
use super::solution::{ContactSolution, Watch};

/// Settings of [`ContactProblem::solve`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// The form of the LCP of condensed points; `None` selects the better conditioned form. The Newton method has no
    /// LCP and ignores this field.
    pub form: Option<Form>,
}

impl ContactProblem {
    /// Solves one load by the method for which K is factored.
    ///
    /// `start` is the solution of another load. Lemke's algorithm tries its contact state first; the Newton method
    /// starts from its displacements and reactions.
    pub fn solve(
        &self,
        load: &Load,
        settings: &Settings,
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, SolveError> {
        load.require_lengths(self)?;
        self.require_start(start)?;
        match &self.backend {
            Backend::Condensed { interface, .. } => {
                let form = settings.form.unwrap_or(interface.better_form());
                by_lemke(self, interface, form, load, start, watch)
            }
            Backend::Penalised(augmentation) | Backend::SaddlePoint(augmentation) => {
                by_active_set(self, augmentation, load, start, watch)
            }
        }
    }

    /// Solves one load on a fixed contact state `pieces` (m,). Points of the solution may be beyond the bounds of their
    /// pieces of the laws.
    pub fn solve_on(&self, load: &Load, pieces: &[u8]) -> Result<ContactSolution, SolveError> {
        load.require_lengths(self)?;
        require_length("pieces", pieces.len(), self.points.len())?;
        let is_beyond = |&i: &usize| usize::from(pieces[i]) >= self.points.graph(i).pieces();
        if let Some(index) = (0..pieces.len()).find(is_beyond) {
            return Err(SolveError::Value { name: "pieces", index, allowed: "the number of a piece of the law" });
        }
        fixed_state::solve_on(self, &mut *fixed_state::kkt(self), load, pieces, None, 0.0)
    }

    /// Residuals of a solution, without a call of a solver: residual nodal forces (3n,) divided by the largest force,
    /// and violations of the laws (m,). A violation in force is divided by the largest force (load, reaction, or the
    /// force that bends the plate), a violation in travel by the largest travel or gap.
    pub fn violations(&self, load: &[f64], solution: &ContactSolution) -> (Vec<f64>, Vec<f64>) {
        let residual = Residual::of(self, load, solution);
        let travel = self.points.travel_from(&vec![0.0; self.points.len()], &solution.displacement);
        let bending = self.scale.stiffness * largest(&solution.displacement.hi);
        let force = largest(&solution.reaction).max(largest(load)).max(bending).max(f64::MIN_POSITIVE);
        let length = largest(&travel).max(largest(&self.points.shift)).max(f64::MIN_POSITIVE);
        let off = |i: usize| {
            let piece = self.points.piece(i, solution.piece[i]);
            let size = if piece.holds() { force } else { length };
            let beside = match piece.holds() {
                true => residual.violation[i].abs() / length,
                false => (solution.reaction[i] - piece.force).abs() / force,
            };
            let state = PointState { gap: residual.violation[i], ..solution.state(i) };
            let beyond = [false, true].map(|is_upper| self.points.signed_distance(i, state, is_upper));
            beyond.into_iter().flatten().fold(beside, |worst, inside| worst.max(-inside / size))
        };
        let points = (0..self.points.len()).map(off).collect();
        (residual.imbalance.iter().map(|f| f / force).collect(), points)
    }

    /// Solves one load by the Newton method and factors K with the springs of its contact state, for warm starts of
    /// other loads. `None` if this contact state leaves a rigid motion free.
    pub fn solve_and_factor(&self, load: &Load, watch: &mut Watch<'_>) -> Result<Option<ContactSolution>, SolveError> {
        load.require_lengths(self)?;
        match &self.backend {
            Backend::Condensed { .. } => Err(SolveError::Condensed),
            Backend::Penalised(augmentation) | Backend::SaddlePoint(augmentation) => {
                solved_and_factored(self, augmentation, load, watch)
            }
        }
    }

    /// Solves many loads, each (3n,), by the Newton method. All loads share the first factor. Unlike
    /// [`ContactProblem::solve`], this function seeks no exact solution on a contact state. `watch` is called repeatedly
    /// and cancels by returning false.
    pub fn solve_together(
        &self,
        start: Option<&ContactSolution>,
        loads: &[Vec<f64>],
        held_value: &[f64],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Result<ContactSolution, SolveError>>, SolveError> {
        loads.iter().try_for_each(|nodal| Load { nodal, held_value }.require_lengths(self))?;
        self.require_start(start)?;
        match &self.backend {
            Backend::Condensed { .. } => Err(SolveError::Condensed),
            Backend::Penalised(augmentation) | Backend::SaddlePoint(augmentation) => {
                solve_together(self, augmentation, start, loads, held_value, watch)
            }
        }
    }

    /// The first LCP w = Mz + q that [`ContactProblem::solve`] poses for condensed points: the template with M, and q
    /// (k,).
    pub fn lcp(&self, load: &Load, settings: &Settings) -> Result<(&LcpTemplate, Vec<f64>), SolveError> {
        load.require_lengths(self)?;
        let interface = self.condensed()?;
        let rest = self.at_rest(load.held_value);
        let form = settings.form.unwrap_or(interface.better_form());
        let reduced = posed_from(self, interface, load.nodal, form, &rest)?;
        let work = Work::of(&interface.free_motions, load.nodal);
        let template = self.lcp_template(form)?;
        let q = template.balanced_q(interface, &self.points, &reduced.rhs, &work, &rest.reaction)?;
        Ok((template, q))
    }

    fn require_start(&self, start: Option<&ContactSolution>) -> Result<(), SolveError> {
        let Some(start) = start else { return Ok(()) };
        require_length("the start's displacement", start.displacement.hi.len(), self.plate.dof_count())?;
        require_length("the start's reaction", start.reaction.len(), self.points.len())
    }
}
