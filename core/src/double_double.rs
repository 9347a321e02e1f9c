//! Unevaluated sums of two doubles, with about 32 digits (Dekker 1971; Knuth's two-sum).

/// The number `hi + lo`. [`DoubleDouble::new`] makes |lo| at most half a unit in the last place of `hi`; `add_product`
/// does not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    pub hi: f64,
    pub lo: f64,
}

#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let hi = c - (c - a);
    (hi, a - hi)
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

impl DoubleDouble {
    #[inline(always)]
    pub fn new(hi: f64, lo: f64) -> Self {
        let (hi, lo) = two_sum(hi, lo);
        Self { hi, lo }
    }

    pub fn value(self) -> f64 {
        self.hi + self.lo
    }

    /// Adds the exact product a · b.
    #[inline]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let (product, error) = two_product(a, b);
        let (sum, carried) = two_sum(self.hi, product);
        *self = Self { hi: sum, lo: self.lo + (carried + error) };
    }

    /// Same result as [`DoubleDouble::add_product`], bit for bit, by a fused multiply-add. It is faster on machines
    /// with such an instruction if the code is compiled for them, and much slower otherwise.
    #[inline(always)]
    pub fn add_product_fused(&mut self, a: f64, b: f64) {
        let product = a * b;
        let error = a.mul_add(b, -product);
        let sum = self.hi + product;
        let part = sum - self.hi;
        *self = Self { hi: sum, lo: self.lo + ((self.hi - (sum - part)) + (product - part) + error) };
    }

    /// The product of `self` and the double `factor`.
    pub fn times(self, factor: f64) -> Self {
        let (p, e) = two_product(self.hi, factor);
        Self::new(p, e + self.lo * factor)
    }

    /// The product of `self` and `factor`, both in double-double.
    pub fn times_sum(self, factor: Self) -> Self {
        self.times(factor.hi) + self.times(factor.lo)
    }

    /// Same result as [`DoubleDouble::times_sum`], bit for bit, by fused multiply-adds; see
    /// [`DoubleDouble::add_product_fused`].
    #[inline(always)]
    pub fn times_sum_fused(self, factor: Self) -> Self {
        let times = |factor: f64| {
            let product = self.hi * factor;
            Self::new(product, self.hi.mul_add(factor, -product) + self.lo * factor)
        };
        times(factor.hi) + times(factor.lo)
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }
}

impl std::ops::Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl std::ops::Add for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (s, e) = two_sum(self.hi, other.hi);
        let (t, f) = two_sum(self.lo, other.lo);
        let partial = Self::new(s, e + t);
        Self::new(partial.hi, partial.lo + f)
    }
}

impl std::ops::Sub for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl std::ops::AddAssign<f64> for DoubleDouble {
    fn add_assign(&mut self, other: f64) {
        let (s, e) = two_sum(self.hi, other);
        *self = Self::new(s, e + self.lo);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_what_a_double_loses() {
        let third = DoubleDouble::from(1.0).times(1.0 / 3.0);
        let mut sum = DoubleDouble::from(1e16);
        sum += 1.0;
        let back = sum - DoubleDouble::from(1e16);
        assert_eq!(back.value(), 1.0);
        let product = DoubleDouble::from(0.1).times(0.1) - DoubleDouble::from(0.1 * 0.1);
        assert!(product.value() != 0.0 && product.value().abs() < 1e-17);
        assert!((third.value() - 1.0 / 3.0).abs() < 1e-17);
    }

    #[test]
    fn a_fused_product_is_the_same_to_the_bit() {
        let (mut plain, mut fused) = (DoubleDouble::from(0.3), DoubleDouble::from(0.3));
        for k in 1..200 {
            let (a, b) = ((1.0 / f64::from(k)).sin() * 1e3, (f64::from(k) / 7.0).cos());
            plain.add_product(a, -b);
            fused.add_product_fused(a, -b);
            assert_eq!(plain, fused);
        }
    }
}
