//! Plates on top of each other: two meshes in one plate, coupled by contact points over two elements.
use signorini_core::contact::{ContactProblem, ContactSolution, Graph, Load, Method, Points, Settings, Supported};
use signorini_core::element::{Kind, Material, Thickness};
use signorini_core::plate::Plate;
use signorini_core::rows::{Rows, Springs};
use std::sync::Arc;

/// Squares of side 1 at the same position, each of n × n elements.
fn squares(sizes: &[usize]) -> Arc<Plate> {
    let (mut points, mut elements) = (Vec::new(), Vec::new());
    for &n in sizes {
        let columns = 2 * n + 1;
        let mut number = vec![usize::MAX; columns * columns];
        for k in (0..columns * columns).filter(|k| k % columns % 2 == 0 || k / columns % 2 == 0) {
            number[k] = points.len();
            let at = |k: usize| k as f64 / (2 * n) as f64;
            points.push([at(k % columns), at(k / columns)]);
        }
        let corner = |e: usize| 2 * (e / n) * columns + 2 * (e % n);
        let nodes = [0, 2, 2 * columns + 2, 2 * columns, 1, columns + 2, 2 * columns + 1, columns];
        elements.extend((0..n * n).map(|e| nodes.map(|offset| number[corner(e) + offset])));
    }
    let material = Material::isotropic(1000.0, 0.3, 5.0 / 6.0);
    Arc::new(Plate::new(points, elements, Thickness::Constant(0.05), material, Kind::Mitc9, None).unwrap())
}

/// Element, and row of the deflection at (x, y), of an n × n square whose elements begin with number `first`.
fn deflection(plate: &Plate, first: usize, n: usize, [x, y]: [f64; 2]) -> (usize, [f64; 24]) {
    let cell = |x: f64| ((n as f64 * x) as usize).min(n - 1);
    let local = |x: f64| 2.0 * (n as f64 * x - cell(x) as f64) - 1.0;
    let element = first + n * cell(y) + cell(x);
    (element, plate.interpolation_row(element, local(x), local(y), 0).0)
}

/// Gauss points of all elements of an n × n square.
fn places(n: usize) -> impl Iterator<Item = [f64; 2]> {
    let at = move |k: usize| ((k / 2) as f64 + [0.211, 0.789][k % 2]) / n as f64;
    (0..4 * n * n).map(move |k| [at(k % (2 * n)), at(k / (2 * n))])
}

/// Rows of the relative deflection w₂ − w₁ of two squares; the elements of square 1 come first.
fn between(plate: &Plate, [below, above]: [usize; 2]) -> Rows {
    let mut rows = Rows::default();
    for place in places(above) {
        let (element, row) = deflection(plate, below * below, above, place);
        let (other, other_row) = deflection(plate, 0, below, place);
        rows.further.insert(rows.len(), vec![(other, other_row.map(|c| -c))]);
        rows.element.push(element);
        rows.coefficient.push(row);
    }
    rows
}

/// Two free squares: the first on soil that only pushes up, the second on a layer on the first that only pushes them
/// apart.
///
/// If `wide`, the rows of the layer are given over arbitrary dofs. If `at_edge`, the left edge of the first square is
/// fixed.
fn layered_at(at_edge: bool, sizes: [usize; 2], soil: f64, layer: f64, wide: bool, method: Method) -> ContactProblem {
    let plate = squares(&sizes);
    let [below, above] = sizes;
    let mut points = Points::default();
    let law = points.add_graph(Graph::one_sided(1.0));
    let mut on_soil = Rows::default();
    for place in places(below) {
        let (element, row) = deflection(&plate, 0, below, place);
        on_soil.element.push(element);
        on_soil.coefficient.push(row);
        points.push_row(&plate, &on_soil, on_soil.len() - 1, law, 0.0, soil / (4 * below * below) as f64);
    }
    let rows = between(&plate, sizes);
    for i in 0..rows.len() {
        let weight = layer / (4 * above * above) as f64;
        if wide {
            points.push(rows.entries(&plate, i), law, 0.0, weight);
        } else {
            points.push_row(&plate, &rows, i, law, 0.0, weight);
        }
    }
    let delta = (0..points.len()).map(|i| points.weight[i]).collect();
    let on_edge = |dof: usize| dof % 3 == 0 && plate.components().of(dof / 3) == 0 && plate.point(dof / 3)[0] == 0.0;
    let held: Vec<bool> = (0..plate.dof_count()).map(|dof| at_edge && on_edge(dof)).collect();
    let motion = |second: bool, of: fn([f64; 2]) -> [f64; 3]| -> Vec<f64> {
        let at = |n: usize| if plate.components().of(n) == usize::from(second) { of(plate.point(n)) } else { [0.0; 3] };
        (0..plate.node_count()).flat_map(at).collect()
    };
    let mut free_motions = Vec::new();
    for second in [false, true] {
        free_motions.push(motion(second, |_| [1.0, 0.0, 0.0]));
        free_motions.push(motion(second, |p| [p[0] - 0.5, 1.0, 0.0]));
        free_motions.push(motion(second, |p| [p[1] - 0.5, 0.0, 1.0]));
    }
    let on = Supported { springs: Springs::default(), held, points, delta, free_motions };
    ContactProblem::new(plate, on, method, usize::MAX).unwrap()
}

fn layered(sizes: [usize; 2], soil: f64, layer: f64, wide: bool, method: Method) -> ContactProblem {
    layered_at(false, sizes, soil, layer, wide, method)
}

/// The first square on two-sided soil springs, and further `springs`.
fn on_springs(plate: Arc<Plate>, below: usize, mut springs: Springs) -> ContactProblem {
    for place in places(below) {
        let mut row = Rows::default();
        let (element, coefficient) = deflection(&plate, 0, below, place);
        row.element.push(element);
        row.coefficient.push(coefficient);
        springs.push(&row, 0, 1.0 / (4 * below * below) as f64, 0.0);
    }
    let held = vec![false; plate.dof_count()];
    let on = Supported { springs, held, points: Points::default(), delta: Vec::new(), free_motions: Vec::new() };
    ContactProblem::new(plate, on, Method::Lemke, usize::MAX).unwrap()
}

fn load(plate: &Plate, [below, above]: [usize; 2], at: [f64; 2], force: f64) -> Vec<f64> {
    let (element, row) = deflection(plate, below * below, above, at);
    let mut out = vec![0.0; plate.dof_count()];
    row.iter().enumerate().for_each(|(j, c)| out[3 * plate.elements()[element][j / 3] + j % 3] += force * c);
    out
}

fn solved(problem: &ContactProblem, load: &[f64]) -> ContactSolution {
    let load = Load { nodal: load, held_value: &vec![0.0; load.len()] };
    problem.solve(&load, &Settings::default(), None, &mut |_| true).unwrap()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) / largest(b)
}

/// Positions of two loads: the first lifts edges, the second does not.
const LOADED: [[f64; 2]; 2] = [[0.8, 0.6], [0.55, 0.5]];

const METHODS: [Method; 3] = [Method::Lemke, Method::ActiveSet, Method::Saddle];

#[test]
fn a_layer_between_meshes_that_do_not_match_is_its_springs_one_by_one() {
    let (sizes, soil) = ([4, 3], 1.0);
    for at in LOADED {
        let wide = layered(sizes, soil, 5.0, true, Method::Lemke);
        let load = load(&wide.plate, sizes, at, 1.0);
        let expected = solved(&wide, &load);
        for method in METHODS {
            let problem = layered(sizes, soil, 5.0, false, method);
            let found = solved(&problem, &load);
            assert_eq!(&found.piece, &expected.piece, "{method:?}");
            assert!(apart(&found.displacement.hi, &expected.displacement.hi) < 1e-10, "{method:?}");
            assert!(apart(&found.reaction, &expected.reaction) < 1e-10, "{method:?}");
        }
    }
}

#[test]
fn a_layer_of_springs_both_ways_is_one_of_points_that_stay_closed() {
    let (sizes, at) = ([4, 3], LOADED[1]);
    let points = layered(sizes, 1.0, 5.0, false, Method::ActiveSet);
    let load = load(&points.plate, sizes, at, 1.0);
    let expected = solved(&points, &load);
    assert!(expected.piece.iter().all(|&piece| piece == 1));
    let mut springs = Springs::default();
    let rows = between(&points.plate, sizes);
    (0..rows.len()).for_each(|i| springs.push(&rows, i, 5.0 / rows.len() as f64, 0.0));
    let problem = on_springs(points.plate.clone(), sizes[0], springs);
    let found = solved(&problem, &load);
    assert!(apart(&found.displacement.hi, &expected.displacement.hi) < 1e-10);
}

/// Bound: at best, two equal plates double the rows and columns of every block of the factor, so it has four times the
/// entries.
#[test]
fn plates_on_one_another_share_separators() {
    let alone = on_springs(squares(&[20]), 20, Springs::default()).factor_size().0;
    for above in [20, 17] {
        let coupled = layered([20, above], 1.0, 5.0, false, Method::ActiveSet).factor_size().0;
        let ratio = coupled as f64 / alone as f64;
        assert!(ratio < 4.2, "{above}: {ratio}");
    }
}

/// The layer is soft, but stiffer than the rounding errors of the factor.
#[test]
fn a_layer_far_softer_than_soft_soil_moves_a_plate_as_one_body() {
    let sizes = [4, 3];
    for at in LOADED {
        for (soil, part) in [(1.0, 1e-6), (1e-3, 1e-3), (1e-6, 1.0), (1e-6, 1e-6), (1e-9, 1e-3)] {
            let problem = layered(sizes, soil, part * soil, false, Method::ActiveSet);
            let load = load(&problem.plate, sizes, at, 1e-3 * soil);
            let found = solved(&problem, &load);
            let (forces, points) = problem.violations(&load, &found);
            assert!(largest(&forces).max(largest(&points)) < 1e-13, "{soil:e} {part:e}");
            let total: f64 = found.reaction[..4 * sizes[0] * sizes[0]].iter().sum();
            assert!((total / (1e-3 * soil) - 1.0).abs() < 1e-12, "{soil:e} {part:e}: {total:e}");
        }
    }
}

/// The fixed edge of the first plate does not hold the second.
#[test]
fn a_layer_far_softer_than_a_plate_that_is_held_moves_the_other_as_one_body() {
    let sizes = [4, 3];
    for at in LOADED {
        for layer in [1e-3, 1e-6, 1e-9, 1e-12] {
            let problem = layered_at(true, sizes, 1.0, layer, false, Method::ActiveSet);
            let load = load(&problem.plate, sizes, at, 1e-3 * layer);
            let found = solved(&problem, &load);
            let (forces, points) = problem.violations(&load, &found);
            assert!(largest(&forces).max(largest(&points)) < 1e-13, "{layer:e}");
            let total: f64 = found.reaction[4 * sizes[0] * sizes[0]..].iter().sum();
            assert!((total / (1e-3 * layer) - 1.0).abs() < 1e-12, "{layer:e}: {total:e}");
        }
    }
}

/// The fixed deflections tilt the first plate and lower the second; neither may bend.
#[test]
fn plates_go_with_what_each_is_held_at() {
    let plate = squares(&[4, 3]);
    let second = (0..plate.node_count()).filter(|&node| plate.components().of(node) == 1);
    let (mut held, mut value) = (vec![false; plate.dof_count()], vec![0.0; plate.dof_count()]);
    let of_first = (0..plate.node_count()).filter(|&node| plate.components().of(node) == 0);
    for (node, slope) in of_first.map(|node| (node, 0.25)).chain(second.map(|node| (node, 0.0))) {
        let x = plate.point(node)[0];
        if x == 0.0 || x == 1.0 {
            held[3 * node] = true;
            value[3 * node] = if slope > 0.0 { slope * x } else { 7.0 };
        }
    }
    let on = Supported {
        springs: Springs::default(),
        held,
        points: Points::default(),
        delta: Vec::new(),
        free_motions: Vec::new(),
    };
    let problem = ContactProblem::new(plate, on, Method::Lemke, usize::MAX).unwrap();
    let moved = Load { nodal: &vec![0.0; value.len()], held_value: &value };
    let found = problem.solve(&moved, &Settings::default(), None, &mut |_| true).unwrap();
    for node in 0..problem.plate.node_count() {
        let [x, _] = problem.plate.point(node);
        let expected = if problem.plate.components().of(node) == 0 { [0.25 * x, 0.25, 0.0] } else { [7.0, 0.0, 0.0] };
        for k in 0..3 {
            assert!((found.displacement.hi[3 * node + k] - expected[k]).abs() < 1e-15, "node {node}");
        }
    }
}
