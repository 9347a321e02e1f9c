//! Shape functions on the reference square [−1, 1]². Nodes: corners counter-clockwise from (−1, −1), midsides
//! counter-clockwise from (0, −1), then (for nine nodes) the centre.

/// Reference coordinates of the nine nodes. The serendipity functions belong to the first eight nodes.
pub const NODES: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];

/// Values of N shape functions and their gradients in reference coordinates at one point.
#[derive(Clone, Copy, Debug)]
pub struct Shape<const N: usize> {
    pub value: [f64; N],
    pub gradient: [[f64; 2]; N],
}

/// The 8-node serendipity functions at (ξ, η) (Ergatoudis, Irons & Zienkiewicz 1968).
///
/// ```
/// let shape = signorini_core::element::shape::serendipity(0.3, -0.4);
/// assert!((shape.value.iter().sum::<f64>() - 1.0).abs() < 1e-15);
/// ```
pub fn serendipity(xi: f64, eta: f64) -> Shape<8> {
    let mut value = [0.0; 8];
    let mut gradient = [[0.0; 2]; 8];
    for i in 0..4 {
        let [a, b] = NODES[i];
        let (x, y) = (a * xi, b * eta);
        value[i] = 0.25 * (1.0 + x) * (1.0 + y) * (x + y - 1.0);
        gradient[i] = [0.25 * a * (1.0 + y) * (2.0 * x + y), 0.25 * b * (1.0 + x) * (x + 2.0 * y)];
    }
    for i in [4, 6] {
        let b = NODES[i][1];
        value[i] = 0.5 * (1.0 - xi * xi) * (1.0 + b * eta);
        gradient[i] = [-xi * (1.0 + b * eta), 0.5 * b * (1.0 - xi * xi)];
    }
    for i in [5, 7] {
        let a = NODES[i][0];
        value[i] = 0.5 * (1.0 + a * xi) * (1.0 - eta * eta);
        gradient[i] = [0.5 * a * (1.0 - eta * eta), -eta * (1.0 + a * xi)];
    }
    Shape { value, gradient }
}

/// The 9-node Lagrange functions at (ξ, η).
///
/// ```
/// let centre = signorini_core::element::shape::lagrange(0.0, 0.0);
/// assert_eq!(centre.value[8], 1.0);
/// ```
pub fn lagrange(xi: f64, eta: f64) -> Shape<9> {
    let quadratic = |at: f64, s: f64| {
        if at == 0.0 { [1.0 - s * s, -2.0 * s] } else { [0.5 * s * (s + at), s + 0.5 * at] }
    };
    let mut value = [0.0; 9];
    let mut gradient = [[0.0; 2]; 9];
    for (i, [a, b]) in NODES.into_iter().enumerate() {
        let [p, dp] = quadratic(a, xi);
        let [q, dq] = quadratic(b, eta);
        value[i] = p * q;
        gradient[i] = [dp * q, p * dq];
    }
    Shape { value, gradient }
}

/// The quadratic functions of the 6-node triangle at (r, s), with r ≥ 0, s ≥ 0, r + s ≤ 1. Their order is that of an
/// element whose third side is collapsed: corners a, b, c, c, midsides ab, bc, c, ca. The functions of the repeated c
/// are zero.
///
/// ```
/// let shape = signorini_core::element::shape::triangular(0.3, 0.2);
/// assert!((shape.value.iter().sum::<f64>() - 1.0).abs() < 1e-15);
/// ```
pub fn triangular(r: f64, s: f64) -> Shape<8> {
    let l = 1.0 - r - s;
    let corner = |x: f64| x * (2.0 * x - 1.0);
    let (a, b, c) = (4.0 * l - 1.0, 4.0 * r - 1.0, 4.0 * s - 1.0);
    Shape {
        value: [corner(l), corner(r), corner(s), 0.0, 4.0 * l * r, 4.0 * r * s, 0.0, 4.0 * s * l],
        gradient: [
            [-a, -a],
            [b, 0.0],
            [0.0, c],
            [0.0; 2],
            [4.0 * (l - r), -4.0 * r],
            [4.0 * s, 4.0 * r],
            [0.0; 2],
            [-4.0 * s, 4.0 * (l - s)],
        ],
    }
}

/// Whether the first side of an element is collapsed to one node (q8r only).
pub fn is_collapsed(nodes: &[usize; 8]) -> bool {
    nodes[0] == nodes[1] && nodes[0] == nodes[4]
}

/// Values of the shape functions, summed by node: those of a collapsed side's three positions are added in the first
/// position, so that each dof appears once.
///
/// ```
/// use signorini_core::element::shape::{gathered, serendipity};
/// let value = gathered(&[0, 0, 1, 2, 0, 3, 4, 5], serendipity(0.3, -1.0).value);
/// assert_eq!(value, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// ```
pub fn gathered<const N: usize>(nodes: &[usize; 8], mut value: [f64; N]) -> [f64; N] {
    if is_collapsed(nodes) {
        value[0] += value[1] + value[4];
        (value[1], value[4]) = (0.0, 0.0);
    }
    value
}

/// The functions of [`triangular`] at (r, s), corrected to vanish at the centroid. The ninth function is the cubic
/// bubble 27rs(1 − r − s).
pub fn bubbled(r: f64, s: f64) -> Shape<9> {
    let plain = triangular(r, s);
    let l = 1.0 - r - s;
    let bubble = 27.0 * l * r * s;
    let slope = [27.0 * s * (l - r), 27.0 * r * (l - s)];
    let share = [1.0, 1.0, 1.0, 0.0, -4.0, -4.0, 0.0, -4.0].map(|part| part / 9.0);
    let (mut value, mut gradient) = ([bubble; 9], [slope; 9]);
    for i in 0..8 {
        value[i] = plain.value[i] + share[i] * bubble;
        gradient[i] = [0, 1].map(|a| plain.gradient[i][a] + share[i] * slope[a]);
    }
    Shape { value, gradient }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f64; 2]; 9] = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [f64::NAN; 2],
        [0.5, 0.0],
        [0.5, 0.5],
        [f64::NAN; 2],
        [0.0, 0.5],
        [1.0 / 3.0, 1.0 / 3.0],
    ];

    fn is_nodal_on_triangles<const N: usize>(shape: impl Fn(f64, f64) -> Shape<N>) {
        for (i, [r, s]) in TRIANGLE[..N].iter().enumerate().filter(|(_, at)| !at[0].is_nan()) {
            for (j, v) in shape(*r, *s).value.iter().enumerate() {
                assert!((*v - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
    }

    fn is_nodal<const N: usize>(shape: impl Fn(f64, f64) -> Shape<N>) {
        for (i, [a, b]) in NODES[..N].iter().enumerate() {
            for (j, v) in shape(*a, *b).value.iter().enumerate() {
                assert_eq!(*v, f64::from(u8::from(i == j)));
            }
        }
    }

    fn gradient_is_derivative<const N: usize>(shape: impl Fn(f64, f64) -> Shape<N>) {
        let (x, y, h) = (0.37, 0.41, 1e-6);
        for i in 0..N {
            let along_x = (shape(x + h, y).value[i] - shape(x - h, y).value[i]) / (2.0 * h);
            let along_y = (shape(x, y + h).value[i] - shape(x, y - h).value[i]) / (2.0 * h);
            let [gx, gy] = shape(x, y).gradient[i];
            assert!((gx - along_x).abs() < 1e-8 && (gy - along_y).abs() < 1e-8);
        }
    }

    #[test]
    fn all_families_are_nodal_and_differentiate() {
        is_nodal(serendipity);
        is_nodal(lagrange);
        gradient_is_derivative(serendipity);
        gradient_is_derivative(lagrange);
        is_nodal_on_triangles(triangular);
        is_nodal_on_triangles(bubbled);
        gradient_is_derivative(triangular);
        gradient_is_derivative(bubbled);
    }
}
