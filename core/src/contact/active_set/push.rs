//! What the points push with.

use super::descent::Descent;

impl Descent<'_> {
    pub(super) fn pushing(&self, i: usize) -> f64 {
        self.stretch[i].max(0.0)
    }

    pub(super) fn largest_push(&self) -> f64 {
        let k = &self.factor.penalty.stiffness;
        (0..k.len()).fold(0.0, |most: f64, i| most.max(k[i] * self.pushing(i)))
    }

    /// Points of the active set that push.
    pub(super) fn pushing_points(&self) -> Vec<bool> {
        self.stretch.iter().map(|&stretch| stretch > 0.0).collect()
    }

    /// Springs no stiffer than a limit, over the plate's stiffness in shear.
    pub(super) fn penalize(&mut self, limit: f64) {
        self.factor.limit = limit;
        self.factor.penalty = self.problem.active.penalized(limit);
        self.balance();
    }

    /// Multipliers become the present forces; the largest change of one.
    pub(super) fn renew_multipliers(&mut self) -> f64 {
        let (problem, points) = (self.problem, &self.problem.active);
        let mut any = false;
        let mut largest: f64 = 0.0;
        for i in 0..points.len() {
            if self.factor.penalty.series[i] > 0.0 {
                let old = self.pushing(i);
                let force = self.factor.penalty.stiffness[i] * old;
                self.stretch[i] += self.factor.penalty.series[i] * (force - self.multiplier[i]);
                largest = largest.max((force - self.multiplier[i]).abs());
                self.multiplier[i] = force;
                let more = self.factor.penalty.stiffness[i] * (self.pushing(i) - old);
                points.scatter(&problem.plate, i, -more, &mut self.residual.imbalance);
                any = true;
            }
        }
        if any {
            problem.release_held(&mut self.residual.imbalance);
            self.residual.worst = problem.scale.largest(&self.residual.imbalance);
        }
        largest
    }
}
