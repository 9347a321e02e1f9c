//! The points' factors in a sum of responses, on one contact set after another.
//!
//! The equations of a set differ from those of one factored beforehand in the rows of the points that have changed sides,
//! so that its inverse serves for both (Woodbury 1950), corrected by residuals in double-double.

use crate::contact::condense::{Condensed, Form};
use crate::contact::responses::Response;
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

/// Equations of closed points, y − C·reaction = distance, and of open ones, reaction = 0, over the points' factors.
pub(super) struct OnSet {
    /// Displacement and reaction of all points under the response of one, one response behind the other.
    moved: Vec<f64>,
    reaction: Vec<f64>,
    compliance: Vec<f64>,
    /// What the factor of an open and of a closed point is multiplied by where it stands alone in its equation.
    alone: [Vec<Option<f64>>; 2],
    known: Option<Known>,
}

/// A set, and the inverse of its equations, each over its largest coefficient.
struct Known {
    closed: Vec<bool>,
    /// What each equation is multiplied by.
    unit: Vec<f64>,
    inverse: Mat<f64>,
}

impl OnSet {
    /// Of a plate's points, from the response of each.
    pub(super) fn new(condensed: &Condensed, form: Form, points: &[Response]) -> Result<Self, OutOfMemory> {
        let alone = [false, true].map(|closed| {
            let lever = |i: usize| match (form, closed) {
                (Form::Stiffness, true) => (condensed.compliance[i] == 0.0).then_some(1.0),
                (Form::Stiffness, false) => None,
                (Form::Dual, true) => condensed.absorbed(i).then_some(condensed.compliance[i]),
                (Form::Dual, false) => (condensed.regularization[i] == 0.0).then_some(-1.0),
            };
            (0..points.len()).map(lever).collect()
        });
        let count = points.len();
        Ok(Self {
            moved: dense::row_major(count, count, |i, j| points[i].moved[j])?,
            reaction: dense::row_major(count, count, |i, j| points[i].reaction[j])?,
            compliance: condensed.compliance.clone(),
            alone,
            known: None,
        })
    }

    /// Inverts the equations of a set that many others are near to, unless they are singular.
    pub(super) fn begin_with(&mut self, closed: Vec<bool>) -> Result<(), OutOfMemory> {
        let count = closed.len();
        if count > MOST {
            return Ok(());
        }
        let unit: Vec<f64> = (0..count).map(|i| self.unit(&closed, i)).collect();
        let factors = Lu::of(dense::matrix(count, count, |i, j| unit[i] * self.coefficient(&closed, i, j))?)?;
        if factors.has_pivots_above(0.0) {
            let mut inverse = dense::matrix(count, count, |i, j| f64::from(i == j))?;
            factors.solve_in_place(inverse.as_mut())?;
            self.known = Some(Known { closed, unit, inverse });
        }
        Ok(())
    }

    /// Factors, reactions and gaps on a set, past those of a load alone; `None` if its equations are singular.
    pub(super) fn solve(
        &self,
        closed: &[bool],
        distance: &[f64],
        moved: &[f64],
        reaction: &[f64],
    ) -> Result<Option<Found>, OutOfMemory> {
        let count = closed.len();
        let right: Vec<f64> = (0..count)
            .map(|i| match closed[i] {
                true => distance[i] - moved[i] + self.compliance[i] * reaction[i],
                false => -reaction[i],
            })
            .collect();
        let updated = self.updated(closed, &right)?;
        let Some(factor) = (if updated.is_some() { updated } else { self.factored(closed, &right)? }) else {
            return Ok(None);
        };
        let own = (0..count).map(|i| if closed[i] { reaction[i] } else { moved[i] }).collect();
        let total = self.add_products(own, &factor, |i, moved, reaction| if closed[i] { reaction } else { moved });
        let reaction = (0..count).map(|i| if closed[i] { total[i] } else { 0.0 }).collect();
        let gap = (0..count).map(|i| if closed[i] { 0.0 } else { distance[i] - total[i] }).collect();
        Ok(Some((factor, reaction, gap)))
    }

    fn alone(&self, closed: &[bool], i: usize) -> Option<f64> {
        self.alone[usize::from(closed[i])][i]
    }

    /// Coefficient of point j's factor in the equation of point i.
    fn coefficient(&self, closed: &[bool], i: usize, j: usize) -> f64 {
        let at = j * closed.len() + i;
        match self.alone(closed, i) {
            Some(lever) if i == j => lever,
            Some(_) => 0.0,
            None if closed[i] => self.moved[at] - self.compliance[i] * self.reaction[at],
            None => self.reaction[at],
        }
    }

    /// What an equation is multiplied by so that its largest coefficient is 1.
    fn unit(&self, closed: &[bool], i: usize) -> f64 {
        let largest = (0..closed.len()).map(|j| self.coefficient(closed, i, j).abs()).fold(0.0, f64::max);
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
    fn left(&self, closed: &[bool], right: &[f64], x: &[f64]) -> Vec<f64> {
        let mut left = self.add_products(right.to_vec(), x, |i, moved, reaction| {
            if closed[i] { self.compliance[i] * reaction - moved } else { -reaction }
        });
        for (i, left) in left.iter_mut().enumerate() {
            if let Some(lever) = self.alone(closed, i) {
                *left = right[i] - lever * x[i];
            }
        }
        left
    }

    /// By the inverse of the known set; `None` if there is none, too many points have changed sides, or rounding of the
    /// update does not go away.
    fn updated(&self, closed: &[bool], right: &[f64]) -> Result<Option<Vec<f64>>, OutOfMemory> {
        let Some(Known { closed: before, unit, inverse }) = &self.known else { return Ok(None) };
        let count = closed.len();
        let changed: Vec<usize> = (0..count).filter(|&i| closed[i] != before[i]).collect();
        if changed.len() as f64 > FEW * count as f64 {
            return Ok(None);
        }
        let mut unit = unit.clone();
        changed.iter().for_each(|&i| unit[i] = self.unit(closed, i));
        // A row of the changed equations times a column of the inverse that belongs to one.
        let row = |p: usize, j: usize| unit[changed[p]] * self.coefficient(closed, changed[p], j);
        let rows = dense::matrix(changed.len(), count, row)?;
        let columns = dense::matrix(count, changed.len(), |i, q| inverse[(i, changed[q])])?;
        let capacitance = Lu::of(dense::product(rows.as_ref(), columns.as_ref())?)?;
        if !capacitance.has_pivots_above(0.0) {
            return Ok(None);
        }
        let mut x = vec![0.0; count];
        let mut left = right.to_vec();
        for _ in 0..CORRECTIONS {
            let scaled = Mat::from_fn(count, 1, |i, _| unit[i] * left[i]);
            let mut step = inverse * &scaled;
            if !changed.is_empty() {
                let mut missed = &rows * &step - Mat::from_fn(changed.len(), 1, |p, _| scaled[(changed[p], 0)]);
                capacitance.solve_in_place(missed.as_mut())?;
                step -= &columns * missed;
            }
            x.iter_mut().enumerate().for_each(|(i, x)| *x += step[(i, 0)]);
            left = self.left(closed, right, &x);
            let size = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            if (0..count).all(|i| (unit[i] * left[i]).abs() <= tolerances::SUM * size) {
                return Ok(Some(x));
            }
        }
        Ok(None)
    }

    /// By a factorization of the equations in which no factor stands alone.
    fn factored(&self, closed: &[bool], right: &[f64]) -> Result<Option<Vec<f64>>, OutOfMemory> {
        let mut x = vec![0.0; closed.len()];
        let mut unknown = Vec::new();
        for i in 0..closed.len() {
            match self.alone(closed, i) {
                Some(lever) => x[i] = right[i] / lever,
                None => unknown.push(i),
            }
        }
        if unknown.is_empty() {
            return Ok(Some(x));
        }
        let size = unknown.len();
        let factors = Lu::of(dense::matrix(size, size, |p, q| self.coefficient(closed, unknown[p], unknown[q]))?)?;
        if !factors.has_pivots_above(0.0) {
            return Ok(None);
        }
        // The second pass corrects the first by what it leaves.
        for _ in 0..2 {
            let left = self.left(closed, right, &x);
            let mut step = Mat::from_fn(size, 1, |p, _| left[unknown[p]]);
            factors.solve_in_place(step.as_mut())?;
            unknown.iter().enumerate().for_each(|(p, &i)| x[i] += step[(p, 0)]);
        }
        Ok(Some(x))
    }
}
