//! Gauss–Legendre points and weights on [−1, 1], tensor product rules, and Radon's rule on the triangle.

pub const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

pub const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The tensor product of a rule with itself: points (ξ, η, weight) on the square, ξ running fastest.
pub fn square<const N: usize>(rule: [(f64, f64); N]) -> impl Iterator<Item = (f64, f64, f64)> {
    rule.into_iter().flat_map(move |(eta, b)| rule.into_iter().map(move |(xi, a)| (xi, eta, a * b)))
}

/// Points (r, s, weight) of the rule of seven points on the triangle that is exact to the fifth degree (Radon 1948).
/// Weights are fractions of the area. Two points of weight 0 follow, so that there are nine points as on a
/// quadrilateral.
pub fn radon() -> [(f64, f64, f64); 9] {
    let root = 15.0_f64.sqrt();
    let (near, far) = ((6.0 - root) / 21.0, (6.0 + root) / 21.0);
    let (light, heavy) = ((155.0 - root) / 1200.0, (155.0 + root) / 1200.0);
    let third = 1.0 / 3.0;
    [
        (third, third, 0.225),
        (near, near, light),
        (1.0 - 2.0 * near, near, light),
        (near, 1.0 - 2.0 * near, light),
        (far, far, heavy),
        (1.0 - 2.0 * far, far, heavy),
        (far, 1.0 - 2.0 * far, heavy),
        (third, third, 0.0),
        (third, third, 0.0),
    ]
}
