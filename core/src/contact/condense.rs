//! The contact points alone: from a plate on constraints to an LCP and back. The one file that speaks both languages:
//! outside, `reaction` and `gap`; inside, z, w, M, q.
//!
//! Constraints read Gu + gap − C·reaction = g. A factor of K̃ = K + Gᵀ diag(δ) G, with the contact dofs last, knows
//! the plate at its contact points in two ways:
//!
//! - *stiffness*: reaction = f̂ − S y at contact displacements y = Gu, with S the Schur complement of K (that of K̃ less
//!   δ). The unknown of the LCP is the gap, M = (S⁻¹ + C)⁻¹; all points are taken closed first. It needs rows that pick
//!   single dofs, and is the better conditioned of the two on long rigid lines of thin plates.
//! - *flexibility*: P̃ = G K̃⁻¹ Gᵀ, and (I − P̃δ)·gap = B·reaction − s̃ with B = P̃(I − δC) + C and
//!   s̃ = G K̃⁻¹f + P̃δg − g. δ = 0 gives the paper's dual, gap = (P + C)·reaction − s, whose unknown is the reaction.
//!   Exchanging reaction and gap on a set J is a principal pivot: where the plate is free to move, J holds its rigid
//!   motions and has δ > 0.
//!
//! Two-sided points have no gap and a reaction of either sign; they are eliminated from the LCP.

use faer::linalg::solvers::{Llt, PartialPivLu, Solve};
use faer::{Mat, MatRef, Side};
use std::sync::OnceLock;

/// The contact points of a factored plate.
pub struct Condensed {
    /// L of the Schur complement of K̃ onto the contact dofs.
    trailing: Mat<f64>,
    /// Entries of each row on the contact dofs.
    rows: Vec<Vec<(usize, f64)>>,
    /// δ: what the factor carries on top of K, by point.
    pub regularization: Vec<f64>,
    /// C: compliance of each support, 0 where it is rigid.
    pub compliance: Vec<f64>,
    /// Points whose constraint is an equation.
    pub two_sided: Vec<bool>,
    /// S, where the rows pick single dofs.
    stiffness: Option<Mat<f64>>,
    flexibility: OnceLock<Mat<f64>>,
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
pub struct Drive {
    /// G K̃⁻¹ r: displacement of the points under the imbalance r; empty where the stiffness serves.
    pub displacement: Vec<f64>,
    /// r condensed onto the contact points; zero where the flexibility serves.
    pub force: Vec<f64>,
    /// What is left of each gap.
    pub remaining: Vec<f64>,
}

/// What the points do in one contact state.
pub struct Response {
    pub reaction: Vec<f64>,
    pub gap: Vec<f64>,
    pub moved: Vec<f64>,
}

/// An LCP w = Mz + q over the one-sided points, row-major, and the way back.
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
    closed: Vec<bool>,
    unknown: Vec<usize>,
    factor: StateFactor,
}

enum StateFactor {
    Nothing,
    /// S over the points that may move, with the springs of those that are closed.
    Stiffness(Llt<f64>),
    Flexibility(PartialPivLu<f64>),
}

impl Condensed {
    /// `trailing` is the factor's last block, `rows` the contact rows over its dofs.
    pub fn new(
        trailing: Mat<f64>,
        rows: Vec<Vec<(usize, f64)>>,
        regularization: Vec<f64>,
        compliance: Vec<f64>,
        two_sided: Vec<bool>,
    ) -> Self {
        let stiffness = picks_single_dofs(&rows, trailing.nrows()).then(|| {
            let product = &trailing * trailing.transpose();
            Mat::from_fn(rows.len(), rows.len(), |i, j| {
                let ((p, a), (q, b)) = (rows[i][0], rows[j][0]);
                let carried = if i == j { regularization[i] } else { 0.0 };
                0.5 * (product[(p, q)] + product[(q, p)]) / (a * b) - carried
            })
        });
        Self { trailing, rows, regularization, compliance, two_sided, stiffness, flexibility: OnceLock::new() }
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

    /// The last part of a forward-substituted vector whose back substitution moves the points by `moved`: z = Lᵀu.
    pub fn prescribing(&self, moved: &[f64]) -> Vec<f64> {
        let mut on_dofs = vec![0.0; self.trailing.nrows()];
        for (row, y) in self.rows.iter().zip(moved) {
            on_dofs[row[0].0] = y / row[0].1;
        }
        let size = on_dofs.len();
        (0..size).map(|i| (i..size).map(|j| self.trailing[(j, i)] * on_dofs[j]).sum()).collect()
    }

    /// The LCP past `reaction`s already acting.
    pub fn lcp(&self, form: Form, drive: &Drive, reaction: &[f64]) -> PosedLcp {
        match (form, &self.stiffness) {
            (Form::Stiffness, Some(stiffness)) => self.stiffness_lcp(stiffness, drive, reaction),
            (Form::Stiffness, None) => self.flexibility_lcp(drive, reaction, &vec![true; self.len()]),
            (Form::Dual, _) => self.flexibility_lcp(drive, reaction, &vec![false; self.len()]),
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

    /// Factors the equations of one contact state; `None` if they are singular.
    pub fn state(&self, closed: Vec<bool>) -> Option<ContactState> {
        match &self.stiffness {
            Some(stiffness) => self.stiffness_state(stiffness, closed),
            None => self.flexibility_state(closed),
        }
    }

    /// Increments of the reactions of closed points, gaps of open ones, and displacements of all, in one contact state.
    pub fn solve_state(&self, state: &ContactState, drive: &Drive) -> Response {
        match &self.stiffness {
            Some(stiffness) => self.solve_stiffness_state(stiffness, state, drive),
            None => self.solve_flexibility_state(state, drive),
        }
    }

    // --- stiffness ---

    /// M = (I + SC)⁻¹S, q = (I + SC)⁻¹(f̂ + reaction − S(remaining − C·reaction)).
    fn stiffness_lcp(&self, stiffness: &Mat<f64>, drive: &Drive, reaction: &[f64]) -> PosedLcp {
        let m = self.len();
        let travel: Vec<f64> = (0..m).map(|i| drive.remaining[i] - self.compliance[i] * reaction[i]).collect();
        let mut q: Vec<f64> = (0..m)
            .map(|i| drive.force[i] + reaction[i] - (0..m).map(|j| stiffness[(i, j)] * travel[j]).sum::<f64>())
            .collect();
        let point: Vec<usize> = (0..m).filter(|&i| !self.two_sided[i]).collect();
        let matrix: Vec<f64> = if self.compliance.iter().all(|&c| c == 0.0) {
            point.iter().flat_map(|&i| point.iter().map(move |&j| stiffness[(i, j)])).collect()
        } else {
            let coupled = Mat::from_fn(m, m, |i, j| {
                let through = stiffness[(i, j)] * self.compliance[j];
                if i == j { 1.0 + through } else { through }
            });
            let mut right = Mat::from_fn(m, m + 1, |i, j| if j < m { stiffness[(i, j)] } else { q[i] });
            coupled.partial_piv_lu().solve_in_place(right.as_mut());
            q = (0..m).map(|i| right[(i, m)]).collect();
            let entry = |i: usize, j: usize| 0.5 * (right[(i, j)] + right[(j, i)]);
            point.iter().flat_map(|&i| point.iter().map(move |&j| entry(i, j))).collect()
        };
        let q = point.iter().map(|&i| q[i]).collect();
        PosedLcp { matrix, q, gap_is_z: vec![true; point.len()], point }
    }

    /// Points whose displacement is not known: open ones, and closed ones on springs.
    fn stiffness_state(&self, stiffness: &Mat<f64>, closed: Vec<bool>) -> Option<ContactState> {
        let unknown: Vec<usize> = (0..self.len()).filter(|&i| !closed[i] || self.compliance[i] > 0.0).collect();
        if unknown.is_empty() {
            return Some(ContactState { closed, unknown, factor: StateFactor::Nothing });
        }
        let matrix = Mat::from_fn(unknown.len(), unknown.len(), |r, c| {
            let (i, j) = (unknown[r], unknown[c]);
            let spring = if i == j && closed[i] { 1.0 / self.compliance[i] } else { 0.0 };
            stiffness[(i, j)] + spring
        });
        let factor = matrix.llt(Side::Lower).ok()?;
        Some(ContactState { closed, unknown, factor: StateFactor::Stiffness(factor) })
    }

    fn solve_stiffness_state(&self, stiffness: &Mat<f64>, state: &ContactState, drive: &Drive) -> Response {
        let m = self.len();
        let rigid = |i: usize| state.closed[i] && self.compliance[i] == 0.0;
        let mut moved: Vec<f64> = (0..m).map(|i| if rigid(i) { drive.remaining[i] } else { 0.0 }).collect();
        let held = |i: usize, moved: &[f64]| (0..m).map(|j| stiffness[(i, j)] * moved[j]).sum::<f64>();
        if let StateFactor::Stiffness(factor) = &state.factor {
            let mut right = Mat::from_fn(state.unknown.len(), 1, |r, _| {
                let i = state.unknown[r];
                let spring = if state.closed[i] { drive.remaining[i] / self.compliance[i] } else { 0.0 };
                drive.force[i] + spring - held(i, &moved)
            });
            factor.solve_in_place(right.as_mut());
            for (r, &i) in state.unknown.iter().enumerate() {
                moved[i] = right[(r, 0)];
            }
        }
        let mut reaction = vec![0.0; m];
        let mut gap = vec![0.0; m];
        for i in 0..m {
            if !state.closed[i] {
                gap[i] = drive.remaining[i] - moved[i];
            } else if rigid(i) {
                reaction[i] = drive.force[i] - held(i, &moved);
            } else {
                reaction[i] = (moved[i] - drive.remaining[i]) / self.compliance[i];
            }
        }
        Response { reaction, gap, moved }
    }

    // --- flexibility ---

    /// P̃ = G (L Lᵀ)⁻¹ Gᵀ.
    fn flexibility(&self) -> MatRef<'_, f64> {
        let compute = || {
            let mut half = Mat::zeros(self.trailing.nrows(), self.rows.len());
            for (j, row) in self.rows.iter().enumerate() {
                for &(dof, c) in row {
                    half[(dof, j)] += c;
                }
            }
            let par = faer::Par::rayon(0);
            faer::linalg::triangular_solve::solve_lower_triangular_in_place(self.trailing.as_ref(), half.as_mut(), par);
            half.transpose() * &half
        };
        self.flexibility.get_or_init(compute).as_ref()
    }

    /// Entry of B = P̃(I − δC) + C.
    fn b(&self, p: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let through = p[(i, j)] * (1.0 - self.regularization[j] * self.compliance[j]);
        if i == j { through + self.compliance[i] } else { through }
    }

    /// Entry of I − P̃δ.
    fn a(&self, p: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let through = -p[(i, j)] * self.regularization[j];
        if i == j { 1.0 + through } else { through }
    }

    /// s̃, past reactions already acting.
    fn closing(&self, p: MatRef<'_, f64>, drive: &Drive, reaction: &[f64]) -> Vec<f64> {
        (0..self.len())
            .map(|i| {
                let mut s = drive.displacement[i] - drive.remaining[i];
                for j in 0..self.len() {
                    s += p[(i, j)] * self.regularization[j] * drive.remaining[j];
                    s += self.b(p, i, j) * reaction[j];
                }
                s
            })
            .collect()
    }

    /// The LCP with the points of `closed_first` (and all that are regularised or two-sided) exchanged.
    fn flexibility_lcp(&self, drive: &Drive, reaction: &[f64], closed_first: &[bool]) -> PosedLcp {
        let p = self.flexibility();
        let closing = self.closing(p, drive, reaction);
        let exchanged = |i: usize| closed_first[i] || self.two_sided[i] || self.regularization[i] > 0.0;
        let (inside, outside): (Vec<usize>, Vec<usize>) = (0..self.len()).partition(|&i| exchanged(i));
        let (nj, no) = (inside.len(), outside.len());

        // Right-hand sides on J: columns gap_J, reaction_O, 1.
        let mut right = Mat::from_fn(nj, nj + no + 1, |r, c| {
            let i = inside[r];
            if c < nj {
                self.a(p, i, inside[c])
            } else if c < nj + no {
                -p[(i, outside[c - nj])]
            } else {
                closing[i]
            }
        });
        if nj > 0 {
            let b = Mat::from_fn(nj, nj, |r, c| self.b(p, inside[r], inside[c]));
            b.partial_piv_lu().solve_in_place(right.as_mut());
        }
        let carried = Mat::from_fn(no, nj, |r, c| self.b(p, outside[r], inside[c])) * &right;

        let mut rows: Vec<usize> = (0..nj).filter(|&r| !self.two_sided[inside[r]]).collect();
        let kept = rows.len();
        rows.extend(nj..nj + no);
        let entry = |r: usize, c: usize| -> f64 {
            if r < nj {
                return right[(r, c)];
            }
            let (i, from) = (outside[r - nj], carried[(r - nj, c)]);
            if c < nj {
                from + p[(i, inside[c])] * self.regularization[inside[c]]
            } else if c < nj + no {
                from + self.b(p, i, outside[c - nj])
            } else {
                from - closing[i]
            }
        };
        let matrix = rows.iter().flat_map(|&r| rows.iter().map(move |&c| (r, c))).map(|(r, c)| entry(r, c)).collect();
        let q = rows.iter().map(|&r| entry(r, nj + no)).collect();
        let point = rows.iter().map(|&r| if r < nj { inside[r] } else { outside[r - nj] }).collect();
        PosedLcp { matrix, q, point, gap_is_z: (0..rows.len()).map(|r| r < kept).collect() }
    }

    fn flexibility_state(&self, closed: Vec<bool>) -> Option<ContactState> {
        let p = self.flexibility();
        let unknown: Vec<usize> = (0..self.len()).filter(|&i| closed[i] || self.regularization[i] > 0.0).collect();
        if unknown.is_empty() {
            return Some(ContactState { closed, unknown, factor: StateFactor::Nothing });
        }
        let matrix = Mat::from_fn(unknown.len(), unknown.len(), |r, c| {
            let (i, j) = (unknown[r], unknown[c]);
            if closed[j] { -self.b(p, i, j) } else { self.a(p, i, j) }
        });
        let factor = matrix.partial_piv_lu();
        let regular = (0..unknown.len()).all(|i| factor.U()[(i, i)] != 0.0 && factor.U()[(i, i)].is_finite());
        regular.then_some(ContactState { closed, unknown, factor: StateFactor::Flexibility(factor) })
    }

    fn solve_flexibility_state(&self, state: &ContactState, drive: &Drive) -> Response {
        let p = self.flexibility();
        let closing = self.closing(p, drive, &vec![0.0; self.len()]);
        let mut reaction = vec![0.0; self.len()];
        let mut gap = vec![0.0; self.len()];
        if let StateFactor::Flexibility(factor) = &state.factor {
            let mut right = Mat::from_fn(state.unknown.len(), 1, |r, _| -closing[state.unknown[r]]);
            factor.solve_in_place(right.as_mut());
            for (r, &i) in state.unknown.iter().enumerate() {
                let side = if state.closed[i] { &mut reaction } else { &mut gap };
                side[i] = right[(r, 0)];
            }
        }
        for i in 0..self.len() {
            if !state.closed[i] && self.regularization[i] == 0.0 {
                let through = |&j: &usize| {
                    if state.closed[j] { self.b(p, i, j) * reaction[j] } else { -self.a(p, i, j) * gap[j] }
                };
                gap[i] = state.unknown.iter().map(through).sum::<f64>() - closing[i];
            }
        }
        let moved = (0..self.len()).map(|i| drive.remaining[i] - gap[i] + self.compliance[i] * reaction[i]).collect();
        Response { reaction, gap, moved }
    }
}

/// Whether every row has one entry and no two rows share a dof.
fn picks_single_dofs(rows: &[Vec<(usize, f64)>], dofs: usize) -> bool {
    let mut taken = vec![false; dofs];
    rows.iter().all(|row| row.len() == 1 && !std::mem::replace(&mut taken[row[0].0], true))
}
