//! The least energy along a direction.

use super::descent::Descent;
use crate::contact::kkt::Direction;
use crate::contact::scale::dot;
use crate::contact::tolerances;
use crate::residual::twice_the_energy;
use crate::superposition::sum_in_order;

/// At most so many times the length is doubled.
const DOUBLINGS: usize = 60;

impl Descent<'_> {
    /// vᵀKv without the points.
    fn elastic_curvature(&self, direction: &Direction, change: &[f64]) -> f64 {
        let stiff = dot(&direction.nodal, &direction.force);
        let carried = &self.factor.factored().carried;
        let rest = stiff - carried.iter().zip(change).map(|(k, c)| k * c * c).sum::<f64>();
        if rest > tolerances::newton::PLAIN * stiff {
            return rest;
        }
        twice_the_energy(&self.problem.plate, &self.problem.springs, &direction.nodal)
    }

    /// Where the energy along a direction is least: its slope is piecewise linear and grows.
    pub(super) fn line_search(&self, direction: &Direction, change: &[f64], closed: &[bool]) -> f64 {
        let stretch = &self.stretch;
        let kept = |i: usize| (stretch[i] > 0.0) == closed[i] && (stretch[i] + change[i] > 0.0) == closed[i];
        if !direction.free && (0..change.len()).all(kept) {
            return 1.0;
        }
        let elastic = self.elastic_curvature(direction, change);
        self.least_energy(-dot(&direction.nodal, &self.residual.imbalance), elastic, change)
    }

    /// How far along a change of the stretches the energy falls, from its slope and the plate's curvature; 0 if it does not.
    pub(super) fn least_energy(&self, start: f64, elastic: f64, change: &[f64]) -> f64 {
        let (k, stretch) = (&self.factor.penalty.stiffness, &self.stretch);
        let slope = |t: f64| -> f64 {
            let one = |i: usize| k[i] * ((stretch[i] + t * change[i]).max(0.0) - stretch[i].max(0.0)) * change[i];
            start + t * elastic + sum_in_order(change.len(), 4096, one)
        };
        let (mut low, mut high) = (0.0, 1.0);
        if !(start < 0.0) {
            return 0.0;
        }
        let mut at_high = slope(high);
        if at_high.abs() <= tolerances::newton::FLAT * start.abs() {
            return 1.0;
        }
        let mut doublings = 0;
        while at_high < 0.0 && doublings < DOUBLINGS {
            (low, high) = (high, 2.0 * high);
            at_high = slope(high);
            doublings += 1;
        }
        if at_high < 0.0 {
            // No point ever ends it: the load has work left by rounding only.
            return 0.0;
        }
        let mut at_low = slope(low);
        for _ in 0..60 {
            // Regula falsi, kept off the ends.
            let part = (at_low / (at_low - at_high)).clamp(0.05, 0.95);
            let middle = low + part * (high - low);
            let value = slope(middle);
            if value.abs() <= tolerances::newton::FLAT * start.abs() {
                return middle;
            }
            if value < 0.0 {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
        }
        low
    }
}
