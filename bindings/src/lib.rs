//! Python bindings of the crates `signorini-core` and `signorini-mesher`. They only convert arguments and results.

#![forbid(unsafe_code)]

mod arrays;
mod combinations;
mod contact;
mod interpolation;
mod lcp;
mod mesher;
mod plate;
mod solution;
mod threads;
mod together;

use pyo3::prelude::*;

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(interpolation::serendipity, module)?)?;
    module.add_function(wrap_pyfunction!(interpolation::triangular, module)?)?;
    module.add_function(wrap_pyfunction!(interpolation::shape_values, module)?)?;
    module.add_function(wrap_pyfunction!(interpolation::map_points, module)?)?;
    module.add_function(wrap_pyfunction!(interpolation::nodal_forces, module)?)?;
    module.add_function(wrap_pyfunction!(lcp::lemke, module)?)?;
    module.add_function(wrap_pyfunction!(mesher::mesh_outline, module)?)?;
    module.add_class::<lcp::LcpSolution>()?;
    module.add_class::<plate::Plate>()?;
    module.add_function(wrap_pyfunction!(plate::section_points, module)?)?;
    module.add_class::<contact::ContactProblem>()?;
    module.add_class::<solution::ContactSolution>()?;
    module.add_class::<combinations::Response>()?;
    module.add_class::<combinations::CombinedCases>()?;
    module.add_function(wrap_pyfunction!(combinations::rest_response, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::load_responses, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::point_responses, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::combined_cases, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::combine, module)?)?;
    module.add_function(wrap_pyfunction!(together::solve_together, module)?)?;
    module.add_function(wrap_pyfunction!(together::solution_stresses, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::superpose, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::envelop, module)?)?;
    module.add_function(wrap_pyfunction!(combinations::evaluate, module)?)?;
    Ok(())
}
