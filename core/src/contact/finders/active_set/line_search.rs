//! Line search: step length of least energy along a direction.

use super::iterate::NewtonIterate;
use crate::contact::kkt::Direction;
use crate::contact::scale::dot;
use crate::contact::tolerances;
use crate::residual::twice_the_energy;
use crate::superposition::sum_in_order;

/// Largest number of doublings of the step length.
const DOUBLINGS: usize = 60;
/// Largest number of interval reductions; it suffices for the last bit of the step length.
const HALVINGS: usize = 120;

impl NewtonIterate<'_> {
    /// Curvature vᵀKv of the energy along a direction v, without the springs of the contact points.
    fn elastic_curvature(&self, direction: &Direction, change: &[f64]) -> f64 {
        let stiff = dot(&direction.nodal, &direction.force);
        let carried = &self.kkt.system().carried;
        let rest = stiff - carried.iter().zip(change).map(|(k, c)| k * c * c).sum::<f64>();
        if rest > tolerances::newton::PLAIN * stiff {
            return rest;
        }
        twice_the_energy(&self.problem.plate, &self.problem.springs, &direction.nodal)
    }

    /// Step length of least energy along a direction. The slope of the energy is piecewise linear and nondecreasing.
    /// The search ends where the slope is at most `FLAT` times its initial value.
    pub(super) fn line_search(&self, direction: &Direction, change: &[f64], pieces: &[u8]) -> f64 {
        let stays = |i: usize| {
            let on = |augmented_travel: f64| self.piece_at(i, augmented_travel) == pieces[i];
            on(self.augmented_travel[i]) && on(self.augmented_travel[i] + change[i])
        };
        if !direction.is_free && (0..change.len()).all(stays) {
            return 1.0;
        }
        let elastic = if direction.is_free { 0.0 } else { self.elastic_curvature(direction, change) };
        self.least_energy(-dot(&direction.nodal, &self.residual.imbalance), elastic, change)
    }

    /// Step length of least energy along a change of the augmented travels. `start` is the slope of the energy at step
    /// length 0, `elastic` is vᵀKv without the contact points. Returns 0 if the energy does not fall.
    pub(super) fn least_energy(&self, start: f64, elastic: f64, change: &[f64]) -> f64 {
        let force: Vec<f64> = (0..change.len()).map(|i| self.force(i)).collect();
        let slope = |t: f64| -> f64 {
            let one = |i: usize| (self.force_at(i, self.augmented_travel[i] + t * change[i]) - force[i]) * change[i];
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
            // No contact point resists this motion at any step length, so the work of the load along it is rounding.
            return 0.0;
        }
        let mut at_low = slope(low);
        let mut halves = false;
        for _ in 0..HALVINGS {
            // Regula falsi, at least 5 % of the interval from its ends. If it has not halved the interval, as beside a
            // stiff point, bisection follows.
            let part = if halves { 0.5 } else { (at_low / (at_low - at_high)).clamp(0.05, 0.95) };
            let (width, middle) = (high - low, low + part * (high - low));
            let value = slope(middle);
            if value.abs() <= tolerances::newton::FLAT * start.abs() {
                return middle;
            }
            if value < 0.0 {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
            halves = high - low > 0.5 * width;
        }
        low
    }
}
