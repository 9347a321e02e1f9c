//! Many combinations of few load cases: each combination solves one LCP of the contact points, without a solve with K.
//!
//! All quantities that are linear in the load are condensed once for each load case. A combination sums q over its
//! cases, solves its LCP, and solves the equations of its contact state with the refined responses. Its result depends
//! on its own factors only, so that order of combinations and number of threads change no bit.

mod contact_set_solver;

use super::error::{SolveError, require_length};
use super::finders::{beyond, pieces_of};
use super::interface::{CondensedRhs, Form, Interface, LcpTemplate, Work};
use super::points::PointState;
use super::problem::ContactProblem;
use super::residual::largest_force;
use super::responses::Response;
use super::tolerances;
use crate::lcp::{Lcp, LcpBasis, LcpFamily};
use contact_set_solver::ContactSetSolver;
use rayon::prelude::*;

/// Number of combinations solved between two calls of the callback.
const TOGETHER: usize = 256;

/// Solution of one combination at the m contact points.
#[derive(Clone, Debug)]
pub struct Combined {
    /// Factors x (m,) of the responses to the contact points, see [`Response`].
    pub factor: Vec<f64>,
    pub reaction: Vec<f64>,
    pub gap: Vec<f64>,
    pub piece: Vec<u8>,
    pub pivots: usize,
}

/// Condensed load cases, which all combinations share.
pub struct CombinedCases {
    form: Form,
    /// Vector q (k,) of the LCP without load, and the change of q by each load case. Balance in the free rigid motions
    /// is not yet imposed on them.
    q_at_rest: Vec<f64>,
    q: Vec<Vec<f64>>,
    /// The LCPs of all combinations have the same M and start at the basis of the reference contact state; `None` if
    /// this basis is singular.
    family: Option<LcpFamily>,
    set_solver: ContactSetSolver,
    /// For each contact point (m,), the distance in travel from the state u = 0, r = 0 to the line of the piece of its
    /// law on which the LCP starts.
    distance: Vec<f64>,
    rest: Response,
    cases: Vec<Response>,
}

impl ContactProblem {
    /// Condenses load cases for [`ContactProblem::combine`], from the responses without load (`rest`), to each case
    /// (`cases`) and to each contact point (`points`). The displacements of these responses are not used.
    ///
    /// The reference contact state is the solution for the sum of all cases, or the first pieces of the laws if this
    /// load has no solution. Each LCP starts from the basis of the reference state. The equations of each contact state
    /// are solved with the inverse for the reference state.
    pub fn combined_cases(
        &self,
        rest: Response,
        cases: Vec<Response>,
        points: &[Response],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<CombinedCases, SolveError> {
        let interface = self.condensed()?;
        require_length("the responses of points", points.len(), self.points.len())?;
        let form = interface.better_form();
        let still = vec![0.0; self.points.len()];
        let first = interface.first_pieces(&self.points, form);
        // Distance in travel from the state u = 0, r = 0 to the line of the first piece of a point's law.
        let to_piece = |(i, &piece): (usize, &u8)| {
            let piece = self.points.piece(i, piece);
            piece.travel - piece.compliance() * piece.force
        };
        let distance: Vec<f64> = first.iter().enumerate().map(to_piece).collect();
        let template = self.lcp_template(form)?;
        let q_at_rest = template.q(interface, &self.points, &rhs(form, &rest, &distance), &still)?;
        let of_case = |case: &Response| template.increment(interface, &rhs(form, case, &still));
        let q = cases.iter().map(of_case).collect::<Result<_, _>>()?;
        let set_solver = ContactSetSolver::new(form, points)?;
        let mut shared = CombinedCases { form, q_at_rest, q, family: None, set_solver, distance, rest, cases };
        let q = shared.pose(template, &vec![1.0; shared.cases.len()]).1;
        let pieces = match pieces_of(self, template, &q, None, &mut 0, &mut |_| watch()) {
            Err(error) if error.is_of_load() => template.vertices.pieces(&vec![false; q.len()]),
            pieces => pieces?,
        };
        let family = Lcp::new(&template.matrix, &q)
            .and_then(|lcp| LcpFamily::new(&lcp, &template.vertices.basis(&pieces)))
            .map_err(SolveError::from);
        shared.family = match family {
            Err(SolveError::Unsolved) => return Ok(shared),
            family => family?,
        };
        shared.set_solver.begin_with(interface, &self.points, pieces)?;
        Ok(shared)
    }

    /// Solves combinations in parallel; each row of `factors` has one factor per case. `watch` is called between groups
    /// of combinations and cancels by returning false.
    ///
    /// The error [`SolveError::NoEquilibrium`] includes gaps that contradict each other. [`SolveError::Unsolved`] means
    /// that the combination must be solved separately: signs are within rounding, or the pivot limit was reached.
    pub fn combine(
        &self,
        shared: &CombinedCases,
        factors: &[Vec<f64>],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Result<Combined, SolveError>>, SolveError> {
        let interface = self.condensed()?;
        factors.iter().try_for_each(|row| require_length("factors", row.len(), shared.cases.len()))?;
        let mut result = Vec::with_capacity(factors.len());
        for rows in factors.chunks(TOGETHER) {
            if !watch() {
                return Err(SolveError::Cancelled);
            }
            let solved = |row: &Vec<f64>| match self.combine_one(interface, shared, row) {
                Err(error) if !error.is_of_load() => Err(error),
                combined => Ok(combined),
            };
            let some: Result<Vec<_>, _> = rows.par_iter().with_min_len(16).map(solved).collect();
            result.extend(some?);
        }
        Ok(result)
    }

    fn combine_one(
        &self,
        interface: &Interface,
        shared: &CombinedCases,
        factors: &[f64],
    ) -> Result<Combined, SolveError> {
        let template = self.lcp_template(shared.form)?;
        let (sum, q) = shared.pose(template, factors);
        if q.is_empty() {
            return self.on_pieces_of(interface, shared, &sum, template.vertices.pieces(&[]), 0);
        }
        let family = shared.family.as_ref().ok_or(SolveError::Unsolved)?;
        let LcpBasis { status, basis, mut pivots } = family.solve(&q)?;
        SolveError::of(status)?;
        let pieces = template.vertices.pieces(&basis);
        match self.on_pieces_of(interface, shared, &sum, pieces.clone(), pivots) {
            Err(SolveError::Unsolved) => {}
            combined => return combined,
        }
        // The LCP was solved, but rounding in many pivots made the contact state infeasible. A new tableau that starts
        // from this state needs few pivots.
        let again = pieces_of(self, template, &q, Some(pieces), &mut pivots, &mut |_| true)?;
        self.on_pieces_of(interface, shared, &sum, again, pivots)
    }

    /// Solves a combination on the contact state `piece` (m,). `sum` is the response without load plus those to the
    /// load cases, multiplied by the factors of the combination.
    fn on_pieces_of(
        &self,
        interface: &Interface,
        shared: &CombinedCases,
        sum: &Response,
        piece: Vec<u8>,
        pivots: usize,
    ) -> Result<Combined, SolveError> {
        let travel = match shared.form {
            Form::Dual => (0..piece.len()).map(|i| self.points.arm[i] * sum.moved[i].abs()).fold(0.0, f64::max),
            Form::Stiffness => 0.0,
        };
        let solved = shared.set_solver.solve(interface, &self.points, &piece, &sum.moved, &sum.reaction)?;
        let (factor, reaction, gap) = solved.ok_or(SolveError::Unsolved)?;
        if !self.is_certain(&piece, &reaction, &gap, travel) {
            return Err(SolveError::Unsolved);
        }
        Ok(Combined { factor, reaction, gap, piece, pivots })
    }

    /// Whether every contact point is within the bounds of its piece of the law, up to rounding. `travel` is the
    /// largest travel in the sum of the responses.
    fn is_certain(&self, pieces: &[u8], reaction: &[f64], gap: &[f64], travel: f64) -> bool {
        let force = tolerances::SIGN * largest_force(self, &[], reaction);
        let (shift, arm) = (&self.points.shift, &self.points.arm);
        let moved = (0..gap.len()).map(|i| arm[i] * (shift[i] - gap[i]).abs()).fold(0.0, f64::max);
        // A large gap of one point changes the tolerance for the travel of this point only.
        let length = |i: usize| {
            let moved = moved / arm[i];
            (tolerances::SIGN * moved.max(shift[i].abs())).max(tolerances::RESIDUAL * travel / arm[i])
        };
        let finite = reaction.iter().chain(gap).all(|value| value.is_finite());
        let state = |i: usize| PointState { piece: pieces[i], reaction: reaction[i], gap: gap[i] };
        finite && beyond(self, state, force, length).next().is_none()
    }
}

/// Right-hand side of the condensed equations for a response, with a copy of `violation` (m,), the distances to pieces
/// of the laws.
fn rhs(form: Form, response: &Response, violation: &[f64]) -> CondensedRhs {
    let (displacement, force) = match form {
        Form::Dual => (response.moved.clone(), vec![0.0; response.moved.len()]),
        Form::Stiffness => (Vec::new(), response.reaction.clone()),
    };
    CondensedRhs { displacement, force, violation: violation.to_vec() }
}

impl CombinedCases {
    /// The sum of the responses with the factors of a combination, and the vector q (k,) of the LCP of this
    /// combination.
    fn pose(&self, template: &LcpTemplate, factors: &[f64]) -> (Response, Vec<f64>) {
        let sum = self.sum(factors);
        let mut q = self.q_at_rest.clone();
        for (part, &factor) in self.q.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
            q.iter_mut().zip(part).for_each(|(total, value)| *total += factor * value);
        }
        template.balance(&mut q, &rhs(self.form, &sum, &self.distance), &sum.work);
        (sum, q)
    }

    /// The sum of responses u₀ + Σ factor_c u_c at the contact points: the response without load plus those to the load
    /// cases.
    fn sum(&self, factors: &[f64]) -> Response {
        let of = |part: fn(&Response) -> &[f64], size: fn(f64) -> f64| {
            let mut total = part(&self.rest).to_vec();
            for (case, &factor) in self.cases.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
                total.iter_mut().zip(part(case)).for_each(|(sum, value)| *sum += size(factor) * value);
            }
            total
        };
        Response {
            moved: of(|r| &r.moved, |factor| factor),
            reaction: of(|r| &r.reaction, |factor| factor),
            work: Work { sum: of(|r| &r.work.sum, |factor| factor), size: of(|r| &r.work.size, f64::abs) },
            ..Response::default()
        }
    }
}
