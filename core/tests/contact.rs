//! Contact problems on a square plate: against the conditions themselves, and the rigid motions in the LCP.
mod common;

use common::{largest, plate_in};
use proptest::prelude::*;
use signorini_core::contact::interior_point::interior_point;
use signorini_core::contact::{Constraints, ContactProblem, ContactSolution, Form, Outcome};
use signorini_core::displacement::Displacement;
use signorini_core::plate::Plate;
use signorini_core::rows::Springs;

/// w = 1, w = x, w = y.
fn motions(plate: &Plate) -> Vec<Vec<f64>> {
    let over =
        |values: fn([f64; 2]) -> [f64; 3]| (0..plate.node_count()).flat_map(|n| values(plate.point(n))).collect();
    vec![over(|_| [1.0, 0.0, 0.0]), over(|p| [p[0], 1.0, 0.0]), over(|p| [p[1], 0.0, 1.0])]
}

/// Points that push up, in corner elements, then one in the middle element; the first three are regularised.
fn free_on_points(at: &[(f64, f64)], gap: &[f64], soft: bool) -> ContactProblem {
    on_points(at, gap, soft, false)
}

fn on_points(at: &[(f64, f64)], gap: &[f64], soft: bool, by_active_set: bool) -> ContactProblem {
    on_points_in([1.0, 1.0], at, gap, soft, by_active_set)
}

fn on_points_in(
    [length, force]: [f64; 2],
    at: &[(f64, f64)],
    gap: &[f64],
    soft: bool,
    by_active_set: bool,
) -> ContactProblem {
    let plate = plate_in([length, force]);
    let mut constraints = Constraints { free_motions: motions(&plate), ..Constraints::default() };
    for (i, (&(xi, eta), &gap)) in at.iter().zip(gap).enumerate() {
        let element = [0, 2, 8, 6, 4][i % 5];
        constraints.rows.element.push(element);
        constraints.rows.coefficient.push(plate.interpolation_row(element, xi, eta, 0).0);
        constraints.distance.push(length * gap);
        constraints.compliance.push(if soft && i == 3 { 0.01 * length / force } else { 0.0 });
        constraints.two_sided.push(false);
        constraints.regularization.push(if i < 3 { 10.0 * force / length } else { 0.0 });
    }
    let held = vec![false; plate.dof_count()];
    ContactProblem::new(plate, Springs::default(), held, constraints, by_active_set, usize::MAX).unwrap()
}

fn by_interior_point(problem: &ContactProblem, constraints: &Constraints, load: &[f64]) -> ContactSolution {
    interior_point(
        &problem.plate,
        &problem.springs,
        &problem.held,
        &vec![0.0; load.len()],
        constraints,
        load,
        &mut |_| true,
    )
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
        let held = vec![0.0; load.len()];
        let form = if dual { Form::Dual } else { Form::Stiffness };
        let found = problem.solve(&load, &held, Some(form), &mut |_| true).unwrap();
        prop_assert!(found.outcome != Outcome::Unsolved);
        if found.outcome == Outcome::Solved {
            let out = problem.imbalance(&load, &found.displacement, &found.reaction);
            prop_assert!(out.iter().all(|f| f.abs() < 1e-10));
            let left = problem.remaining(&found.displacement, &found.reaction);
            for i in 0..5 {
                prop_assert!(found.reaction[i] >= -1e-10 && left[i] >= -1e-11);
                prop_assert!((found.reaction[i] * left[i]).abs() < 1e-10);
            }
        } else {
            prop_assert!(found.reaction.iter().chain(&found.displacement.hi).all(|x| x.is_nan()));
        }
    }

    /// Powers of 4, since a root of one is a power of 2: nothing is rounded otherwise.
    #[test]
    fn units_change_no_bit(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool, way in 0usize..4, units in (-6i32..7, -6i32..7),
    ) {
        let units = [4f64.powi(units.0), 4f64.powi(units.1)];
        let [length, force] = units;
        let solved = |units: [f64; 2]| {
            let problem = on_points_in(units, &at, &gap, soft, way == 0);
            let load = load(&problem.plate, element, units[1]);
            let held = vec![0.0; load.len()];
            match way {
                0 => problem.solve(&load, &held, None, &mut |_| true),
                1 => problem.solve(&load, &held, Some(Form::Dual), &mut |_| true),
                2 => problem.solve(&load, &held, Some(Form::Stiffness), &mut |_| true),
                _ => problem.solve_by_proximal_steps(&load, &held, 1e-9, None, &mut |_| true),
            }.unwrap()
        };
        let (plain, other) = (solved([1.0, 1.0]), solved(units));
        prop_assert_eq!(plain.outcome, other.outcome);
        prop_assert_eq!(&plain.closed, &other.closed);
        prop_assert_eq!((plain.pivots, plain.corrections), (other.pivots, other.corrections));
        prop_assume!(plain.outcome == Outcome::Solved);
        for i in 0..5 {
            prop_assert_eq!(force * plain.reaction[i], other.reaction[i]);
            prop_assert_eq!(length * plain.gap[i], other.gap[i]);
        }
        for (dof, (u, other)) in plain.displacement.hi.iter().zip(&other.displacement.hi).enumerate() {
            prop_assert_eq!(if dof % 3 == 0 { length * u } else { *u }, *other);
        }
    }

    #[test]
    fn the_active_set_finds_what_lemke_finds(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool,
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let load = load(&problem.plate, element, 1.0);
        let held = vec![0.0; load.len()];
        let by_lemke = problem.solve(&load, &held, None, &mut |_| true).unwrap();
        prop_assume!(by_lemke.outcome == Outcome::Solved);
        let found = on_points(&at, &gap, soft, true).solve(&load, &held, None, &mut |_| true).unwrap();
        prop_assert_eq!(found.outcome, Outcome::Solved);
        let most = largest(&by_lemke.displacement.hi);
        for i in 0..5 {
            prop_assert!((found.reaction[i] - by_lemke.reaction[i]).abs() < 1e-9);
            prop_assert!((found.gap[i] - by_lemke.gap[i]).abs() < 1e-9 * most);
        }
    }

    #[test]
    fn proximal_steps_find_what_lemke_finds(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(prop_oneof![Just(0.0), 0.0f64..0.01], 5),
        element in 0usize..9, soft: bool, part in prop_oneof![Just(1e-12), Just(1e-9), Just(1e-6), Just(1e-3)],
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let load = load(&problem.plate, element, 1.0);
        let held = vec![0.0; load.len()];
        let exact = problem.solve(&load, &held, None, &mut |_| true).unwrap();
        prop_assume!(exact.outcome == Outcome::Solved);
        let found = problem.solve_by_proximal_steps(&load, &held, part, None, &mut |_| true).unwrap();
        let from_set = problem.solve_by_proximal_steps(&load, &held, part, Some(&exact.closed), &mut |_| true).unwrap();
        let most = largest(&exact.displacement.hi);
        for found in [found, from_set] {
            prop_assert_eq!(found.outcome, Outcome::Solved);
            for i in 0..5 {
                prop_assert!((found.reaction[i] - exact.reaction[i]).abs() < 1e-8);
                prop_assert!((found.gap[i] - exact.gap[i]).abs() < 1e-8 * most);
            }
        }
    }

    #[test]
    fn the_interior_point_method_finds_what_pivoting_finds(
        at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5),
        gap in prop::collection::vec(0.0f64..0.01, 5),
        held_both_ways: bool, soft: bool,
    ) {
        let problem = free_on_points(&at, &gap, soft);
        let load = load(&problem.plate, 4, 1.0);
        let mut constraints = problem.all_constraints();
        constraints.two_sided[4] = held_both_ways;
        constraints.regularization.clone_from(&problem.constraints.regularization);
        if held_both_ways {
            constraints.free_motions.clear();
        }
        let (plate, held) = (problem.plate.clone(), problem.held.clone());
        let problem = ContactProblem::new(plate, Springs::default(), held, constraints, false, usize::MAX).unwrap();
        let exact = problem.solve(&load, &vec![0.0; load.len()], None, &mut |_| true).unwrap();
        prop_assume!(exact.outcome == Outcome::Solved);
        let found = by_interior_point(&problem, &problem.all_constraints(), &load);
        prop_assert_eq!(found.outcome, Outcome::Solved);
        prop_assert!(apart(&found.reaction, &exact.reaction) < 1e-5);
        prop_assert!(apart(&found.displacement.hi, &exact.displacement.hi) < 1e-5);
        let polished = problem.solve_by_interior_point(&load, &vec![0.0; load.len()], &mut |_| true).unwrap();
        prop_assert!(polished.iterations == found.iterations && polished.closed == exact.closed);
        prop_assert!(apart(&polished.reaction, &exact.reaction) < 1e-12);
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
        let shared = problem.combined_cases(rest.clone(), cases.clone(), &points, &mut || true).unwrap().unwrap();
        let rows: Vec<Vec<f64>> = factors.chunks(2).map(<[f64]>::to_vec).collect();
        for (row, found) in rows.iter().zip(problem.combine(&shared, &rows, &mut || true).unwrap()) {
            let sum: Vec<f64> = loads[0].iter().zip(&loads[1]).map(|(a, b)| row[0] * a + row[1] * b).collect();
            let single = problem.solve(&sum, &held, None, &mut |_| true).unwrap();
            match found.outcome {
                Outcome::NoEquilibrium => prop_assert_eq!(single.outcome, Outcome::NoEquilibrium),
                Outcome::Solved => {
                    prop_assert_eq!(single.outcome, Outcome::Solved);
                    for i in 0..5 {
                        prop_assert!((found.reaction[i] - single.reaction[i]).abs() < 1e-9);
                    }
                    let terms = [(1.0, &rest), (row[0], &cases[0]), (row[1], &cases[1])];
                    let pushes = found.factor.iter().copied().zip(&points);
                    let mut displacement = vec![0.0; sum.len()];
                    for (factor, term) in terms.into_iter().chain(pushes) {
                        displacement.iter_mut().zip(&term.displacement.hi).for_each(|(u, v)| *u += factor * v);
                    }
                    let rounded = Displacement { lo: vec![0.0; sum.len()], hi: displacement };
                    let out = problem.imbalance(&sum, &rounded, &found.reaction);
                    prop_assert!(out.iter().all(|f| f.abs() < 1e-8));
                }
                _ => {}
            }
        }
    }

    /// Gaps that a rigid motion opens cost no reaction, and the posed reactions balance the load.
    #[test]
    fn the_lcp_knows_the_rigid_motions_exactly(at in prop::collection::vec((-0.9f64..0.9, -0.9f64..0.9), 5), element in 0usize..9) {
        let problem = free_on_points(&at, &[0.0; 5], false);
        let load = load(&problem.plate, element, 1.0);
        let posed = problem.lcp(&load, &vec![0.0; load.len()], Some(Form::Dual)).unwrap();
        let order = posed.q.len();
        prop_assert_eq!(&posed.gap_is_z, &[true, true, true, false, false]);
        for motion in motions(&problem.plate) {
            let rows = &problem.constraints.rows;
            let moves: Vec<f64> = (0..rows.len()).map(|row| rows.dot(&problem.plate, row, &motion)).collect();
            let work: f64 = motion.iter().zip(&load).map(|(u, f)| u * f).sum();
            let carried: f64 = (0..3).map(|r| moves[posed.point[r]] * posed.q[r]).sum();
            prop_assert!((carried - work).abs() < 1e-13);
            for r in 3..5 {
                let follows: f64 = (0..3).map(|c| posed.matrix[r * order + c] * moves[posed.point[c]]).sum();
                prop_assert!((follows - moves[posed.point[r]]).abs() < 1e-13);
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
    let held = vec![0.0; problem.plate.dof_count()];
    for (element, force) in [(0, 1.0), (8, 1.0), (4, -1.0)] {
        let load = load(&problem.plate, element, force);
        let (inside, up) = (element == 4, force < 0.0);
        for form in [None, Some(Form::Dual), Some(Form::Stiffness)] {
            let found = problem.solve(&load, &held, form, &mut |_| true).unwrap();
            let expected = if inside && !up { Outcome::Solved } else { Outcome::NoEquilibrium };
            assert_eq!(found.outcome, expected, "element {element}, {form:?}");
        }
        let found = by_interior_point(&problem, &problem.all_constraints(), &load);
        let expected = if inside && !up { Outcome::Solved } else { Outcome::NoEquilibrium };
        assert_eq!(found.outcome, expected, "element {element}, interior point");
        assert_eq!(found.reaction.iter().any(|r| r.is_nan()), expected != Outcome::Solved);
    }
}

#[test]
fn whoever_watches_the_active_set_may_stop_it() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = on_points(&at, &[0.0; 5], false, true);
    let (load, held) = (load(&problem.plate, 4, 1.0), vec![0.0; problem.plate.dof_count()]);
    let mut steps = Vec::new();
    let found = problem.solve(&load, &held, None, &mut |now| {
        steps.push(now.step);
        now.step < 2
    });
    assert_eq!(found.unwrap().outcome, Outcome::Interrupted);
    assert_eq!(steps, [1, 2]);
}

#[test]
fn the_interior_point_method_proves_that_gaps_contradict_each_other() {
    let problem = free_on_points(&[(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)], &[0.0; 5], false);
    let load = load(&problem.plate, 4, 1.0);
    for (depth, expected) in [(1e-3, Outcome::Solved), (-1e-3, Outcome::NoEquilibrium)] {
        let mut constraints = problem.all_constraints();
        let turned = constraints.rows.coefficient[4].map(|c| -c);
        (constraints.rows.element[3], constraints.rows.coefficient[3]) = (constraints.rows.element[4], turned);
        constraints.distance[3] = depth;
        assert_eq!(by_interior_point(&problem, &constraints, &load).outcome, expected, "depth {depth}");
    }
}

#[test]
fn a_contact_set_to_begin_with_leaves_no_pivots() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = free_on_points(&at, &[0.0, 0.001, 0.002, 0.0, 0.003], true);
    let (load, held) = (load(&problem.plate, 4, 1.0), vec![0.0; problem.plate.dof_count()]);
    let (cold, warm) = (
        problem.solve(&load, &held, None, &mut |_| true),
        problem.solve_by_interior_point(&load, &held, &mut |_| true),
    );
    let (cold, warm) = (cold.unwrap(), warm.unwrap());
    assert!(cold.pivots > 0 && warm.pivots == 0 && warm.iterations > 3);
    assert_eq!(cold.closed, warm.closed);
}

#[test]
fn where_there_is_no_answer_no_point_has_one() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    let problem = on_points(&at, &[0.0; 5], true, true);
    let (load, held) = (load(&problem.plate, 4, 1.0), vec![0.0; problem.plate.dof_count()]);
    let found = problem.solve_by_interior_point(&load, &held, &mut |_| false).unwrap();
    assert_eq!(found.outcome, Outcome::Interrupted);
    assert_eq!([found.reaction.len(), found.gap.len(), found.closed.len()], [5; 3]);
    assert!(found.reaction.iter().chain(&found.gap).all(|value| value.is_nan()));
}

#[test]
fn without_a_load_the_active_set_stays_at_rest() {
    let at = [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.0, 0.0)];
    for gap in [0.0, 0.01] {
        let problem = on_points(&at, &[gap; 5], true, true);
        let nothing = vec![0.0; problem.plate.dof_count()];
        let found = problem.solve(&nothing, &nothing, None, &mut |_| true).unwrap();
        assert_eq!(found.outcome, Outcome::Solved, "gap {gap}");
        assert_eq!((found.displacement.hi, found.reaction), (nothing, vec![0.0; 5]), "gap {gap}");
    }
}
