//! Many combinations of few load cases: one LCP each, without an operation on the plate.
//!
//! All terms that are linear in the factors are condensed once. A combination sums q of its cases, solves its LCP, and
//! solves the equations of that contact state with the refined responses. Each result depends on its factors only, so
//! that order and number of threads change no bit.

mod contact_set_solver;

use super::finders::{ended, in_memory, is_feasible, pieces_of};
use super::interface::{CondensedRhs, Form, FreeMotions, PosedLcp, Work};
use super::problem::ContactProblem;
use super::residual::largest_force;
use super::responses::Response;
use super::solution::Outcome;
use super::tolerances;
use crate::cholesky::FactorError;
use crate::lcp::{Lcp, LcpBasis, LcpFamily};
use contact_set_solver::ContactSetSolver;
use rayon::prelude::*;

/// Combinations between two calls of the callback.
const TOGETHER: usize = 256;

/// Result of one combination at the contact points.
#[derive(Clone, Debug)]
pub struct Combined {
    /// `NoEquilibrium` includes contradictory gaps. `Unsolved` means that the combination needs a solve of its own:
    /// signs are within rounding, or the pivot limit was reached.
    pub outcome: Outcome,
    /// Factors x of the responses of points.
    pub factor: Vec<f64>,
    pub reaction: Vec<f64>,
    pub gap: Vec<f64>,
    pub piece: Vec<u8>,
    pub pivots: usize,
}

/// Data shared by all combinations.
pub struct CombinedCases {
    form: Form,
    /// The LCP of the sum of all cases; q at rest and of each case, before the free motions are imposed.
    lcp: PosedLcp,
    motions: FreeMotions,
    q_at_rest: Vec<f64>,
    q: Vec<Vec<f64>>,
    /// Family of LCPs with one M; `None` without a start basis.
    family: Option<LcpFamily>,
    set_solver: ContactSetSolver,
    /// Travel of each point from rest to its first piece.
    distance: Vec<f64>,
    rest: Response,
    cases: Vec<Response>,
}

impl ContactProblem {
    /// Condenses load cases, given by their responses, for [`ContactProblem::combine`]; displacements of the responses
    /// are unused.
    ///
    /// Each LCP starts from the basis, and each contact state from the factor, of all cases at factor 1, or of the open
    /// state if these have no equilibrium. `None` if `watch` cancels.
    pub fn combined_cases(
        &self,
        rest: Response,
        cases: Vec<Response>,
        points: &[Response],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Option<CombinedCases>, FactorError> {
        let interface = self.interface();
        let form = interface.better_form();
        let still = vec![0.0; self.points.len()];
        let first = interface.first_pieces(&self.points, form);
        // Travel at which the force on the first piece is zero.
        let to_piece = |(i, &piece): (usize, &u8)| {
            let piece = self.points.piece(i, piece);
            piece.travel - piece.compliance() * piece.force
        };
        let distance: Vec<f64> = first.iter().enumerate().map(to_piece).collect();
        let of_cases = cases.iter().map(|case| rhs(form, case, &still));
        let all: Vec<_> = std::iter::once(rhs(form, &rest, &distance)).chain(of_cases).collect();
        let (mut lcp, q) = interface.posed(&self.points, form, &all, &still)?;
        let motions = interface.impose_motions(&self.points, &mut lcp)?;
        let set_solver = ContactSetSolver::new(self, form, points)?;
        let q_at_rest = lcp.q.clone();
        let mut shared =
            CombinedCases { form, lcp, motions, q_at_rest, q, family: None, set_solver, distance, rest, cases };
        shared.lcp.q = shared.pose(&vec![1.0; shared.cases.len()]).1;
        let pieces = match pieces_of(self, &shared.lcp, None, &mut 0, &mut |_| watch())? {
            Ok(pieces) => pieces,
            Err(Outcome::Interrupted) => return Ok(None),
            Err(_) => shared.lcp.pieces(&vec![false; shared.lcp.q.len()]),
        };
        let Some(lcp) = in_memory(Lcp::new(&shared.lcp.matrix, &shared.lcp.q))? else { return Ok(Some(shared)) };
        shared.family = in_memory(LcpFamily::new(&lcp, &shared.lcp.basis(&pieces)))?.flatten();
        shared.set_solver.begin_with(self, pieces)?;
        Ok(Some(shared))
    }

    /// Solves combinations, one row of factors each, in parallel. `watch` is called at intervals and cancels by
    /// returning false; then results are missing.
    pub fn combine(
        &self,
        shared: &CombinedCases,
        factors: &[Vec<f64>],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Combined>, FactorError> {
        let mut result = Vec::with_capacity(factors.len());
        for rows in factors.chunks(TOGETHER) {
            if !watch() {
                break;
            }
            let some: Result<Vec<_>, _> =
                rows.par_iter().with_min_len(16).map(|row| self.combine_one(shared, row)).collect();
            result.extend(some?);
        }
        Ok(result)
    }

    fn combine_one(&self, shared: &CombinedCases, factors: &[f64]) -> Result<Combined, FactorError> {
        let (sum, q) = shared.pose(factors);
        if q.is_empty() {
            return self.on_pieces_of(shared, &sum, Ok(shared.lcp.pieces(&[])), 0);
        }
        let end = shared.family.as_ref().map(|family| in_memory(family.solve(&q))).transpose()?.flatten();
        let Some(LcpBasis { status, basis, mut pivots }) = end else {
            return self.on_pieces_of(shared, &sum, Err(Outcome::Unsolved), 0);
        };
        let ended = ended(status);
        let pieces = shared.lcp.pieces(&basis);
        let combined = self.on_pieces_of(shared, &sum, ended.map(|()| pieces.clone()), pivots)?;
        if ended.is_err() || combined.outcome == Outcome::Solved {
            return Ok(combined);
        }
        // Rounding of many pivots gave an infeasible state nearby: few pivots with a fresh tableau remain.
        let mut posed = shared.lcp.clone();
        posed.q = q;
        let again = pieces_of(self, &posed, Some(pieces), &mut pivots, &mut |_| true)?;
        self.on_pieces_of(shared, &sum, again, pivots)
    }

    /// The combination on the contact state of its LCP.
    fn on_pieces_of(
        &self,
        shared: &CombinedCases,
        sum: &Response,
        end: Result<Vec<u8>, Outcome>,
        pivots: usize,
    ) -> Result<Combined, FactorError> {
        let count = sum.moved.len();
        let ended = |outcome| {
            let nan = vec![f64::NAN; count];
            let (factor, reaction, gap) = (nan.clone(), nan.clone(), nan);
            Ok(Combined { outcome, factor, reaction, gap, piece: vec![0; count], pivots })
        };
        let piece = match end {
            Ok(piece) => piece,
            Err(outcome) => return ended(outcome),
        };
        let travel = match shared.form {
            Form::Dual => (0..count).map(|i| self.points.arm[i] * sum.moved[i].abs()).fold(0.0, f64::max),
            Form::Stiffness => 0.0,
        };
        match shared.set_solver.solve(self, &piece, &sum.moved, &sum.reaction)? {
            Some((factor, reaction, gap)) => {
                let settled = self.is_certain(&piece, &reaction, &gap, travel);
                let outcome = if settled { Outcome::Solved } else { Outcome::Unsolved };
                Ok(Combined { outcome, factor, reaction, gap, piece, pivots })
            }
            None => ended(Outcome::Unsolved),
        }
    }

    /// Whether every point is within the bounds of its piece, beyond rounding.
    fn is_certain(&self, pieces: &[u8], reaction: &[f64], gap: &[f64], travel: f64) -> bool {
        let force = tolerances::SIGN * largest_force(self, &[], reaction);
        let (shift, arm) = (&self.points.shift, &self.points.arm);
        let moved = (0..gap.len()).map(|i| arm[i] * (shift[i] - gap[i]).abs()).fold(0.0, f64::max);
        // A distant stop does not change the tolerance at other points.
        let length = |i: usize| {
            let moved = moved / arm[i];
            (tolerances::SIGN * moved.max(shift[i].abs())).max(tolerances::RESIDUAL * travel / arm[i])
        };
        let finite = reaction.iter().chain(gap).all(|value| value.is_finite());
        finite && is_feasible(self, pieces, reaction, gap, force, length)
    }
}

/// The right-hand side of a response at the points.
fn rhs(form: Form, response: &Response, violation: &[f64]) -> CondensedRhs {
    let (displacement, force) = match form {
        Form::Dual => (response.moved.clone(), vec![0.0; response.moved.len()]),
        Form::Stiffness => (Vec::new(), response.reaction.clone()),
    };
    CondensedRhs { displacement, force, violation: violation.to_vec() }
}

impl CombinedCases {
    /// The sum of the cases of a combination, and q of its LCP.
    fn pose(&self, factors: &[f64]) -> (Response, Vec<f64>) {
        let sum = self.sum(factors);
        let mut q = self.q_at_rest.clone();
        for (part, &factor) in self.q.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
            q.iter_mut().zip(part).for_each(|(total, value)| *total += factor * value);
        }
        self.motions.balance(&mut q, &rhs(self.form, &sum, &self.distance), &sum.work);
        (sum, q)
    }

    /// The sum of responses without displacements.
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
