//! Many combinations of few load cases: one LCP each, posed and solved without touching the plate.
//!
//! Everything that is linear in the factors is condensed once. A combination sums the cases' q, solves its LCP, and
//! solves the equations of the contact state found with the refined responses. Each is computed from its factors alone,
//! so that neither order nor number of threads changes a bit.

use super::condense::{Drive, Form, PosedLcp};
use super::problem::ContactProblem;
use super::responses::Response;
use super::solve::{ROUNDING, SIGN};
use crate::double_double::DoubleDouble;
use crate::lcp::{Lcp, LcpStatus, LemkeOptions, lemke_from};
use faer::Mat;
use faer::linalg::solvers::Solve;
use rayon::prelude::*;

/// How a combination ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Solved,
    /// Lemke's ray: no reactions balance the load, or the gaps contradict each other.
    NoEquilibrium,
    /// To be solved by itself: a sign is within rounding, or the pivot limit was reached.
    Doubtful,
}

/// One combination at the contact points.
#[derive(Clone, Debug)]
pub struct Combined {
    pub verdict: Verdict,
    /// Factors x of the points' responses.
    pub factor: Vec<f64>,
    pub reaction: Vec<f64>,
    pub gap: Vec<f64>,
    pub closed: Vec<bool>,
    pub pivots: usize,
}

/// What the combinations of some load cases share. Rows are contact points, columns cases or points.
pub struct CombinedCases {
    form: Form,
    /// The LCP of the plate at rest, before its free motions are imposed, and the part of q of each case.
    lcp: PosedLcp,
    q: Vec<Vec<f64>>,
    distance: Vec<f64>,
    rest: Response,
    cases: Vec<Response>,
    moved: Mat<f64>,
    reaction: Mat<f64>,
    start: Vec<bool>,
}

impl ContactProblem {
    /// Condenses load cases, given as their responses, for [`ContactProblem::combine`].
    ///
    /// The displacements of the responses are not read. The basis from which every LCP starts is that of all cases at
    /// factor 1.
    pub fn combined_cases(&self, rest: Response, cases: Vec<Response>, points: &[Response]) -> CombinedCases {
        let count = self.constraints.rows.len();
        let form = self.base.condensed.better_form();
        let still = vec![0.0; count];
        let distance = self.constraints.distance.clone();
        let pose = |response: &Response, remaining: &[f64]| {
            let sum = Sum { moved: response.moved.clone(), reaction: response.reaction.clone(), ..Sum::default() };
            self.base.condensed.posed(form, &sum.drive(form, remaining), &still)
        };
        let lcp = pose(&rest, &distance);
        let q = cases.iter().map(|case| pose(case, &still).q).collect();
        let column = |of: fn(&Response) -> &[f64]| Mat::from_fn(count, points.len(), |i, j| of(&points[j])[i]);
        let moved = column(|point| &point.moved);
        let reaction = column(|point| &point.reaction);
        let mut shared = CombinedCases { form, lcp, q, distance, rest, cases, moved, reaction, start: Vec::new() };
        let slacks = vec![false; shared.lcp.q.len()];
        let all = vec![1.0; shared.cases.len()];
        let (_, posed) = self.pose_combination(&shared, &all);
        let found =
            Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| lemke_from(&lcp, &LemkeOptions::default(), &slacks));
        shared.start = found.map_or(slacks, |solution| solution.basis);
        shared
    }

    /// Solves combinations, a row of factors each, in parallel.
    pub fn combine(&self, shared: &CombinedCases, factors: &[Vec<f64>]) -> Vec<Combined> {
        factors.par_iter().with_min_len(16).map(|row| self.combine_one(shared, row)).collect()
    }

    fn pose_combination(&self, shared: &CombinedCases, factors: &[f64]) -> (Sum, PosedLcp) {
        let sum = shared.sum(factors);
        let mut q = shared.lcp.q.clone();
        for (part, &factor) in shared.q.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
            q.iter_mut().zip(part).for_each(|(total, value)| *total += factor * value);
        }
        let drive = sum.drive(shared.form, &shared.distance);
        let posed = self.base.condensed.balanced(PosedLcp { q, ..shared.lcp.clone() }, &drive);
        (sum, posed)
    }

    fn combine_one(&self, shared: &CombinedCases, factors: &[f64]) -> Combined {
        let (sum, posed) = self.pose_combination(shared, factors);
        let count = sum.moved.len();
        let mut pivots = 0;
        let mut basis = Vec::new();
        let ended = |verdict, pivots| Combined {
            verdict,
            factor: vec![f64::NAN; count],
            reaction: vec![f64::NAN; count],
            gap: vec![f64::NAN; count],
            closed: vec![false; count],
            pivots,
        };
        if !posed.q.is_empty() {
            let found = Lcp::new(&posed.matrix, &posed.q)
                .and_then(|lcp| lemke_from(&lcp, &LemkeOptions::default(), &shared.start));
            let Ok(found) = found else { return ended(Verdict::Doubtful, 0) };
            pivots = found.pivots;
            match found.status {
                LcpStatus::Solved => basis = found.basis,
                LcpStatus::Ray => return ended(Verdict::NoEquilibrium, pivots),
                LcpStatus::PivotLimit => return ended(Verdict::Doubtful, pivots),
            }
        }
        let closed = self.base.condensed.closed_points(&posed, &basis);
        let travel = match shared.form {
            Form::Dual => sum.moved.iter().fold(0.0, |a: f64, b| a.max(b.abs())),
            Form::Stiffness => 0.0,
        };
        match self.state_of_sum(shared, &sum, &closed) {
            Some((factor, reaction, gap)) => {
                let settled = self.certain(&reaction, &gap, travel);
                let verdict = if settled { Verdict::Solved } else { Verdict::Doubtful };
                Combined { verdict, factor, reaction, gap, closed, pivots }
            }
            None => ended(Verdict::Doubtful, pivots),
        }
    }

    /// Factors of the points' responses, reactions and gaps in one contact state; `None` if its equations are singular.
    ///
    /// Closed points have y − C·reaction = distance, open ones reaction = 0.
    fn state_of_sum(
        &self,
        shared: &CombinedCases,
        sum: &Sum,
        closed: &[bool],
    ) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let count = closed.len();
        let (compliance, carried) = (&self.base.condensed.compliance, &self.base.condensed.regularization);
        let (y, r) = (&shared.moved, &shared.reaction);
        let right = |i: usize| {
            if closed[i] {
                shared.distance[i] - sum.moved[i] + compliance[i] * sum.reaction[i]
            } else {
                -sum.reaction[i]
            }
        };
        let entry = |i: usize, j: usize| if closed[i] { y[(i, j)] - compliance[i] * r[(i, j)] } else { r[(i, j)] };
        // Equations in which one factor stands alone.
        let alone = |i: usize| match (shared.form, closed[i]) {
            (Form::Stiffness, true) => (compliance[i] == 0.0).then_some(1.0),
            (Form::Stiffness, false) => None,
            (Form::Dual, true) => self.base.condensed.absorbed(i).then_some(compliance[i]),
            (Form::Dual, false) => (carried[i] == 0.0).then_some(-1.0),
        };
        let mut x = vec![0.0; count];
        let mut unknown = Vec::new();
        for i in 0..count {
            match alone(i) {
                Some(lever) => x[i] = right(i) / lever,
                None => unknown.push(i),
            }
        }
        if !unknown.is_empty() {
            let size = unknown.len();
            let matrix = Mat::from_fn(size, size, |p, q| entry(unknown[p], unknown[q]));
            let factors = matrix.partial_piv_lu();
            if (0..size).any(|p| factors.U()[(p, p)] == 0.0 || !factors.U()[(p, p)].is_finite()) {
                return None;
            }
            // The second pass corrects the first by what it leaves, summed in double-double.
            for _ in 0..2 {
                let mut left = Mat::from_fn(size, 1, |p, _| {
                    let mut rest = DoubleDouble::from(right(unknown[p]));
                    (0..count).for_each(|j| rest.add_product(-entry(unknown[p], j), x[j]));
                    rest.value()
                });
                factors.solve_in_place(left.as_mut());
                unknown.iter().enumerate().for_each(|(p, &i)| x[i] += left[(p, 0)]);
            }
        }
        let total = |of: &Mat<f64>, own: f64, i: usize| {
            let mut sum = DoubleDouble::from(own);
            (0..count).for_each(|j| sum.add_product(of[(i, j)], x[j]));
            sum.value()
        };
        let reaction = (0..count).map(|i| if closed[i] { total(r, sum.reaction[i], i) } else { 0.0 }).collect();
        let gap =
            (0..count).map(|i| if closed[i] { 0.0 } else { shared.distance[i] - total(y, sum.moved[i], i) }).collect();
        Some((x, reaction, gap))
    }

    /// Whether every reaction pushes and every gap is open, beyond rounding.
    fn certain(&self, reaction: &[f64], gap: &[f64], travel: f64) -> bool {
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let force = SIGN * largest(reaction);
        let distance = &self.constraints.distance;
        let moved = distance.iter().zip(gap).fold(0.0, |most: f64, (distance, gap)| most.max((distance - gap).abs()));
        // A stop far away says nothing of what happens at others.
        let length = |i: usize| (SIGN * moved.max(distance[i].abs())).max(ROUNDING * travel);
        let holds = |i: usize| self.constraints.two_sided[i] || (reaction[i] >= -force && gap[i] >= -length(i));
        let finite = reaction.iter().chain(gap).all(|value| value.is_finite());
        finite && (0..reaction.len()).all(holds)
    }
}

/// The cases of one combination together, before any point pushes.
#[derive(Default)]
struct Sum {
    moved: Vec<f64>,
    reaction: Vec<f64>,
    work: Vec<f64>,
    work_size: Vec<f64>,
}

impl Sum {
    fn drive(&self, form: Form, remaining: &[f64]) -> Drive {
        let zeros = || vec![0.0; self.moved.len()];
        let (displacement, force) = match form {
            Form::Dual => (self.moved.clone(), zeros()),
            Form::Stiffness => (Vec::new(), self.reaction.clone()),
        };
        let (work, work_size) = (self.work.clone(), self.work_size.clone());
        Drive { displacement, force, work, work_size, remaining: remaining.to_vec() }
    }
}

impl CombinedCases {
    fn sum(&self, factors: &[f64]) -> Sum {
        let of = |part: fn(&Response) -> &[f64], size: fn(f64) -> f64| {
            let mut total = part(&self.rest).to_vec();
            for (case, &factor) in self.cases.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
                total.iter_mut().zip(part(case)).for_each(|(sum, value)| *sum += size(factor) * value);
            }
            total
        };
        Sum {
            moved: of(|r| &r.moved, |factor| factor),
            reaction: of(|r| &r.reaction, |factor| factor),
            work: of(|r| &r.work, |factor| factor),
            work_size: of(|r| &r.work_size, f64::abs),
        }
    }
}
