//! The equations of one contact set, their solvers, and the one way in which solutions are refined.
//!
//! ```text
//! K   Gᵀ   Δu     out of balance
//! G  −C    Δλ  =  left of the gaps      rows and columns of closed points
//! ```
//!
//! A set's equations are solved with something added to the diagonal, −σ below or ρ above, which keeps them regular
//! (Friedlander & Orban 2012), and the residual in double-double takes back what that and rounding leave. The solvers
//! differ in what they eliminate: [`Interface`] condenses onto the contact points, [`Penalized`] takes the reactions of
//! many points into K, [`Uncondensed`] eliminates nothing. `refinement` is the same for all.

mod active_factor;
mod conjugate_gradients;
mod floating;
mod interface;
mod penalized;
mod refinement;
mod residual;
mod saddle;
mod set;
mod shears;
mod uncondensed;

pub(super) use active_factor::{ActiveFactor, Direction};
pub(super) use conjugate_gradients::ConjugateGradients;
pub(super) use floating::Floating;
pub(super) use interface::{Interface, Reduced};
pub(super) use refinement::Correction;
pub(super) use residual::Residual;
pub(super) use saddle::{Regularized, Saddle, TOGETHER};
pub(super) use set::OnSet;
pub(super) use uncondensed::Uncondensed;
