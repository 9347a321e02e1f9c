//! Fuzz targets, which make problems from bytes; core/tests/fuzz_corpus.rs runs them on the corpus.
use signorini_core::contact::{
    ContactProblem, ContactSolution, Form, Graph, Load, Method, Points, Settings, Supported,
};
use signorini_core::element::{Kind, Layered, Material, Thickness};
use signorini_core::lcp::{Lcp, LcpStatus, LemkeOptions, lemke, lemke_from, parametric};
use signorini_core::plate::Plate;
use signorini_core::rows::{Rows, Springs};
use std::sync::Arc;

/// A reader of bytes; after the end it returns zeros.
struct Bytes<'a>(std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        *self.0.next().unwrap_or(&0)
    }

    fn below(&mut self, limit: usize) -> usize {
        usize::from(self.byte()) % limit
    }

    /// Usually a small number, sometimes one that is extreme or not finite.
    fn number(&mut self) -> f64 {
        match self.byte() {
            byte @ 0..=239 => f64::from(byte) / 16.0 - 7.0,
            240..=244 => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
            245 => f64::NAN,
            246 => f64::INFINITY,
            247 => -1e300,
            248 => 1e-300,
            249 => -0.0,
            byte => 10f64.powi(i32::from(byte) - 248),
        }
    }

    fn numbers(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.number()).collect()
    }

    fn flags(&mut self, count: usize) -> Vec<bool> {
        (0..count).map(|_| self.byte() & 1 == 1).collect()
    }
}

/// Makes a linear complementarity problem of up to seven pairs, some with arrays of wrong lengths. It is solved by a
/// cold and a warm start; then a parametric path along a direction of q is followed.
pub fn linear_complementarity(data: &[u8]) {
    let mut bytes = Bytes(data.iter());
    let order = bytes.below(8);
    let (rows, more) = (order + usize::from(bytes.byte() == 255), usize::from(bytes.byte() == 255));
    let matrix = bytes.numbers(rows * order + more);
    let q = bytes.numbers(order);
    let Ok(problem) = Lcp::new(&matrix, &q) else { return };
    let covering = (bytes.byte() & 1 == 1).then(|| bytes.numbers(order + more));
    let options = LemkeOptions { covering: covering.as_deref(), max_pivots: Some(bytes.below(200)) };
    let basis = bytes.flags(order + more);
    for answer in [lemke(&problem, &options), lemke_from(&problem, &options, &basis)].into_iter().flatten() {
        if answer.status == LcpStatus::Solved {
            assert!(answer.z.iter().chain(&answer.w).all(|v| *v >= 0.0 && v.is_finite()), "{answer:?}");
            assert!(answer.z.iter().zip(&answer.w).all(|(z, w)| *z == 0.0 || *w == 0.0), "{answer:?}");
            let (direction, end) = (bytes.numbers(order + more), bytes.number());
            let Ok(path) = parametric(&problem, &direction, &answer.basis, end, &mut |_| true) else { continue };
            let mut reached = 0.0;
            for segment in &path.segments {
                assert!(segment.from == reached && segment.to > segment.from, "{path:?}");
                reached = segment.to;
            }
        }
    }
}

/// Makes two elements on up to four points; the bytes determine distortion, fixed dofs, laws and load. It is solved by
/// all three methods.
pub fn contact(data: &[u8]) {
    let mut bytes = Bytes(data.iter());
    let mut points: Vec<[f64; 2]> = [(0, 0), (2, 0), (4, 0), (0, 2), (2, 2), (4, 2), (1, 0)]
        .into_iter()
        .chain([(3, 0), (0, 1), (2, 1), (4, 1), (1, 2), (3, 2)])
        .map(|(x, y)| [0.5 * f64::from(x), 0.5 * f64::from(y)])
        .collect();
    for _ in 0..bytes.below(3) {
        let (node, axis) = (bytes.below(points.len()), bytes.below(2));
        points[node][axis] += bytes.number() / 40.0;
    }
    let mut elements = vec![[0, 1, 4, 3, 6, 9, 11, 8], [1, 2, 5, 4, 7, 10, 12, 9]];
    if bytes.byte() > 250 {
        elements[0][bytes.below(8)] = bytes.below(20);
    }
    let odd = (bytes.byte() > 240).then(|| (bytes.below(13), bytes.number()));
    let material = Material::isotropic(1000.0, 0.3, 5.0 / 6.0);
    let kind = if bytes.byte() & 1 == 0 { Kind::Mitc9 } else { Kind::Q8r };
    let mut at_points = vec![0.2; 2 * kind.points().len()];
    if let Some((index, value)) = odd {
        let count = at_points.len();
        at_points[index % count] = value;
    }
    let thickness = Thickness::Varying { at_points, layered: Layered::default() };
    let Ok(plate) = Plate::new(points, elements, thickness, material, kind, None) else { return };
    let plate = Arc::new(plate);
    let count = bytes.below(5);
    let (mut points, mut rows, mut delta) = (Points::default(), Rows::default(), Vec::new());
    for i in 0..count {
        let (xi, eta) = (f64::from(bytes.byte()) / 127.5 - 1.0, f64::from(bytes.byte()) / 127.5 - 1.0);
        let element = bytes.below(2);
        rows.element.push(element);
        rows.coefficient.push(plate.interpolation_row(element, xi, eta, 0).0);
        // Vertices (travel, force), which may decrease, and slopes at the ends.
        let vertices = (0..bytes.below(4)).map(|_| [bytes.number(), bytes.number()]).collect();
        let ends = [bytes.number(), if bytes.byte() & 1 == 0 { f64::INFINITY } else { bytes.number() }];
        let Ok(graph) = Graph::new(vertices, ends) else { return };
        let graph = points.add_graph(graph);
        let (shift, weight) = (bytes.number(), 1.0 + f64::from(bytes.byte()));
        points.push_row(&plate, &rows, i, graph, shift, weight);
        delta.push(if bytes.byte() & 1 == 0 { 0.0 } else { 10.0 });
    }
    let mut held = vec![false; plate.dof_count()];
    for _ in 0..bytes.below(8) {
        held[bytes.below(plate.dof_count())] = true;
    }
    let springs = Springs {
        rows: Rows {
            element: vec![0],
            coefficient: vec![plate.interpolation_row(0, 0.1, 0.2, 0).0],
            ..Rows::default()
        },
        stiffness: vec![f64::from(bytes.byte())],
        base: vec![0.1],
    };
    let load: Vec<f64> = (0..plate.dof_count()).map(|_| bytes.number()).collect();
    let values = vec![0.0; plate.dof_count()];
    for method in [Method::Lemke, Method::ActiveSet, Method::Saddle] {
        let (springs, held, points, delta) = (springs.clone(), held.clone(), points.clone(), delta.clone());
        let on = Supported { springs, held, points, delta, free_motions: Vec::new() };
        let Ok(problem) = ContactProblem::new(plate.clone(), on, method, usize::MAX) else { continue };
        for form in [None, Some(Form::Dual), Some(Form::Stiffness)] {
            let at_rest = Load { nodal: &load, held_value: &values };
            let Ok(answer) = problem.solve(&at_rest, &Settings { form }, None, &mut |_| true) else { continue };
            meets_the_conditions(&problem, &load, &answer);
        }
    }
}

/// Asserts that a solution satisfies equilibrium and the points' laws, if no load, shift or weight exceeds 1e6.
fn meets_the_conditions(problem: &ContactProblem, load: &[f64], answer: &ContactSolution) {
    let size = load.iter().chain(&problem.points.shift).chain(&problem.points.weight);
    if size.clone().any(|value| value.abs() > 1e6) {
        return;
    }
    let (forces, points) = problem.violations(load, answer);
    let worst = |values: &[f64], is_free: &dyn Fn(usize) -> bool| {
        (0..values.len()).filter(|&i| is_free(i)).fold(0.0, |worst: f64, i| worst.max(values[i].abs()))
    };
    let (forces, points) = (worst(&forces, &|dof| !problem.held[dof]), worst(&points, &|_| true));
    assert!(forces <= 1e-8 && points <= 1e-8, "{forces:e} {points:e}");
}
