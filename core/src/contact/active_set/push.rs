//! What the points push with.

use super::descent::Descent;

impl Descent<'_> {
    /// The part of a stretch that pushes.
    pub(super) fn pushes(&self, i: usize, stretch: f64) -> f64 {
        match &self.imposed {
            Some(closed) => f64::from(u8::from(closed[i])) * stretch,
            None => stretch.max(0.0),
        }
    }

    pub(super) fn is_closed(&self, i: usize) -> bool {
        self.imposed.as_ref().map_or(self.stretch[i] > 0.0, |closed| closed[i])
    }

    pub(super) fn pushing(&self, i: usize) -> f64 {
        self.pushes(i, self.stretch[i])
    }

    pub(super) fn largest_push(&self) -> f64 {
        let k = &self.penalty.stiffness;
        (0..k.len()).fold(0.0, |most: f64, i| most.max(k[i] * self.pushing(i)))
    }

    /// Points of the active set that push.
    pub(super) fn pushing_points(&self) -> Vec<bool> {
        self.stretch.iter().map(|&stretch| stretch > 0.0).collect()
    }

    /// Springs no stiffer than a limit, over the plate's stiffness in shear.
    pub(super) fn penalize(&mut self, limit: f64) {
        self.limit = limit;
        self.penalty = self.problem.active.penalized(limit);
        self.balance();
    }

    /// Multipliers become the present forces; the largest change of one.
    pub(super) fn renew_multipliers(&mut self) -> f64 {
        let (problem, points) = (self.problem, &self.problem.active);
        let mut any = false;
        let mut largest: f64 = 0.0;
        for i in 0..points.len() {
            if self.penalty.series[i] > 0.0 {
                let old = self.pushing(i);
                let force = self.penalty.stiffness[i] * old;
                self.stretch[i] += self.penalty.series[i] * (force - self.multiplier[i]);
                largest = largest.max((force - self.multiplier[i]).abs());
                self.multiplier[i] = force;
                let more = self.penalty.stiffness[i] * (self.pushing(i) - old);
                points.scatter(&problem.plate, i, -more, &mut self.residual.imbalance);
                any = true;
            }
        }
        if any {
            problem.release_held(&mut self.residual.imbalance);
            self.residual.worst = self.residual.imbalance.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        }
        largest
    }
}
