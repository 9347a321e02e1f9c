//! Meshes of typical plates, and invalid outlines.

use signorini_mesher::{Line, Loop, Mesh, MeshError, MeshOptions, Point, Refinement, mesh};
use std::f64::consts::TAU;

fn polygon(corners: &[Point]) -> Loop {
    let names = (1..=corners.len()).map(|i| format!("edge {i}")).collect();
    Loop { corners: corners.to_vec(), through: vec![None; corners.len()], names }
}

fn hole(corners: &[Point], number: usize) -> Loop {
    Loop { names: vec![format!("hole {number}"); corners.len()], ..polygon(corners) }
}

fn circle(name: &str, [x, y]: Point, radius: f64) -> Loop {
    let at = |turn: f64| [x + radius * (TAU * turn).cos(), y + radius * (TAU * turn).sin()];
    Loop {
        corners: (0..4).map(|i| at(0.25 * f64::from(i))).collect(),
        through: (0..4).map(|i| Some(at(0.25 * f64::from(i) + 0.125))).collect(),
        names: vec![name.to_string(); 4],
    }
}

fn box_of([x0, y0]: Point, [x1, y1]: Point) -> Vec<Point> {
    vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

fn of(size: f64) -> MeshOptions {
    MeshOptions { size, ..MeshOptions::default() }
}

fn made(loops: &[Loop], options: &MeshOptions) -> Mesh {
    mesh(loops, options).unwrap_or_else(|fault| panic!("{fault}"))
}

fn refused(loops: &[Loop]) -> MeshError {
    mesh(loops, &of(0.5)).map(|mesh| mesh.elements.len()).unwrap_err()
}

fn turned(loops: &[Loop], degrees: f64) -> Vec<Loop> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turn = |[x, y]: Point| [cos * x - sin * y, sin * x + cos * y];
    loops.iter().map(|ring| Loop { corners: ring.corners.iter().map(|&p| turn(p)).collect(), ..ring.clone() }).collect()
}

/// Straight lines with increasing ranks.
fn lines(ends: &[[Point; 2]]) -> Vec<Line> {
    ends.iter().enumerate().map(|(rank, &ends)| Line { ends, rank, ..Line::default() }).collect()
}

/// Number of element corners on the straight line through a and b.
fn nodes_on(mesh: &Mesh, a: Point, b: Point) -> usize {
    let length = f64::hypot(b[0] - a[0], b[1] - a[1]);
    let mut nodes: Vec<usize> = mesh.elements.iter().flat_map(|e| e[..4].to_vec()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let on = |p: Point| {
        let off = ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / length;
        let along = ((b[0] - a[0]) * (p[0] - a[0]) + (b[1] - a[1]) * (p[1] - a[1])) / length;
        off.abs() < 1e-9 && along > -1e-9 && along < length + 1e-9
    };
    nodes.into_iter().filter(|&node| on(mesh.points[node])).count()
}

#[test]
fn a_rectangle_has_the_regular_mesh_at_any_angle() {
    let plate = [polygon(&box_of([1.0, 2.0], [7.0, 5.0]))];
    for degrees in [0.0, 17.0, 45.0, 123.4] {
        let mesh = made(&turned(&plate, degrees), &of(0.5));
        assert_eq!((mesh.elements.len(), mesh.points.len(), mesh.sides.len()), (72, 253, 36), "{degrees}");
        assert!(mesh.quadrilaterals == 1.0 && mesh.least_angle > 90.0 - 1e-6);
    }
    let straight = made(&plate, &of(0.5));
    let off = straight.points.iter().flatten().map(|x| (4.0 * x - (4.0 * x).round()).abs()).fold(0.0, f64::max);
    assert!(off < 1e-14, "its nodes are those of the grid but for {off}");
}

#[test]
fn orthogonal_slabs_are_all_but_quadrilaterals_at_any_angle() {
    let slab = [
        polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [7.0, 5.0], [7.0, 8.0], [0.0, 8.0]]),
        hole(&box_of([2.3, 2.6], [4.1, 3.9]), 1),
        hole(&box_of([5.2, 5.3], [6.3, 6.9]), 2),
    ];
    for degrees in [0.0, 30.0, 71.0] {
        for size in [0.5, 0.2, 0.1] {
            let mesh = made(&turned(&slab, degrees), &of(size));
            assert!(mesh.quadrilaterals > 0.99 && mesh.least_angle > 40.0, "{degrees} {size}: {mesh:?}");
        }
    }
}

#[test]
fn discs_skew_plates_and_triangles_are_all_but_quadrilaterals() {
    let skew = |degrees: f64| {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        [polygon(&[[0.0, 0.0], [6.0, 0.0], [6.0 + 4.0 * cos, 4.0 * sin], [4.0 * cos, 4.0 * sin]])]
    };
    let triangle = |p: Point, q: Point| [polygon(&[[0.0, 0.0], p, q])];
    let turn = |degrees: f64| [4.0 * f64::to_radians(degrees).cos(), 4.0 * f64::to_radians(degrees).sin()];
    for (loops, size, share, angle) in [
        (vec![circle("rim", [3.0, 1.0], 2.0)], 0.5, 0.97, 40.0),
        (vec![circle("rim", [3.0, 1.0], 2.0)], 0.2, 0.98, 40.0),
        (vec![circle("rim", [0.0, 0.0], 1.0), circle("hole 1", [0.3, 0.1], 0.3)], 0.05, 0.98, 40.0),
        (skew(60.0).to_vec(), 0.3, 1.0, 60.0),
        (skew(45.0).to_vec(), 0.3, 1.0, 45.0),
        (triangle([4.0, 0.0], turn(60.0)).to_vec(), 0.5, 0.95, 40.0),
        (triangle(turn(22.0), turn(82.0)).to_vec(), 0.5, 0.95, 40.0),
        (triangle([4.0, 0.0], [0.0, 3.0]).to_vec(), 0.5, 0.95, 36.8),
        (triangle([4.0, 0.0], [1.7, 3.0]).to_vec(), 0.5, 0.93, 40.0),
        (triangle([4.0, 0.0], [1.2, 1.6]).to_vec(), 0.25, 0.95, 29.7),
    ] {
        let mesh = made(&loops, &of(size));
        let (found, least) = (mesh.quadrilaterals, mesh.least_angle);
        assert!(found > share - 1e-9 && least > angle - 1e-6, "{loops:?}: {found} {least}");
    }
}

#[test]
fn a_parallelogram_has_the_mesh_of_its_lattice() {
    for degrees in [45.0, 60.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let mesh = made(&[polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0 + cos, sin], [cos, sin]])], &of(0.1));
        assert_eq!((mesh.elements.len(), mesh.quadrilaterals), (100, 1.0));
        assert!((mesh.least_angle - degrees).abs() < 1e-9);
    }
}

#[test]
fn all_nodes_of_arcs_are_on_them_and_sides_keep_their_names() {
    let loops = [polygon(&box_of([0.0, 0.0], [4.0, 4.0])), circle("hole 1", [1.5, 2.0], 0.7)];
    let mesh = made(&loops, &of(0.4));
    for (side, of) in mesh.sides.iter().zip(&mesh.side_of) {
        for &node in side {
            let [x, y] = mesh.points[node];
            let off = match of {
                [0, side] => [y, 4.0 - x, 4.0 - y, x][*side],
                _ => f64::hypot(x - 1.5, y - 2.0) - 0.7,
            };
            assert!(off.abs() < 1e-14, "{of:?} {x} {y}");
        }
    }
    // Counter-clockwise around the outline, clockwise around the hole, so that the plate is on the left.
    let turn = |ring: usize| -> f64 {
        let sides = mesh.sides.iter().zip(&mesh.side_of).filter(|(_, of)| of[0] == ring);
        sides
            .map(|([a, _, b], _)| mesh.points[*a][0] * mesh.points[*b][1] - mesh.points[*a][1] * mesh.points[*b][0])
            .sum()
    };
    assert!(turn(0) > 0.0 && turn(1) < 0.0);
}

#[test]
fn corners_may_run_either_way_round() {
    let corners = [[0.0, 0.0], [5.0, 0.0], [4.0, 3.0], [0.0, 2.0]];
    let mut back = polygon(&corners);
    back.corners.reverse();
    let (mesh, other) = (made(&[polygon(&corners)], &of(0.5)), made(&[back], &of(0.5)));
    assert_eq!(mesh.elements.len(), other.elements.len());
    // Corner 1 is now [0, 2], and the first edge is the oblique one.
    let first: Vec<usize> = (0..other.sides.len()).filter(|&i| other.side_of[i][1] == 0).collect();
    assert!(
        first
            .iter()
            .all(|&i| (other.points[other.sides[i][1]][1] - 2.0 - 0.25 * other.points[other.sides[i][1]][0]).abs()
                < 1e-12)
    );
}

#[test]
fn lines_with_room_are_followed_and_others_left() {
    let plate = [polygon(&box_of([0.0, 0.0], [8.0, 6.0]))];
    let ends =
        [[[1.3, 1.0], [6.2, 4.5]], [[2.0, 5.0], [10.0, 5.0]], [[2.0, 4.9], [7.0, 4.9]], [[1.0, 0.0], [5.0, 0.0]]];
    let mesh = made(&plate, &MeshOptions { lines: lines(&ends), points: vec![[6.5, 1.1]], ..of(0.5) });
    assert!(nodes_on(&mesh, ends[0][0], ends[0][1]) >= 12);
    assert_eq!(nodes_on(&mesh, [2.0, 5.0], [8.0, 5.0]), 13);
    assert_eq!(nodes_on(&mesh, ends[2][0], ends[2][1]), 0, "it is too near to the one before it");
    assert!(mesh.points.contains(&[6.5, 1.1]));
    assert!(mesh.least_angle > 35.0 && mesh.quadrilaterals > 0.93);
}

#[test]
fn walls_are_followed_but_where_they_come_too_near_to_something() {
    let plate = [polygon(&box_of([0.0, 0.0], [8.0, 6.0]))];
    // The first wall ends near the upper edge; the second passes near the end of the first.
    let mut walls = lines(&[[[2.0, 1.0], [5.0, 5.95]], [[0.5, 0.9], [7.5, 0.9]]]);
    walls.iter_mut().for_each(|wall| wall.in_part = true);
    let mesh = made(&plate, &MeshOptions { lines: walls, ..of(0.5) });
    assert!(nodes_on(&mesh, [2.0, 1.0], [4.6, 5.29]) >= 10);
    assert!(nodes_on(&mesh, [0.5, 0.9], [1.6, 0.9]) >= 3 && nodes_on(&mesh, [2.4, 0.9], [7.5, 0.9]) >= 10);
    assert!(mesh.least_angle > 25.0);
}

#[test]
fn arcs_are_followed_within_the_plate_and_their_sides_are_round() {
    let plate = [polygon(&box_of([0.0, 0.0], [8.0, 6.0])), hole(&box_of([5.2, 1.0], [6.4, 2.0]), 1)];
    let ring = |centre: Point, radius: f64| -> Vec<Line> {
        let Loop { corners, through, .. } = circle("", centre, radius);
        let ends = |i: usize| [corners[i], corners[(i + 1) % 4]];
        (0..4).map(|i| Line { ends: ends(i), through: through[i], ..Line::default() }).collect()
    };
    for (centre, radius, part) in [([3.0, 3.0], 1.7, 1.0), ([0.0, 0.0], 2.5, 0.25), ([5.8, 3.0], 1.5, 0.882)] {
        let mesh = made(&plate, &MeshOptions { lines: ring(centre, radius), ..of(0.5) });
        let off = |node: usize| f64::hypot(mesh.points[node][0] - centre[0], mesh.points[node][1] - centre[1]) - radius;
        let on = |node: usize| off(node).abs() < 1e-12;
        let mut length = 0.0;
        let corners = |e: &[usize; 8]| if e[2] == e[3] { vec![0, 1, 3] } else { vec![0, 1, 2, 3] };
        for e in &mesh.elements {
            for i in corners(e) {
                let [a, b] = [e[i], e[(i + 1) % 4]];
                if on(a) && on(b) {
                    assert!(on(e[4 + i]), "a side of an arc is straight");
                    length += f64::hypot(mesh.points[a][0] - mesh.points[b][0], mesh.points[a][1] - mesh.points[b][1]);
                }
            }
        }
        let whole = 2.0 * TAU * radius * part;
        assert!((length - whole).abs() < 0.02 * whole, "{length} of {whole} around {centre:?}");
        assert!(mesh.least_angle > 30.0, "{}", mesh.least_angle);
    }
}

#[test]
fn elements_are_smaller_where_that_is_asked_for_and_grow_slowly() {
    let plate = [polygon(&box_of([0.0, 0.0], [8.0, 6.0]))];
    let finest = Refinement { from: [3.0, 2.0], to: [3.0, 2.0], size: 0.05 };
    let mesh = made(&plate, &MeshOptions { refinements: vec![finest], ..of(0.5) });
    for element in &mesh.elements {
        for i in (0..4).filter(|&i| element[i] != element[(i + 1) % 4]) {
            let [p, q] = [element[i], element[(i + 1) % 4]].map(|node| mesh.points[node]);
            let away = f64::hypot(0.5 * (p[0] + q[0]) - 3.0, 0.5 * (p[1] + q[1]) - 2.0);
            let length = f64::hypot(p[0] - q[0], p[1] - q[1]);
            assert!(length < 2.2 * (0.05 + 0.25 * away).min(0.5), "{length} at {away}");
        }
    }
    assert!(mesh.elements.len() < 800, "{}", mesh.elements.len());
}

#[test]
fn the_same_plate_has_the_same_bits() {
    let loops = [circle("rim", [0.0, 0.0], 3.0), hole(&box_of([-1.0, -0.5], [0.3, 0.9]), 1)];
    let options = MeshOptions { lines: lines(&[[[1.0, -1.0], [2.0, 1.5]]]), ..of(0.11) };
    let (one, two) = (made(&loops, &options), made(&loops, &options));
    assert_eq!((one.points, one.elements, one.sides), (two.points, two.elements, two.sides));
}

#[test]
fn bad_outlines_are_refused_with_side_place_and_remedy() {
    let plate = polygon(&box_of([0.0, 0.0], [4.0, 4.0]));
    let inner = |low: Point, high: Point, number: usize| hole(&box_of(low, high), number);
    let flat = Loop { through: vec![Some([2.0, 0.0]), None, None, None], ..plate.clone() };
    let bulging = Loop { through: vec![Some([2.0, 4.0]), None, None, None], ..plate.clone() };
    for (loops, side, words) in [
        (
            vec![polygon(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]])],
            (0, 2),
            "edge 1 and edge 3 cross or touch at [2, 2]. Give the corners in order",
        ),
        (
            vec![polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]])],
            (0, 2),
            "cross or touch at [2, 0]",
        ),
        (
            vec![polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [0.0, 4.0]])],
            (0, 1),
            "edge 2 has no length: both its corners are [4, 0]",
        ),
        (
            vec![polygon(&[[0.0, 0.0], [4.0, 0.0], [2.0, 0.0], [2.0, 4.0]])],
            (0, 0),
            "edge 1 and edge 2 at [4, 0] is sharper than one degree",
        ),
        (
            vec![polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [3.9999, 4.0], [0.0, 4.0]])],
            (0, 2),
            "edge 3 is only 0.0001 long at [4, 4]",
        ),
        (
            vec![plate.clone(), inner([1.0, 1e-5], [2.0, 1.0], 1)],
            (1, 3),
            "edge 1 and hole 1 come within 0.00001 of each other",
        ),
        (vec![plate.clone(), inner([3.0, 3.0], [5.0, 3.5], 1)], (1, 2), "edge 2 and hole 1 cross or touch at [4, 3"),
        (vec![plate.clone(), inner([5.0, 3.0], [6.0, 3.5], 1)], (1, 3), "hole 1 at [5, 3] is not inside the outline"),
        (
            vec![plate.clone(), inner([1.0, 1.0], [3.0, 3.0], 1), inner([1.5, 1.5], [2.0, 2.0], 2)],
            (2, 3),
            "hole 2 at [1.5, 1.5] is inside hole 1",
        ),
        (
            vec![plate.clone(), inner([1.0, 1.0], [2.0, 2.0], 1), inner([1.0, 1.0], [2.0, 2.0], 2)],
            (2, 3),
            "hole 1 and hole 2 cross or touch at",
        ),
        (vec![flat], (0, 0), "edge 1 is no arc: [0, 0], [2, 0] and [4, 0] are on one line"),
        (vec![bulging], (0, 3), "edge 1 and edge 4 cross or touch at [0, 3]"),
    ] {
        let fault = refused(&loops);
        assert!(fault.message.contains(words), "{words:?} is not in {:?}", fault.message);
        assert_eq!(fault.side, Some(side), "{}", fault.message);
    }
    let line = Refinement { from: [1.0, 1.0], to: [3.0, 3.0], size: 1e-7 };
    let round = circle("rim", [2.0, 2.0], 2.0);
    for (plate, options) in [
        (&plate, of(1e-4)),
        (&plate, MeshOptions { refinements: vec![line], ..of(0.5) }),
        (&round, of(1e-4)),
        (&round, of(1e-200)),
    ] {
        let fault = mesh(std::slice::from_ref(plate), &options).map(|mesh| mesh.elements.len()).unwrap_err();
        assert!(fault.message.contains("would be more than the 10000000 that there is room for"), "{fault}");
    }
    let fault =
        mesh(&[round], &MeshOptions { most: Some(1000), ..of(0.01) }).map(|mesh| mesh.elements.len()).unwrap_err();
    assert!(fault.message.contains("more than the 1000 that"), "{fault}");
}
