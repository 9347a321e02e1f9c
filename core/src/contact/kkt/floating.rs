//! The rigid motions of plates that only springs and contact points hold, on given pieces and under a load.

use super::solver::Correction;
use crate::contact::floating::Floating;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;
use crate::contact::rigid::{Matrix, eliminated};
use crate::double_double::DoubleDouble;

/// What holds plates afloat on some pieces.
pub(super) struct Held<'a> {
    floating: &'a Floating,
    /// Compliance of the points that hold.
    compliance: Vec<Option<f64>>,
    matrix: Matrix,
}

impl<'a> Held<'a> {
    /// Given the compliance that increments of reaction meet at points that hold; nothing where dofs of every plate are
    /// held, or springs and points hold them as firmly as they hold together.
    pub(super) fn by(problem: &'a ContactProblem, mut compliance: Vec<Option<f64>>) -> Option<Self> {
        let floating = problem.floating.as_ref()?;
        // Of rigid points there is more than these equations.
        compliance.iter_mut().for_each(|own| *own = own.filter(|&c| c > 0.0));
        let matrix = floating.holding(|i| compliance[i].map_or(0.0, |c| 1.0 / c), &problem.springs.stiffness);
        let softest = eliminated(matrix.clone(), vec![DoubleDouble::default(); matrix.len()]).least;
        (softest < problem.scale.stiffness).then_some(Self { floating, compliance, matrix })
    }

    /// The rigid motions that balance a residual's resultants by springs and points alone, and the increments of reaction
    /// that go with them.
    pub(super) fn response(&self, right: &Residual) -> Correction {
        let Self { floating, compliance, matrix } = self;
        let mut forces = floating.resultants(&right.imbalance);
        for (i, c) in compliance.iter().enumerate().filter_map(|(i, c)| Some((i, (*c)?))) {
            let root = 1.0 / c.sqrt();
            for (force, arm) in forces.iter_mut().zip(floating.of_point(i)) {
                force.add_product(root * arm, root * right.violation[i]);
            }
        }
        let amount = eliminated(matrix.clone(), forces).unknown;
        let along = |arm: &[f64]| arm.iter().zip(&amount).map(|(arm, amount)| arm * amount).sum::<f64>();
        let push =
            |(i, c): (usize, &Option<f64>)| c.map_or(0.0, |c| (along(floating.of_point(i)) - right.violation[i]) / c);
        let reaction = compliance.iter().enumerate().map(push).collect();
        Correction { rigid: floating.motion(&amount), nodal: vec![0.0; right.imbalance.len()], reaction }
    }
}

/// Plates that only springs and points hold, and the load on their rigid motions.
pub(in crate::contact) struct Afloat<'a> {
    pub(in crate::contact) floating: &'a Floating,
    pub(in crate::contact) load: Vec<DoubleDouble>,
    pub(in crate::contact) magnitude: f64,
}

impl<'a> Afloat<'a> {
    /// Nothing where dofs of every plate are held, or a point holds both ways.
    pub(in crate::contact) fn under(problem: &'a ContactProblem, load: &[f64]) -> Option<Self> {
        let floating = problem.floating.as_ref().filter(|_| !problem.points.has_straight())?;
        let terms = floating.nodal.iter().flat_map(|motion| motion.iter().zip(load).map(|(u, f)| (u * f).abs()));
        Some(Self { magnitude: terms.sum(), load: floating.resultants(load), floating })
    }
}
