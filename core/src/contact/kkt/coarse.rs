//! Rigid motions of plates without held dofs: projected equations for a fixed contact state, and resultants of a load.

use super::solver::Correction;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;
use crate::contact::rigid::{Matrix, eliminated};
use crate::contact::rigid_body_space::RigidBodySpace;
use crate::double_double::DoubleDouble;

/// Solver of the projected equations RᵀGᵀkGR a = RᵀF of a contact state, for the amounts a of the rigid motions R:
/// slopes k of the laws, nodal forces F.
pub(super) struct CoarseSolver<'a> {
    rigid_space: &'a RigidBodySpace,
    /// Compliance 1/k (m,) of the points whose force depends on the travel; `None` at other points and at rigid points.
    compliance: Vec<Option<f64>>,
    matrix: Matrix,
}

impl<'a> CoarseSolver<'a> {
    /// Makes the solver from the compliance (m,) of the points whose force depends on the travel. Returns `None` if
    /// every plate has a held dof, or if springs and points are as stiff as the plate.
    pub(super) fn by(problem: &'a ContactProblem, mut compliance: Vec<Option<f64>>) -> Option<Self> {
        let rigid_space = problem.rigid_space.as_ref()?;
        // Rigid points are left out, since their equations are constraints of the contact state.
        compliance.iter_mut().for_each(|own| *own = own.filter(|&c| c > 0.0));
        let matrix =
            rigid_space.projected_stiffness(|i| compliance[i].map_or(0.0, |c| 1.0 / c), &problem.springs.stiffness);
        let softest = eliminated(matrix.clone(), vec![DoubleDouble::default(); matrix.len()]).least;
        (softest < problem.scale.stiffness).then_some(Self { rigid_space, compliance, matrix })
    }

    /// The rigid motions for which the forces of springs and points balance the resultants of a residual, and the
    /// increments of reaction that these motions cause.
    pub(super) fn response(&self, right: &Residual) -> Correction {
        let Self { rigid_space, compliance, matrix } = self;
        let mut forces = rigid_space.resultants(&right.imbalance);
        for (i, c) in compliance.iter().enumerate().filter_map(|(i, c)| Some((i, (*c)?))) {
            let root = 1.0 / c.sqrt();
            for (force, arm) in forces.iter_mut().zip(rigid_space.of_point(i)) {
                force.add_product(root * arm, root * right.violation[i]);
            }
        }
        let amount = eliminated(matrix.clone(), forces).unknown;
        let along = |arm: &[f64]| arm.iter().zip(&amount).map(|(arm, amount)| arm * amount).sum::<f64>();
        let push = |(i, c): (usize, &Option<f64>)| {
            c.map_or(0.0, |c| (along(rigid_space.of_point(i)) - right.violation[i]) / c)
        };
        let reaction = compliance.iter().enumerate().map(push).collect();
        Correction { rigid: rigid_space.motion(&amount), nodal: vec![0.0; right.imbalance.len()], reaction }
    }
}

/// Resultants of a load on plates without held dofs, and the sum of the magnitudes of the terms of these resultants.
pub(in crate::contact) struct CoarseLoad<'a> {
    pub(in crate::contact) rigid_space: &'a RigidBodySpace,
    pub(in crate::contact) load: Vec<DoubleDouble>,
    pub(in crate::contact) magnitude: f64,
}

impl<'a> CoarseLoad<'a> {
    /// Computes the resultants of `load` (3n,). Returns `None` if every plate has a held dof, or if a point has a
    /// linear law.
    pub(in crate::contact) fn under(problem: &'a ContactProblem, load: &[f64]) -> Option<Self> {
        let rigid_space = problem.rigid_space.as_ref().filter(|_| !problem.points.has_straight())?;
        let terms = rigid_space.nodal.iter().flat_map(|motion| motion.iter().zip(load).map(|(u, f)| (u * f).abs()));
        Some(Self { magnitude: terms.sum(), load: rigid_space.resultants(load), rigid_space })
    }
}
