//! Many combinations of few load cases: one LCP each, posed and solved without touching the plate.
//!
//! Everything that is linear in the factors is condensed once. A combination sums the cases' q, solves its LCP, and
//! solves the equations of the contact state found with the refined responses. Each is computed from its factors alone,
//! so that neither order nor number of threads changes a bit.

mod on_set;

use super::condense::{Form, FreeMotions, InterfaceResidual, PosedLcp, Work};
use super::lcp::{ended, in_memory};
use super::problem::ContactProblem;
use super::responses::Response;
use super::solution::Outcome;
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::lcp::{Lcp, LcpBasis, LcpFamily};
use on_set::OnSet;
use rayon::prelude::*;

/// Combinations between two looks at whoever watches.
const TOGETHER: usize = 256;

/// One combination at the contact points.
#[derive(Clone, Debug)]
pub struct Combined {
    /// Without equilibrium also where the gaps contradict each other; unsolved are those to be solved by themselves, whose
    /// signs are within rounding or whose pivots came to their limit.
    pub outcome: Outcome,
    /// Factors x of the points' responses.
    pub factor: Vec<f64>,
    pub reaction: Vec<f64>,
    pub gap: Vec<f64>,
    pub closed: Vec<bool>,
    pub pivots: usize,
}

/// What the combinations of some load cases share.
pub struct CombinedCases {
    form: Form,
    /// The LCP of all cases together, and q, before its free motions are imposed, of the plate at rest and of each case.
    lcp: PosedLcp,
    motions: FreeMotions,
    q_at_rest: Vec<f64>,
    q: Vec<Vec<f64>>,
    /// Nothing if there is no basis to begin with.
    family: Option<LcpFamily>,
    on_set: OnSet,
    distance: Vec<f64>,
    rest: Response,
    cases: Vec<Response>,
}

impl ContactProblem {
    /// Condenses load cases, given as their responses, for [`ContactProblem::combine`].
    ///
    /// The displacements of the responses are not read. Every LCP starts from the basis, and every contact set from the
    /// factor, of all cases at factor 1, or of no contact if these have no equilibrium. `None` where `watch` wants no more.
    pub fn combined_cases(
        &self,
        rest: Response,
        cases: Vec<Response>,
        points: &[Response],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Option<CombinedCases>, FactorError> {
        let count = self.constraints.rows.len();
        let form = self.base.condensed.better_form();
        let still = vec![0.0; count];
        let distance = self.constraints.distance.clone();
        let of_cases = cases.iter().map(|case| interface(form, case, &still));
        let all: Vec<_> = std::iter::once(interface(form, &rest, &distance)).chain(of_cases).collect();
        let (mut lcp, q) = self.base.condensed.posed(form, &all, &still)?;
        let motions = self.base.condensed.impose_motions(&mut lcp)?;
        let on_set = OnSet::new(&self.base.condensed, form, points)?;
        let q_at_rest = lcp.q.clone();
        let mut shared =
            CombinedCases { form, lcp, motions, q_at_rest, q, family: None, on_set, distance, rest, cases };
        shared.lcp.q = shared.pose(&vec![1.0; shared.cases.len()]).1;
        let basis = match self.solve_lcp(&shared.lcp, None, &mut 0, &mut |_| watch())? {
            Ok(basis) => basis,
            Err(Outcome::Interrupted) => return Ok(None),
            Err(_) => vec![false; shared.lcp.q.len()],
        };
        let Some(lcp) = in_memory(Lcp::new(&shared.lcp.matrix, &shared.lcp.q))? else { return Ok(Some(shared)) };
        shared.family = in_memory(LcpFamily::new(&lcp, &basis))?.flatten();
        shared.on_set.begin_with(self.base.condensed.closed_points(&shared.lcp, &basis))?;
        Ok(Some(shared))
    }

    /// Solves combinations, a row of factors each, in parallel. `watch` is asked now and then and ends it by returning
    /// false; then answers are missing.
    pub fn combine(
        &self,
        shared: &CombinedCases,
        factors: &[Vec<f64>],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<Combined>, FactorError> {
        let mut found = Vec::with_capacity(factors.len());
        for rows in factors.chunks(TOGETHER) {
            if !watch() {
                break;
            }
            let some: Result<Vec<_>, _> =
                rows.par_iter().with_min_len(16).map(|row| self.combine_one(shared, row)).collect();
            found.extend(some?);
        }
        Ok(found)
    }

    fn combine_one(&self, shared: &CombinedCases, factors: &[f64]) -> Result<Combined, FactorError> {
        let (sum, q) = shared.pose(factors);
        if q.is_empty() {
            return self.on_basis(shared, &sum, Ok(&[]), 0);
        }
        let found = shared.family.as_ref().map(|family| in_memory(family.solve(&q))).transpose()?.flatten();
        let Some(LcpBasis { status, basis, mut pivots }) = found else {
            return self.on_basis(shared, &sum, Err(Outcome::Unsolved), 0);
        };
        let ended = ended(status);
        let combined = self.on_basis(shared, &sum, ended.map(|()| &basis[..]), pivots)?;
        if ended.is_err() || combined.outcome == Outcome::Solved {
            return Ok(combined);
        }
        // Rounding of many pivots has led astray, but not far: from there, with a tableau of its own, few are left.
        let posed = PosedLcp { q, ..shared.lcp.clone() };
        let again = self.solve_lcp(&posed, Some(&basis), &mut pivots, &mut |_| true)?;
        self.on_basis(shared, &sum, again.as_deref().map_err(|outcome| *outcome), pivots)
    }

    /// The combination at the basis at which its LCP ended, if it did at one.
    fn on_basis(
        &self,
        shared: &CombinedCases,
        sum: &Response,
        found: Result<&[bool], Outcome>,
        pivots: usize,
    ) -> Result<Combined, FactorError> {
        let count = sum.moved.len();
        let ended = |outcome| {
            let nan = vec![f64::NAN; count];
            let (factor, reaction, gap) = (nan.clone(), nan.clone(), nan);
            Ok(Combined { outcome, factor, reaction, gap, closed: vec![false; count], pivots })
        };
        let basis = match found {
            Ok(basis) => basis,
            Err(outcome) => return ended(outcome),
        };
        let closed = self.base.condensed.closed_points(&shared.lcp, basis);
        let travel = match shared.form {
            Form::Dual => (0..count).map(|i| self.lever(i) * sum.moved[i].abs()).fold(0.0, f64::max),
            Form::Stiffness => 0.0,
        };
        match shared.on_set.solve(&closed, &shared.distance, &sum.moved, &sum.reaction)? {
            Some((factor, reaction, gap)) => {
                let settled = self.certain(&reaction, &gap, travel);
                let outcome = if settled { Outcome::Solved } else { Outcome::Unsolved };
                Ok(Combined { outcome, factor, reaction, gap, closed, pivots })
            }
            None => ended(Outcome::Unsolved),
        }
    }

    /// Whether every reaction pushes and every gap is open, beyond rounding.
    fn certain(&self, reaction: &[f64], gap: &[f64], travel: f64) -> bool {
        let force = tolerances::SIGN * self.largest_force(&[], reaction);
        let distance = &self.constraints.distance;
        let moved = (0..gap.len()).map(|i| self.lever(i) * (distance[i] - gap[i]).abs()).fold(0.0, f64::max);
        // A stop far away says nothing of what happens at others.
        let length = |i: usize| {
            let moved = moved / self.lever(i);
            (tolerances::SIGN * moved.max(distance[i].abs())).max(tolerances::RESIDUAL * travel / self.lever(i))
        };
        let finite = reaction.iter().chain(gap).all(|value| value.is_finite());
        finite && self.push_and_open(reaction, gap, force, length)
    }
}

/// What a response does at the points, past no reaction.
fn interface(form: Form, response: &Response, remaining: &[f64]) -> InterfaceResidual {
    let (displacement, force) = match form {
        Form::Dual => (response.moved.clone(), vec![0.0; response.moved.len()]),
        Form::Stiffness => (Vec::new(), response.reaction.clone()),
    };
    InterfaceResidual { displacement, force, remaining: remaining.to_vec() }
}

impl CombinedCases {
    /// The cases of a combination together, and the q of its LCP.
    fn pose(&self, factors: &[f64]) -> (Response, Vec<f64>) {
        let sum = self.sum(factors);
        let mut q = self.q_at_rest.clone();
        for (part, &factor) in self.q.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
            q.iter_mut().zip(part).for_each(|(total, value)| *total += factor * value);
        }
        self.motions.balance(&mut q, &interface(self.form, &sum, &self.distance), &sum.work);
        (sum, q)
    }

    /// Their sum, but for the displacement.
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
