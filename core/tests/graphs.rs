//! Points with monotone graphs of two to five pieces as laws, on a square plate. Every method is compared with an
//! enumeration of all pieces and with a convex quadratic program; the contact conditions are checked.
mod common;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use common::{SIZE, largest, plate_in};
use faer::Mat;
use faer::linalg::solvers::Solve;
use proptest::prelude::*;
use signorini_core::assembly::{Assembly, Bedding, Numbering};
use signorini_core::contact::{
    ContactProblem, ContactSolution, Form, Graph, Load, Method, Points, Settings, SolveError, Supported,
};
use signorini_core::plate::Plate;
use signorini_core::rows::Springs;
use std::sync::Arc;

/// A point at (ξ, η) of an element, and its law.
#[derive(Clone, Debug)]
struct Point {
    element: usize,
    at: (f64, f64),
    graph: Graph,
    shift: f64,
    weight: f64,
}

fn row(plate: &Plate, point: &Point) -> Vec<(usize, f64)> {
    let row = plate.interpolation_row(point.element, point.at.0, point.at.1, 0).0;
    let nodes = &plate.elements()[point.element];
    let mut entries: Vec<(usize, f64)> = Vec::new();
    for (j, &c) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        entries.push((3 * nodes[j / 3] + j % 3, c));
    }
    entries
}

fn problem(plate: &Arc<Plate>, points: &[Point], held: &[bool], method: Method, delta: f64) -> ContactProblem {
    let mut table = Points::default();
    let mut rows = signorini_core::rows::Rows::default();
    for (i, point) in points.iter().enumerate() {
        let graph = table.add_graph(point.graph.clone());
        rows.element.push(point.element);
        rows.coefficient.push(plate.interpolation_row(point.element, point.at.0, point.at.1, 0).0);
        table.push_row(plate, &rows, i, graph, point.shift, point.weight);
    }
    let on = Supported {
        springs: Springs::default(),
        held: held.to_vec(),
        delta: vec![delta; points.len()],
        points: table,
        free_motions: Vec::new(),
    };
    ContactProblem::new(plate.clone(), on, method, usize::MAX).unwrap_or_else(|error| panic!("{method:?}: {error}"))
}

/// Fixes the deflections of three corners.
fn held(plate: &Plate) -> Vec<bool> {
    let corners = [0, 2 * SIZE, plate.node_count() - 1];
    (0..plate.dof_count()).map(|dof| dof % 3 == 0 && corners.contains(&(dof / 3))).collect()
}

fn load(plate: &Plate, force: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; plate.dof_count()];
    for (e, force) in force.iter().enumerate() {
        let centre = Point { element: e, at: (0.0, 0.0), graph: Graph::one_sided(1.0), shift: 0.0, weight: 1.0 };
        row(plate, &centre).into_iter().for_each(|(dof, c)| out[dof] += force * c);
    }
    out
}

fn stiffness(plate: &Plate) -> Mat<f64> {
    let numbering = Numbering::natural(plate);
    let springs = Springs::default();
    let lower = Assembly::new(plate, &springs, &Bedding::default(), &numbering).lower_triangle();
    let mut k = Mat::zeros(numbering.len(), numbering.len());
    for column in 0..numbering.len() {
        for at in lower.column_start[column]..lower.column_start[column + 1] {
            k[(lower.row[at], column)] = lower.value[at];
            k[(column, lower.row[at])] = lower.value[at];
        }
    }
    k
}

/// Travels d without reactions, minus the shifts, and P = GK⁻¹Gᵀ, by dense elimination.
fn condensed(plate: &Plate, held: &[bool], points: &[Point], load: &[f64]) -> (Vec<f64>, Mat<f64>) {
    let mut k = stiffness(plate);
    for dof in (0..held.len()).filter(|&dof| held[dof]) {
        (0..held.len()).for_each(|other| (k[(dof, other)], k[(other, dof)]) = (0.0, 0.0));
        k[(dof, dof)] = 1.0;
    }
    let rows: Vec<_> = points.iter().map(|point| row(plate, point)).collect();
    let mut right = Mat::zeros(held.len(), points.len() + 1);
    for (i, row) in rows.iter().enumerate() {
        row.iter().filter(|(dof, _)| !held[*dof]).for_each(|&(dof, c)| right[(dof, i)] += c);
    }
    (0..held.len()).filter(|&dof| !held[dof]).for_each(|dof| right[(dof, points.len())] = load[dof]);
    let moved = k.partial_piv_lu().solve(&right);
    let dot = |i: usize, c: usize| rows[i].iter().map(|&(dof, value)| value * moved[(dof, c)]).sum::<f64>();
    let d = (0..points.len()).map(|i| dot(i, points.len()) - points[i].shift).collect();
    (d, Mat::from_fn(points.len(), points.len(), dot))
}

/// Reactions found by trying all combinations of pieces: travel = d − P r, with each point on its piece.
fn by_enumeration(points: &[Point], d: &[f64], p: &Mat<f64>) -> Vec<f64> {
    let m = points.len();
    let count: usize = points.iter().map(|point| point.graph.pieces()).product();
    let mut best = (f64::INFINITY, Vec::new());
    for number in 0..count {
        let mut rest = number;
        let pieces: Vec<u8> = points
            .iter()
            .map(|point| {
                let piece = rest % point.graph.pieces();
                rest /= point.graph.pieces();
                piece as u8
            })
            .collect();
        // On a piece, travel = s + a x and reaction = r + b x. So (a + P b) x = d − s − P r.
        let line = |i: usize| {
            let piece = points[i].graph.piece(pieces[i]);
            let w = points[i].weight;
            if piece.holds() {
                (piece.travel, w * piece.force, piece.compliance() / w, 1.0)
            } else {
                (piece.travel, w * piece.force, 1.0, 0.0)
            }
        };
        let lines: Vec<_> = (0..m).map(line).collect();
        let matrix = Mat::from_fn(m, m, |i, j| p[(i, j)] * lines[j].3 + if i == j { lines[j].2 } else { 0.0 });
        let right = Mat::from_fn(m, 1, |i, _| d[i] - lines[i].0 - (0..m).map(|j| p[(i, j)] * lines[j].1).sum::<f64>());
        let x = matrix.partial_piv_lu().solve(&right);
        let mut worst: f64 = 0.0;
        for i in 0..m {
            let [low, high] = points[i].graph.ends(pieces[i]);
            let holds = points[i].graph.piece(pieces[i]).holds();
            let (value, axis) =
                if holds { ((lines[i].1 + x[(i, 0)]) / points[i].weight, 1) } else { (lines[i].0 + x[(i, 0)], 0) };
            worst = worst.max(low.map_or(0.0, |end| end[axis] - value)).max(high.map_or(0.0, |end| value - end[axis]));
        }
        if worst < best.0 {
            best = (worst, (0..m).map(|i| lines[i].1 + lines[i].3 * x[(i, 0)]).collect());
        }
    }
    assert!(best.0 < 1e-9, "no pieces are right: {}", best.0);
    best.1
}

/// (column, coefficient) pairs of a row, and its right-hand side.
type Row = (Vec<(usize, f64)>, f64);

/// Travel and force at which the energy of a law is zero: the end of its first piece.
fn begin(graph: &Graph) -> [f64; 2] {
    let first = graph.piece(0);
    graph.ends(0)[1].unwrap_or([first.travel, first.force])
}

/// Smallest energy, by a convex quadratic program over all dofs and the travels along pieces; `None` if there is no
/// minimum.
fn by_program(plate: &Plate, held: &[bool], points: &[Point], load: &[f64]) -> Option<f64> {
    let k = stiffness(plate);
    let n = held.len();
    let (mut p, mut q): (Vec<(usize, usize, f64)>, Vec<f64>) = (Vec::new(), load.iter().map(|f| -f).collect());
    for j in 0..n {
        (0..=j).filter(|&i| k[(i, j)] != 0.0).for_each(|i| p.push((i, j, k[(i, j)])));
    }
    let (mut equations, mut bounds): (Vec<Row>, Vec<Row>) = (Vec::new(), Vec::new());
    for point in points {
        let mut entries = row(plate, point);
        let graph = &point.graph;
        let w = point.weight;
        let mut along = |slope: f64, force: f64, sign: f64, length: Option<f64>, bounded: bool| {
            let column = q.len();
            q.push(sign * w * force);
            if slope > 0.0 {
                p.push((column, column, w * slope));
            }
            entries.push((column, -sign));
            if bounded {
                bounds.push((vec![(column, -1.0)], 0.0));
            }
            length.into_iter().for_each(|length| bounds.push((vec![(column, 1.0)], length)));
        };
        let (first, begin) = (graph.piece(0), begin(graph));
        if graph.is_straight() {
            if first.slope.is_finite() {
                along(first.slope, begin[1], 1.0, None, false);
            }
        } else {
            if first.slope.is_finite() {
                along(first.slope, begin[1], -1.0, None, true);
            }
            for number in 1..graph.pieces() as u8 {
                let (piece, [low, high]) = (graph.piece(number), graph.ends(number));
                if piece.slope.is_finite() {
                    let force = low.map_or(piece.force, |low| low[1]);
                    along(piece.slope, force, 1.0, high.zip(low).map(|(h, l)| h[0] - l[0]), true);
                }
            }
        }
        equations.push((entries, point.shift + begin[0]));
    }
    for dof in (0..n).filter(|&dof| held[dof]) {
        equations.push((vec![(dof, 1.0)], 0.0));
    }
    // Variables are scaled so that all diagonal entries of the quadratic term are 1.
    let mut unit = vec![0.1; q.len()];
    p.iter().filter(|(i, j, _)| i == j).for_each(|&(i, _, value)| unit[i] = 1.0 / value.sqrt());
    p.iter_mut().for_each(|(i, j, value)| *value *= unit[*i] * unit[*j]);
    q.iter_mut().zip(&unit).for_each(|(value, unit)| *value *= unit);
    let scaled = equations.iter_mut().chain(&mut bounds).flat_map(|(row, _)| row.iter_mut());
    scaled.for_each(|(column, value)| *value *= unit[*column]);
    let of = |entries: &[(usize, usize, f64)], rows, columns| {
        let (row, column) = entries.iter().map(|entry| (entry.0, entry.1)).unzip();
        CscMatrix::new_from_triplets(rows, columns, row, column, entries.iter().map(|entry| entry.2).collect())
    };
    let rows: Vec<_> = equations.iter().chain(&bounds).collect();
    let entries: Vec<_> =
        rows.iter().enumerate().flat_map(|(r, row)| row.0.iter().map(move |&(c, value)| (r, c, value))).collect();
    let right: Vec<f64> = rows.iter().map(|row| row.1).collect();
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-13,
        tol_gap_rel: 1e-13,
        tol_feas: 1e-13,
        ..DefaultSettings::default()
    };
    let cones = [ZeroConeT(equations.len()), NonnegativeConeT(bounds.len())];
    let columns = q.len();
    let mut solver =
        DefaultSolver::new(&of(&p, columns, columns), &q, &of(&entries, rows.len(), columns), &right, &cones, settings)
            .unwrap();
    solver.solve();
    match solver.solution.status {
        SolverStatus::PrimalInfeasible | SolverStatus::DualInfeasible => None,
        SolverStatus::AlmostPrimalInfeasible | SolverStatus::AlmostDualInfeasible => None,
        // Loads are about 1: a huge energy means that the solver follows a ray along which the energy decreases without
        // limit.
        _ => Some(solver.solution.obj_val).filter(|energy| energy.abs() < 1e6),
    }
}

/// Energy ½uᵀKu − fᵀu plus the energies of the points' laws, and the magnitude of its largest term.
fn energy(plate: &Plate, points: &[Point], load: &[f64], found: &ContactSolution) -> (f64, f64) {
    let k = stiffness(plate);
    let u = &found.displacement.hi;
    let product = |i: usize| (0..u.len()).map(|j| k[(i, j)] * u[j]).sum::<f64>();
    let mut terms: Vec<f64> = (0..u.len()).flat_map(|i| [0.5 * u[i] * product(i), -load[i] * u[i]]).collect();
    for (point, &force) in points.iter().zip(&found.reaction) {
        let travel = row(plate, point).iter().map(|&(dof, c)| c * u[dof]).sum::<f64>() - point.shift;
        let (graph, force) = (&point.graph, force / point.weight);
        // Integrates force over travel by trapezoids between the vertices, up to the point's travel.
        let mut at = begin(graph);
        let passed = (1..graph.pieces() as u8).filter_map(|number| graph.ends(number)[1]);
        for to in passed.filter(|to| to[0] + to[1] < travel + force).chain([[travel, force]]) {
            terms.push(point.weight * 0.5 * (at[1] + to[1]) * (to[0] - at[0]));
            at = to;
        }
    }
    (terms.iter().sum(), largest(&terms))
}

/// Solutions by every method, each with its name.
fn by_all(
    plate: &Arc<Plate>,
    points: &[Point],
    held: &[bool],
    load: &[f64],
    delta: f64,
) -> Vec<(&'static str, Result<ContactSolution, SolveError>)> {
    let load = Load { nodal: load, held_value: &vec![0.0; load.len()] };
    let solved = |method: Method, form: Option<Form>| {
        let delta = if method == Method::Lemke { delta } else { 0.0 };
        problem(plate, points, held, method, delta).solve(&load, &Settings { form }, None, &mut |_| true)
    };
    vec![
        ("lemke, dual", solved(Method::Lemke, Some(Form::Dual))),
        ("lemke, stiffness", solved(Method::Lemke, Some(Form::Stiffness))),
        ("active set", solved(Method::ActiveSet, None)),
        ("saddle", solved(Method::Saddle, None)),
    ]
}

/// Random nondecreasing polylines. Steps of travel and force may be zero; the end slopes are zero, finite or infinite.
fn graphs(most: usize) -> impl Strategy<Value = Graph> {
    let step = prop_oneof![3 => 0.002f64..0.02, 1 => Just(0.0)];
    let rise = prop_oneof![3 => 0.02f64..0.5, 1 => Just(0.0)];
    let end = || prop_oneof![2 => Just(0.0), 2 => 5.0f64..100.0, 1 => Just(f64::INFINITY)];
    (prop::collection::vec((step, rise), 0..most - 1), end(), end(), -0.01f64..0.01, -0.2f64..0.2).prop_filter_map(
        "not a graph",
        |(steps, first, last, travel, force)| {
            // A one-sided support begins with zero force.
            let mut at = if first == 0.0 { [travel, 0.0] } else { [travel, force] };
            let mut vertices = vec![at];
            for (step, rise) in steps {
                at = [at[0] + step, at[1] + rise];
                vertices.push(at);
            }
            Graph::new(vertices, [first, last]).ok().filter(|graph| graph.piece(graph.steepest()).holds())
        },
    )
}

fn points(count: std::ops::RangeInclusive<usize>, most: usize) -> impl Strategy<Value = Vec<Point>> {
    let point = (0usize..9, -0.9f64..0.9, -0.9f64..0.9, graphs(most), -0.005f64..0.005, 0.5f64..2.0);
    let point = point.prop_map(|(element, xi, eta, graph, shift, weight)| Point {
        element,
        at: (xi, eta),
        graph,
        shift,
        weight,
    });
    prop::collection::vec(point, count)
}

fn agree(
    name: &str,
    found: Result<ContactSolution, SolveError>,
    expected: &[f64],
    tolerance: f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(found.as_ref().err(), None, "{}", name);
    let found = found.unwrap();
    let size = largest(expected).max(0.01);
    for (i, (r, e)) in found.reaction.iter().zip(expected).enumerate() {
        prop_assert!((r - e).abs() <= tolerance * size, "{}: point {}: {} for {} of {}", name, i, r, e, size);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn every_method_finds_the_pieces_that_enumeration_finds(
        points in points(1..=7, 5), force in prop::collection::vec(-1.0f64..2.0, 9),
    ) {
        let count: usize = points.iter().map(|point| point.graph.pieces()).product();
        prop_assume!(count <= 4000);
        let plate = plate_in([1.0, 1.0]);
        let (held, load) = (held(&plate), load(&plate, &force));
        let (d, p) = condensed(&plate, &held, &points, &load);
        let expected = by_enumeration(&points, &d, &p);
        for (name, found) in by_all(&plate, &points, &held, &load, 0.0) {
            agree(name, found, &expected, 1e-9)?;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 0, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn every_method_solves_the_quadratic_program(
        points in points(6..=24, 5), force in prop::collection::vec(-1.0f64..2.0, 9), free: bool,
    ) {
        let plate = plate_in([1.0, 1.0]);
        let held = if free { vec![false; plate.dof_count()] } else { held(&plate) };
        let load = load(&plate, &force);
        let expected = by_program(&plate, &held, &points, &load);
        for (name, found) in by_all(&plate, &points, &held, &load, if free { 20.0 } else { 0.0 }) {
            match expected {
                Some(expected) => {
                    prop_assert_eq!(found.as_ref().err(), None, "{}", name);
                    let found = found.unwrap();
                    // Points in one element may share a force in different ways; only the energy is unique.
                    let (energy, size) = energy(&plate, &points, &load, &found);
                    prop_assert!((energy - expected).abs() < 1e-9 * size, "{}: {} for {}", name, energy, expected);
                    let problem = problem(&plate, &points, &held, Method::ActiveSet, 0.0);
                    let (forces, travels) = problem.violations(&load, &found);
                    prop_assert!(largest(&forces).max(largest(&travels)) < 1e-9, "{}", name);
                }
                None => prop_assert!(found.is_err(), "{}", name),
            }
        }
    }
}
