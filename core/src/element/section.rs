//! The section of a plate at one point: thickness and rigidities.

use super::kind::Kind;
use super::number::Number;

/// Linear elasticity, isotropic or not.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// Largest Young's modulus: the reference of forces.
    pub young: f64,
    /// Rigidities of a plate of thickness 1.
    pub unit: Section,
}

impl Material {
    /// The same in all directions; the shear correction factor is that of the plate.
    pub const fn isotropic(young: f64, poisson: f64, shear_factor: f64) -> Self {
        let d = young / (12.0 * (1.0 - poisson * poisson));
        let (coupled, twist) = (d * poisson, d * 0.5 * (1.0 - poisson));
        let s = shear_factor * young / (2.0 * (1.0 + poisson));
        let bending = [[d, coupled, 0.0], [coupled, d, 0.0], [0.0, 0.0, twist]];
        Self { young, unit: Section { bending, shear: [[s, 0.0], [0.0, s]] } }
    }

    /// The lesser rigidity in bending of x and y; Eh³/12(1−ν²) where there is one.
    pub fn bending_rigidity(&self, thickness: f64) -> f64 {
        let unit = &self.unit.bending;
        unit[0][0].min(unit[1][1]) * thickness.powi(3)
    }

    /// The greater rigidity in shear of x and y; κGh where there is one.
    pub fn shear_rigidity(&self, thickness: f64) -> f64 {
        let unit = &self.unit.shear;
        unit[0][0].max(unit[1][1]) * thickness
    }

    /// The section of a plate of one thickness.
    #[inline(always)]
    pub fn section(&self, thickness: f64) -> Section {
        let cube = thickness * thickness * thickness;
        Section {
            bending: self.unit.bending.map(|row| row.map(|value| cube * value)),
            shear: self.unit.shear.map(|row| row.map(|value| thickness * value)),
        }
    }
}

/// Material of each element.
#[derive(Clone, Debug)]
pub struct Materials {
    all: Vec<Material>,
    /// Which of them each element is of; empty where there is one.
    of: Vec<u32>,
}

impl From<Material> for Materials {
    fn from(material: Material) -> Self {
        Self { all: vec![material], of: Vec::new() }
    }
}

impl Materials {
    /// Several materials, and which of them each element is of.
    pub const fn several(all: Vec<Material>, of: Vec<u32>) -> Self {
        Self { all, of }
    }

    pub fn number(&self, e: usize) -> u32 {
        self.of.get(e).copied().unwrap_or(0)
    }

    pub fn at(&self, e: usize) -> &Material {
        &self.all[self.number(e) as usize]
    }

    pub fn all(&self) -> &[Material] {
        &self.all
    }

    /// Whether all elements refer to existing materials.
    pub fn fit(&self, elements: usize) -> bool {
        let of_each = self.of.len() == elements && self.of.iter().all(|&number| (number as usize) < self.all.len());
        of_each || (self.of.is_empty() && self.all.len() == 1)
    }

    /// Young's modulus, the largest.
    pub fn young(&self) -> f64 {
        self.all.iter().map(|material| material.young).fold(0.0, f64::max)
    }
}

/// Rigidities: [mxx, myy, mxy] from [κxx, κyy, 2κxy] and [qx, qy] from [γx, γy].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section<T = f64> {
    pub bending: [[T; 3]; 3],
    pub shear: [[T; 2]; 2],
}

impl<T: Number> Section<T> {
    #[inline(always)]
    pub fn moment(&self, curvature: [T; 3]) -> [T; 3] {
        self.bending.map(|row| row[0] * curvature[0] + row[1] * curvature[1] + row[2] * curvature[2])
    }

    #[inline(always)]
    pub fn shear_force(&self, strain: [T; 2]) -> [T; 2] {
        self.shear.map(|row| row[0] * strain[0] + row[1] * strain[1])
    }
}

impl Section {
    /// Whether every load meets resistance: both matrices symmetric, finite and positive definite.
    pub fn resists(&self) -> bool {
        let ([[a, b, c], [_, d, e], [_, _, f]], [[s, t], [_, u]]) = (self.bending, self.shear);
        let symmetric = (0..3).all(|i| (0..i).all(|j| self.bending[i][j] == self.bending[j][i]));
        let minor = a * d - b * b;
        let determinant = f * minor - e * (a * e - b * c) + c * (b * e - c * d);
        let finite = determinant.is_finite() && (s * u).is_finite();
        finite && symmetric && self.shear[1][0] == t && a > 0.0 && minor > 0.0 && determinant > 0.0 && s > 0.0 && {
            s * u > t * t
        }
    }
}

/// Thickness of a plate at its elements' points, see [`Kind::points`].
#[derive(Clone, Debug)]
pub enum Thickness {
    Constant(f64),
    Varying {
        /// Element after element, its points in their order.
        at_points: Vec<f64>,
        layered: Layered,
    },
}

/// Sections, at each of their points, of elements inside which the thickness jumps.
#[derive(Clone, Debug, Default)]
pub struct Layered {
    /// In increasing order.
    pub element: Vec<usize>,
    pub section: Vec<Section>,
}

/// Sections of one element, at each of its points.
#[derive(Clone, Copy, Debug)]
pub enum Sections<'a> {
    Constant(f64),
    Varying(&'a [f64]),
    Layered(&'a [Section]),
}

impl Sections<'_> {
    #[inline(always)]
    pub fn at(&self, point: usize, material: &Material) -> Section {
        match self {
            Self::Constant(thickness) => material.section(*thickness),
            Self::Varying(thickness) => material.section(thickness[point]),
            Self::Layered(sections) => sections[point],
        }
    }
}

impl Thickness {
    pub fn of(&self, kind: Kind, e: usize) -> Sections<'_> {
        let count = kind.points().len();
        match self {
            Self::Constant(thickness) => Sections::Constant(*thickness),
            Self::Varying { at_points, layered } => match layered.element.binary_search(&e) {
                Ok(at) => Sections::Layered(&layered.section[count * at..count * (at + 1)]),
                Err(_) => Sections::Varying(&at_points[count * e..count * (e + 1)]),
            },
        }
    }

    /// All there are; of an element whose thickness jumps those of its points.
    pub fn all(&self) -> &[f64] {
        match self {
            Self::Constant(thickness) => std::slice::from_ref(thickness),
            Self::Varying { at_points, .. } => at_points,
        }
    }

    pub fn least(&self) -> f64 {
        self.all().iter().copied().fold(f64::INFINITY, f64::min)
    }

    pub fn most(&self) -> f64 {
        self.all().iter().copied().fold(0.0, f64::max)
    }

    /// Least of an element's points.
    pub fn least_of(&self, kind: Kind, e: usize) -> f64 {
        match self {
            Self::Constant(thickness) => *thickness,
            Self::Varying { at_points, .. } => {
                let count = kind.points().len();
                at_points[count * e..count * (e + 1)].iter().copied().fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// At the first point of an element.
    pub fn first(&self, kind: Kind, e: usize) -> f64 {
        match self {
            Self::Constant(thickness) => *thickness,
            Self::Varying { at_points, .. } => at_points[kind.points().len() * e],
        }
    }
}
