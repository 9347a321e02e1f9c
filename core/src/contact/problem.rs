//! The contact problem: plates on their supports, factored once for all loads.

use super::backend::{Augmentation, Backend, Method};
use super::error::{SolveError, require_length, require_values};
use super::interface::{Form, Interface, LcpTemplate};
use super::points::Points;
use super::rigid::nearest_motions;
use super::rigid_body_space::RigidBodySpace;
use super::scale::Scale;
use super::solution::ContactSolution;
use super::system::{KktPattern, System};
use super::tolerances;
use crate::cholesky::FactorError;
use crate::displacement::Displacement;
use crate::double_double::DoubleDouble;
use crate::element::{Kind, packed};
use crate::plate::Plate;
use crate::rows::Springs;
use std::sync::Arc;
use std::time::Instant;

/// Seconds that the ordering of the columns, the factorization and the condensation took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    pub order: f64,
    pub factor: f64,
    pub condense: f64,
}

/// Springs, held dofs and contact points: the input of a contact problem in addition to the plate.
pub struct Supported {
    pub springs: Springs,
    /// Whether each dof (3n,) has a prescribed value.
    pub held: Vec<bool>,
    pub points: Points,
    /// Stiffness δ (m,) that the factor includes at condensed points. For a soft elastic point δ is its whole
    /// stiffness. Other points have δ > 0 only where K alone would be singular.
    pub delta: Vec<f64>,
    /// Rigid motions, each (3n,), that springs, held dofs and two-sided points leave free.
    pub free_motions: Vec<Vec<f64>>,
}

/// Plates on their supports, factored once for all loads.
#[derive(Clone)]
pub struct ContactProblem {
    pub plate: Arc<Plate>,
    pub springs: Springs,
    pub held: Vec<bool>,
    pub points: Points,
    pub seconds: Seconds,
    pub(super) scale: Scale,
    pub(super) pattern: Arc<KktPattern>,
    pub(super) base: Arc<System>,
    pub(super) backend: Backend,
    /// Rigid motions R of the plates without held dofs; `None` if every plate has a held dof.
    pub(super) rigid_space: Option<Arc<RigidBodySpace>>,
    /// Relative increase of the diagonal of K in every factor.
    diagonal_shift: f64,
}

impl Supported {
    fn require_valid(&self, plate: &Plate) -> Result<(), SolveError> {
        let (dofs, springs) = (plate.dof_count(), self.springs.rows.len());
        require_length("held", self.held.len(), dofs)?;
        require_length("the springs' stiffness", self.springs.stiffness.len(), springs)?;
        require_length("the springs' base", self.springs.base.len(), springs)?;
        require_length("delta", self.delta.len(), self.points.len())?;
        self.free_motions.iter().try_for_each(|motion| require_length("a free motion", motion.len(), dofs))?;
        let is_size = |value: f64| value >= 0.0 && value.is_finite();
        require_values("the springs' stiffness", &self.springs.stiffness, "finite and not negative", is_size)?;
        require_values("the springs' base", &self.springs.base, "finite", f64::is_finite)?;
        require_values("delta", &self.delta, "finite and not negative", is_size)?;
        self.points.require_valid()
    }
}

impl ContactProblem {
    /// Orders and factors K, and for Lemke's algorithm condenses the plate onto its points. A factor of more than
    /// `room` bytes is refused before it is begun.
    pub fn new(plate: Arc<Plate>, on: Supported, method: Method, room: usize) -> Result<Self, SolveError> {
        Self::posed(plate, on, method, room, None)
    }

    /// A problem of the same plate and method on other supports. Ordering, factor and condensation of this problem are
    /// shared if the new problem would have the same. The solutions have the same bits as without sharing.
    pub fn on_other_supports(&self, on: Supported, room: usize) -> Result<Self, SolveError> {
        Self::posed(self.plate.clone(), on, self.method(), room, Some(self))
    }

    /// The method for which K is factored.
    pub fn method(&self) -> Method {
        match &self.backend {
            Backend::Condensed { .. } => Method::Lemke,
            Backend::Penalised(_) => Method::ActiveSet,
            Backend::SaddlePoint(_) => Method::Saddle,
        }
    }

    fn posed(
        plate: Arc<Plate>,
        on: Supported,
        method: Method,
        room: usize,
        like: Option<&Self>,
    ) -> Result<Self, SolveError> {
        on.require_valid(&plate)?;
        let Supported { springs, held, mut points, delta, free_motions } = on;
        let clock = Instant::now();
        let scale = Scale::of(&plate);
        points.set_arm(scale.size);
        let is_multiplier_row = |i: usize| match method {
            Method::Lemke => delta[i] > 0.0 && !points.is_bedding(i),
            Method::ActiveSet => !points.is_bedding(i),
            Method::Saddle => true,
        };
        let is_like = |like: &&Self| {
            like.held == held
                && like.springs.stiffness == springs.stiffness
                && like.springs.rows == springs.rows
                && like.points.has_rows_of(&points)
                && like.pattern.has_multiplier_rows(is_multiplier_row)
        };
        let like = like.filter(is_like);
        let pattern = like.map(|like| like.pattern.clone()).unwrap_or_else(|| {
            let mut trailing = vec![false; plate.dof_count()];
            let last = (0..points.len()).filter(|&i| method == Method::Lemke && points.is_narrow(i));
            last.flat_map(|i| points.row(i)).for_each(|(dof, _)| trailing[dof] = true);
            Arc::new(KktPattern::new(&plate, &held, &springs, &points, &trailing, is_multiplier_row))
        });
        let order = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let augmentation = match method {
            Method::Lemke => None,
            Method::ActiveSet => Some(Augmentation::of_penalties(&plate, &points)),
            Method::Saddle => Some(Augmentation::of_saddle_point(&points, &scale)),
        };
        let carried = match &augmentation {
            None => delta.clone(),
            Some(new) => new.slopes(&points, |i| points.steepest(i), new.first_penalty),
        };
        let rigid_space = RigidBodySpace::on(&plate, &held, &scale, &points, &springs).map(Arc::new);
        let softest = rigid_space.as_ref().map(|rigid_space| rigid_space.softest(|i| carried[i], &springs.stiffness));
        // If the softest spring is as stiff as the plate, no diagonal shift is needed.
        let diagonal_shift =
            softest.filter(|&softest| softest < scale.stiffness).map_or(0.0, |softest| needed_shift(&plate, softest));
        let like = like.filter(|like| like.base.carried == carried && like.diagonal_shift == diagonal_shift);
        let base = match like {
            Some(like) => like.base.clone(),
            None => Arc::new(pattern.factored(&plate, &springs, &points, carried, diagonal_shift, room)?),
        };
        let factor = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let backend = match (augmentation.map(Arc::new), like.map(|like| &like.backend)) {
            (Some(augmentation), _) if method == Method::Saddle => Backend::SaddlePoint(augmentation),
            (Some(augmentation), _) => Backend::Penalised(augmentation),
            (None, Some(Backend::Condensed { interface, .. })) if interface.free_motions == free_motions => {
                Backend::Condensed { interface: interface.clone(), templates: Arc::default() }
            }
            (None, _) => {
                let multiplier_rows = pattern.multiplier_rows(plate.dof_count());
                let trailing = pattern.numbering.trailing;
                let rows = pattern.rows(&points);
                let interface =
                    Interface::on(&base.factor, trailing, &points, &rows, &multiplier_rows, delta, free_motions)?;
                Backend::Condensed { interface: Arc::new(interface), templates: Arc::default() }
            }
        };
        let seconds = Seconds { order, factor, condense: clock.elapsed().as_secs_f64() };
        Ok(Self { plate, springs, held, points, seconds, scale, pattern, base, backend, rigid_space, diagonal_shift })
    }

    /// The same problem with other gaps `shift` (m,) of its points. Both problems share the factor.
    pub fn with_shift(&self, shift: Vec<f64>) -> Result<Self, SolveError> {
        let mut moved = self.clone();
        moved.points.shift = shift;
        moved.points.require_valid()?;
        Ok(moved)
    }

    /// Displacements K̃⁻¹ f (3n,) under a nodal load f; K̃ is the factored matrix.
    pub fn apply_inverse(&self, load: &[f64]) -> Result<Vec<f64>, SolveError> {
        require_length("the load", load.len(), self.plate.dof_count())?;
        Ok(self.base.solve(load)?)
    }

    /// Number of stored entries of the factor, and number of multiplications and additions of its factorization.
    pub fn factor_size(&self) -> (usize, f64) {
        (self.base.factor.entries(), self.base.factor.flops())
    }

    /// The plate condensed onto its contact points; an error if the stiffness matrix is factored for another method
    /// than Lemke's.
    pub(super) fn condensed(&self) -> Result<&Interface, SolveError> {
        match &self.backend {
            Backend::Condensed { interface, .. } => Ok(interface),
            Backend::Penalised(_) | Backend::SaddlePoint(_) => Err(SolveError::NotCondensed),
        }
    }

    /// The LCP of the condensed points in the given form. It is made once for all loads and gaps.
    pub(super) fn lcp_template(&self, form: Form) -> Result<&LcpTemplate, SolveError> {
        let Backend::Condensed { interface, templates } = &self.backend else { return Err(SolveError::NotCondensed) };
        let place = &templates[form as usize];
        if place.get().is_none() {
            let template = LcpTemplate::of(interface, &self.points, form)?;
            place.get_or_init(|| template);
        }
        Ok(place.get().expect("made here or before"))
    }

    /// The plate without load and reactions. Held dofs have their prescribed values. All other dofs have the rigid
    /// motion of their plate that is nearest to these values, so that the plate is strained least.
    pub(super) fn at_rest(&self, held_value: &[f64]) -> ContactSolution {
        let mut displacement = self.carried_along(held_value);
        for dof in (0..self.held.len()).filter(|&dof| self.held[dof]) {
            (displacement.hi[dof], displacement.lo[dof]) = (held_value[dof], 0.0);
        }
        displacement.follow(self.plate.bodies());
        let none = vec![0.0; self.points.len()];
        let piece = self.points.first_pieces();
        ContactSolution { displacement, reaction: none.clone(), gap: none, piece, ..ContactSolution::default() }
    }

    /// The rigid motions of the plates that are nearest to the prescribed values. The second pass removes the rounding
    /// of the first pass; prescribed values minus rigid motions are then strain only.
    fn carried_along(&self, held_value: &[f64]) -> Displacement {
        let mut displacement = Displacement::zeros(self.plate.dof_count());
        for _ in 0..2 {
            let missed = self.missed(held_value, &displacement);
            let Some(motions) = nearest_motions(&self.plate, &self.scale, &self.held, &missed) else { break };
            displacement.add_rigid(&self.plate, self.scale.centre, &motions);
        }
        displacement
    }

    /// Prescribed values of held dofs minus the rigid motions nearest to these values (3n,); zero at free dofs.
    pub(super) fn strained(&self, held_value: &[f64]) -> Vec<f64> {
        self.missed(held_value, &self.carried_along(held_value))
    }

    fn missed(&self, held_value: &[f64], displacement: &Displacement) -> Vec<f64> {
        let of = |dof: usize| (DoubleDouble::from(held_value[dof]) - displacement.at(dof)).value();
        (0..self.held.len()).map(|dof| if self.held[dof] { of(dof) } else { 0.0 }).collect()
    }

    /// Factors K with springs of stiffness `carried` (m,) at the points.
    pub(super) fn factored(&self, carried: Vec<f64>) -> Result<System, FactorError> {
        let Self { plate, springs, points, .. } = self;
        self.pattern.factored(plate, springs, points, carried, self.diagonal_shift, usize::MAX)
    }

    pub(super) fn steepest_pieces(&self) -> Vec<u8> {
        (0..self.points.len()).map(|i| self.points.graph(i).steepest()).collect()
    }

    /// Sets the entries of a nodal vector at held dofs to zero.
    pub(super) fn release_held(&self, vector: &mut [f64]) {
        for (value, _) in vector.iter_mut().zip(&self.held).filter(|(_, held)| **held) {
            *value = 0.0;
        }
    }
}

/// Relative increase of the diagonal of K for a plate that only springs hold; `softest` is the softest projected
/// stiffness. It is 0 if `softest` is well above the rounding of the factor. Iterative refinement removes its effect.
fn needed_shift(plate: &Plate, softest: f64) -> f64 {
    let diagonal = |e: usize| (0..8).map(|node| plate.element_stiffness(e)[packed(3 * node, 3 * node)]).sum::<f64>();
    let all: f64 = (0..plate.elements().len()).map(diagonal).sum();
    let added = tolerances::DIAGONAL_SHIFT * all;
    if plate.kind == Kind::Mitc9 && softest < tolerances::SHIFT_BELOW * added {
        tolerances::DIAGONAL_SHIFT
    } else {
        0.0
    }
}
