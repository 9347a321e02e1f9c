//! A direction of the plate's motion.

/// A displacement, the force that the factored matrix has for it, and what it adds to two-sided points' reactions.
#[derive(Default)]
pub(crate) struct Direction {
    pub nodal: Vec<f64>,
    pub force: Vec<f64>,
    pub reaction: Vec<f64>,
    /// Whether the closed points let the plate move along it freely: then it has no length of its own.
    pub free: bool,
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Direction {
    pub(crate) fn zeros(size: usize, reactions: usize) -> Self {
        Self { nodal: vec![0.0; size], force: vec![0.0; size], reaction: vec![0.0; reactions], free: false }
    }

    /// self·beta + other
    pub(crate) fn renew(&mut self, beta: f64, other: &Self) {
        for (mine, new) in
            [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force), (&mut self.reaction, &other.reaction)]
        {
            for (a, b) in mine.iter_mut().zip(new) {
                *a = beta * *a + b;
            }
        }
    }

    pub(crate) fn add(&mut self, alpha: f64, other: &Self) {
        for (mine, new) in
            [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force), (&mut self.reaction, &other.reaction)]
        {
            for (a, b) in mine.iter_mut().zip(new) {
                *a += alpha * b;
            }
        }
    }
}
