//! Quality of the meshes of typical plates, and the time taken: `cargo run --release --example figures [DIRECTORY]`.
//!
//! If a directory is given, the meshes are written to it as SVG.

use signorini_mesher::{Line, Loop, Mesh, MeshOptions, Point, Refinement, mesh};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::Instant;

fn polygon(name: &str, corners: Vec<Point>) -> Loop {
    let names = (1..=corners.len()).map(|i| if name.is_empty() { format!("edge {i}") } else { name.to_string() });
    Loop { through: vec![None; corners.len()], names: names.collect(), corners }
}

fn ellipse_like(name: &str, [x, y]: Point, [a, b]: [f64; 2]) -> Loop {
    let at = |turn: f64| [x + a * (TAU * turn).cos(), y + b * (TAU * turn).sin()];
    let corners: Vec<Point> = (0..4).map(|i| at(0.25 * f64::from(i))).collect();
    let through = (0..4).map(|i| Some(at(0.25 * f64::from(i) + 0.125))).collect();
    Loop { corners, through, names: vec![name.to_string(); 4] }
}

fn rectangle(name: &str, [x0, y0, x1, y1]: [f64; 4]) -> Loop {
    polygon(name, vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
}

fn turned(loops: &[Loop], degrees: f64) -> Vec<Loop> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turn = |[x, y]: Point| [cos * x - sin * y, sin * x + cos * y];
    loops
        .iter()
        .map(|ring| Loop {
            corners: ring.corners.iter().map(|&p| turn(p)).collect(),
            through: ring.through.iter().map(|p| p.map(turn)).collect(),
            names: ring.names.clone(),
        })
        .collect()
}

fn line(from: Point, to: Point) -> Line {
    Line { ends: [from, to], ..Line::default() }
}

/// A floor of 10 × 8 with two shafts and twenty columns; element sides follow the sides of the columns.
fn floor() -> (Vec<Loop>, Vec<Line>) {
    let loops = vec![
        polygon("", vec![[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [7.0, 5.0], [7.0, 8.0], [0.0, 8.0]]),
        rectangle("hole 1", [2.3, 2.6, 4.1, 3.9]),
        rectangle("hole 2", [5.2, 5.3, 6.3, 6.9]),
    ];
    let mut lines = Vec::new();
    for i in 0..5 {
        for j in 0..4 {
            let (x, y) = (0.3 + 2.3 * f64::from(i), 0.4 + 2.1 * f64::from(j));
            let c = rectangle("", [x, y, x + 0.4, y + 0.4]).corners;
            lines.extend((0..4).map(|k| line(c[k], c[(k + 1) % 4])));
        }
    }
    (loops, lines)
}

fn cases() -> Vec<(&'static str, Vec<Loop>, MeshOptions)> {
    let of = |size: f64| MeshOptions { size, ..MeshOptions::default() };
    let square = rectangle("edge", [0.0, 0.0, 10.0, 10.0]);
    let ell = polygon("", vec![[0.0, 0.0], [8.0, 0.0], [8.0, 4.0], [4.0, 4.0], [4.0, 8.0], [0.0, 8.0]]);
    let (floor, columns) = floor();
    let wedge = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        polygon("", vec![[0.0, 0.0], [4.0, 0.0], [4.0 * cos, 4.0 * sin]])
    };
    let skew = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        polygon("", vec![[0.0, 0.0], [6.0, 0.0], [6.0 + 4.0 * cos, 4.0 * sin], [4.0 * cos, 4.0 * sin]])
    };
    let rounded = Loop {
        corners: vec![[0.0, 0.0], [8.0, 0.0], [8.0, 4.0], [5.0, 6.0], [0.0, 6.0]],
        through: vec![None, None, Some([7.0, 6.0]), None, None],
        names: (1..=5).map(|i| format!("edge {i}")).collect(),
    };
    let at = |p: Point, size: f64| Refinement { from: p, to: p, size };
    vec![
        ("square", vec![square.clone()], of(0.5)),
        ("L", vec![ell.clone()], of(0.5)),
        ("L with a hole", vec![ell.clone(), rectangle("hole 1", [1.3, 1.2, 2.6, 2.9])], of(0.5)),
        ("floor .5", floor.clone(), MeshOptions { size: 0.5, lines: columns.clone(), ..of(0.5) }),
        ("floor .2", floor.clone(), MeshOptions { size: 0.2, lines: columns.clone(), ..of(0.2) }),
        ("floor .1", floor.clone(), MeshOptions { size: 0.1, lines: columns.clone(), ..of(0.1) }),
        ("floor at 30 degrees .2", turned(&floor, 30.0), of(0.2)),
        ("disc .5", vec![ellipse_like("rim", [0.0; 2], [2.0; 2])], of(0.5)),
        ("disc .2", vec![ellipse_like("rim", [0.0; 2], [2.0; 2])], of(0.2)),
        ("disc .1", vec![ellipse_like("rim", [0.0; 2], [2.0; 2])], of(0.1)),
        (
            "disc with a hole .1",
            vec![ellipse_like("rim", [0.0; 2], [1.0; 2]), ellipse_like("hole 1", [0.3, 0.1], [0.3; 2])],
            of(0.1),
        ),
        ("square, small hole", vec![square.clone(), ellipse_like("hole 1", [3.0, 4.0], [0.2; 2])], of(0.5)),
        ("skew 60 degrees", vec![skew(60.0)], of(0.3)),
        ("skew 30 degrees", vec![skew(30.0)], of(0.3)),
        ("equilateral triangle", vec![wedge(60.0)], of(0.3)),
        ("10 degree corner", vec![wedge(10.0)], of(0.1)),
        ("strip 10 x 0.3", vec![rectangle("edge", [0.0, 0.0, 10.0, 0.3])], of(0.5)),
        ("rounded corner", vec![rounded], of(0.4)),
        (
            "square, refined at a point",
            vec![square.clone()],
            MeshOptions { refinements: vec![at([3.0, 4.0], 0.05)], ..of(0.5) },
        ),
        (
            "square, refined at an edge",
            vec![square.clone()],
            MeshOptions { refinements: vec![Refinement { from: [10.0, 0.0], to: [10.0, 10.0], size: 0.1 }], ..of(0.5) },
        ),
        (
            "square, skew line",
            vec![square.clone()],
            MeshOptions { lines: vec![line([1.0, 1.0], [9.0, 6.0])], ..of(0.5) },
        ),
        ("square of 100,000", vec![square.clone()], of(10.0 / 316.3)),
        ("disc of 100,000", vec![ellipse_like("rim", [0.0; 2], [2.0; 2])], of(0.0112)),
        ("floor of 100,000", turned(&floor, 17.0), of(0.0255)),
    ]
}

fn svg(mesh: &Mesh) -> String {
    let low = mesh.points.iter().fold([f64::INFINITY; 2], |l, p| [l[0].min(p[0]), l[1].min(p[1])]);
    let high = mesh.points.iter().fold([f64::NEG_INFINITY; 2], |h, p| [h[0].max(p[0]), h[1].max(p[1])]);
    let zoom = 1000.0 / (high[0] - low[0]).max(high[1] - low[1]);
    let at = |n: usize| (10.0 + zoom * (mesh.points[n][0] - low[0]), 10.0 + zoom * (high[1] - mesh.points[n][1]));
    let mut text = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1020\" height=\"1020\">\n");
    for element in &mesh.elements {
        let fill = if element[2] == element[3] { "#f90" } else { "#eee" };
        let (x, y) = at(element[0]);
        let _ = write!(text, "<path fill=\"{fill}\" stroke=\"#333\" stroke-width=\"0.6\" d=\"M{x:.2} {y:.2}");
        for i in 0..4 {
            let (p, m, q) = (at(element[i]), at(element[4 + i]), at(element[(i + 1) % 4]));
            let control = (2.0 * m.0 - 0.5 * (p.0 + q.0), 2.0 * m.1 - 0.5 * (p.1 + q.1));
            let _ = write!(text, " Q{:.2} {:.2} {:.2} {:.2}", control.0, control.1, q.0, q.1);
        }
        text.push_str("\"/>\n");
    }
    text + "</svg>\n"
}

fn main() {
    let directory = std::env::args().nth(1);
    println!("{:28}{:>10}{:>12}{:>12}{:>8}", "case", "elements", "in quads", "least angle", "ms");
    for (name, loops, options) in cases() {
        let start = Instant::now();
        let made = mesh(&loops, &options).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        let time = start.elapsed().as_secs_f64() * 1e3;
        let (count, share) = (made.elements.len(), 100.0 * made.quadrilaterals);
        println!("{name:28}{count:>10}{share:>11.2}%{:>12.1}{time:>8.0}", made.least_angle);
        if let Some(directory) = directory.as_ref().filter(|_| count < 20_000) {
            let file = format!("{directory}/{}.svg", name.replace(' ', "-"));
            std::fs::write(&file, svg(&made)).unwrap_or_else(|error| panic!("{file}: {error}"));
        }
    }
}
