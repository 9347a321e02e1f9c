//! The linear complementarity problem (LCP) of contact points whose laws are polylines of force over travel.
//!
//! Each point starts on its first piece. The unknown x of a point is its force if this depends on the travel, otherwise
//! its travel, measured from the reference point of the piece ([`Piece`]). Elimination of the plate gives x = x₀ − Σ
//! columns z. Each vertex of a polyline is a row of the LCP. At an end of the first piece, w is the distance from x to
//! this end, and z the length travelled along the next piece. At a further vertex, w is the length of the piece before
//! it minus the z of the vertex before. Katzenelson (1965) follows a piecewise linear monotone map in this way. For
//! laws of two pieces, w and z are reaction and gap.

use super::condensed::{CondensedRhs, Form, Interface};
use super::motions::{FreeMotions, Work};
use super::vertices::{Kind, VertexRow, Vertices, direction, end_length};
use crate::contact::graph::Piece;
use crate::contact::points::Points;
use crate::dense::{self, Lu, OutOfMemory, row_major};
use faer::Mat;

/// The parts of the LCP w = Mz + q of the contact points that do not depend on the load or on the gaps, in one form. q
/// is affine in the load.
pub struct LcpTemplate {
    /// Matrix M (k, k) of the LCP, row-major, after the free rigid motions are imposed on it.
    pub matrix: Vec<f64>,
    pub vertices: Vertices,
    elimination: Elimination,
    motions: FreeMotions,
}

/// Factored equations HΔx = b, where x are the unknowns (force or travel) of all points on the first pieces of their
/// laws.
enum Elimination {
    /// H = I + SC, with forces as unknowns, the Schur complement S and the compliances C of the first pieces of the
    /// laws. `None` if all first pieces are rigid.
    Stiffness(Option<Lu>),
    /// The matrix H of the flexibility form in blocks. `alone` lists the points whose column of H has only a diagonal
    /// entry, and this entry. `coupled` lists the other points, and `factor` is their factored diagonal block. `across`
    /// is the block with rows `alone` and columns `coupled`.
    Flexibility { coupled: Vec<usize>, alone: Vec<(usize, f64)>, factor: Option<Lu>, across: Mat<f64> },
}

impl Elimination {
    /// Overwrites the right-hand sides B = `all` (m, columns) with H⁻¹B, the solution of the factored equations.
    fn solve_in_place(&self, all: &mut Mat<f64>) -> Result<(), OutOfMemory> {
        match self {
            Self::Stiffness(None) => {}
            Self::Stiffness(Some(factor)) => factor.solve_in_place(all.as_mut())?,
            Self::Flexibility { coupled, alone, factor, across } => {
                let mut top = dense::matrix(coupled.len(), all.ncols(), |r, c| all[(coupled[r], c)])?;
                if let Some(factor) = factor {
                    factor.solve_in_place(top.as_mut())?;
                }
                let through = dense::product(across.as_ref(), top.as_ref())?;
                for c in 0..all.ncols() {
                    coupled.iter().enumerate().for_each(|(r, &i)| all[(i, c)] = top[(r, c)]);
                    for (r, &(i, own)) in alone.iter().enumerate() {
                        all[(i, c)] = (all[(i, c)] - through[(r, c)]) / own;
                    }
                }
            }
        }
        Ok(())
    }
}

impl LcpTemplate {
    pub(in crate::contact) fn of(interface: &Interface, points: &Points, form: Form) -> Result<Self, OutOfMemory> {
        let vertices = Vertices::of(points, interface.first_pieces(points, form));
        let piece = vertices.first_pieces(points);
        let Vertices { rows, .. } = &vertices;
        // For each row of the LCP, the change of [travel, force] of its point per unit of z, along the piece of its law
        // beyond the vertex.
        let along: Vec<[f64; 2]> = rows.iter().map(|row| direction(points, row)).collect();
        let (elimination, mut columns) = match form {
            Form::Stiffness if interface.stiffness.is_some() => interface.by_stiffness(&piece, rows, &along)?,
            _ => interface.by_flexibility(&piece, rows, &along)?,
        };
        elimination.solve_in_place(&mut columns)?;
        if let Elimination::Stiffness(Some(_)) = &elimination {
            symmetrize(rows, &mut columns);
        }
        let entry = |r: usize, c: usize| match rows[r].before {
            // The unknown x (force or travel) of a point is x₀ − Σ columns z; w is the distance from x to the upper or
            // lower end of the first piece of its law.
            None => rows[r].sign() * columns[(rows[r].point, c)],
            Some(before) if before == c => -1.0,
            Some(_) => 0.0,
        };
        let mut matrix = row_major(rows.len(), rows.len(), entry)?;
        let motions = interface.impose_motions(points, &vertices, &mut matrix)?;
        Ok(Self { matrix, vertices, elimination, motions })
    }

    /// Vector q (k,) of the LCP for a load, with balance in the free rigid motions imposed. The LCP is posed from the
    /// state with reactions `reaction` (m,). `rhs.violation` has the distances to the first pieces of the laws.
    pub(in crate::contact) fn balanced_q(
        &self,
        interface: &Interface,
        points: &Points,
        rhs: &CondensedRhs,
        work: &Work,
        reaction: &[f64],
    ) -> Result<Vec<f64>, OutOfMemory> {
        let mut q = self.q(interface, points, rhs, reaction)?;
        self.balance(&mut q, rhs, work);
        Ok(q)
    }

    /// Vector q (k,) of the LCP for a load, before balance in the free rigid motions is imposed. The LCP is posed from
    /// the state with reactions `reaction` (m,).
    pub(in crate::contact) fn q(
        &self,
        interface: &Interface,
        points: &Points,
        rhs: &CondensedRhs,
        reaction: &[f64],
    ) -> Result<Vec<f64>, OutOfMemory> {
        let piece = self.vertices.first_pieces(points);
        // A point that starts on a horizontal piece of its law changes from its present reaction to the force of this
        // piece.
        let released: Vec<f64> =
            (0..piece.len()).map(|j| if piece[j].holds() { 0.0 } else { reaction[j] - piece[j].force }).collect();
        let linear = self.linear(interface, rhs, Some(&released))?;
        let length = |(linear, row): (f64, &VertexRow)| {
            if !row.is_next() {
                return end_length(points, row);
            }
            // x is `from` plus an increment, both relative to the reference point of the first piece of the law. A
            // vertex above this piece is reached from its upper end, a vertex below it from its lower end.
            let (i, piece) = (row.point, piece[row.point]);
            let from = if piece.holds() { reaction[i] - piece.force } else { 0.0 };
            let [low, high] = points.ends(i, self.vertices.base[i]);
            let at = |end: [f64; 2]| if piece.holds() { end[1] - piece.force } else { end[0] - piece.travel };
            let end = if row.upward { high.map(at) } else { low.map(at) }.expect("a vertex at this end");
            row.sign() * (end - from) + linear
        };
        Ok(linear.into_iter().zip(&self.vertices.rows).map(length).collect())
    }

    /// Change of the vector q (k,) of the LCP for an increment of load.
    pub(in crate::contact) fn increment(
        &self,
        interface: &Interface,
        rhs: &CondensedRhs,
    ) -> Result<Vec<f64>, OutOfMemory> {
        self.linear(interface, rhs, None)
    }

    fn linear(
        &self,
        interface: &Interface,
        rhs: &CondensedRhs,
        released: Option<&[f64]>,
    ) -> Result<Vec<f64>, OutOfMemory> {
        let count = interface.len();
        let CondensedRhs { displacement, force, violation } = rhs;
        let mut column = match (&self.elimination, &interface.stiffness) {
            (Elimination::Stiffness(_), Some(stiffness)) => {
                let travel = interface.without_rigid_motion(violation);
                dense::matrix(count, 1, |i, _| {
                    force[i] - (0..count).map(|j| stiffness.matrix[(i, j)] * travel[j]).sum::<f64>()
                })?
            }
            _ => {
                let p = interface.flexibility()?.matrix.as_ref();
                dense::matrix(count, 1, |i, _| {
                    let mut sum = displacement[i] - violation[i];
                    for j in 0..count {
                        sum += p[(i, j)] * interface.delta[j] * violation[j];
                        if let Some(released) = released {
                            sum += p[(i, j)] * released[j];
                        }
                    }
                    sum
                })?
            }
        };
        self.elimination.solve_in_place(&mut column)?;
        let of = |row: &VertexRow| if row.is_next() { -row.sign() * column[(row.point, 0)] } else { 0.0 };
        Ok(self.vertices.rows.iter().map(of).collect())
    }

    /// Imposes balance in the free rigid motions on q: the reactions on the first pieces of the laws must balance the
    /// load.
    pub(in crate::contact) fn balance(&self, q: &mut [f64], rhs: &CondensedRhs, work: &Work) {
        self.motions.balance(q, rhs, work);
    }

    /// Imposes balance in the free rigid motions on the change of q for an increment of load.
    pub(in crate::contact) fn balance_increment(&self, q: &mut [f64], rhs: &CondensedRhs, work: &Work) {
        self.motions.balance_increment(q, rhs, work);
    }
}

impl Interface {
    /// The matrix H of the stiffness form SΔs + Δr = f̂ (symbols: see module `interface`) with every point on the first
    /// piece of its law, factored, and the columns (m, k) by which z acts on these equations.
    fn by_stiffness(
        &self,
        piece: &[Piece],
        rows: &[VertexRow],
        along: &[[f64; 2]],
    ) -> Result<(Elimination, Mat<f64>), OutOfMemory> {
        let s = &self.stiffness.as_ref().expect("the stiffness form has a Schur complement").matrix;
        let count = self.len();
        let columns = dense::matrix(count, rows.len(), |i, c| {
            let j = rows[c].point;
            along[c][0] * s[(i, j)] + if i == j { along[c][1] } else { 0.0 }
        })?;
        if piece.iter().all(|piece| piece.compliance() == 0.0) {
            return Ok((Elimination::Stiffness(None), columns));
        }
        let coupled = dense::matrix(count, count, |i, j| {
            let through = s[(i, j)] * piece[j].compliance();
            if i == j { 1.0 + through } else { through }
        })?;
        Ok((Elimination::Stiffness(Some(Lu::of(coupled)?)), columns))
    }

    /// The matrix H of the flexibility form (I − P̃δ)Δs + P̃Δr = d (symbols: see module `interface`) with every point
    /// on the first piece of its law, factored, and the columns (m, k) by which z acts on these equations.
    fn by_flexibility(
        &self,
        piece: &[Piece],
        rows: &[VertexRow],
        along: &[[f64; 2]],
    ) -> Result<(Elimination, Mat<f64>), OutOfMemory> {
        let p = self.flexibility()?.matrix.as_ref();
        let column = |i: usize, j: usize| match piece[j].holds() {
            true => self.holding_entry(p, piece[j].compliance(), i, j),
            false => self.travel_entry(p, i, j),
        };
        let is_coupled = |j: usize| match piece[j].holds() {
            true => !self.absorbs(j, piece[j].compliance()),
            false => self.delta[j] > 0.0,
        };
        let columns = dense::matrix(self.len(), rows.len(), |i, c| {
            let (j, [travel, force]) = (rows[c].point, along[c]);
            match force {
                0.0 => travel * self.travel_entry(p, i, j),
                _ => force * self.holding_entry(p, travel / force, i, j),
            }
        })?;
        let (coupled, alone): (Vec<usize>, Vec<usize>) = (0..self.len()).partition(|&j| is_coupled(j));
        let h = dense::matrix(coupled.len(), coupled.len(), |r, c| column(coupled[r], coupled[c]))?;
        let factor = if coupled.is_empty() { None } else { Some(Lu::of(h)?) };
        let across = dense::matrix(alone.len(), coupled.len(), |r, c| column(alone[r], coupled[c]))?;
        let own = |i: usize| (i, if piece[i].holds() { piece[i].compliance() } else { 1.0 });
        let alone = alone.into_iter().map(own).collect();
        Ok((Elimination::Flexibility { coupled, alone, factor, across }, columns))
    }
}

/// Removes the rounding by which (I + SC)⁻¹S in `columns` differs from a symmetric matrix.
fn symmetrize(rows: &[VertexRow], columns: &mut Mat<f64>) {
    let gap = |i: usize| rows.iter().position(|row| row.point == i && row.kind == Kind::Gap);
    let of_point: Vec<Option<usize>> = (0..columns.nrows()).map(gap).collect();
    for i in 0..columns.nrows() {
        for j in 0..i {
            if let (Some(a), Some(b)) = (of_point[i], of_point[j]) {
                let even = 0.5 * (columns[(i, b)] + columns[(j, a)]);
                (columns[(i, b)], columns[(j, a)]) = (even, even);
            }
        }
    }
}
