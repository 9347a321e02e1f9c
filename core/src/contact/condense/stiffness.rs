//! The plate at its contact points by stiffness: reaction = f̂ − S y.

use super::condensed::{Condensed, ContactState, InterfaceResidual, PosedLcp, Response, StateFactor};
use crate::dense::{self, Cholesky, Lu, OutOfMemory, row_major};
use faer::Mat;

impl Condensed {
    /// M = (I + SC)⁻¹S, every q = (I + SC)⁻¹(f̂ + reaction − S(remaining − C·reaction)).
    pub(super) fn stiffness_lcp(
        &self,
        stiffness: &Mat<f64>,
        interfaces: &[InterfaceResidual],
        reaction: &[f64],
    ) -> Result<(PosedLcp, Vec<Vec<f64>>), OutOfMemory> {
        let m = self.len();
        let acting = |interface: &InterfaceResidual| -> Vec<f64> {
            let travel = |i: usize| interface.remaining[i] - self.compliance[i] * reaction[i];
            let travel = self.without_rigid_motion(&(0..m).map(travel).collect::<Vec<f64>>());
            let held = |i: usize| (0..m).map(|j| stiffness[(i, j)] * travel[j]).sum::<f64>();
            (0..m).map(|i| interface.force[i] + reaction[i] - held(i)).collect()
        };
        let mut q: Vec<Vec<f64>> = interfaces.iter().map(acting).collect();
        let point: Vec<usize> = (0..m).filter(|&i| !self.two_sided[i]).collect();
        let matrix: Vec<f64> = if self.compliance.iter().all(|&c| c == 0.0) {
            row_major(point.len(), point.len(), |r, c| stiffness[(point[r], point[c])])?
        } else {
            let coupled = dense::matrix(m, m, |i, j| {
                let through = stiffness[(i, j)] * self.compliance[j];
                if i == j { 1.0 + through } else { through }
            })?;
            let mut right = dense::matrix(m, m + q.len(), |i, j| if j < m { stiffness[(i, j)] } else { q[j - m][i] })?;
            Lu::of(coupled)?.solve_in_place(right.as_mut())?;
            q = (0..q.len()).map(|k| (0..m).map(|i| right[(i, m + k)]).collect()).collect();
            let even = |i: usize, j: usize| 0.5 * (right[(i, j)] + right[(j, i)]);
            row_major(point.len(), point.len(), |r, c| even(point[r], point[c]))?
        };
        let of_points = |q: &Vec<f64>| -> Vec<f64> { point.iter().map(|&i| q[i]).collect() };
        let (first, others) = (of_points(&q[0]), q[1..].iter().map(of_points).collect());
        Ok((PosedLcp { matrix, q: first, gap_is_z: vec![true; point.len()], point }, others))
    }

    /// Points whose displacement is not known: open ones, and closed ones on springs.
    pub(super) fn stiffness_state(
        &self,
        stiffness: &Mat<f64>,
        closed: Vec<bool>,
    ) -> Result<Option<ContactState>, OutOfMemory> {
        let unknown: Vec<usize> = (0..self.len()).filter(|&i| !closed[i] || self.compliance[i] > 0.0).collect();
        if unknown.is_empty() {
            return Ok(Some(ContactState { closed, unknown, factor: StateFactor::Nothing }));
        }
        let matrix = dense::matrix(unknown.len(), unknown.len(), |r, c| {
            let (i, j) = (unknown[r], unknown[c]);
            let spring = if i == j && closed[i] { 1.0 / self.compliance[i] } else { 0.0 };
            stiffness[(i, j)] + spring
        })?;
        let Some(factor) = Cholesky::of(matrix)? else { return Ok(None) };
        Ok(Some(ContactState { closed, unknown, factor: StateFactor::Stiffness(factor) }))
    }

    pub(super) fn solve_stiffness_state(
        &self,
        stiffness: &Mat<f64>,
        state: &ContactState,
        interface: &InterfaceResidual,
    ) -> Response {
        let m = self.len();
        let rigid = |i: usize| state.closed[i] && self.compliance[i] == 0.0;
        let mut moved: Vec<f64> = (0..m).map(|i| if rigid(i) { interface.remaining[i] } else { 0.0 }).collect();
        let held = |i: usize, moved: &[f64]| (0..m).map(|j| stiffness[(i, j)] * moved[j]).sum::<f64>();
        if let StateFactor::Stiffness(factor) = &state.factor {
            let mut right = Mat::from_fn(state.unknown.len(), 1, |r, _| {
                let i = state.unknown[r];
                let spring = if state.closed[i] { interface.remaining[i] / self.compliance[i] } else { 0.0 };
                interface.force[i] + spring - held(i, &moved)
            });
            factor.solve_in_place(right.as_mut());
            for (r, &i) in state.unknown.iter().enumerate() {
                moved[i] = right[(r, 0)];
            }
        }
        let mut reaction = vec![0.0; m];
        for i in (0..m).filter(|&i| state.closed[i]) {
            reaction[i] = match rigid(i) {
                true => interface.force[i] - held(i, &moved),
                false => (moved[i] - interface.remaining[i]) / self.compliance[i],
            };
        }
        Response { reaction, moved }
    }
}
