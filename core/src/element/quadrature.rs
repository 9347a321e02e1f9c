//! Gauss–Legendre points and weights on [−1, 1].

pub const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

pub const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Tensor product rule: (ξ, η, weight), ξ running fastest.
pub fn square<const N: usize>(rule: [(f64, f64); N]) -> impl Iterator<Item = (f64, f64, f64)> {
    rule.into_iter().flat_map(move |(eta, b)| rule.into_iter().map(move |(xi, a)| (xi, eta, a * b)))
}
