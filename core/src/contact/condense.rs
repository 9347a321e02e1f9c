//! The contact points alone: from a plate on constraints to an LCP and back. The one file that speaks both languages:
//! outside, `reaction` and `gap`; inside, z, w, M, q.
//!
//! With constraints Gu + gap − C·reaction = g and a factor of K̃ = K + Gᵀ diag(δ) G, the contact points obey
//!
//!   (I − P̃δ)·gap = B·reaction − s̃,   P̃ = G K̃⁻¹ Gᵀ,   B = P̃(I − δC) + C,   s̃ = G K̃⁻¹f + P̃δg − g,
//!
//! and δ = 0 gives the paper's dual, gap = (P + C)·reaction − s. Exchanging reaction and gap on a set J of points
//! taken closed first is a principal pivot: J empty is the dual form, J = all the stiffness form (the unknown is
//! the gap), and when the plate is free to move, any J that holds its rigid motions makes the problem regular, with
//! δ > 0 on J alone. Two-sided points belong to J; their gap is nil and their reaction has either sign.

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatRef};

/// The contact points of a factored plate.
pub struct Condensed {
    /// P̃ = G K̃⁻¹ Gᵀ.
    pub flexibility: Mat<f64>,
    /// δ: what the factor carries on top of K, by point.
    pub regularization: Vec<f64>,
    /// C: compliance of each support, 0 where it is rigid.
    pub compliance: Vec<f64>,
    /// Points whose constraint is an equation.
    pub two_sided: Vec<bool>,
}

/// An LCP w = Mz + q over the one-sided points, row-major, and the way back.
pub struct PivotedLcp {
    pub matrix: Vec<f64>,
    pub q: Vec<f64>,
    /// Contact point of every row.
    pub point: Vec<usize>,
    /// Whether the row's unknown is the gap (the point is taken closed first) rather than the reaction.
    pub closed_first: Vec<bool>,
}

/// The linear system of one contact state, factored.
pub struct ContactState {
    closed: Vec<bool>,
    unknown: Vec<usize>,
    factor: Option<PartialPivLu<f64>>,
}

impl Condensed {
    pub fn len(&self) -> usize {
        self.compliance.len()
    }

    pub fn is_empty(&self) -> bool {
        self.compliance.is_empty()
    }

    /// Entry of B = P̃(I − δC) + C.
    fn b(&self, i: usize, j: usize) -> f64 {
        let through = self.flexibility[(i, j)] * (1.0 - self.regularization[j] * self.compliance[j]);
        if i == j { through + self.compliance[i] } else { through }
    }

    /// Entry of I − P̃δ.
    fn a(&self, i: usize, j: usize) -> f64 {
        let through = -self.flexibility[(i, j)] * self.regularization[j];
        if i == j { 1.0 + through } else { through }
    }

    /// s̃ from the free displacement of the points (G K̃⁻¹ f) and their gaps, past `reaction`s already acting.
    pub fn closing(&self, free: &[f64], gap: &[f64], reaction: &[f64]) -> Vec<f64> {
        (0..self.len())
            .map(|i| {
                let mut s = free[i] - gap[i];
                for j in 0..self.len() {
                    s += self.flexibility[(i, j)] * self.regularization[j] * gap[j];
                    s += self.b(i, j) * reaction[j];
                }
                s
            })
            .collect()
    }

    /// The LCP with the points of `closed_first` (and all that are regularised or two-sided) exchanged.
    pub fn lcp(&self, closing: &[f64], closed_first: &[bool]) -> PivotedLcp {
        let exchanged: Vec<bool> = (0..self.len())
            .map(|i| closed_first[i] || self.two_sided[i] || self.regularization[i] > 0.0)
            .collect();
        let inside: Vec<usize> = (0..self.len()).filter(|&i| exchanged[i]).collect();
        let outside: Vec<usize> = (0..self.len()).filter(|&i| !exchanged[i]).collect();
        let (nj, no) = (inside.len(), outside.len());

        // Right-hand sides on J: columns gap_J, reaction_O, 1.
        let mut right = Mat::zeros(nj, nj + no + 1);
        for (r, &i) in inside.iter().enumerate() {
            for (c, &j) in inside.iter().enumerate() {
                right[(r, c)] = self.a(i, j);
            }
            for (c, &j) in outside.iter().enumerate() {
                right[(r, nj + c)] = -self.flexibility[(i, j)];
            }
            right[(r, nj + no)] = closing[i];
        }
        if nj > 0 {
            let b = Mat::from_fn(nj, nj, |r, c| self.b(inside[r], inside[c]));
            b.partial_piv_lu().solve_in_place(right.as_mut());
        }
        let spread = Mat::from_fn(no, nj, |r, c| self.b(outside[r], inside[c]));
        let carried = &spread * &right;

        let mut rows: Vec<usize> = (0..nj).filter(|&r| !self.two_sided[inside[r]]).collect();
        let kept = rows.len();
        rows.extend(nj..nj + no);
        let size = rows.len();
        let entry = |r: usize, c: usize| -> f64 {
            if r < nj {
                return right[(r, c)];
            }
            let (i, from) = (outside[r - nj], carried[(r - nj, c)]);
            if c < nj {
                from + self.flexibility[(i, inside[c])] * self.regularization[inside[c]]
            } else if c < nj + no {
                from + self.b(i, outside[c - nj])
            } else {
                from - closing[i]
            }
        };
        let mut matrix = Vec::with_capacity(size * size);
        let mut q = Vec::with_capacity(size);
        for &r in &rows {
            matrix.extend(rows.iter().map(|&c| entry(r, c)));
            q.push(entry(r, nj + no));
        }
        let point = rows.iter().map(|&r| if r < nj { inside[r] } else { outside[r - nj] }).collect();
        let closed_first = (0..size).map(|r| r < kept).collect();
        PivotedLcp { matrix, q, point, closed_first }
    }

    /// Which points are closed, given which z of the LCP are basic.
    pub fn closed_points(&self, lcp: &PivotedLcp, basis: &[bool]) -> Vec<bool> {
        let mut closed = self.two_sided.clone();
        for (r, &i) in lcp.point.iter().enumerate() {
            closed[i] = basis[r] != lcp.closed_first[r];
        }
        closed
    }

    /// Factors the equations of one contact state; `None` if they are singular.
    pub fn state(&self, closed: Vec<bool>) -> Option<ContactState> {
        let unknown: Vec<usize> = (0..self.len()).filter(|&i| closed[i] || self.regularization[i] > 0.0).collect();
        if unknown.is_empty() {
            return Some(ContactState { closed, unknown, factor: None });
        }
        let matrix = Mat::from_fn(unknown.len(), unknown.len(), |r, c| {
            let (i, j) = (unknown[r], unknown[c]);
            if closed[j] { -self.b(i, j) } else { self.a(i, j) }
        });
        let factor = matrix.partial_piv_lu();
        let regular = (0..unknown.len()).all(|i| {
            let pivot = factor.U()[(i, i)];
            pivot != 0.0 && pivot.is_finite()
        });
        regular.then_some(ContactState { closed, unknown, factor: Some(factor) })
    }

    /// Reactions of the closed points and gaps of the open ones in one contact state.
    pub fn solve_state(&self, state: &ContactState, closing: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut reaction = vec![0.0; self.len()];
        let mut gap = vec![0.0; self.len()];
        if let Some(factor) = &state.factor {
            let mut right = Mat::from_fn(state.unknown.len(), 1, |r, _| -closing[state.unknown[r]]);
            factor.solve_in_place(right.as_mut());
            for (r, &i) in state.unknown.iter().enumerate() {
                if state.closed[i] {
                    reaction[i] = right[(r, 0)];
                } else {
                    gap[i] = right[(r, 0)];
                }
            }
        }
        for i in 0..self.len() {
            if !state.closed[i] && self.regularization[i] == 0.0 {
                gap[i] = -closing[i]
                    + state
                        .unknown
                        .iter()
                        .map(|&j| if state.closed[j] { self.b(i, j) * reaction[j] } else { -self.a(i, j) * gap[j] })
                        .sum::<f64>();
            }
        }
        (reaction, gap)
    }
}

/// P̃ = G (L L ᵀ)⁻¹ Gᵀ from the trailing block L of the factor and the rows' entries on its dofs.
pub fn flexibility(trailing: MatRef<'_, f64>, rows: &[Vec<(usize, f64)>]) -> Mat<f64> {
    let mut half = Mat::zeros(trailing.nrows(), rows.len());
    for (j, row) in rows.iter().enumerate() {
        for &(dof, c) in row {
            half[(dof, j)] += c;
        }
    }
    faer::linalg::triangular_solve::solve_lower_triangular_in_place(trailing, half.as_mut(), faer::Par::rayon(0));
    half.transpose() * &half
}
