//! Materials, thicknesses, and sections of a plate: bending and shear rigidities at one point.

use super::kind::Kind;
use super::number::Number;

/// A linear elastic material of a plate, isotropic or anisotropic.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// Largest Young's modulus of the material over all directions, for reference forces.
    pub young: f64,
    /// Rigidities of a plate of this material with thickness 1.
    pub unit: Section,
}

impl Material {
    /// Makes an isotropic material; `shear_factor` is κₛ in the shear rigidity κₛGh.
    pub const fn isotropic(young: f64, poisson: f64, shear_factor: f64) -> Self {
        let d = young / (12.0 * (1.0 - poisson * poisson));
        let (coupled, twist) = (d * poisson, d * 0.5 * (1.0 - poisson));
        let s = shear_factor * young / (2.0 * (1.0 + poisson));
        let bending = [[d, coupled, 0.0], [coupled, d, 0.0], [0.0, 0.0, twist]];
        Self { young, unit: Section { bending, shear: [[s, 0.0], [0.0, s]] } }
    }

    /// Smaller of the bending rigidities in x and y; D = Eh³/12(1−ν²) if the material is isotropic.
    pub fn bending_rigidity(&self, thickness: f64) -> f64 {
        let unit = &self.unit.bending;
        unit[0][0].min(unit[1][1]) * thickness.powi(3)
    }

    /// Larger of the shear rigidities in x and y; S = κₛGh if the material is isotropic.
    pub fn shear_rigidity(&self, thickness: f64) -> f64 {
        let unit = &self.unit.shear;
        unit[0][0].max(unit[1][1]) * thickness
    }

    /// Section for a thickness h: bending rigidities of thickness 1 times h³, shear rigidities times h.
    #[inline(always)]
    pub fn section(&self, thickness: f64) -> Section {
        let cube = thickness * thickness * thickness;
        Section {
            bending: self.unit.bending.map(|row| row.map(|value| cube * value)),
            shear: self.unit.shear.map(|row| row.map(|value| thickness * value)),
        }
    }
}

/// The materials of a plate, with the index of each element's material.
#[derive(Clone, Debug)]
pub struct Materials {
    all: Vec<Material>,
    /// Index of each element's material in `all`; empty if there is one material.
    of: Vec<u32>,
}

impl From<Material> for Materials {
    fn from(material: Material) -> Self {
        Self { all: vec![material], of: Vec::new() }
    }
}

impl Materials {
    /// Makes the materials `all`; `of` has, for each element, the index of its material.
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

    /// Whether each of `elements` elements has the index of an existing material. The list of indices may be empty if
    /// there is one material.
    pub fn fit(&self, elements: usize) -> bool {
        let of_each = self.of.len() == elements && self.of.iter().all(|&number| (number as usize) < self.all.len());
        of_each || (self.of.is_empty() && self.all.len() == 1)
    }

    /// Largest Young's modulus of all materials.
    pub fn young(&self) -> f64 {
        self.all.iter().map(|material| material.young).fold(0.0, f64::max)
    }
}

/// Rigidities of a plate at a point: `bending` maps [κxx, κyy, 2κxy] to [mxx, myy, mxy], `shear` maps [γx, γy] to [qx,
/// qy].
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
    /// Whether both rigidity matrices are symmetric, finite and positive definite.
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

/// Thickness of a plate at the points of its elements at which sections are needed, see [`Kind::points`].
#[derive(Clone, Debug)]
pub enum Thickness {
    Constant(f64),
    Varying {
        /// Thickness at each point of each element, element by element.
        at_points: Vec<f64>,
        layered: Layered,
    },
}

/// Sections of those elements inside which the thickness jumps, at each of their points, element by element.
#[derive(Clone, Debug, Default)]
pub struct Layered {
    /// Indices of the elements inside which the thickness jumps, in increasing order.
    pub element: Vec<usize>,
    pub section: Vec<Section>,
}

/// Sections of one element at each of its points: given by one thickness, by a thickness at each point, or by
/// rigidities.
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

    /// The constant thickness, or the thicknesses at all points of all elements.
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

    /// Smallest thickness at the points of element e.
    pub fn least_of(&self, kind: Kind, e: usize) -> f64 {
        match self {
            Self::Constant(thickness) => *thickness,
            Self::Varying { at_points, .. } => {
                let count = kind.points().len();
                at_points[count * e..count * (e + 1)].iter().copied().fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Thickness at the first point of element e.
    pub fn first(&self, kind: Kind, e: usize) -> f64 {
        match self {
            Self::Constant(thickness) => *thickness,
            Self::Varying { at_points, .. } => at_points[kind.points().len() * e],
        }
    }
}
