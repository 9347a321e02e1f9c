//! Nodes that follow a leader as one rigid body.
//!
//! A follower has no unknowns: w_i = w + θ·(x_i − x), θ_i = θ, with w, θ, x of its leader. Forces on a follower act on
//! its leader, with their couples about the leader. Displacements are stored at all nodes, residual forces at leaders
//! only.

use crate::double_double::DoubleDouble;

/// A follower with its leader, and its position relative to the leader as an exact difference of doubles.
#[derive(Clone, Copy)]
pub struct Follower {
    pub node: usize,
    pub leader: usize,
    pub arm: [DoubleDouble; 2],
}

#[derive(Clone, Default)]
pub struct Bodies {
    followers: Vec<Follower>,
}

impl Bodies {
    /// Makes the rigid bodies from the leader of each node; a free node is its own leader.
    pub fn new(points: &[[f64; 2]], leader: &[usize]) -> Self {
        let follower = |(node, &leader): (usize, &usize)| {
            let arm = [0, 1].map(|k| DoubleDouble::from(points[node][k]) - DoubleDouble::from(points[leader][k]));
            Follower { node, leader, arm }
        };
        let followers = leader.iter().enumerate().filter(|(node, leader)| node != *leader).map(follower).collect();
        Self { followers }
    }

    pub fn followers(&self) -> &[Follower] {
        &self.followers
    }

    pub fn is_empty(&self) -> bool {
        self.followers.is_empty()
    }

    /// Moves the forces on followers to their leaders, and adds the couples of these forces about the leaders.
    pub fn gather(&self, force: &mut [f64]) {
        self.gathered(force, |arm| arm);
    }

    /// Moves magnitudes of forces from followers to their leaders. A force F at the position (a, b) relative to the
    /// leader adds |a|F and |b|F to the leader's couples.
    pub fn gather_magnitudes(&self, force: &mut [f64]) {
        self.gathered(force, f64::abs);
    }

    fn gathered(&self, force: &mut [f64], of_arm: impl Fn(f64) -> f64) {
        for Follower { node, leader, arm } in &self.followers {
            let own: [f64; 3] = std::array::from_fn(|k| std::mem::take(&mut force[3 * node + k]));
            force[3 * leader] += own[0];
            for k in 0..2 {
                force[3 * leader + 1 + k] += own[1 + k] + of_arm(arm[k].value()) * own[0];
            }
        }
    }

    /// Sets the displacements of followers in a nodal vector to the rigid motion of their leaders.
    pub fn follow(&self, vector: &mut [f64]) {
        for Follower { node, leader, arm } in &self.followers {
            let [w, x, y] = std::array::from_fn(|k| vector[3 * leader + k]);
            vector[3 * node] = w + x * arm[0].value() + y * arm[1].value();
            (vector[3 * node + 1], vector[3 * node + 2]) = (x, y);
        }
    }
}
