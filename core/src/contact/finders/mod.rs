//! Methods that find the contact state under a load: Lemke's algorithm and the active set.

mod active_set;
mod feasibility;
mod lemke;

pub(super) use active_set::{by_active_set, solve_together, solved_and_factored};
pub(super) use feasibility::beyond;
pub(super) use lemke::{by_lemke, pieces_of, posed_from};
