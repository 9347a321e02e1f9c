//! Small contact problems with known matrices M, on strips of unit width with EI = 1 and κGA = 5.
//!
//! A strip of 9-node elements has the nodal deflections of a Timoshenko beam: the tip of a cantilever of length 1 has
//! the flexibility 1/3 + 1/5 = 8/15.
use signorini_core::contact::{
    ContactProblem, ContactSolution, Form, Graph, Load, Method, PathEnd, PathLoad, Points, Settings, Supported,
};
use signorini_core::element::{Kind, Material, Thickness};
use signorini_core::plate::Plate;
use signorini_core::rows::Springs;
use std::sync::Arc;

/// Row of a support: (dof, coefficient) pairs.
type Row = Vec<(usize, f64)>;

/// A strip of `count` elements of size (1, 1) from x = `start` on. On the line x = start + i, nodes 5i, 5i + 1 and 5i +
/// 2 are at the lower end, in the middle and at the upper end.
fn strip(start: f64, count: usize, young: f64) -> Arc<Plate> {
    let mut points = Vec::new();
    for i in 0..=count {
        let x = start + i as f64;
        points.extend([[x, 0.0], [x, 0.5], [x, 1.0]]);
        if i < count {
            points.extend([[x + 0.5, 0.0], [x + 0.5, 1.0]]);
        }
    }
    let nodes = [0, 5, 7, 2, 3, 6, 4, 1];
    let elements = (0..count).map(|e| nodes.map(|node| 5 * e + node)).collect();
    let material = Material::isotropic(young, 0.0, 5.0 / 6.0);
    Arc::new(Plate::new(points, elements, Thickness::Constant(1.0), material, Kind::Mitc9, None).unwrap())
}

/// Row of the mean deflection on the line x = start + i.
fn mean(i: usize) -> Row {
    vec![(15 * i, 1.0 / 6.0), (15 * i + 3, 4.0 / 6.0), (15 * i + 6, 1.0 / 6.0)]
}

fn nodal(plate: &Plate, rows: &[(Row, f64)]) -> Vec<f64> {
    let mut load = vec![0.0; plate.dof_count()];
    for (row, force) in rows {
        row.iter().for_each(|(dof, coefficient)| load[*dof] += force * coefficient);
    }
    load
}

/// A strip held only by `supports`, each with a row, a law and a gap.
fn free(plate: &Arc<Plate>, supports: &[(Row, Graph, f64)], delta: f64, method: Method) -> ContactProblem {
    // Rotations about the axis of the strip are fixed.
    let held: Vec<bool> = (0..plate.dof_count()).map(|dof| dof % 3 == 2).collect();
    let motion =
        |values: fn(f64) -> [f64; 3]| (0..plate.node_count()).flat_map(|n| values(plate.point(n)[0])).collect();
    problem(plate, held, supports, delta, vec![motion(|_| [1.0, 0.0, 0.0]), motion(|x| [x, 1.0, 0.0])], method)
}

/// A cantilever of length 1 with a support at its tip.
fn cantilever(law: Graph, gap: f64, method: Method) -> ContactProblem {
    let plate = strip(0.0, 1, 12.0);
    let held = (0..plate.dof_count()).map(|dof| dof < 9).collect();
    problem(&plate, held, &[(mean(1), law, gap)], 0.0, Vec::new(), method)
}

fn problem(
    plate: &Arc<Plate>,
    held: Vec<bool>,
    supports: &[(Row, Graph, f64)],
    delta: f64,
    free_motions: Vec<Vec<f64>>,
    method: Method,
) -> ContactProblem {
    let mut points = Points::default();
    for (row, law, gap) in supports {
        let graph = points.add_graph(law.clone());
        points.push(row.iter().copied(), graph, *gap, 1.0);
    }
    let delta = vec![if method == Method::Lemke { delta } else { 0.0 }; supports.len()];
    let on = Supported { springs: Springs::default(), held, points, delta, free_motions };
    ContactProblem::new(plate.clone(), on, method, usize::MAX).unwrap()
}

fn solved(problem: &ContactProblem, load: &[f64]) -> ContactSolution {
    let load = Load { nodal: load, held_value: &vec![0.0; load.len()] };
    problem.solve(&load, &Settings::default(), None, &mut |_| true).unwrap()
}

/// M (row-major) and q of the linear complementarity problem.
fn lcp(problem: &ContactProblem, load: &[f64], form: Form) -> (Vec<f64>, Vec<f64>) {
    let load = Load { nodal: load, held_value: &vec![0.0; load.len()] };
    let (template, q) = problem.lcp(&load, &Settings { form: Some(form) }).unwrap();
    (template.matrix.clone(), q)
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance), "{found:?}, expected {expected:?}");
}

const METHODS: [Method; 3] = [Method::Lemke, Method::ActiveSet, Method::Saddle];

/// Two springs k = 10 at the ends, a force of 4 at a quarter of the length: by equilibrium the reactions are 3 and 1.
#[test]
fn a_beam_on_two_springs() {
    let plate = strip(0.0, 1, 12.0);
    let springs = [0, 1].map(|i| (mean(i), Graph::one_sided(10.0), 0.0));
    let load = nodal(&plate, &[(mean(0), 3.0), (mean(1), 1.0)]);
    // The gaps are the unknowns z. M is zero, because opening a gap by a rigid motion causes no reaction.
    let (matrix, q) = lcp(&free(&plate, &springs, 10.0, Method::Lemke), &load, Form::Stiffness);
    assert_close(&matrix, &[0.0, 0.0, 0.0, 0.0], 0.0);
    assert_close(&q, &[3.0, 1.0], 1e-12);
    for method in METHODS {
        let found = solved(&free(&plate, &springs, 10.0, method), &load);
        assert_eq!(found.piece, [1, 1]);
        assert_close(&found.reaction, &[3.0, 1.0], 1e-12);
        assert_close(&[found.displacement.hi[3], found.displacement.hi[18]], &[0.3, 0.1], 1e-12);
    }
}

/// A force of 15 at the tip deflects the free cantilever by 8. The prop is 2 below the tip, so its reaction is 6 ·
/// 15/8.
#[test]
fn a_cantilever_on_a_prop() {
    let rigid = || Graph::one_sided(f64::INFINITY);
    let load = nodal(&strip(0.0, 1, 12.0), &[(mean(1), 15.0)]);
    let (matrix, q) = lcp(&cantilever(rigid(), 2.0, Method::Lemke), &load, Form::Dual);
    assert_close(&matrix, &[8.0 / 15.0], 1e-13);
    assert_close(&q, &[2.0 - 8.0], 1e-12);
    for method in METHODS {
        let found = solved(&cantilever(rigid(), 2.0, method), &load);
        assert_eq!(found.piece, [1]);
        assert_close(&found.reaction, &[11.25], 1e-11);
        assert_close(&found.displacement.hi[15..16], &[2.0], 1e-12);
    }
}

/// The prop is a spring k = 30 that yields at 3: w₀ is the gap, w₁ = 3 − z₀ the remaining force to the limit, z₁ the
/// plastic travel.
#[test]
fn a_yielding_point() {
    let law = || Graph::new(vec![[0.0, 0.0], [0.1, 3.0]], [0.0, 0.0]).unwrap();
    let load = nodal(&strip(0.0, 1, 12.0), &[(mean(1), 15.0)]);
    let (matrix, q) = lcp(&cantilever(law(), 0.0, Method::Lemke), &load, Form::Dual);
    assert_close(&matrix, &[8.0 / 15.0 + 1.0 / 30.0, 1.0, -1.0, 0.0], 1e-13);
    assert_close(&q, &[-8.0, 3.0], 1e-12);
    for method in METHODS {
        let found = solved(&cantilever(law(), 0.0, method), &load);
        assert_eq!(found.piece, [2]);
        assert_close(&found.reaction, &[3.0], 1e-12);
        // Total travel (15 − 3) 8/15, of which 0.1 is elastic.
        assert_close(&found.displacement.hi[15..16], &[6.4], 1e-12);
        assert_close(&found.gap, &[0.1 - 6.4], 1e-12);
    }
}

/// A rigid raft on three springs k = 1 at x = −1, 0, 1, with a force of 1 at x = 0.8, outside the kern |x| ≤ 2/3.
///
/// M = C⁻¹ − N(NᵀN)⁻¹Nᵀ with the rigid motions N; this is vvᵀ/6 with v = (1, −2, 1).
#[test]
fn a_tilted_raft() {
    let plate = strip(-1.0, 2, 12e9);
    let springs = [0, 1, 2].map(|i| (mean(i), Graph::one_sided(1.0), 0.0));
    let load = nodal(&plate, &[(mean(1), 0.2), (mean(2), 0.8)]);
    let (matrix, q) = lcp(&free(&plate, &springs, 1.0, Method::Lemke), &load, Form::Stiffness);
    let sixths = [1.0, -2.0, 1.0, -2.0, 4.0, -2.0, 1.0, -2.0, 1.0];
    assert_close(&matrix, &sixths.map(|value| value / 6.0), 1e-8);
    assert_close(&q, &[1.0 / 3.0 - 0.4, 1.0 / 3.0, 1.0 / 3.0 + 0.4], 1e-8);
    for method in METHODS {
        let found = solved(&free(&plate, &springs, 1.0, method), &load);
        assert_eq!(found.piece, [0, 1, 1]);
        assert_close(&found.reaction, &[0.0, 0.2, 0.8], 1e-12);
        // The raft is the line through the deflections 0.2 and 0.8.
        assert_close(&found.gap, &[0.4, 0.0, 0.0], 1e-8);
    }
}

/// A beam on rigid points at x = 0 and 1, with a force of 1 at 0.5 and a force t at −1. At t = 0.5 it tips about x = 0
/// until it touches a point at x = −1 that is 0.01 lower.
#[test]
fn a_jump() {
    let plate = strip(-1.0, 2, 12e6);
    let supports = [(0, 0.01), (1, 0.0), (2, 0.0)].map(|(i, gap)| (mean(i), Graph::one_sided(f64::INFINITY), gap));
    let start = nodal(&plate, &[(mean(1), 0.5), (mean(2), 0.5)]);
    let add = nodal(&plate, &[(mean(0), 1.0)]);
    for method in [Method::Lemke, Method::ActiveSet] {
        let problem = free(&plate, &supports, 1e6, method);
        let load = PathLoad { start: &start, add: &add, held_value: &vec![0.0; start.len()], end: 1.0 };
        let mut stops = Vec::new();
        let mut visit = |stop: signorini_core::contact::Stop| {
            stops.push((stop.t, stop.switched.to_vec(), stop.solution.clone()));
            true
        };
        assert_eq!(problem.path(&load, &mut visit, &mut |_| true).unwrap(), PathEnd::Reached, "{method:?}");
        let times: Vec<f64> = stops.iter().map(|(t, ..)| *t).collect();
        let switched: Vec<&[usize]> = stops.iter().map(|(_, switched, _)| &switched[..]).collect();
        assert_close(&times, &[0.0, 0.5, 0.5, 1.0], 1e-9);
        assert_eq!(switched, [&[][..], &[2], &[0], &[]], "{method:?}");
        let reactions = [[0.0, 0.5, 0.5], [0.0, 1.5, 0.0], [0.0, 1.5, 0.0], [0.5, 1.5, 0.0]];
        for ((_, _, found), reaction) in stops.iter().zip(reactions) {
            assert_close(&found.reaction, &reaction, 1e-8);
        }
        // Without bending, the tip at x = 1 would rise as much as the tip at x = −1 sinks.
        assert_close(&[stops[1].2.gap[2], stops[2].2.gap[2]], &[0.0, 0.01], 1e-5);
    }
}
