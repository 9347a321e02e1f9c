//! Displacements in double-double, and their part without the rigid motion of an element.

use crate::bodies::{Bodies, Follower};
use crate::double_double::DoubleDouble;
use crate::element::DOFS;
use crate::plate::Plate;
use crate::vectorized::vectorized;

/// Nodal displacements u = hi + lo (3n,), each the sum of two doubles.
#[derive(Clone, Debug, Default)]
pub struct Displacement {
    pub hi: Vec<f64>,
    pub lo: Vec<f64>,
}

impl Displacement {
    pub fn zeros(len: usize) -> Self {
        Self { hi: vec![0.0; len], lo: vec![0.0; len] }
    }

    pub fn at(&self, i: usize) -> DoubleDouble {
        DoubleDouble { hi: self.hi[i], lo: self.lo[i] }
    }

    pub fn add(&mut self, i: usize, increment: f64) {
        let mut sum = self.at(i);
        sum += increment;
        (self.hi[i], self.lo[i]) = (sum.hi, sum.lo);
    }

    /// Sets the displacements of followers from those of their leaders. The sums are in double-double, so that rigid
    /// bodies have no strain.
    pub fn follow(&mut self, bodies: &Bodies) {
        for Follower { node, leader, arm } in bodies.followers() {
            let [w, x, y] = std::array::from_fn(|k| self.at(3 * leader + k));
            let moved = [w + x.times_sum(arm[0]) + y.times_sum(arm[1]), x, y];
            for (k, value) in moved.into_iter().enumerate() {
                (self.hi[3 * node + k], self.lo[3 * node + k]) = (value.hi, value.lo);
            }
        }
    }

    /// Adds a rigid motion w + sx (x − cx) + sy (y − cy), with (cx, cy) = `centre`, to each connected component of the
    /// mesh. `motions` has [w, sx, sy] of each component. The sum is in double-double, so that rounding causes no
    /// strain.
    pub fn add_rigid(&mut self, plate: &Plate, centre: [f64; 2], motions: &[[f64; 3]]) {
        let add = |to: &mut Self, i: usize, what: DoubleDouble| {
            let sum = to.at(i) + what;
            (to.hi[i], to.lo[i]) = (sum.hi, sum.lo);
        };
        for node in 0..plate.node_count() {
            let [w, sx, sy] = motions[plate.components().of(node)];
            let point = plate.point(node);
            let along = |slope: f64, k: usize| {
                DoubleDouble::from(slope).times_sum(DoubleDouble::from(point[k]) - DoubleDouble::from(centre[k]))
            };
            add(self, 3 * node, DoubleDouble::from(w) + along(sx, 0) + along(sy, 1));
            let slopes = match plate.frame(node) {
                Some([c, s]) => {
                    // Transforms slopes in x and y to the frame (c, s) of the node. The second term of `turned`
                    // corrects for c² + s², which is 1 except for rounding.
                    let square = DoubleDouble::from(c).times(c) + DoubleDouble::from(s).times(s);
                    let excess = (square - DoubleDouble::from(1.0)).value();
                    let turned = |a: f64, b: f64| {
                        let sum = DoubleDouble::from(c).times(a) + DoubleDouble::from(s).times(b);
                        sum - sum.times(excess)
                    };
                    [turned(sx, sy), turned(sy, -sx)]
                }
                None => [DoubleDouble::from(sx), DoubleDouble::from(sy)],
            };
            for (k, slope) in slopes.into_iter().enumerate() {
                add(self, 3 * node + 1 + k, slope);
            }
        }
    }

    /// Slopes θx, θy of a node. The stored slopes are those along the axes of the node's frame.
    fn slopes(&self, plate: &Plate, node: usize) -> [DoubleDouble; 2] {
        let [p, q] = [self.at(3 * node + 1), self.at(3 * node + 2)];
        match plate.frame(node) {
            Some([c, s]) => [p.times(c) - q.times(s), p.times(s) + q.times(c)],
            None => [p, q],
        }
    }

    /// Displacements of an element in x and y, minus the rigid motion of the element's first node.
    pub fn strained(&self, plate: &Plate, e: usize) -> [f64; DOFS] {
        self.stripped(plate, e).map(DoubleDouble::value)
    }

    /// Displacements of an element minus the rigid motion of its first node, as [`Displacement::strained`], in
    /// double-double.
    pub fn stripped(&self, plate: &Plate, e: usize) -> [DoubleDouble; DOFS] {
        vectorized(
            #[inline(always)]
            || self.stripped_fused(plate, e),
        )
    }

    #[inline(always)]
    fn stripped_fused(&self, plate: &Plate, e: usize) -> [DoubleDouble; DOFS] {
        let nodes = &plate.elements()[e];
        let first = plate.point(nodes[0]);
        let origin = self.at(3 * nodes[0]);
        let slope = self.slopes(plate, nodes[0]);
        let mut out = [DoubleDouble::default(); DOFS];
        for i in 1..8 {
            let point = plate.point(nodes[i]);
            // Differences of coordinates are computed without rounding, since a rigid motion must not strain the
            // element.
            let along =
                |k: usize| slope[k].times_sum_fused(DoubleDouble::from(point[k]) - DoubleDouble::from(first[k]));
            let rigid = along(0) + along(1);
            out[3 * i] = self.at(3 * nodes[i]) - origin - rigid;
            let here = self.slopes(plate, nodes[i]);
            out[3 * i + 1] = here[0] - slope[0];
            out[3 * i + 2] = here[1] - slope[1];
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_motion_strains_nothing_whatever_its_size() {
        let points = [[0.1, 0.7], [1.3, 0.6], [1.7, 1.9], [0.3, 1.4], [0.7, 0.65], [1.5, 1.2], [1.0, 1.7], [0.2, 1.1]];
        let frames = (0..8).map(|i| [(0.3 * f64::from(i)).cos(), (0.3 * f64::from(i)).sin()]).collect();
        let material = crate::element::Material::isotropic(1e11, 0.3, 5.0 / 6.0);
        let kind = crate::element::Kind::Mitc9;
        let thickness = crate::element::Thickness::Constant(0.01);
        let plate =
            Plate::new(points.to_vec(), vec![[0, 1, 2, 3, 4, 5, 6, 7]], thickness, material, kind, Some(frames));
        let plate = plate.unwrap();
        let mut displacement = Displacement::zeros(24);
        displacement.add_rigid(&plate, [0.37, 1.1], &[[1e3 / 3.0, 70.0 / 3.0, -1e2 / 7.0]]);
        let strained = displacement.strained(&plate, 0);
        assert!(strained.iter().all(|u| u.abs() < 1e-28), "{strained:?}");
        assert!(displacement.hi.iter().any(|u| u.abs() > 300.0));
    }
}
