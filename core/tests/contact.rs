//! Contact problems on a square plate: the contact conditions are checked, and the rigid motions in the LCP.
mod common;

use common::{SIZE, largest, plate_in};
use proptest::prelude::*;
use signorini_core::contact::{
    ContactProblem, ContactSolution, Form, Graph, Load, Method, PathEnd, PathLoad, Points, Settings, SolveError,
    Supported,
};
use signorini_core::plate::Plate;
use signorini_core::rows::{Rows, Springs};
use std::sync::Arc;

/// The rigid motions w = 1, w = x, w = y.
fn motions(plate: &Plate) -> Vec<Vec<f64>> {
    let over =
        |values: fn([f64; 2]) -> [f64; 3]| (0..plate.node_count()).flat_map(|n| values(plate.point(n))).collect();
    vec![over(|_| [1.0, 0.0, 0.0]), over(|p| [p[0], 1.0, 0.0]), over(|p| [p[1], 0.0, 1.0])]
}

/// A free plate on points that push up: four in the corner elements, then one in the middle element. The first three
/// are regularised; with `soft`, the fourth has a finite stiffness.
fn free_on_points(at: &[(f64, f64)], gap: &[f64], soft: bool) -> ContactProblem {
    on_points(at, gap, soft, Method::Lemke)
}

fn on_points(at: &[(f64, f64)], gap: &[f64], soft: bool, method: Method) -> ContactProblem {
    on_points_in([1.0, 1.0], at, gap, soft, method)
}

fn on_points_in(units: [f64; 2], at: &[(f64, f64)], gap: &[f64], soft: bool, method: Method) -> ContactProblem {
    let plate = plate_in(units);
    let law = |i: usize| Graph::one_sided(if soft && i == 3 { 100.0 * units[1] / units[0] } else { f64::INFINITY });
    with_laws(units, plate, at, gap, law, method)
}

fn with_laws(
    [length, force]: [f64; 2],
    plate: Arc<Plate>,
    at: &[(f64, f64)],
    gap: &[f64],
    law: impl Fn(usize) -> Graph,
    method: Method,
) -> ContactProblem {
    let (mut points, mut rows) = (Points::default(), Rows::default());
    for (i, (&(xi, eta), &gap)) in at.iter().zip(gap).enumerate() {
        let element = [0, 2, 8, 6, 4][i % 5];
        rows.element.push(element);
        rows.coefficient.push(plate.interpolation_row(element, xi, eta, 0).0);
        let law = points.add_graph(law(i));
        points.push_row(&plate, &rows, i, law, length * gap, 1.0);
    }
    let (held, free_motions) = (vec![false; plate.dof_count()], motions(&plate));
    let delta = delta(at.len(), 10.0 * force / length);
    let on = Supported { springs: Springs::default(), held, points, delta, free_motions };
    ContactProblem::new(plate, on, method, usize::MAX).unwrap()
}

/// Stiffness that the factor includes at the first three points.
fn delta(points: usize, stiffness: f64) -> Vec<f64> {
    (0..points).map(|i| if i < 3 { stiffness } else { 0.0 }).collect()
}

fn solved(problem: &ContactProblem, load: &[f64]) -> Result<ContactSolution, SolveError> {
    solved_in(problem, load, None)
}

fn solved_in(problem: &ContactProblem, load: &[f64], form: Option<Form>) -> Result<ContactSolution, SolveError> {
    let load = Load { nodal: load, held_value: &vec![0.0; load.len()] };
    problem.solve(&load, &Settings { form }, None, &mut |_| true)
}

/// Largest violation of the contact conditions by a solution.
fn worst(problem: &ContactProblem, load: &[f64], solution: &ContactSolution) -> f64 {
    let (forces, points) = problem.violations(load, solution);
    largest(&forces).max(largest(&points))
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) / largest(b)
}

fn load(plate: &Plate, element: usize, force: f64) -> Vec<f64> {
    let row = plate.interpolation_row(element, 0.1, -0.2, 0).0;
    let mut out = vec![0.0; plate.dof_count()];
    for (j, c) in row.iter().enumerate() {
        out[3 * plate.elements()[element][j / 3] + j % 3] += force * c;
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_plate_on_points_meets_every_condition(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool, dual: bool,
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let load = load(&problem.plate, element, 1.0);
        let form = if dual { Form::Dual } else { Form::Stiffness };
        match solved_in(&problem, &load, Some(form)) {
            Ok(found) => prop_assert!(worst(&problem, &load, &found) < 1e-10),
            Err(error) => prop_assert_eq!(error, SolveError::NoEquilibrium),
        }
    }

    /// Units are powers of 4, because their roots are powers of 2 and cause no rounding.
    #[test]
    fn units_change_no_bit(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool, way in 0usize..4, units in (-6i32..7, -6i32..7),
    ) {
        let units = [4f64.powi(units.0), 4f64.powi(units.1)];
        let [length, force] = units;
        let solved = |units: [f64; 2]| {
            let method = [Method::ActiveSet, Method::Lemke, Method::Lemke, Method::Saddle][way];
            let form = [None, Some(Form::Dual), Some(Form::Stiffness), None][way];
            let problem = on_points_in(units, &at, &gap, soft, method);
            let load = load(&problem.plate, element, units[1]);
            solved_in(&problem, &load, form)
        };
        let (plain, other) = (solved([1.0, 1.0]), solved(units));
        prop_assert_eq!(plain.as_ref().err(), other.as_ref().err());
        let (Ok(plain), Ok(other)) = (plain, other) else { return Ok(()) };
        prop_assert_eq!(&plain.piece, &other.piece);
        prop_assert_eq!((plain.pivots, plain.corrections), (other.pivots, other.corrections));
        for i in 0..5 {
            prop_assert_eq!(force * plain.reaction[i], other.reaction[i]);
            prop_assert_eq!(length * plain.gap[i], other.gap[i]);
        }
        for (dof, (u, other)) in plain.displacement.hi.iter().zip(&other.displacement.hi).enumerate() {
            prop_assert_eq!(if dof % 3 == 0 { length * u } else { *u }, *other);
        }
    }

    #[test]
    fn every_method_finds_what_lemke_finds(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool,
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let load = load(&problem.plate, element, 1.0);
        let exact = solved(&problem, &load);
        prop_assume!(exact.is_ok());
        let exact = exact.unwrap();
        let most = largest(&exact.displacement.hi);
        let others = [
            ("active set", solved(&on_points(&at, &gap, soft, Method::ActiveSet), &load)),
            ("saddle", solved(&on_points(&at, &gap, soft, Method::Saddle), &load)),
        ];
        for (name, found) in others {
            prop_assert_eq!(found.as_ref().err(), None, "{}", name);
            let found = found.unwrap();
            for i in 0..5 {
                prop_assert!((found.reaction[i] - exact.reaction[i]).abs() < 1e-9);
                prop_assert!((found.gap[i] - exact.gap[i]).abs() < 1e-9 * most);
            }
        }
    }

    #[test]
    fn loads_solved_together_are_solved_as_by_themselves(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(0.0f64..0.01, 5),
        elements in prop::collection::vec(0usize..9, 1..12), soft: bool,
    ) {
        let problem = on_points(&at, &gap, soft, Method::ActiveSet);
        let held = vec![0.0; problem.plate.dof_count()];
        let mean = load(&problem.plate, 4, 1.0);
        // The resultant of each load is between the points, so that they can balance it.
        let beside = |&e: &usize| mean.iter().zip(load(&problem.plate, e, 0.3)).map(|(a, b)| a + b).collect();
        let loads: Vec<Vec<f64>> = elements.iter().map(beside).collect();
        let mean = Load { nodal: &mean, held_value: &held };
        let reference = problem.solve_and_factor(&mean, &mut |_| true).unwrap();
        for found in [None, reference.as_ref()] {
            let together = problem.solve_together(found, &loads, &held, &mut || true).unwrap();
            for (load, found) in loads.iter().zip(together) {
                let (alone, found) = (solved(&problem, load).unwrap(), found.unwrap());
                prop_assert!(worst(&problem, load, &found) < 1e-9);
                prop_assert!(apart(&found.reaction, &alone.reaction) < 1e-9);
            }
        }
    }

    #[test]
    fn a_problem_with_other_shifts_solves_as_one_that_is_made_with_them(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(0.0f64..0.01, 5), other in prop::collection::vec(-0.01f64..0.01, 5),
        soft: bool, method in prop_oneof![Just(Method::Lemke), Just(Method::ActiveSet), Just(Method::Saddle)],
    ) {
        let (moved, made) = (on_points(&at, &gap, soft, method), on_points(&at, &other, soft, method));
        let (moved, load) = (moved.with_shift(other).unwrap(), load(&made.plate, 4, 1.0));
        let (found, wanted) = (solved(&moved, &load), solved(&made, &load));
        prop_assert_eq!(found.as_ref().err(), wanted.as_ref().err());
        let (Ok(found), Ok(wanted)) = (found, wanted) else { return Ok(()) };
        prop_assert_eq!(found.reaction, wanted.reaction);
        prop_assert_eq!(found.displacement.hi, wanted.displacement.hi);
    }

    #[test]
    fn a_problem_on_other_supports_solves_as_a_new_one(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5), moved: bool, soft in prop::array::uniform2(any::<bool>()),
        gap in prop::collection::vec(0.0f64..0.01, 5), other in prop::collection::vec(-0.01f64..0.01, 5),
        method in prop_oneof![Just(Method::Lemke), Just(Method::ActiveSet), Just(Method::Saddle)],
    ) {
        let places: Vec<_> = at.iter().map(|&(x, y)| if moved { (y, x) } else { (x, y) }).collect();
        let (first, made) = (on_points(&at, &gap, soft[0], method), on_points(&places, &other, soft[1], method));
        let (springs, held, points) = (made.springs.clone(), made.held.clone(), made.points.clone());
        let on = Supported { springs, held, points, delta: delta(5, 10.0), free_motions: motions(&made.plate) };
        let found = first.on_other_supports(on, usize::MAX).unwrap();
        let load = load(&made.plate, 4, 1.0);
        let (found, wanted) = (solved(&found, &load), solved(&made, &load));
        prop_assert_eq!(found.as_ref().err(), wanted.as_ref().err());
        let (Ok(found), Ok(wanted)) = (found, wanted) else { return Ok(()) };
        prop_assert_eq!(found.reaction, wanted.reaction);
        prop_assert_eq!(found.displacement.hi, wanted.displacement.hi);
    }

    /// A plate that is fixed at three corners, which settle.
    #[test]
    fn settlements_move_the_plate_as_they_say(
        at in (-0.9f64..0.9, -0.9f64..0.9), settlement in prop::collection::vec(-0.01f64..0.01, 3), gap in 0.0f64..0.01,
    ) {
        let plate = plate_in([1.0, 1.0]);
        let corners = [0, 2 * SIZE, plate.node_count() - 1];
        let (mut held, mut values) = (vec![false; plate.dof_count()], vec![0.0; plate.dof_count()]);
        for (corner, s) in corners.into_iter().zip(&settlement) {
            (held[3 * corner], values[3 * corner]) = (true, *s);
        }
        let (mut points, mut rows) = (Points::default(), Rows::default());
        rows.element.push(4);
        rows.coefficient.push(plate.interpolation_row(4, at.0, at.1, 0).0);
        let law = points.add_graph(Graph::one_sided(f64::INFINITY));
        points.push_row(&plate, &rows, 0, law, gap, 1.0);
        for method in [Method::Lemke, Method::ActiveSet, Method::Saddle] {
            let (held, points) = (held.clone(), points.clone());
            let on = Supported { springs: Springs::default(), held, points, delta: vec![0.0], free_motions: Vec::new() };
            let problem = ContactProblem::new(plate.clone(), on, method, usize::MAX).unwrap();
            let none = vec![0.0; values.len()];
            let moved = Load { nodal: &none, held_value: &values };
            let found = problem.solve(&moved, &Settings::default(), None, &mut |_| true).unwrap();
            prop_assert!(corners.iter().zip(&settlement).all(|(c, s)| found.displacement.hi[3 * c] == *s));
            prop_assert!(worst(&problem, &none, &found) < 1e-9);
            // Without contact, the plate is the plane through its corners, which are at ±1.5.
            let [a, b, c] = [settlement[0], settlement[1], settlement[2]];
            let [x, y] = [at.0 / 2.0, at.1 / 2.0];
            let plane = 0.5 * (a + c) + (b - a) * x / 3.0 + (c - b) * y / 3.0;
            prop_assert_eq!(found.reaction[0] > 0.0, plane > gap, "{} of {}", plane, gap);
        }
    }

    /// A footprint: its row is the mean deflection over all nine elements.
    #[test]
    fn a_footprint_carries_what_it_must(compliance in prop_oneof![Just(0.0), 1e-4f64..1.0], gap in 0.0f64..0.01) {
        let plate = plate_in([1.0, 1.0]);
        let mut rows = Rows::default();
        let mean = |e: usize| plate.interpolation_row(e, 0.0, 0.0, 0).0.map(|c| c / 9.0);
        rows.element.push(0);
        rows.coefficient.push(mean(0));
        rows.further.insert(0, (1..9).map(|e| (e, mean(e))).collect());
        let mut sum: std::collections::BTreeMap<usize, f64> = Default::default();
        rows.entries(&plate, 0).for_each(|(dof, c)| *sum.entry(dof).or_default() += c);
        let mut held = vec![false; plate.dof_count()];
        let node = plate.elements()[4][0];
        (held[3 * node + 1], held[3 * node + 2]) = (true, true);
        let load = load(&plate, 4, 1.0);
        for method in [Method::Lemke, Method::ActiveSet, Method::Saddle] {
            let mut points = Points::default();
            let law = points.add_graph(Graph::one_sided(1.0 / compliance));
            points.push(sum.clone().into_iter(), law, gap, 1.0);
            let on = Supported {
                springs: Springs::default(),
                held: held.clone(),
                points,
                delta: vec![if method == Method::Lemke { 10.0 } else { 0.0 }],
                free_motions: motions(&plate)[..1].to_vec(),
            };
            let problem = ContactProblem::new(plate.clone(), on, method, usize::MAX).unwrap();
            let found = solved(&problem, &load).unwrap();
            prop_assert!((found.reaction[0] - 1.0).abs() < 1e-9, "{}", found.reaction[0]);
            prop_assert!(worst(&problem, &load, &found) < 1e-8);
        }
    }

    /// At every stop of a path, the solution satisfies the contact conditions for the load there. The last one agrees
    /// with a direct solution.
    #[test]
    fn a_path_goes_through_solutions(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.002], 5),
        element in 0usize..9, soft: bool, limited: bool,
    ) {
        let plate = plate_in([1.0, 1.0]);
        let law = |i: usize| match i {
            // Point 4 yields, so it may fail to balance the load.
            4 if limited => Graph::new(vec![[0.0, 0.0], [0.01, 0.2]], [0.0, 0.0]).unwrap(),
            3 if soft => Graph::one_sided(100.0),
            _ => Graph::one_sided(f64::INFINITY),
        };
        for method in [Method::Lemke, Method::ActiveSet] {
            let problem = with_laws([1.0, 1.0], plate.clone(), &at, &gap, law, method);
            let (start, add) = (load(&plate, 4, 1.0), load(&plate, element, 1.0));
            let held_value = vec![0.0; start.len()];
            let path = PathLoad { start: &start, add: &add, held_value: &held_value, end: 3.0 };
            let mut stops: Vec<(f64, ContactSolution)> = Vec::new();
            let mut visit = |stop: signorini_core::contact::Stop| {
                stops.push((stop.t, stop.solution.clone()));
                true
            };
            let end = problem.path(&path, &mut visit, &mut |_| true).unwrap();
            let at = |t: f64| -> Vec<f64> { start.iter().zip(&add).map(|(a, b)| a + t * b).collect() };
            for (t, found) in &stops {
                let load = at(*t);
                prop_assert!(worst(&problem, &load, found) < 1e-7, "t = {}: {}", t, worst(&problem, &load, found));
            }
            let first = solved(&problem, &start);
            let last = solved(&problem, &at(3.0));
            prop_assert_eq!(stops.is_empty(), first.is_err(), "{:?}", method);
            match end {
                PathEnd::Reached => prop_assert!(apart(&stops.last().unwrap().1.reaction, &last.unwrap().reaction) < 1e-7),
                // The loads in equilibrium are a convex set, so that no larger factor is in equilibrium again.
                PathEnd::NoEquilibrium => prop_assert_eq!(last.err(), Some(SolveError::NoEquilibrium), "{:?}", method),
                end => prop_assert!(first.is_err() || last.is_err(), "{:?}: {:?}", method, end),
            }
        }
    }

    #[test]
    fn combinations_of_two_loads_are_their_sums_solved_by_themselves(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        elements in (0usize..9, 0usize..9), soft: bool,
        factors in prop::collection::vec(prop_oneof![Just(0.0), Just(1.0), -0.5f64..1.5], 6),
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let held = vec![0.0; problem.plate.dof_count()];
        let loads = vec![load(&problem.plate, elements.0, 1.0), load(&problem.plate, elements.1, 2.0)];
        let rest = problem.rest_response(&held).unwrap();
        let cases = problem.load_responses(&loads, &mut || true).unwrap();
        let points = problem.point_responses(0..5, &mut || true).unwrap();
        let shared = problem.combined_cases(rest.clone(), cases.clone(), &points, &mut || true).unwrap();
        let rows: Vec<Vec<f64>> = factors.chunks(2).map(<[f64]>::to_vec).collect();
        for (row, found) in rows.iter().zip(problem.combine(&shared, &rows, &mut || true).unwrap()) {
            let sum: Vec<f64> = loads[0].iter().zip(&loads[1]).map(|(a, b)| row[0] * a + row[1] * b).collect();
            let single = solved(&problem, &sum);
            match (found, single) {
                (Ok(found), Ok(single)) => prop_assert!((0..5).all(|i| (found.reaction[i] - single.reaction[i]).abs() < 1e-9)),
                // The contact state is undetermined only if a point touches without a force.
                (Err(SolveError::Unsolved), Ok(single)) => {
                    prop_assert!((0..5).any(|i| single.reaction[i].abs() < 1e-9 && single.gap[i].abs() < 1e-9));
                }
                (found, single) => prop_assert_eq!(found.err(), single.err()),
            }
        }
    }

    /// Opening gaps by a rigid motion causes no reaction, and the reactions q of closed gaps balance the load.
    #[test]
    fn the_lcp_knows_the_rigid_motions_exactly(at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5), element in 0usize..9) {
        let problem = free_on_points(&at, &[0.0; 5], false);
        let load = load(&problem.plate, element, 1.0);
        let at_rest = vec![0.0; load.len()];
        let settings = Settings { form: Some(Form::Dual) };
        let (posed, q) = problem.lcp(&Load { nodal: &load, held_value: &at_rest }, &settings).unwrap();
        let (order, rows) = (q.len(), &posed.vertices.rows);
        let gap_is_z: Vec<bool> = rows.iter().map(|row| row.gap_is_z()).collect();
        prop_assert_eq!(&gap_is_z, &[true, true, true, false, false]);
        for motion in motions(&problem.plate) {
            let moves: Vec<f64> = (0..5).map(|i| problem.points.dot(i, &motion)).collect();
            let work: f64 = motion.iter().zip(&load).map(|(u, f)| u * f).sum();
            let carried: f64 = (0..3).map(|r| moves[rows[r].point] * q[r]).sum();
            prop_assert!((carried - work).abs() < 1e-13);
            for r in 3..5 {
                let follows: f64 = (0..3).map(|c| posed.matrix[r * order + c] * moves[rows[c].point]).sum();
                prop_assert!((follows - moves[rows[r].point]).abs() < 1e-13);
            }
        }
        for r in 0..3 {
            for c in 0..3 {
                prop_assert_eq!(posed.matrix[r * order + c], 0.0);
            }
            for c in 3..5 {
                prop_assert_eq!(posed.matrix[r * order + c], -posed.matrix[c * order + r]);
            }
        }
    }
}

#[test]
fn a_load_beyond_the_points_has_no_equilibrium() {
    let problem = free_on_points(&[(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)], &[0.0; 5], false);
    for (element, force) in [(0, 1.0), (8, 1.0), (4, -1.0)] {
        let load = load(&problem.plate, element, force);
        let (inside, up) = (element == 4, force < 0.0);
        let expected = if inside && !up { None } else { Some(SolveError::NoEquilibrium) };
        for form in [None, Some(Form::Dual), Some(Form::Stiffness)] {
            assert_eq!(solved_in(&problem, &load, form).err(), expected, "element {element}, {form:?}");
        }
    }
}

#[test]
fn the_callback_cancels_a_solve() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = on_points(&at, &[0.0; 5], false, Method::ActiveSet);
    let (nodal, held_value) = (&load(&problem.plate, 4, 1.0), &vec![0.0; problem.plate.dof_count()]);
    let mut steps = Vec::new();
    let found = problem.solve(&Load { nodal, held_value }, &Settings::default(), None, &mut |now| {
        steps.push(now.step);
        now.step < 2
    });
    assert_eq!((found.err(), steps), (Some(SolveError::Cancelled), vec![1, 2]));
}

#[test]
fn gaps_that_contradict_each_other_have_no_solution() {
    let plate = plate_in([1.0, 1.0]);
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)];
    let load = load(&plate, 4, 1.0);
    for (depth, expected) in [(1e-3, None), (-1e-3, Some(SolveError::NoEquilibrium))] {
        let (mut points, mut rows) = (Points::default(), Rows::default());
        let law = points.add_graph(Graph::one_sided(f64::INFINITY));
        for (i, (element, (xi, eta))) in [0, 2, 8, 6].into_iter().zip(at).enumerate() {
            rows.element.push(element);
            rows.coefficient.push(plate.interpolation_row(element, xi, eta, 0).0);
            points.push_row(&plate, &rows, i, law, 0.0, 1.0);
        }
        // The last point pushes down on the place of the fourth one, at a distance `depth`.
        points.push(rows.entries(&plate, 3).map(|(dof, c)| (dof, -c)), law, depth, 1.0);
        let delta = vec![10.0, 10.0, 10.0, 0.0, 0.0];
        let (held, free_motions) = (vec![false; plate.dof_count()], motions(&plate));
        let on = Supported { springs: Springs::default(), held, points, delta, free_motions };
        let problem = ContactProblem::new(plate.clone(), on, Method::Lemke, usize::MAX).unwrap();
        assert_eq!(solved(&problem, &load).err(), expected, "depth {depth}");
    }
}

#[test]
fn a_contact_set_to_begin_with_leaves_no_pivots() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = free_on_points(&at, &[0.0, 0.001, 0.002, 0.0, 0.003], true);
    let (nodal, held_value) = (&load(&problem.plate, 4, 1.0), &vec![0.0; problem.plate.dof_count()]);
    let cold = solved(&problem, nodal).unwrap();
    let warm = problem.solve(&Load { nodal, held_value }, &Settings::default(), Some(&cold), &mut |_| true).unwrap();
    assert!(cold.pivots > 0 && warm.pivots == 0);
    assert_eq!(cold.piece, warm.piece);
}

#[test]
fn vectors_of_wrong_lengths_and_requests_for_another_method_are_refused() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = on_points(&at, &[0.0; 5], true, Method::ActiveSet);
    let dofs = problem.plate.dof_count();
    let short = vec![0.0; dofs - 1];
    let length = |name| Some(SolveError::Length { name, found: dofs - 1, expected: dofs });
    assert_eq!(solved(&problem, &short).err(), length("the load"));
    let load = load(&problem.plate, 4, 1.0);
    let held = Load { nodal: &load, held_value: &short };
    assert_eq!(problem.solve_on(&held, &[0; 5]).err(), length("held_value"));
    let at_rest = Load { nodal: &load, held_value: &vec![0.0; dofs] };
    assert!(matches!(problem.solve_on(&at_rest, &[2; 5]).err(), Some(SolveError::Value { index: 0, .. })));
    assert_eq!(problem.lcp(&at_rest, &Settings::default()).err(), Some(SolveError::NotCondensed));
    let condensed = free_on_points(&at, &[0.0; 5], true);
    assert_eq!(condensed.solve_and_factor(&at_rest, &mut |_| true).err(), Some(SolveError::Condensed));
}

#[test]
fn without_a_load_the_active_set_stays_at_rest() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    for gap in [0.0, 0.01] {
        let problem = on_points(&at, &[gap; 5], true, Method::ActiveSet);
        let nothing = vec![0.0; problem.plate.dof_count()];
        let found = solved(&problem, &nothing).unwrap();
        assert_eq!((found.displacement.hi, found.reaction), (nothing, vec![0.0; 5]), "gap {gap}");
    }
}
