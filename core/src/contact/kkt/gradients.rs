//! Preconditioned conjugate gradients for the equations of a contact state. The preconditioner is a factor with the
//! springs of another contact state.
//!
//! Few points change their piece of the law from one Newton step to the next. Therefore the last direction is deflated
//! (Saad, Yeung, Erhel & Guyomarc'h 2000), and the iteration continues from state to state.

use super::factored::{Direction, Factored};
use crate::cholesky::FactorError;
use crate::contact::backend::Backend;
use crate::contact::scale::dot;
use crate::contact::tolerances;

/// Number of conjugate gradient steps before a new factorization, which costs about as much. With a shared factor a
/// step is cheaper, and the number is `SHARED` times as large. The saddle-point method factors at once, since the
/// springs of two contact states differ too much.
pub(in crate::contact) const BEFORE_A_FACTOR: usize = 10;
const SHARED: usize = 3;
/// Largest number of conjugate gradient steps if K with the springs of the contact state cannot be factored.
const MOST: usize = 500;

/// The linear equations of one contact state, and the accuracy of their solution.
pub(in crate::contact) struct Equations<'e> {
    pub(in crate::contact) pieces: &'e [u8],
    /// Right-hand side (3n,): residual nodal forces.
    pub(in crate::contact) imbalance: &'e [f64],
    /// Norm of the residual at which the iteration ends.
    pub(in crate::contact) enough: f64,
    /// Whether the last direction with the same factor is deflated.
    pub(in crate::contact) deflates: bool,
}

/// A deflated direction v, the product `force` = Av with the matrix A of the contact state, and vᵀAv.
struct Deflated {
    direction: Direction,
    force: Vec<f64>,
    curvature: f64,
}

impl Deflated {
    /// The last direction of `kkt`, for deflation. `None` if the energy has little curvature along it on this contact
    /// state.
    fn last(kkt: &mut Factored<'_>, differing: &[(usize, f64)]) -> Option<Self> {
        let direction = kkt.last.take().filter(|_| !differing.is_empty())?;
        let mut force = kkt.difference(differing, &direction.nodal);
        force.iter_mut().zip(&direction.force).for_each(|(total, force)| *total += force);
        let curvature = dot(&direction.nodal, &force);
        let is_stiff = curvature > tolerances::newton::PLAIN * dot(&direction.nodal, &direction.force);
        is_stiff.then_some(Self { direction, force, curvature })
    }
}

/// Solves the equations of a contact state by conjugate gradients. The matrix is factored anew if the springs of many
/// stiff points differ from the factor, or if the iteration is slow.
pub(in crate::contact) async fn direction(
    kkt: &mut Factored<'_>,
    equations: &Equations<'_>,
) -> Result<Direction, FactorError> {
    let most = match kkt.problem.backend {
        Backend::SaddlePoint(_) => 0,
        _ if kkt.shares() => SHARED * BEFORE_A_FACTOR,
        _ => BEFORE_A_FACTOR,
    };
    let differing = kkt.differing(equations.pieces);
    let deflated = if equations.deflates { Deflated::last(kkt, &differing) } else { None };
    // Each stiff point whose spring differs from the factored one takes about one conjugate gradient step. With the
    // first penalty the springs of these points are soft relative to the plate and take fewer.
    let stiff = differing.iter().filter(|(i, _)| kkt.series[*i] > 0.0).count();
    if stiff <= most || kkt.limit <= kkt.augmentation.first_penalty {
        if let (direction, true) = iterate(kkt, equations, &differing, deflated, most).await? {
            return Ok(direction);
        }
    }
    kkt.refactor(equations.pieces)?;
    let differing = kkt.differing(equations.pieces);
    Ok(iterate(kkt, equations, &differing, None, MOST).await?.0)
}

/// Iterates conjugate gradients from zero. Returns the direction, and false if it has not converged after `most` steps.
/// `differing` are the points whose springs differ from the factored springs, with the differences.
async fn iterate(
    kkt: &mut Factored<'_>,
    equations: &Equations<'_>,
    differing: &[(usize, f64)],
    deflated: Option<Deflated>,
    most: usize,
) -> Result<(Direction, bool), FactorError> {
    let mut residual = equations.imbalance.to_vec();
    if differing.is_empty() {
        let direction = kkt.response(&residual).await?;
        kkt.gradients += 1;
        kkt.last = (!kkt.shares()).then(|| direction.clone());
        return Ok((direction, true));
    }
    let mut total = Direction::zeros(residual.len());
    if let Some(Deflated { direction, force, curvature }) = &deflated {
        // Minimise along the deflated direction; all later directions are conjugate to it.
        let alpha = dot(&residual, &direction.nodal) / curvature;
        total.combine(1.0, alpha, direction);
        residual.iter_mut().zip(force).for_each(|(residual, force)| *residual -= alpha * force);
    }
    let mut ahead = Direction::zeros(residual.len());
    let mut product = f64::INFINITY;
    for _ in 0..most {
        let mut along = kkt.response(&residual).await?;
        kkt.gradients += 1;
        let next = dot(&residual, &along.nodal);
        if !(next > 0.0) {
            return Ok((total, true));
        }
        if let Some(Deflated { direction, force, curvature }) = &deflated {
            along.combine(1.0, -dot(&along.nodal, force) / curvature, direction);
        }
        ahead.combine(next / product, 1.0, &along);
        product = next;
        let difference = kkt.difference(differing, &ahead.nodal);
        let stiff = dot(&ahead.nodal, &ahead.force);
        let mut curvature = stiff + dot(&ahead.nodal, &difference);
        if !(curvature > tolerances::newton::PLAIN * stiff) {
            curvature = kkt.curvature(equations.pieces, &ahead.nodal);
        }
        if !(curvature > tolerances::newton::FREE * stiff) {
            // No support resists this direction until the next points come into contact, where the line search ends.
            return Ok((Direction { is_free: true, ..ahead }, true));
        }
        let alpha = next / curvature;
        total.combine(1.0, alpha, &ahead);
        for (residual, (force, difference)) in residual.iter_mut().zip(ahead.force.iter().zip(&difference)) {
            *residual -= alpha * (force + difference);
        }
        if kkt.problem.scale.length(&residual) <= equations.enough {
            kkt.last = (!kkt.shares()).then_some(ahead);
            return Ok((total, true));
        }
    }
    Ok((total, false))
}
