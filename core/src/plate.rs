//! A discretised plate: nodes, 8-node elements, thickness, material, and the frames of nodal rotations. A triangle
//! repeats its third corner (`element::mitc7`); a quadrilateral with a collapsed side repeats the first
//! (`element::q8r`).
//!
//! Dofs are (w, θ1, θ2), node by node. θ1, θ2 are θx, θy, or, at a node with a frame (c, s), the slopes along (c, s)
//! and (−s, c). Thus a support can fix one slope in any direction.

use crate::bodies::Bodies;
use crate::components::Components;
use crate::double_double::DoubleDouble;
use crate::element::thin::{self, Strains};
use crate::element::{self, Centre, DOFS, Geometry, Kind, Material, Materials, PACKED, Sections, Thickness, shape};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Reasons why the arrays of a plate are invalid.
#[derive(Clone, Debug, PartialEq)]
pub enum PlateError {
    /// The plate has no elements.
    Empty,
    /// The named array has the wrong length.
    Length { what: &'static str, found: usize, expected: usize },
    /// A number of the named array is NaN or infinite.
    NotFinite { what: &'static str, index: usize },
    /// A value of the named array is outside its range.
    Range { what: &'static str, index: usize },
    /// An element refers to a node that does not exist.
    NoSuchNode { element: usize, node: usize },
    /// An element repeats a node in a pattern other than [a, b, c, c, ab, bc, c, ca] and [c, c, a, b, c, ca, ab, bc].
    Repeated { element: usize },
    /// An element is a triangle, but its kind has no triangles.
    Triangle { element: usize },
    /// An element is a collapsed quadrilateral, but its kind does not allow this.
    Collapsed { element: usize },
    /// The Jacobian determinant of an element is not positive at a Gauss point.
    Inverted { element: usize },
}

impl std::fmt::Display for PlateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Empty => write!(f, "a plate has at least one element"),
            Self::Length { what, found, expected } => write!(f, "{what} has length {found}; expected {expected}"),
            Self::NotFinite { what, index } => write!(f, "{what} is not finite at index {index}"),
            Self::Range { what, index } => write!(f, "{what} is out of range at index {index}"),
            Self::NoSuchNode { element, node } => write!(f, "element {element} names node {node}, which is not there"),
            Self::Repeated { element } => {
                write!(
                    f,
                    "element {element} repeats a node; of mitc9 a triangle may, [a, b, c, c, ab, bc, c, ca], of q8r a \
                     quadrilateral with a collapsed side, [c, c, a, b, c, ca, ab, bc]"
                )
            }
            Self::Triangle { element } => write!(f, "element {element} is a triangle, which q8r has not; take mitc9"),
            Self::Collapsed { element } => write!(
                f,
                "element {element} has a collapsed side, which mitc9 has not; take q8r, or its triangle [a, b, c, c, ab, \
                 bc, c, ca]"
            ),
            Self::Inverted { element } => write!(f, "element {element} is turned over or degenerate"),
        }
    }
}

impl std::error::Error for PlateError {}

/// In elements of larger slenderness (`thin::slenderness`), nodal forces are computed from strains. If they were
/// computed with the element matrix, they would have a relative error of ε times the slenderness squared, more than
/// 1e-10 of the load.
const THIN: f64 = 2e3;

/// Number of elements in one parallel chunk.
const CHUNK: usize = 64;

pub struct Plate {
    points: Vec<[f64; 2]>,
    elements: Vec<[usize; 8]>,
    pub thickness: Thickness,
    frames: Option<Vec<[f64; 2]>>,
    pub materials: Materials,
    pub kind: Kind,
    /// Index of each element's stiffness matrix; congruent elements share a matrix.
    matrix: Vec<u32>,
    stiffness: Vec<f64>,
    centres: Vec<Centre>,
    thin: Vec<bool>,
    stress_nodes: Option<StressNodes>,
    bodies: Arc<Bodies>,
    components: Components,
    /// For each element, the leaders of its nodes (`leading`), and whether all its nodes have the same leader
    /// (`rigid`). Both lists are empty if the plate has no rigid bodies.
    leading: Vec<[usize; 8]>,
    rigid: Vec<bool>,
}

/// Nodes at which moments and shears are evaluated. On a jump of the section, a mesh node has a stress node on each
/// side.
pub struct StressNodes {
    /// The eight stress nodes of each element.
    pub elements: Vec<[usize; 8]>,
    pub count: usize,
}

impl Plate {
    /// Checks the arrays of a plate and computes every element matrix, in parallel.
    ///
    /// `frames`, if present, has (cos, sin) of the first rotation direction of each node.
    pub fn new(
        points: Vec<[f64; 2]>,
        elements: Vec<[usize; 8]>,
        thickness: Thickness,
        materials: impl Into<Materials>,
        kind: Kind,
        frames: Option<Vec<[f64; 2]>>,
    ) -> Result<Self, PlateError> {
        let materials = materials.into();
        if elements.is_empty() {
            return Err(PlateError::Empty);
        }
        check_finite("points", points.iter().flatten())?;
        check_thickness(&thickness, kind.points().len(), elements.len())?;
        let sound = |m: &Material| m.young > 0.0 && m.young.is_finite() && m.unit.resists();
        if let Some(index) = materials.all().iter().position(|material| !sound(material)) {
            return Err(PlateError::Range { what: "material", index });
        }
        if !materials.fit(elements.len()) {
            return Err(PlateError::Range { what: "materials of elements", index: 0 });
        }
        if let Some(frames) = &frames {
            check_finite("frames", frames.iter().flatten())?;
            check_length("frames", frames.len(), points.len())?;
            if let Some(index) = frames.iter().position(|[c, s]| (c.hypot(*s) - 1.0).abs() > 1e-12) {
                return Err(PlateError::Range { what: "frames", index });
            }
        }
        for (element, nodes) in elements.iter().enumerate() {
            if let Some(&node) = nodes.iter().find(|&&node| node >= points.len()) {
                return Err(PlateError::NoSuchNode { element, node });
            }
            let again = |i: usize| nodes[..i].contains(&nodes[i]);
            match ((1..8).filter(|&i| again(i)).count(), kind) {
                (0, _) => {}
                (2, Kind::Mitc9) if is_triangle(nodes) => {}
                (2, Kind::Q8r) if shape::is_collapsed(nodes) => {}
                (2, Kind::Q8r) if is_triangle(nodes) => return Err(PlateError::Triangle { element }),
                (2, Kind::Mitc9) if shape::is_collapsed(nodes) => return Err(PlateError::Collapsed { element }),
                _ => return Err(PlateError::Repeated { element }),
            }
        }
        let mut plate = Self {
            points,
            elements,
            thickness,
            frames,
            materials,
            kind,
            matrix: Vec::new(),
            stiffness: Vec::new(),
            centres: Vec::new(),
            thin: Vec::new(),
            stress_nodes: None,
            bodies: Arc::default(),
            components: Components::default(),
            leading: Vec::new(),
            rigid: Vec::new(),
        };
        let first = plate.share_matrices();
        if let Some(&element) = first.par_iter().find_first(|&&e| plate.geometry(e).is_inverted()) {
            return Err(PlateError::Inverted { element });
        }
        let mut stiffness = vec![0.0; PACKED * first.len()];
        let (mut centres, mut thin) = (vec![Centre::default(); first.len()], vec![false; first.len()]);
        let size = plate.size();
        let beside = centres.par_chunks_mut(CHUNK).zip(thin.par_chunks_mut(CHUNK));
        let chunks = stiffness.par_chunks_mut(PACKED * CHUNK).zip(beside);
        first.par_chunks(CHUNK).zip(chunks).for_each(|(which, (stiffness, (centres, thin)))| {
            let elements: Vec<_> =
                which.iter().map(|&e| (plate.geometry(e), plate.materials.at(e), plate.sections(e))).collect();
            element::stiffness(kind, &elements, |at, found| {
                let (geometry, material, sections) = &elements[at];
                let thinnest = plate.thickness.least_of(kind, which[at]);
                let out = &mut stiffness[PACKED * at..PACKED * (at + 1)];
                out.copy_from_slice(&found.packed);
                thin[at] = kind == Kind::Mitc9 && thin::slenderness(geometry, thinnest, size) > THIN;
                if thin[at] {
                    let softer = thin::factored_stiffness(geometry, material, *sections, thinnest);
                    softer.iter().for_each(|softer| out.copy_from_slice(softer));
                }
                centres[at].clone_from(&found.centre);
            });
        });
        (plate.stiffness, plate.centres, plate.thin) = (stiffness, centres, thin);
        plate.components = Components::new(plate.node_count(), plate.elements.iter().map(<[_; 8]>::as_slice));
        Ok(plate)
    }

    /// Sets the stress nodes, which separate moments and shears where these jump.
    pub fn with_stress_nodes(mut self, nodes: StressNodes) -> Result<Self, PlateError> {
        check_length("elements of stress nodes", nodes.elements.len(), self.elements.len())?;
        // There are at most eight stress nodes for each element. This is checked before memory is allocated.
        if nodes.count > 8 * self.elements.len() {
            return Err(PlateError::Range { what: "stress nodes", index: 0 });
        }
        for (element, &node) in nodes.elements.iter().enumerate().flat_map(|(e, own)| own.iter().map(move |n| (e, n))) {
            if node >= nodes.count {
                return Err(PlateError::NoSuchNode { element, node });
            }
        }
        self.stress_nodes = Some(nodes);
        Ok(self)
    }

    /// Makes each node follow its leader (n,) as part of a rigid body; a free node is its own leader. Elements within a
    /// rigid body add no stiffness and have no moments and shears.
    pub fn with_bodies(mut self, leader: &[usize]) -> Result<Self, PlateError> {
        check_length("leaders", leader.len(), self.node_count())?;
        let plain = |node: usize| self.frame(node).is_none();
        let leads = |node: usize, of: usize| of == node || (leader.get(of) == Some(&of) && plain(node) && plain(of));
        if let Some(index) = (0..leader.len()).find(|&node| !leads(node, leader[node])) {
            return Err(PlateError::Range { what: "leaders", index });
        }
        self.bodies = Arc::new(Bodies::new(&self.points, leader));
        let links: Vec<[usize; 2]> = leader.iter().enumerate().map(|(node, &leader)| [node, leader]).collect();
        let elements = self.elements.iter().map(<[_; 8]>::as_slice);
        self.components = Components::new(self.node_count(), elements.chain(links.iter().map(<[_; 2]>::as_slice)));
        self.leading = self.elements.iter().map(|nodes| nodes.map(|node| leader[node])).collect();
        self.rigid = self.leading.iter().map(|nodes| nodes.iter().all(|node| *node == nodes[0])).collect();
        Ok(self)
    }

    pub fn bodies(&self) -> &Arc<Bodies> {
        &self.bodies
    }

    /// Connected components of the mesh. Nodes are connected by elements and by rigid bodies.
    pub fn components(&self) -> &Components {
        &self.components
    }

    /// The leaders of the eight nodes of element e; a free node is its own leader.
    pub fn leading(&self, e: usize) -> &[usize; 8] {
        self.leading.get(e).unwrap_or(&self.elements[e])
    }

    /// Whether all nodes of element e belong to one rigid body.
    pub fn is_rigid(&self, e: usize) -> bool {
        self.rigid.get(e) == Some(&true)
    }

    /// Whether some node of element e follows a leader as part of a rigid body.
    pub fn has_followers(&self, e: usize) -> bool {
        self.leading(e) != &self.elements[e]
    }

    /// Position of a node of element e relative to the leader of this node.
    pub fn arm(&self, e: usize, local: usize) -> [f64; 2] {
        let [from, to] = [self.leading(e)[local], self.elements[e][local]].map(|node| self.points[node]);
        [to[0] - from[0], to[1] - from[1]]
    }

    /// Transforms a covector over the dofs of element e (a force, a row of G) to the dofs of the leaders of its nodes.
    /// If several nodes have the same leader, the coefficients are summed at the first of these nodes.
    pub fn onto_leaders(&self, e: usize, covector: &mut [f64; DOFS]) {
        let leading = self.leading(e);
        for i in (0..8).filter(|_| self.has_followers(e)) {
            let arm = self.arm(e, i);
            let own: [f64; 3] = std::array::from_fn(|k| std::mem::take(&mut covector[3 * i + k]));
            let at = 3 * leading.iter().position(|node| *node == leading[i]).expect("node i has a leader");
            covector[at] += own[0];
            (0..2).for_each(|k| covector[at + 1 + k] += own[1 + k] + arm[k] * own[0]);
        }
    }

    /// The stress nodes of each element, and the total number of stress nodes.
    pub fn stress_nodes(&self) -> (&[[usize; 8]], usize) {
        self.stress_nodes.as_ref().map_or((&self.elements, self.node_count()), |nodes| (&nodes.elements, nodes.count))
    }

    /// Assigns a stiffness matrix to each element. Returns, for each matrix, the first element that uses it.
    ///
    /// Elements share a matrix if their geometry and sections are equal to the last bit, so that a matrix does not
    /// depend on other elements.
    fn share_matrices(&mut self) -> Vec<usize> {
        let mut first = Vec::new();
        let mut known = HashMap::new();
        let numbers = (0..self.elements.len()).map(|e| {
            let mut new = || {
                first.push(e);
                first.len() as u32 - 1
            };
            let Geometry { at, triangle } = self.geometry(e);
            let at = (triangle, self.materials.number(e), at.map(|point| point.map(f64::to_bits)));
            match self.sections(e) {
                Sections::Constant(_) => *known.entry((at, &[][..])).or_insert_with(new),
                Sections::Varying(h) => *known.entry((at, bytemuck::cast_slice::<f64, u64>(h))).or_insert_with(new),
                Sections::Layered(_) => new(),
            }
        });
        self.matrix = numbers.collect();
        first
    }

    pub fn node_count(&self) -> usize {
        self.points.len()
    }

    pub fn dof_count(&self) -> usize {
        3 * self.points.len()
    }

    pub fn point(&self, node: usize) -> [f64; 2] {
        self.points[node]
    }

    pub fn elements(&self) -> &[[usize; 8]] {
        &self.elements
    }

    /// Packed lower triangle of the stiffness of element e, for rotations in x and y instead of nodal frames. The
    /// matrix of a very thin element has a reduced shear stiffness, since bending would be lost in the rounding of the
    /// full one; this matrix only serves as preconditioner.
    pub fn element_stiffness(&self, e: usize) -> &[f64] {
        let matrix = self.matrix[e] as usize;
        &self.stiffness[PACKED * matrix..PACKED * (matrix + 1)]
    }

    /// Whether the forces of element e are computed from strains, because forces computed with its matrix would be lost
    /// in rounding.
    pub fn is_thin(&self, e: usize) -> bool {
        self.thin[self.matrix[e] as usize]
    }

    pub fn has_thin(&self) -> bool {
        self.thin.contains(&true)
    }

    /// Strains of the thin element e. `stripped` has its displacements without the rigid motion of its first node.
    pub fn strains(&self, e: usize, stripped: &[DoubleDouble; DOFS]) -> Strains<'_> {
        Strains::of(&self.geometry(e), self.materials.at(e), self.sections(e), self.centre(e), stripped)
    }

    /// The shear stiffness that the matrix of element e leaves out, as springs: for each, its row over the dofs of the
    /// leaders of the nodes, in nodal frames, and its compliance.
    pub fn shear_springs(&self, e: usize) -> Vec<([f64; DOFS], f64)> {
        if !self.is_thin(e) || self.is_rigid(e) {
            return Vec::new();
        }
        let thinnest = self.thickness.least_of(self.kind, e);
        let springs = thin::shear_springs(&self.geometry(e), self.materials.at(e), self.sections(e), thinnest);
        let mut springs = springs.unwrap_or_default();
        springs.iter_mut().for_each(|(row, _)| {
            self.into_frames(e, row);
            self.onto_leaders(e, row);
        });
        springs
    }

    /// Coefficients that recover the condensed centre rotations of element e.
    pub fn centre(&self, e: usize) -> &Centre {
        &self.centres[self.matrix[e] as usize]
    }

    pub fn geometry(&self, e: usize) -> Geometry {
        let nodes = &self.elements[e];
        let origin = self.points[nodes[0]];
        let at = nodes.map(|n| [self.points[n][0] - origin[0], self.points[n][1] - origin[1]]);
        Geometry { at, triangle: is_triangle(nodes) }
    }

    /// Sections of element e at its points, see [`Kind::points`].
    pub fn sections(&self, e: usize) -> Sections<'_> {
        self.thickness.of(self.kind, e)
    }

    pub fn is_triangle(&self, e: usize) -> bool {
        is_triangle(&self.elements[e])
    }

    /// Mean position of the four corners of element e.
    pub fn centroid(&self, e: usize) -> [f64; 2] {
        let corners = &self.elements[e][..if self.is_triangle(e) { 3 } else { 4 }];
        let sum = corners.iter().fold([0.0; 2], |s, &n| [s[0] + self.points[n][0], s[1] + self.points[n][1]]);
        sum.map(|s| s / corners.len() as f64)
    }

    /// Smallest thickness of the plate divided by the diagonal of its bounding box.
    pub fn slenderness(&self) -> f64 {
        self.thickness.least() / self.size()
    }

    /// Length of the diagonal of the plate's bounding box.
    fn size(&self) -> f64 {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for point in &self.points {
            for a in 0..2 {
                low[a] = low[a].min(point[a]);
                high[a] = high[a].max(point[a]);
            }
        }
        (high[0] - low[0]).hypot(high[1] - low[1])
    }

    pub fn has_frames(&self) -> bool {
        self.frames.is_some()
    }

    /// (cos, sin) of the first rotation direction of a node; `None` if this direction is x.
    pub fn frame(&self, node: usize) -> Option<[f64; 2]> {
        self.frames.as_ref().map(|f| f[node]).filter(|f| *f != [1.0, 0.0])
    }

    /// Transforms a covector over the dofs of element e (a force, a row of G) from slopes in x and y to slopes in the
    /// frames of its nodes.
    pub fn into_frames(&self, e: usize, covector: &mut [f64; DOFS]) {
        if self.frames.is_some() {
            for (i, &node) in self.elements[e].iter().enumerate() {
                if let Some([c, s]) = self.frame(node) {
                    let [x, y] = [covector[3 * i + 1], covector[3 * i + 2]];
                    covector[3 * i + 1] = c * x + s * y;
                    covector[3 * i + 2] = c * y - s * x;
                }
            }
        }
    }

    /// Sets the force and the couples at the first node of element e so that they balance the forces at the other
    /// nodes.
    ///
    /// Internal forces have no resultant. If rounding gave them one, it would load the supports and rotate a plate on
    /// soft supports. For K_e u, balancing is the transpose of removing the first node's rigid motion from u, so the
    /// operator stays symmetric.
    pub fn balance(&self, e: usize, force: &mut [f64; DOFS]) {
        let mut first = [0.0; 3];
        for (i, at) in self.geometry(e).at.iter().enumerate().skip(1) {
            let [w, x, y] = [force[3 * i], force[3 * i + 1], force[3 * i + 2]];
            first[0] -= w;
            first[1] -= x + at[0] * w;
            first[2] -= y + at[1] * w;
        }
        force[..3].copy_from_slice(&first);
    }

    /// Row over the dofs of element e, in nodal frames, that gives w, θx or θy (`field` 0, 1, 2) at (ξ, η). The row
    /// includes the centre rotations that follow from nodal displacements. The second value has the coefficients of the
    /// centre rotations that couples on them cause.
    pub fn interpolation_row(&self, e: usize, xi: f64, eta: f64, field: usize) -> ([f64; DOFS], [f64; 2]) {
        let mut row = [0.0; DOFS];
        let mut centre = [0.0; 2];
        if field == 0 {
            let value = shape::gathered(&self.elements[e], self.geometry(e).jacobian(xi, eta).shape.value);
            for i in 0..8 {
                row[3 * i] = value[i];
            }
        } else {
            let values = element::rotation_functions(self.kind, self.is_triangle(e), xi, eta);
            let values = shape::gathered(&self.elements[e], values);
            for i in 0..8 {
                row[3 * i + field] = values[i];
            }
            if values[8] != 0.0 {
                centre[field - 1] = values[8];
                for j in 0..DOFS {
                    row[j] -= values[8] * self.centre(e).coupling[field - 1][j];
                }
            }
        }
        self.into_frames(e, &mut row);
        (row, centre)
    }

    /// Nodal forces (3n,) of a stress-free curvature [κxx, κyy, κxy] of the whole plate, and its couples on the centre
    /// rotations, two for each element.
    pub fn curvature_load(&self, curvature: [f64; 3]) -> (Vec<f64>, Vec<f64>) {
        let mut load = vec![0.0; self.dof_count()];
        let mut centre = vec![0.0; 2 * self.elements.len()];
        for (e, nodes) in self.elements.iter().enumerate() {
            let (nodal, couples) = self.curvature_load_on(e, curvature);
            for (i, &node) in nodes.iter().enumerate() {
                for a in 0..3 {
                    load[3 * node + a] += nodal[3 * i + a];
                }
            }
            centre[2 * e..2 * e + 2].copy_from_slice(&couples);
        }
        (load, centre)
    }

    /// Nodal forces of a stress-free curvature of element e, over its dofs in nodal frames, and the couples on its
    /// centre rotations.
    pub fn curvature_load_on(&self, e: usize, curvature: [f64; 3]) -> ([f64; DOFS], [f64; 2]) {
        if self.is_rigid(e) {
            return ([0.0; DOFS], [0.0; 2]);
        }
        let (geometry, material) = (self.geometry(e), self.materials.at(e));
        let all = element::curvature_load(self.kind, &geometry, material, self.sections(e), curvature);
        let coupling = &self.centre(e).coupling;
        let mut nodal = std::array::from_fn(|j| all[j] - coupling[0][j] * all[DOFS] - coupling[1][j] * all[DOFS + 1]);
        self.balance(e, &mut nodal);
        self.into_frames(e, &mut nodal);
        (nodal, [all[DOFS], all[DOFS + 1]])
    }
}

fn check_thickness(thickness: &Thickness, points: usize, elements: usize) -> Result<(), PlateError> {
    check_finite("thickness", thickness.all().iter())?;
    if let Some(index) = thickness.all().iter().position(|&h| h <= 0.0) {
        return Err(PlateError::Range { what: "thickness", index });
    }
    if let Thickness::Varying { at_points, layered } = thickness {
        check_length("thickness", at_points.len(), points * elements)?;
        check_length("sections", layered.section.len(), points * layered.element.len())?;
        if let Some(index) = layered.section.iter().position(|section| !section.resists()) {
            return Err(PlateError::Range { what: "sections", index });
        }
        let ordered = |i: usize| i == 0 || layered.element[i - 1] < layered.element[i];
        let there = |i: usize| layered.element[i] < elements;
        if let Some(index) = (0..layered.element.len()).find(|&i| !(ordered(i) && there(i))) {
            return Err(PlateError::Range { what: "elements of sections", index });
        }
    }
    Ok(())
}

/// Whether the side between the third and the fourth corner is collapsed to a node, so that the element is a triangle.
fn is_triangle(nodes: &[usize; 8]) -> bool {
    nodes[2] == nodes[3] && nodes[2] == nodes[6]
}

fn check_finite<'a>(what: &'static str, values: impl Iterator<Item = &'a f64>) -> Result<(), PlateError> {
    match values.enumerate().find(|(_, v)| !v.is_finite()) {
        Some((index, _)) => Err(PlateError::NotFinite { what, index }),
        None => Ok(()),
    }
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), PlateError> {
    if found == expected { Ok(()) } else { Err(PlateError::Length { what, found, expected }) }
}
