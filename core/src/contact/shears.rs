//! Shear forces of elements so thin that the factor has their shear softer: unknowns of their own while a solution is refined.
//!
//! Displacements alone would have to tell shears that are far below the rounding of a correction. With the forces beside
//! them every correction leaves that part of the shears' error by which bending is softer than the softened shear (the method
//! of multipliers, as for rigid points).

use crate::displacement::Displacement;
use crate::element::DOFS;
use crate::element::thin::{SHEARS, ShearForces};
use crate::plate::Plate;
use crate::residual::nodal_force;
use std::collections::BTreeMap;

/// Of every element whose shear is softer in the factor, in their order.
pub(super) type OfShears = Vec<[f64; SHEARS]>;

/// The elements whose shear is softer in the factor, and which of them they are.
pub(super) struct Shears(BTreeMap<usize, (usize, ShearForces)>);

impl Shears {
    pub(super) fn of(plate: &Plate) -> Self {
        let softer = (0..plate.elements().len()).filter_map(|e| Some((e, plate.shear_forces(e)?)));
        Self(softer.enumerate().map(|(at, (e, shear))| (e, (at, shear))).collect())
    }

    /// The forces that the elements' strains take.
    pub(super) fn forces(&self, plate: &Plate, displacement: &Displacement) -> OfShears {
        self.0.keys().map(|&e| plate.strains(e, &displacement.stripped(plate, e)).shear_forces()).collect()
    }

    fn balance(&self, plate: &Plate, e: usize, u: &Displacement, forces: &OfShears) -> ([f64; DOFS], [f64; SHEARS]) {
        let (at, shear) = &self.0[&e];
        let stripped = u.stripped(plate, e);
        shear.balance(&plate.geometry(e), plate.materials.at(e), plate.sections(e), &stripped, &forces[*at])
    }

    /// What an element's nodes do to it, in their frames, if its shear has a force of its own.
    pub(super) fn nodal_force(&self, plate: &Plate, e: usize, u: &Displacement, forces: &OfShears) -> [f64; DOFS] {
        if !self.0.contains_key(&e) {
            return nodal_force(plate, e, u);
        }
        let (mut force, _) = self.balance(plate, e, u, forces);
        plate.balance(e, &mut force);
        plate.into_frames(e, &mut force);
        force
    }

    /// By how much shears are more than their forces make them.
    pub(super) fn violation(&self, plate: &Plate, u: &Displacement, forces: &OfShears) -> OfShears {
        self.0.keys().map(|&e| self.balance(plate, e, u, forces).1).collect()
    }

    /// Violations as shares of what bending to them would take, over a force.
    pub(super) fn scaled<'a>(&'a self, violation: &'a OfShears, force: f64) -> impl Iterator<Item = f64> + 'a {
        let of = move |(at, shear): &'a (usize, ShearForces)| {
            violation[*at].iter().zip(shear.bending).map(move |(v, k)| k * v / force)
        };
        self.0.values().take(violation.len()).flat_map(of)
    }

    /// The largest force by which shears miss their own.
    pub(super) fn missed(&self, violation: &OfShears) -> f64 {
        self.0.values().fold(0.0, |most, (at, shear)| most.max(shear.largest_force(&violation[*at])))
    }

    /// Takes off an imbalance what the factor's shears push for their violation.
    pub(super) fn reduce(&self, plate: &Plate, violation: &OfShears, imbalance: &mut [f64]) {
        for ((&e, (_, shear)), violation) in self.0.iter().zip(violation) {
            let mut force = shear.nodal(&shear.increments(violation));
            plate.into_frames(e, &mut force);
            for (i, &node) in plate.elements()[e].iter().enumerate() {
                (0..3).for_each(|a| imbalance[3 * node + a] -= force[3 * i + a]);
            }
        }
    }

    /// Increments of the forces with a motion of the nodes.
    pub(super) fn increments(&self, plate: &Plate, motion: Vec<f64>, violation: &OfShears) -> OfShears {
        let motion = Displacement { lo: vec![0.0; motion.len()], hi: motion };
        let of = |((&e, (_, shear)), violation): ((&usize, &(usize, ShearForces)), &[f64; SHEARS])| {
            let moved = shear.shears(&motion.strained(plate, e));
            shear.increments(&std::array::from_fn(|t| moved[t] + violation[t]))
        };
        self.0.iter().zip(violation).map(of).collect()
    }
}
