//! Solves the equations of a contact state for x, the factors of the responses to the contact points in a combination
//! of load cases.
//!
//! The equations of a contact state differ from those of a reference state only at points that are on another piece of
//! their law. So one inverse, that of the reference state, serves for many contact states by a low-rank update
//! (Woodbury 1950) and corrections by double-double residuals.

use crate::contact::interface::{Form, Interface};
use crate::contact::points::Points;
use crate::contact::responses::Response;
use crate::contact::solution::differing;
use crate::contact::tolerances;
use crate::dense::{self, Lu, OutOfMemory};
use crate::double_double::DoubleDouble;
use crate::vectorized::vectorized;
use faer::Mat;

/// Largest fraction of the points that may be on another piece of their law than in the reference state if its inverse
/// is updated. With more such points a new factorization is cheaper.
const FEW: f64 = 0.25;
/// Largest number of points for which the dense inverse is stored; it limits memory.
const MOST: usize = 2000;
/// Largest number of iterative refinements with the updated inverse of the reference state. If the residual does not
/// converge, the equations of the contact state are factored.
const CORRECTIONS: usize = 4;

/// Three vectors (m,): factors x of the responses to the m contact points, reactions and gaps of the points.
pub(super) type PointFactors = (Vec<f64>, Vec<f64>, Vec<f64>);

/// Solver for x, the factors of the responses to the contact points, on one contact state after another. If the force r
/// of a point depends on its travel, the equation of the point prescribes travel − r/k with the slope k of its piece of
/// the law; otherwise it prescribes r.
pub(super) struct ContactSetSolver {
    form: Form,
    /// Travel (`moved`) and reaction of all m points in the response to each point (m, m), response by response.
    moved: Vec<f64>,
    reaction: Vec<f64>,
    known: Option<ReferenceInverse>,
}

/// The compliance 1/k of a contact point whose force depends on its travel; `None` for other contact points.
type Compliance = Option<f64>;

/// The reference contact state and the inverse of its equations. Each equation is divided by its largest coefficient.
struct ReferenceInverse {
    pieces: Vec<u8>,
    /// Scale factor (m,) by which each equation is multiplied.
    unit: Vec<f64>,
    inverse: Mat<f64>,
}

/// A contact state, given by the compliance (m,) of each contact point on its piece of the law.
struct On<'a> {
    interface: &'a Interface,
    form: Form,
    compliance: Vec<Compliance>,
}

impl On<'_> {
    fn len(&self) -> usize {
        self.compliance.len()
    }

    /// The coefficient of x_i in the equation of point i if this equation has no other unknown; otherwise `None`.
    fn alone(&self, i: usize) -> Option<f64> {
        match (self.form, self.compliance[i]) {
            (Form::Stiffness, Some(compliance)) => (compliance == 0.0).then_some(1.0),
            (Form::Stiffness, None) => None,
            (Form::Dual, Some(compliance)) => self.interface.absorbs(i, compliance).then_some(compliance),
            (Form::Dual, None) => (self.interface.delta[i] == 0.0).then_some(-1.0),
        }
    }
}

impl ContactSetSolver {
    /// Makes the solver from `points`, the responses to each contact point.
    pub(super) fn new(form: Form, points: &[Response]) -> Result<Self, OutOfMemory> {
        let count = points.len();
        Ok(Self {
            form,
            moved: dense::row_major(count, count, |i, j| points[i].moved[j])?,
            reaction: dense::row_major(count, count, |i, j| points[i].reaction[j])?,
            known: None,
        })
    }

    fn on<'a>(&self, interface: &'a Interface, points: &Points, pieces: &[u8]) -> On<'a> {
        let compliance = |(i, &number): (usize, &u8)| {
            let piece = points.piece(i, number);
            piece.holds().then(|| piece.compliance())
        };
        On { interface, form: self.form, compliance: pieces.iter().enumerate().map(compliance).collect() }
    }

    /// Inverts the equations of the reference contact state `pieces`. If they are singular, no inverse is stored.
    pub(super) fn begin_with(
        &mut self,
        interface: &Interface,
        points: &Points,
        pieces: Vec<u8>,
    ) -> Result<(), OutOfMemory> {
        let count = pieces.len();
        if count > MOST {
            return Ok(());
        }
        let on = self.on(interface, points, &pieces);
        let unit: Vec<f64> = (0..count).map(|i| self.unit(&on, i)).collect();
        let factors = Lu::of(dense::matrix(count, count, |i, j| unit[i] * self.coefficient(&on, i, j))?)?;
        if factors.has_pivots_above(0.0) {
            let mut inverse = dense::matrix(count, count, |i, j| f64::from(i == j))?;
            factors.solve_in_place(inverse.as_mut())?;
            self.known = Some(ReferenceInverse { pieces, unit, inverse });
        }
        Ok(())
    }

    /// Factors x, reactions and gaps for the contact state `pieces`; `None` if its equations are singular. `moved` and
    /// `reaction` (m,) are travel and reaction of the points in the sum of the load cases, before the responses to the
    /// points are added.
    pub(super) fn solve(
        &self,
        interface: &Interface,
        points: &Points,
        pieces: &[u8],
        moved: &[f64],
        reaction: &[f64],
    ) -> Result<Option<PointFactors>, OutOfMemory> {
        let count = pieces.len();
        let line: Vec<_> = (0..count).map(|i| points.piece(i, pieces[i])).collect();
        let on = self.on(interface, points, pieces);
        let right: Vec<f64> = (0..count)
            .map(|i| match on.compliance[i] {
                Some(compliance) => line[i].travel - moved[i] + compliance * (reaction[i] - line[i].force),
                None => line[i].force - reaction[i],
            })
            .collect();
        let updated = self.updated(&on, pieces, &right)?;
        let Some(factor) = (if updated.is_some() { updated } else { self.factored(&on, &right)? }) else {
            return Ok(None);
        };
        let holds = |i: usize| on.compliance[i].is_some();
        let own = (0..count).map(|i| if holds(i) { reaction[i] } else { moved[i] }).collect();
        let total = self.add_products(own, &factor, |i, moved, reaction| if holds(i) { reaction } else { moved });
        let reaction = (0..count).map(|i| if holds(i) { total[i] } else { line[i].force }).collect();
        let gap = (0..count).map(|i| if holds(i) { 0.0 } else { line[i].travel - total[i] }).collect();
        Ok(Some((factor, reaction, gap)))
    }

    /// Coefficient of x_j, the factor of the response to point j, in the equation of point i for the contact state
    /// `on`.
    fn coefficient(&self, on: &On, i: usize, j: usize) -> f64 {
        let at = j * on.len() + i;
        match (on.alone(i), on.compliance[i]) {
            (Some(own), _) if i == j => own,
            (Some(_), _) => 0.0,
            (None, Some(compliance)) => self.moved[at] - compliance * self.reaction[at],
            (None, None) => self.reaction[at],
        }
    }

    /// Scale factor that makes the largest coefficient of equation i equal to 1.
    fn unit(&self, on: &On, i: usize) -> f64 {
        let largest = (0..on.len()).map(|j| self.coefficient(on, i, j).abs()).fold(0.0, f64::max);
        if largest > 0.0 { 1.0 / largest } else { 1.0 }
    }

    /// For each point i, own_i + Σ_j part(i, moved_ij, reaction_ij) x_j in double-double. `moved_ij` and `reaction_ij`
    /// are travel and reaction of point i in the response to point j.
    fn add_products(&self, own: Vec<f64>, x: &[f64], part: impl Fn(usize, f64, f64) -> f64) -> Vec<f64> {
        let count = own.len();
        let (mut high, mut low) = (own, vec![0.0; count]);
        vectorized(
            #[inline(always)]
            || {
                for (j, &x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                    let (moved, reaction) = (&self.moved[j * count..][..count], &self.reaction[j * count..][..count]);
                    for i in 0..count {
                        let mut sum = DoubleDouble { hi: high[i], lo: low[i] };
                        sum.add_product_fused(part(i, moved[i], reaction[i]), x);
                        (high[i], low[i]) = (sum.hi, sum.lo);
                    }
                }
            },
        );
        high.iter().zip(&low).map(|(hi, lo)| hi + lo).collect()
    }

    /// Residual (m,) of the equations of the contact points for the factors `x`: `right` minus the left-hand side.
    fn residual(&self, on: &On, right: &[f64], x: &[f64]) -> Vec<f64> {
        let mut residual = self.add_products(right.to_vec(), x, |i, moved, reaction| match on.compliance[i] {
            Some(compliance) => compliance * reaction - moved,
            None => -reaction,
        });
        for (i, residual) in residual.iter_mut().enumerate() {
            if let Some(own) = on.alone(i) {
                *residual = right[i] - own * x[i];
            }
        }
        residual
    }

    /// Factors x (m,) by the updated inverse of the reference state. `None` if there is no inverse, if too many points
    /// are on another piece of their law than in the reference state, or without convergence.
    fn updated(&self, on: &On, pieces: &[u8], right: &[f64]) -> Result<Option<Vec<f64>>, OutOfMemory> {
        let Some(ReferenceInverse { pieces: before, unit, inverse }) = &self.known else { return Ok(None) };
        let count = on.len();
        let changed = differing(pieces, before);
        if changed.len() as f64 > FEW * count as f64 {
            return Ok(None);
        }
        let mut unit = unit.clone();
        changed.iter().for_each(|&i| unit[i] = self.unit(on, i));
        // Rows of the changed equations. Their product with the columns of the inverse is the capacitance matrix of
        // Woodbury.
        let row = |p: usize, j: usize| unit[changed[p]] * self.coefficient(on, changed[p], j);
        let rows = dense::matrix(changed.len(), count, row)?;
        let columns = dense::matrix(count, changed.len(), |i, q| inverse[(i, changed[q])])?;
        let capacitance = Lu::of(dense::product(rows.as_ref(), columns.as_ref())?)?;
        if !capacitance.has_pivots_above(0.0) {
            return Ok(None);
        }
        let mut x = vec![0.0; count];
        let mut residual = right.to_vec();
        for _ in 0..CORRECTIONS {
            let scaled = Mat::from_fn(count, 1, |i, _| unit[i] * residual[i]);
            let mut step = inverse * &scaled;
            if !changed.is_empty() {
                let mut missed = &rows * &step - Mat::from_fn(changed.len(), 1, |p, _| scaled[(changed[p], 0)]);
                capacitance.solve_in_place(missed.as_mut())?;
                step -= &columns * missed;
            }
            x.iter_mut().enumerate().for_each(|(i, x)| *x += step[(i, 0)]);
            residual = self.residual(on, right, &x);
            let size = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            if (0..count).all(|i| (unit[i] * residual[i]).abs() <= tolerances::SUM * size) {
                return Ok(Some(x));
            }
        }
        Ok(None)
    }

    /// Factors x (m,) by a factorization of the equations with more than one unknown; `None` if they are singular.
    fn factored(&self, on: &On, right: &[f64]) -> Result<Option<Vec<f64>>, OutOfMemory> {
        let mut x = vec![0.0; on.len()];
        let mut unknown = Vec::new();
        for i in 0..on.len() {
            match on.alone(i) {
                Some(own) => x[i] = right[i] / own,
                None => unknown.push(i),
            }
        }
        if unknown.is_empty() {
            return Ok(Some(x));
        }
        let size = unknown.len();
        let factors = Lu::of(dense::matrix(size, size, |p, q| self.coefficient(on, unknown[p], unknown[q]))?)?;
        if !factors.has_pivots_above(0.0) {
            return Ok(None);
        }
        // The second pass is a step of iterative refinement for the solution of the first pass.
        for _ in 0..2 {
            let residual = self.residual(on, right, &x);
            let mut step = Mat::from_fn(size, 1, |p, _| residual[unknown[p]]);
            factors.solve_in_place(step.as_mut())?;
            unknown.iter().enumerate().for_each(|(p, &i)| x[i] += step[(p, 0)]);
        }
        Ok(Some(x))
    }
}
