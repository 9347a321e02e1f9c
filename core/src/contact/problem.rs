//! A plate on its supports, factored once.

use super::condense::{Condensed, WideSprings, picks_single_dofs, pins};
use super::points::{ActivePoints, Constraints};
use super::scale::Scale;
use crate::assembly::{Assembly, HELD, Numbering};
use crate::cholesky::{Analysis, Factor, FactorError};
use crate::contact::tolerances;
use crate::element::Kind;
use crate::plate::Plate;
use crate::rows::{Rows, Springs};
use std::sync::Arc;
use std::time::Instant;

/// Positions, in the caller's order, of the points that are condensed and of those of the active set.
#[derive(Clone, Debug, Default)]
pub struct PointOrder {
    pub condensed: Vec<usize>,
    pub active: Vec<usize>,
}

/// Seconds of each stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    pub order: f64,
    pub factor: f64,
    pub condense: f64,
}

/// K with the springs of some points on top, factored, and what it is at the condensed points.
pub struct Factored {
    pub factor: Factor,
    /// Springs over several elements, unless they are in the factor.
    wide: Option<WideSprings>,
    pub condensed: Condensed,
    /// Stiffness carried at each point of the active set.
    pub carried: Vec<f64>,
    /// Whether every dof is a little stiffer than it is, since what holds the plate is lost in rounding.
    pub firmer: bool,
}

impl Factored {
    /// Overwrites vectors in elimination order, one after the other, with what [`Factored::backward`] makes K̃⁻¹ times each.
    pub(super) fn forward(&self, vectors: &mut [f64]) -> Result<(), FactorError> {
        self.factor.forward(vectors)?;
        self.hold(vectors);
        Ok(())
    }

    pub(super) fn backward(&self, vectors: &mut [f64]) -> Result<(), FactorError> {
        self.factor.backward(vectors)
    }

    fn hold(&self, forward: &mut [f64]) {
        if let Some(springs) = &self.wide {
            forward.chunks_exact_mut(self.factor.len()).for_each(|vector| springs.hold(vector));
        }
    }

    /// Overwrites vectors in elimination order, one after the other, with K̃⁻¹ times each, with the bits that it has alone.
    pub(super) fn solve_side_by_side(&self, vectors: &mut [f64]) -> Result<(), FactorError> {
        if self.wide.is_none() {
            return self.factor.solve_side_by_side(vectors);
        }
        self.forward(vectors)?;
        self.backward(vectors)
    }

    /// Lets the points be pushed: adds forces on them to a vector after [`Factored::forward`].
    pub(super) fn push(&self, force: &[f64], forward: &mut [f64]) -> Result<(), FactorError> {
        let mut pushed = vec![0.0; forward.len()];
        self.condensed.push(force, &mut pushed)?;
        self.hold(&mut pushed);
        forward.iter_mut().zip(&pushed).for_each(|(total, value)| *total += value);
        Ok(())
    }
}

pub struct ContactProblem {
    pub plate: Arc<Plate>,
    pub springs: Springs,
    pub held: Vec<bool>,
    /// Points that are condensed: all of them, or, beside an active set, the two-sided ones.
    pub constraints: Constraints,
    /// One-sided points of the active set, and where both kinds stand in the caller's order.
    pub active: ActivePoints,
    pub order: PointOrder,
    pub numbering: Numbering,
    pub base: Factored,
    pub seconds: Seconds,
    pub(super) scale: Scale,
    /// By what what is left of a condensed point's gap is a length.
    pub(super) levers: Vec<f64>,
    analysis: Analysis,
    way: Way,
    pub(super) first_limit: f64,
}

impl ContactProblem {
    /// Orders with the condensed dofs last, factors, and condenses.
    ///
    /// With `by_active_set` the one-sided points are the active set's instead of an LCP's: the factor carries them all.
    /// A factor that takes more than `room`, in bytes, is refused before it is begun.
    pub fn new(
        plate: Arc<Plate>,
        springs: Springs,
        held: Vec<bool>,
        constraints: Constraints,
        by_active_set: bool,
        room: usize,
    ) -> Result<Self, FactorError> {
        let clock = Instant::now();
        let (constraints, active, order) = split(&plate, constraints, by_active_set);
        let rows = &constraints.rows;
        let mut trailing = vec![false; plate.dof_count()];
        for row in (0..rows.len()).filter(|row| !rows.further.contains_key(row)) {
            rows.entries(&plate, row).for_each(|(dof, _)| trailing[dof] = true);
        }
        let numbering = Numbering::new(&plate, &held, &trailing);
        let ordering = clock.elapsed().as_secs_f64();

        let first_limit = Self::first_limit(&plate, &active);
        let all_closed = active.penalized(first_limit).stiffness;
        let scale = Scale::of(&plate);
        let mut parts = Parts {
            plate: &plate,
            springs: &springs,
            constraints: &constraints,
            active: &active,
            numbering: &numbering,
            scale: &scale,
            way: Way::Apart,
            room,
            seconds: Seconds { order: ordering, ..Seconds::default() },
        };
        // Of a plate that may float, where what holds it is lost in rounding, the factor is a little firmer. Rigid motions are
        // found apart from it, exactly, and solves with care take back what it adds. Beside held dofs they would be rounded,
        // and elements with motions of their own that nothing resists are no such plate.
        let may_float = plate.kind == Kind::Mitc9 && !held.contains(&true);
        let apart = plate.kind == Kind::Mitc9 && parts.has_wide_springs();
        let mut base = Err(FactorError::NotPositiveDefinite { column: 0 });
        for (_, way) in
            [(apart, Way::Apart), (true, Way::Whole), (may_float, Way::Firmer)].into_iter().filter(|way| way.0)
        {
            parts.way = way;
            base = parts.factored(all_closed.clone(), None);
            if !matches!(base, Err(FactorError::NotPositiveDefinite { .. })) {
                break;
            }
        }
        let (base, analysis) = base?;
        let Parts { seconds, way, .. } = parts;
        let levers = (0..constraints.rows.len()).map(|row| scale.lever(&constraints.rows, row)).collect();
        Ok(Self {
            plate,
            springs,
            held,
            constraints,
            active,
            order,
            numbering,
            base,
            seconds,
            scale,
            levers,
            analysis,
            way: if way == Way::Firmer { Way::Whole } else { way },
            first_limit,
        })
    }

    /// The factor with other stiffnesses at the points of the active set; the analysis is kept.
    pub(super) fn refactored(&self, carried: Vec<f64>) -> Result<Factored, FactorError> {
        let mut parts = Parts {
            plate: &self.plate,
            springs: &self.springs,
            constraints: &self.constraints,
            active: &self.active,
            numbering: &self.numbering,
            scale: &self.scale,
            way: self.way,
            room: usize::MAX,
            seconds: Seconds::default(),
        };
        Ok(parts.factored(carried, Some(&self.analysis))?.0)
    }

    /// Every contact point, in the caller's order; the factor's part left out.
    pub fn all_constraints(&self) -> Constraints {
        let (rest, active) = (&self.constraints, &self.active);
        let (condensed, count) = (rest.rows.len(), rest.rows.len() + active.len());
        let mut rows = Rows::default();
        for at in self.in_order(&(0..count).collect::<Vec<_>>()) {
            match at.checked_sub(condensed) {
                Some(at) => active.push_row(at, &mut rows),
                None => rows.push_from(&rest.rows, at),
            }
        }
        let mut two_sided = rest.two_sided.clone();
        two_sided.resize(count, false);
        Constraints {
            rows,
            distance: self.in_order(&[&rest.distance[..], &active.distance].concat()),
            compliance: self.in_order(&[&rest.compliance[..], &active.compliance].concat()),
            two_sided: self.in_order(&two_sided),
            regularization: vec![0.0; count],
            free_motions: rest.free_motions.clone(),
        }
    }

    /// A nodal load in elimination order, without the dofs held.
    pub fn gather(&self, load: &[f64]) -> Vec<f64> {
        self.numbering.dof.iter().map(|&dof| load[dof]).collect()
    }

    /// A vector in elimination order as a nodal one; dofs held are zero.
    pub fn scatter(&self, ordered: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.plate.dof_count()];
        for (&dof, &value) in self.numbering.dof.iter().zip(ordered) {
            out[dof] = value;
        }
        out
    }

    /// K̃⁻¹ times a nodal load.
    pub fn apply_inverse(&self, load: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut ordered = self.gather(load);
        self.base.forward(&mut ordered)?;
        self.base.backward(&mut ordered)?;
        Ok(self.scatter(&ordered))
    }

    /// Takes what the condensed points' reactions do, Gᵀ·reaction, off a nodal vector.
    pub(super) fn take_off(&self, reaction: &[f64], vector: &mut [f64]) {
        for (i, &reaction) in reaction.iter().enumerate().filter(|(_, reaction)| **reaction != 0.0) {
            self.constraints.rows.scatter(&self.plate, i, -reaction, vector);
        }
    }
}

/// How a plate is factored.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Springs over several elements apart from the factor.
    Apart,
    /// All springs in it.
    Whole,
    /// All springs in it, and every dof a little stiffer than it is.
    Firmer,
}

/// What a factor is made of, and the seconds that making it takes.
struct Parts<'a> {
    plate: &'a Plate,
    springs: &'a Springs,
    constraints: &'a Constraints,
    active: &'a ActivePoints,
    numbering: &'a Numbering,
    scale: &'a Scale,
    way: Way,
    room: usize,
    seconds: Seconds,
}

impl Parts<'_> {
    /// Whether springs over several elements can, and need, be kept out of the factor. Beside points at dofs of their own, whose
    /// stiffness the factor's last block is, they cannot.
    fn has_wide_springs(&self) -> bool {
        let Constraints { rows, regularization, .. } = self.constraints;
        let carried = rows.further.keys().any(|&row| regularization[row] > 0.0);
        let any = carried || !self.springs.rows.further.is_empty() || !self.active.further.is_empty();
        any && (rows.is_empty() || !picks_single_dofs(&self.by_column(rows)))
    }

    /// Rows by columns of the factor.
    fn by_column(&self, rows: &Rows) -> Vec<Vec<(usize, f64)>> {
        let column = &self.numbering.column;
        let entries = |row| rows.entries(self.plate, row).map(|(dof, c)| (column[dof], c));
        (0..rows.len()).map(|row| entries(row).filter(|entry| entry.0 != HELD).collect()).collect()
    }

    /// The factor, with the analysis of one before it if there is one, and that.
    fn factored(&mut self, carried: Vec<f64>, known: Option<&Analysis>) -> Result<(Factored, Analysis), FactorError> {
        let &mut Self { plate, constraints, numbering, way, .. } = self;
        let clock = Instant::now();
        let bedding = self.active.stiffness_by_element(plate, &carried);
        let mut springs = with_regularization(self.springs, constraints);
        self.active.add_footprint_springs(&carried, &mut springs);
        let mut wide = Springs::default();
        if way == Way::Apart {
            (springs, wide) = springs.narrow_and_wide();
        }
        if !wide.rows.is_empty() {
            let pins = pins(plate, numbering, self.scale);
            for (pin, &stiffness) in pins.stiffness.iter().enumerate() {
                springs.push(&pins.rows, pin, stiffness, 0.0);
                wide.push(&pins.rows, pin, -stiffness, 0.0);
            }
        }
        let firmer = if way == Way::Firmer { tolerances::FIRMER } else { 0.0 };
        let matrix = Assembly::new(plate, &springs, &bedding, numbering).firmer(firmer);
        let analysis = known.cloned().map_or_else(|| Analysis::new(&matrix), Ok)?;
        analysis.require_room(self.room)?;
        let factor = analysis.factorize(&matrix)?;
        // Elements of q8r bend in some shapes without resistance, and not all supports hold them.
        if carried.contains(&0.0) || plate.kind == Kind::Q8r {
            let (column, part) = factor.weakest_pivot();
            if part < tolerances::LOOSE_PIVOT {
                return Err(FactorError::NotPositiveDefinite { column });
            }
        }
        self.seconds.factor += clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let trailing = factor.trailing_block(numbering.trailing)?;
        let wide = match wide.rows.is_empty() {
            true => None,
            false => Some(WideSprings::of(&factor, &trailing, &self.by_column(&wide.rows), &wide.stiffness)?),
        };
        let rows = &constraints.rows;
        let moves = |motion: &Vec<f64>| (0..rows.len()).map(|row| rows.dot(plate, row, motion)).collect();
        let moves: Vec<Vec<f64>> = constraints.free_motions.iter().map(moves).collect();
        let condensed = Condensed::on(&factor, trailing, constraints, &self.by_column(rows), &moves, wide.as_ref())?;
        self.seconds.condense += clock.elapsed().as_secs_f64();
        Ok((Factored { factor, wide, condensed, carried, firmer: way == Way::Firmer }, analysis))
    }
}

pub(super) fn with_regularization(springs: &Springs, constraints: &Constraints) -> Springs {
    let mut all = springs.clone();
    for (i, &delta) in constraints.regularization.iter().enumerate().filter(|(_, delta)| **delta > 0.0) {
        all.push(&constraints.rows, i, delta, 0.0);
    }
    all
}

/// Sets the one-sided points apart if the active set is to solve them.
fn split(plate: &Plate, constraints: Constraints, by_active_set: bool) -> (Constraints, ActivePoints, PointOrder) {
    let mut rest = Constraints { free_motions: constraints.free_motions, ..Constraints::default() };
    let mut active = ActivePoints::default();
    let mut order = PointOrder::default();
    for i in 0..constraints.rows.len() {
        let (distance, compliance) = (constraints.distance[i], constraints.compliance[i]);
        if by_active_set && !constraints.two_sided[i] {
            active.push(plate, &constraints.rows, i, distance, compliance);
            order.active.push(i);
        } else {
            rest.rows.push_from(&constraints.rows, i);
            rest.distance.push(distance);
            rest.compliance.push(compliance);
            rest.two_sided.push(constraints.two_sided[i]);
            rest.regularization.push(constraints.regularization[i]);
            order.condensed.push(i);
        }
    }
    (rest, active, order)
}
