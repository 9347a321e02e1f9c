//! The points' factors in a sum of responses, on one contact set after another.
//!
//! The equations of a set differ from those of one factored beforehand in the rows of the points that have changed sides,
//! so that its inverse serves for both (Woodbury 1950), corrected by residuals in double-double.

use crate::contact::interface::Form;
use crate::contact::problem::ContactProblem;
use crate::contact::responses::Response;
use crate::contact::solution::differing;
use crate::contact::tolerances;
use crate::dense::{self, Lu, OutOfMemory};
use crate::double_double::DoubleDouble;
use crate::vectorized::vectorized;
use faer::Mat;

/// Points that have changed sides, over all, up to which updating an inverse takes less work than a factorization.
const FEW: f64 = 0.25;
/// More points than this have no inverse, whose matrix would be no small part of memory.
const MOST: usize = 2000;
/// Corrections by an updated inverse; where they do not end in rounding the set is factored.
const CORRECTIONS: usize = 4;

/// Factors of the points' responses, reactions and gaps.
pub(super) type Found = (Vec<f64>, Vec<f64>, Vec<f64>);

/// Equations of points that hold, travel − reaction/k, and of others, reaction, over the points' factors.
pub(super) struct OnSet {
    form: Form,
    /// Travel and reaction of all points under the response of one, one response behind the other.
    moved: Vec<f64>,
    reaction: Vec<f64>,
    known: Option<Known>,
}

/// The compliance of a point that holds; of others there is none.
type Compliance = Option<f64>;

/// Pieces, and the inverse of their equations, each over its largest coefficient.
struct Known {
    pieces: Vec<u8>,
    /// What each equation is multiplied by.
    unit: Vec<f64>,
    inverse: Mat<f64>,
}

/// The pieces of points as their equations have them.
struct On<'a> {
    problem: &'a ContactProblem,
    form: Form,
    compliance: Vec<Compliance>,
}

impl On<'_> {
    fn len(&self) -> usize {
        self.compliance.len()
    }

    /// What the factor of a point is multiplied by where it stands alone in its equation.
    fn alone(&self, i: usize) -> Option<f64> {
        match (self.form, self.compliance[i]) {
            (Form::Stiffness, Some(compliance)) => (compliance == 0.0).then_some(1.0),
            (Form::Stiffness, None) => None,
            (Form::Dual, Some(compliance)) => self.problem.interface().absorbs(i, compliance).then_some(compliance),
            (Form::Dual, None) => (self.problem.delta[i] == 0.0).then_some(-1.0),
        }
    }
}

impl OnSet {
    /// Of a plate's points, from the response of each.
    pub(super) fn new(problem: &ContactProblem, form: Form, points: &[Response]) -> Result<Self, OutOfMemory> {
        let count = problem.points.len();
        Ok(Self {
            form,
            moved: dense::row_major(count, count, |i, j| points[i].moved[j])?,
            reaction: dense::row_major(count, count, |i, j| points[i].reaction[j])?,
            known: None,
        })
    }

    fn on<'a>(&self, problem: &'a ContactProblem, pieces: &[u8]) -> On<'a> {
        let compliance = |(i, &number): (usize, &u8)| {
            let piece = problem.points.piece(i, number);
            piece.holds().then(|| piece.compliance())
        };
        On { problem, form: self.form, compliance: pieces.iter().enumerate().map(compliance).collect() }
    }

    /// Inverts the equations of pieces that many others are near to, unless they are singular.
    pub(super) fn begin_with(&mut self, problem: &ContactProblem, pieces: Vec<u8>) -> Result<(), OutOfMemory> {
        let count = pieces.len();
        if count > MOST {
            return Ok(());
        }
        let on = self.on(problem, &pieces);
        let unit: Vec<f64> = (0..count).map(|i| self.unit(&on, i)).collect();
        let factors = Lu::of(dense::matrix(count, count, |i, j| unit[i] * self.coefficient(&on, i, j))?)?;
        if factors.has_pivots_above(0.0) {
            let mut inverse = dense::matrix(count, count, |i, j| f64::from(i == j))?;
            factors.solve_in_place(inverse.as_mut())?;
            self.known = Some(Known { pieces, unit, inverse });
        }
        Ok(())
    }

    /// Factors, reactions and gaps on pieces, past those of a load alone; `None` if their equations are singular.
    pub(super) fn solve(
        &self,
        problem: &ContactProblem,
        pieces: &[u8],
        moved: &[f64],
        reaction: &[f64],
    ) -> Result<Option<Found>, OutOfMemory> {
        let count = pieces.len();
        let line: Vec<_> = (0..count).map(|i| problem.points.piece(i, pieces[i])).collect();
        let on = self.on(problem, pieces);
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

    /// Coefficient of point j's factor in the equation of point i.
    fn coefficient(&self, on: &On, i: usize, j: usize) -> f64 {
        let at = j * on.len() + i;
        match (on.alone(i), on.compliance[i]) {
            (Some(own), _) if i == j => own,
            (Some(_), _) => 0.0,
            (None, Some(compliance)) => self.moved[at] - compliance * self.reaction[at],
            (None, None) => self.reaction[at],
        }
    }

    /// What an equation is multiplied by so that its largest coefficient is 1.
    fn unit(&self, on: &On, i: usize) -> f64 {
        let largest = (0..on.len()).map(|j| self.coefficient(on, i, j).abs()).fold(0.0, f64::max);
        if largest > 0.0 { 1.0 / largest } else { 1.0 }
    }

    /// own + Σ_j part(i, moved_ij, reaction_ij) x_j, summed in double-double, all points side by side.
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

    /// What factors leave of the right-hand side.
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

    /// By the inverse of the known set; `None` if there is none, too many points have changed sides, or rounding of the
    /// update does not go away.
    fn updated(&self, on: &On, pieces: &[u8], right: &[f64]) -> Result<Option<Vec<f64>>, OutOfMemory> {
        let Some(Known { pieces: before, unit, inverse }) = &self.known else { return Ok(None) };
        let count = on.len();
        let changed = differing(pieces, before);
        if changed.len() as f64 > FEW * count as f64 {
            return Ok(None);
        }
        let mut unit = unit.clone();
        changed.iter().for_each(|&i| unit[i] = self.unit(on, i));
        // A row of the changed equations times a column of the inverse that belongs to one.
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

    /// By a factorization of the equations in which no factor stands alone.
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
        // The second pass corrects the first by what it leaves.
        for _ in 0..2 {
            let residual = self.residual(on, right, &x);
            let mut step = Mat::from_fn(size, 1, |p, _| residual[unknown[p]]);
            factors.solve_in_place(step.as_mut())?;
            unknown.iter().enumerate().for_each(|(p, &i)| x[i] += step[(p, 0)]);
        }
        Ok(Some(x))
    }
}
