//! Methods that find the contact state.

mod active_set;
mod finder;
mod lemke;

pub(super) use active_set::{ActiveSet, solve_together, solved_and_factored};
pub(super) use finder::{SetFinder, is_feasible};
pub(super) use lemke::{Lemke, ended, in_memory, pieces_of, posed_from};
