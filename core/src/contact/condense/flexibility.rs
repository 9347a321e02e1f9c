//! The plate at its contact points by flexibility: (I − P̃δ)·gap = B·reaction − s̃.

use super::condensed::{Condensed, ContactState, InterfaceResidual, PosedLcp, Response, StateFactor};
use crate::contact::tolerances;
use crate::dense::{self, Lu, OutOfMemory, row_major};
use faer::{MatMut, MatRef};

impl Condensed {
    /// Whether the factor carries the whole stiffness of a compliant point.
    pub(crate) fn absorbed(&self, i: usize) -> bool {
        self.compliance[i] > 0.0
            && (1.0 - self.regularization[i] * self.compliance[i]).abs() < tolerances::interface::ABSORBED
    }

    /// Entry of B = P̃(I − δC) + C.
    fn b(&self, p: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let through =
            if self.absorbed(j) { 0.0 } else { p[(i, j)] * (1.0 - self.regularization[j] * self.compliance[j]) };
        if i == j { through + self.compliance[i] } else { through }
    }

    /// Entry of I − P̃δ.
    fn a(&self, p: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let through = -p[(i, j)] * self.regularization[j];
        if i == j { 1.0 + through } else { through }
    }

    /// s̃, past reactions already acting.
    fn closing(&self, p: MatRef<'_, f64>, interface: &InterfaceResidual, reaction: &[f64]) -> Vec<f64> {
        (0..self.len())
            .map(|i| {
                let mut s = interface.displacement[i] - interface.remaining[i];
                for j in 0..self.len() {
                    s += p[(i, j)] * self.regularization[j] * interface.remaining[j];
                    s += self.b(p, i, j) * reaction[j];
                }
                s
            })
            .collect()
    }

    /// The LCP with every point exchanged if all are `closed_first`, else those that are regularised or two-sided.
    pub(super) fn flexibility_lcp(
        &self,
        interfaces: &[InterfaceResidual],
        reaction: &[f64],
        closed_first: bool,
    ) -> Result<(PosedLcp, Vec<Vec<f64>>), OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let closing: Vec<_> = interfaces.iter().map(|interface| self.closing(p, interface, reaction)).collect();
        let exchanged = |i: usize| closed_first || self.two_sided[i] || self.regularization[i] > 0.0;
        let (mut inside, outside): (Vec<usize>, Vec<usize>) = (0..self.len()).partition(|&i| exchanged(i));
        inside.sort_by_key(|&i| self.absorbed(i));
        let coupled = inside.partition_point(|&i| !self.absorbed(i));
        let (nj, no) = (inside.len(), outside.len());

        // B_JJ · reaction_J in terms of gap_J, reaction_O and a 1 for every interface; the columns of absorbed points are diagonal.
        let mut right = dense::matrix(nj, nj + no + closing.len(), |r, c| {
            let i = inside[r];
            if c < nj {
                self.a(p, i, inside[c])
            } else if c < nj + no {
                -self.b(p, i, outside[c - nj])
            } else {
                closing[c - nj - no][i]
            }
        })?;
        if coupled > 0 {
            let (mut top, mut bottom) = right.as_mut().split_at_row_mut(coupled);
            let b = dense::matrix(coupled, coupled, |r, c| self.b(p, inside[r], inside[c]))?;
            Lu::of(b)?.solve_in_place(top.as_mut())?;
            let across = dense::matrix(nj - coupled, coupled, |r, c| self.b(p, inside[coupled + r], inside[c]))?;
            bottom -= dense::product(across.as_ref(), top.as_ref())?;
        }
        for (r, &i) in inside.iter().enumerate().skip(coupled) {
            for c in 0..right.ncols() {
                right[(r, c)] /= self.compliance[i];
            }
        }
        let spread = dense::matrix(no, coupled, |r, c| self.b(p, outside[r], inside[c]))?;
        let carried = dense::product(spread.as_ref(), right.as_ref().subrows(0, coupled))?;

        let mut rows: Vec<usize> = (0..nj).filter(|&r| !self.two_sided[inside[r]]).collect();
        let kept = rows.len();
        rows.extend(nj..nj + no);
        let entry = |r: usize, c: usize| -> f64 {
            if r < nj {
                return right[(r, c)];
            }
            let (i, from) = (outside[r - nj], carried[(r - nj, c)]);
            if c < nj {
                from - self.a(p, i, inside[c])
            } else if c < nj + no {
                from + self.b(p, i, outside[c - nj])
            } else {
                from - closing[c - nj - no][i]
            }
        };
        let matrix = row_major(rows.len(), rows.len(), |r, c| entry(rows[r], rows[c]))?;
        let q = |k: usize| -> Vec<f64> { rows.iter().map(|&r| entry(r, nj + no + k)).collect() };
        let (first, others) = (q(0), (1..closing.len()).map(q).collect());
        let point = rows.iter().map(|&r| if r < nj { inside[r] } else { outside[r - nj] }).collect();
        let gap_is_z = (0..rows.len()).map(|r| r < kept).collect();
        Ok((PosedLcp { matrix, q: first, point, gap_is_z }, others))
    }

    /// What one point's unknown, its reaction where closed and its gap where open, does in another's equation.
    fn column(&self, p: MatRef<'_, f64>, closed: &[bool], i: usize, j: usize) -> f64 {
        if closed[j] { -self.b(p, i, j) } else { self.a(p, i, j) }
    }

    /// Points whose unknown enters the equations of others.
    pub(super) fn flexibility_state(&self, closed: Vec<bool>) -> Result<Option<ContactState>, OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let enters = |i: usize| if closed[i] { !self.absorbed(i) } else { self.regularization[i] > 0.0 };
        let unknown: Vec<usize> = (0..self.len()).filter(|&i| enters(i)).collect();
        if unknown.is_empty() {
            return Ok(Some(ContactState { closed, unknown, factor: StateFactor::Nothing }));
        }
        let size = unknown.len();
        let factor = Lu::of(dense::matrix(size, size, |r, c| self.column(p, &closed, unknown[r], unknown[c]))?)?;
        let regular = factor.has_pivots_above(0.0);
        Ok(regular.then_some(ContactState { closed, unknown, factor: StateFactor::Flexibility(factor) }))
    }

    pub(super) fn solve_flexibility_state(
        &self,
        state: &ContactState,
        interface: &InterfaceResidual,
    ) -> Result<Response, OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let closing = self.closing(p, interface, &vec![0.0; self.len()]);
        let mut reaction = vec![0.0; self.len()];
        let mut gap = vec![0.0; self.len()];
        let mut solved = vec![false; self.len()];
        let mut found = Vec::new();
        if let StateFactor::Flexibility(factor) = &state.factor {
            found = state.unknown.iter().map(|&i| -closing[i]).collect();
            let size = found.len();
            factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut found, size, 1))?;
            for (&i, &value) in state.unknown.iter().zip(&found) {
                let side = if state.closed[i] { &mut reaction } else { &mut gap };
                side[i] = value;
                solved[i] = true;
            }
        }
        for i in (0..self.len()).filter(|&i| !solved[i]) {
            let of_others = |(&j, value): (&usize, &f64)| self.column(p, &state.closed, i, j) * value;
            let rest = closing[i] + state.unknown.iter().zip(&found).map(of_others).sum::<f64>();
            if state.closed[i] {
                reaction[i] = rest / self.compliance[i];
            } else {
                gap[i] = -rest;
            }
        }
        let moved =
            (0..self.len()).map(|i| interface.remaining[i] - gap[i] + self.compliance[i] * reaction[i]).collect();
        Ok(Response { reaction, moved })
    }
}
