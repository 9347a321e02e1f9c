//! Fields computed node by node from moments m = [mx, my, mxy], shears q = [qx, qy] and thickness h.

use crate::vectorized::vectorized;

/// Number of nodes whose values are computed together, so that these values stay in registers.
pub const TILE: usize = 16;

/// Values of one quantity at the nodes of a tile of [`TILE`] nodes.
pub type Lanes = [f64; TILE];

/// A formula for values at a node from moments m or shears q, and thickness h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formula {
    /// The input itself; this formula has one input.
    Sum,
    /// Principal moments m1 ≥ m2.
    Principal,
    /// Angle from x to the direction of m1, in degrees towards y.
    Angle,
    /// Design moments of bars: bottom x and y ≥ 0, top x and y ≤ 0.
    ///
    /// R. H. Wood, The reinforcement of slabs in accordance with a pre-determined field of moments, Concrete 2 (1968);
    /// G. S. T. Armer, discussion of this paper.
    Design,
    /// Stresses at the faces of a solid plate, ∓6 m/h² at the top and the bottom, tension positive: σx, σy, τxy at the
    /// top, then at the bottom; von Mises' stress at the top and the bottom.
    Face,
    /// Shear stresses τxz, τyz at mid-depth of a solid plate, 3/2 q/h.
    Shear,
    /// Areas of bars per length, required by the design moments: bottom x and y, top x and y.
    Steel(Bars),
}

/// Constants of a section of reinforced concrete; `signorini.design.en1992_bending` cites the clauses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bars {
    /// Distances from the axes of the bars to the face of the plate: bottom bars in x and y, top bars in x and y.
    pub distance: [f64; 4],
    /// Stress η fcd of the rectangular stress block.
    pub block: f64,
    /// Design strength fyd of the bars.
    pub yield_stress: f64,
    /// Largest λx/d.
    pub deepest: f64,
    /// Minimum reinforcement: area of bars per length, divided by the depth d.
    pub least: f64,
    /// Maximum reinforcement: area of bars per length, divided by the thickness h.
    pub most: f64,
    /// Largest m/h² that counts as a rounding error and needs no bars.
    pub plain: f64,
}

impl Bars {
    /// Required area of bars per length for m ≥ 0 at depth d: at least the minimum; infinite if bars in tension alone
    /// cannot resist m.
    ///
    /// With s = λx/d, m = η fcd d² s (1 − s/2) and As fyd = η fcd d s.
    #[inline(always)]
    fn area(&self, m: f64, d: f64, h: f64) -> f64 {
        let twice = 2.0 * m / (self.block * d * d);
        let rest = 1.0 - twice;
        let s = twice / (1.0 + if rest > 0.0 { rest } else { 0.0 }.sqrt());
        let (needed, least) = (self.block * d * s / self.yield_stress, self.least * d);
        let area = if needed > least { needed } else { least };
        let possible = (d > 0.0) & (rest >= 0.0) & (s <= self.deepest) & (area <= self.most * h);
        let area = if possible { area } else { f64::INFINITY };
        let area = if m > self.plain * h * h { area } else { 0.0 };
        let known = m + h;
        if known.is_nan() { known } else { area }
    }

    #[inline(always)]
    fn areas(&self, m: [f64; 3], h: f64) -> [f64; 4] {
        let [x, y, top_x, top_y] = design(m);
        let [a, b, c, d] = self.distance;
        [self.area(x, h - a, h), self.area(y, h - b, h), self.area(-top_x, h - c, h), self.area(-top_y, h - d, h)]
    }
}

#[inline(always)]
fn middle_and_radius([mx, my, mxy]: [f64; 3]) -> (f64, f64) {
    let half = 0.5 * (mx - my);
    (0.5 * (mx + my), (half * half + mxy * mxy).sqrt())
}

#[inline(always)]
fn principal(m: [f64; 3]) -> [f64; 2] {
    let (middle, radius) = middle_and_radius(m);
    [middle + radius, middle - radius]
}

#[inline(always)]
fn angle([mx, my, mxy]: [f64; 3]) -> [f64; 1] {
    [(0.5 * (2.0 * mxy).atan2(mx - my)).to_degrees()]
}

#[inline(always)]
fn design([mx, my, mxy]: [f64; 3]) -> [f64; 4] {
    let (x, y) = sagging(mx, my, mxy);
    let (top_x, top_y) = sagging(-mx, -my, mxy);
    [x, y, 0.0 - top_x, 0.0 - top_y]
}

/// Design moments of the bottom bars in x and y. The moment is 0 in a direction if the bars of the other direction
/// suffice.
#[inline(always)]
fn sagging(mx: f64, my: f64, mxy: f64) -> (f64, f64) {
    let (x, y, twist) = (mx + mxy.abs(), my + mxy.abs(), mxy * mxy);
    let (alone_x, alone_y) = (mx + twist / my.abs(), my + twist / mx.abs());
    let alone_x = if alone_x > 0.0 { alone_x } else { 0.0 };
    let alone_y = if alone_y > 0.0 { alone_y } else { 0.0 };
    let (of_x, of_y) = (if y < 0.0 { alone_x } else { x }, if x < 0.0 { alone_y } else { y });
    (if x < 0.0 { 0.0 } else { of_x }, if y < 0.0 { 0.0 } else { of_y })
}

#[inline(always)]
fn face(m: [f64; 3], h: f64) -> [f64; 8] {
    let [x, y, xy] = m.map(|m| 6.0 * m / (h * h));
    let square = x * x - x * y + y * y + 3.0 * xy * xy;
    let mises = if square < 0.0 { 0.0 } else { square }.sqrt();
    [-x, -y, -xy, x, y, xy, mises, mises]
}

impl Formula {
    /// Number of inputs of the formula at a node: 3 moments, 2 shears, or 1 for [`Formula::Sum`].
    pub fn inputs(self) -> usize {
        match self {
            Self::Sum => 1,
            Self::Shear => 2,
            _ => 3,
        }
    }

    /// Number of values that the formula gives at a node.
    pub fn values(self) -> usize {
        match self {
            Self::Sum | Self::Angle => 1,
            Self::Principal | Self::Shear => 2,
            Self::Design | Self::Steel(_) => 4,
            Self::Face => 8,
        }
    }

    /// Computes the values of the formula at the nodes of a tile.
    #[inline(always)]
    pub fn apply(self, inputs: &[Lanes], thickness: &Lanes, values: &mut [Lanes]) {
        match self {
            Self::Sum => values.copy_from_slice(inputs),
            Self::Principal => each(inputs, thickness, values, |m, _| principal(m)),
            Self::Angle => each(inputs, thickness, values, |m, _| angle(m)),
            Self::Design => each(inputs, thickness, values, |m, _| design(m)),
            Self::Face => each(inputs, thickness, values, face),
            Self::Shear => each(inputs, thickness, values, |q: [f64; 2], h| q.map(|q| 1.5 * q / h)),
            Self::Steel(bars) => each(inputs, thickness, values, |m, h| bars.areas(m, h)),
        }
    }

    /// Values (n, c) of the formula at n nodes, row-major, from inputs (n, i) and thickness (n,). They are equal to the
    /// last bit to those of which envelopes are made.
    pub fn of(self, inputs: &[f64], thickness: &[f64]) -> Vec<f64> {
        let (from, to) = (self.inputs(), self.values());
        let mut result = vec![0.0; thickness.len() * to];
        let rows = inputs.chunks(TILE * from).zip(thickness.chunks(TILE)).zip(result.chunks_mut(TILE * to));
        let (mut tile, mut values, mut h) = (vec![[0.0; TILE]; from], vec![[0.0; TILE]; to], [0.0; TILE]);
        for ((input, thickness), out) in rows {
            h[..thickness.len()].copy_from_slice(thickness);
            for (i, row) in input.chunks_exact(from).enumerate() {
                row.iter().zip(&mut tile).for_each(|(value, lanes)| lanes[i] = *value);
            }
            vectorized(
                #[inline(always)]
                || self.apply(&tile, &h, &mut values),
            );
            for (i, row) in out.chunks_exact_mut(to).enumerate() {
                row.iter_mut().zip(&values).for_each(|(value, lanes)| *value = lanes[i]);
            }
        }
        result
    }
}

/// Evaluates a formula of I inputs and O values at each node of a tile.
#[inline(always)]
fn each<const I: usize, const O: usize>(
    inputs: &[Lanes],
    thickness: &Lanes,
    values: &mut [Lanes],
    formula: impl Fn([f64; I], f64) -> [f64; O],
) {
    let mut out = [[0.0; TILE]; O];
    if let Ok(inputs) = <&[Lanes; I]>::try_from(inputs) {
        for i in 0..TILE {
            let found = formula(std::array::from_fn(|c| inputs[c][i]), thickness[i]);
            for c in 0..O {
                out[c][i] = found[c];
            }
        }
    }
    values.copy_from_slice(&out);
}
