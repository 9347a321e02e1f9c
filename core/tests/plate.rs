//! Plates: refused arrays, rigid motions without strain, and double-double arithmetic.
use proptest::prelude::*;
use signorini_core::displacement::Displacement;
use signorini_core::double_double::DoubleDouble;
use signorini_core::element::{Kind, Layered, Material, Materials, Thickness};
use signorini_core::plate::{Plate, PlateError, StressNodes};
use signorini_core::residual::residual;
use signorini_core::rows::Springs;
use signorini_core::stress::smoothed;

const MATERIAL: Material = Material::isotropic(1000.0, 0.3, 5.0 / 6.0);

/// Points and elements of a grid of unit squares; inner nodes are moved by `skew`.
fn grid(nx: usize, ny: usize, skew: f64) -> (Vec<[f64; 2]>, Vec<[usize; 8]>) {
    let (columns, rows) = (2 * nx + 1, 2 * ny + 1);
    let mut number = vec![usize::MAX; columns * rows];
    let mut points = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            if i % 2 == 1 && j % 2 == 1 {
                continue;
            }
            number[j * columns + i] = points.len();
            let inner = i > 0 && i < columns - 1 && j > 0 && j < rows - 1;
            let shift = if inner { skew * ((3 * i + 5 * j) as f64).sin() } else { 0.0 };
            points.push([0.5 * i as f64 + shift, 0.5 * j as f64 - shift]);
        }
    }
    let at = |i: usize, j: usize| number[j * columns + i];
    let element = |x: usize, y: usize| {
        let (i, j) = (2 * x, 2 * y);
        [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)].map(|(a, b)| at(i + a, j + b))
    };
    let elements = (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).map(|(x, y)| element(x, y)).collect();
    (points, elements)
}

fn plate(kind: Kind, frames: Option<Vec<[f64; 2]>>) -> Plate {
    let (points, elements) = grid(3, 2, 0.05);
    Plate::new(points, elements, Thickness::Constant(0.1), MATERIAL, kind, frames).unwrap()
}

fn refused(change: impl FnOnce(&mut Vec<[f64; 2]>, &mut Vec<[usize; 8]>, &mut Vec<f64>)) -> PlateError {
    let (mut points, mut elements) = grid(1, 1, 0.0);
    let mut at_points = vec![0.1; 13];
    change(&mut points, &mut elements, &mut at_points);
    let thickness = Thickness::Varying { at_points, layered: Layered::default() };
    Plate::new(points, elements, thickness, MATERIAL, Kind::Mitc9, None).err().expect("refused")
}

#[test]
fn bad_arrays_are_refused_by_name() {
    let found = refused(|_, _, h| h.truncate(7));
    assert_eq!(found, PlateError::Length { what: "thickness", found: 7, expected: 13 });
    assert_eq!(refused(|p, _, _| p[1][1] = f64::NAN), PlateError::NotFinite { what: "points", index: 3 });
    assert_eq!(refused(|_, _, h| h[2] = f64::INFINITY), PlateError::NotFinite { what: "thickness", index: 2 });
    assert_eq!(refused(|_, _, h| h[5] = 0.0), PlateError::Range { what: "thickness", index: 5 });
    assert_eq!(refused(|_, e, _| e[0][3] = 8), PlateError::NoSuchNode { element: 0, node: 8 });
    assert_eq!(refused(|_, e, _| e[0].swap(0, 2)), PlateError::Inverted { element: 0 });
    assert_eq!(refused(|p, _, _| p.iter_mut().for_each(|x| x[1] = 0.0)), PlateError::Inverted { element: 0 });
}

#[test]
fn a_matrix_that_elements_share_is_that_of_each_alone() {
    let (points, elements) = grid(3, 3, 0.0);
    let thick: Vec<f64> = (0..13 * elements.len()).map(|i| if i / 13 == 4 { 0.2 } else { 0.1 }).collect();
    let made = |points: &[[f64; 2]], elements: &[[usize; 8]], at_points: &[f64]| {
        let thickness = Thickness::Varying { at_points: at_points.to_vec(), layered: Layered::default() };
        Plate::new(points.to_vec(), elements.to_vec(), thickness, MATERIAL, Kind::Mitc9, None).unwrap()
    };
    let mut moved = points.clone();
    moved[elements[8][2]][0] += 0.1;
    for points in [points, moved] {
        let plate = made(&points, &elements, &thick);
        for e in 0..elements.len() {
            let alone = made(&points, &elements[e..=e], &thick[13 * e..13 * (e + 1)]);
            assert_eq!(plate.element_stiffness(e), alone.element_stiffness(0));
            assert_eq!(plate.centre(e).coupling, alone.centre(0).coupling);
        }
        assert_ne!(plate.element_stiffness(4), plate.element_stiffness(0));
    }
}

#[test]
fn elements_of_several_materials_have_each_its_own() {
    let (points, elements) = grid(3, 1, 0.0);
    let soft = Material::isotropic(10.0, 0.1, 0.5);
    let made = |materials: Materials| {
        Plate::new(points.clone(), elements.clone(), Thickness::Constant(0.1), materials, Kind::Mitc9, None)
    };
    let plate = made(Materials::several(vec![MATERIAL, soft], vec![0, 1, 0])).unwrap();
    let of = |material: Material| made(material.into()).unwrap().element_stiffness(0).to_vec();
    let (own, other) = (of(MATERIAL), of(soft));
    assert!([&own, &other, &own].iter().enumerate().all(|(e, k)| plate.element_stiffness(e) == k.as_slice()));
    assert_eq!(plate.materials.young(), 1000.0);
    for of in [vec![0, 1], vec![0, 2, 0], vec![]] {
        let refused = made(Materials::several(vec![MATERIAL, soft], of)).err();
        assert_eq!(refused, Some(PlateError::Range { what: "materials of elements", index: 0 }));
    }
}

#[test]
fn moments_keep_the_sides_of_a_jump_apart() {
    let (points, elements) = grid(2, 1, 0.0);
    let (first, second) = (elements[0], elements[1]);
    let materials = Materials::several(vec![MATERIAL, Material::isotropic(100.0, 0.3, 5.0 / 6.0)], vec![0, 1]);
    let plate = Plate::new(points.clone(), elements, Thickness::Constant(0.1), materials, Kind::Mitc9, None).unwrap();
    // w = x²/2: a curvature of one everywhere, and ten times the moment in the first element.
    let dofs: Vec<f64> = points.iter().flat_map(|[x, _]| [0.5 * x * x, *x, 0.0]).collect();
    let displaced = Displacement { lo: vec![0.0; dofs.len()], hi: dofs };
    let [left, right] = [1000.0, 100.0].map(|young: f64| -young * 1e-3 / 12.0 / 0.91);
    let shared: Vec<usize> = first.into_iter().filter(|node| second.contains(node)).collect();
    let (mean, _) = smoothed(&plate, &displaced, [0.0; 3], &[0.0; 4]);
    assert!(shared.iter().all(|&node| (mean[node][0] - 0.5 * (left + right)).abs() < 1e-9));
    let apart = |node: usize| shared.iter().position(|&one| one == node).map_or(node, |i| points.len() + i);
    let nodes = StressNodes { elements: vec![first, second.map(apart)], count: points.len() + shared.len() };
    let plate = plate.with_stress_nodes(nodes).unwrap();
    let (kept, _) = smoothed(&plate, &displaced, [0.0; 3], &[0.0; 4]);
    assert!(first.iter().all(|&node| (kept[node][0] - left).abs() < 1e-9));
    assert!(second.iter().all(|&node| (kept[apart(node)][0] - right).abs() < 1e-9));
    for (element, count) in [([17; 8], 16), ([0; 8], 1 << 60)] {
        assert!(plate_again(&points).with_stress_nodes(StressNodes { elements: vec![element; 2], count }).is_err());
    }
}

fn plate_again(points: &[[f64; 2]]) -> Plate {
    let (_, elements) = grid(2, 1, 0.0);
    Plate::new(points.to_vec(), elements, Thickness::Constant(0.1), MATERIAL, Kind::Mitc9, None).unwrap()
}

/// A plate with one element given as layered, whose sections equal those of its thickness.
fn layered_alike(kind: Kind, change: impl FnOnce(&mut Layered)) -> Result<Plate, PlateError> {
    let (points, elements) = grid(3, 2, 0.05);
    let count = kind.points().len();
    let at_points: Vec<f64> = (0..6 * count).map(|i| 0.1 + 0.001 * i as f64).collect();
    let section = at_points[4 * count..5 * count].iter().map(|h| MATERIAL.section(*h)).collect();
    let mut layered = Layered { element: vec![4], section };
    change(&mut layered);
    Plate::new(points, elements, Thickness::Varying { at_points, layered }, MATERIAL, kind, None)
}

#[test]
fn layers_of_one_thickness_are_no_layers() {
    for kind in [Kind::Mitc9, Kind::Q8r] {
        let layered = layered_alike(kind, |_| ()).unwrap();
        let plain = layered_alike(kind, |layers| *layers = Layered::default()).unwrap();
        let alike = |a: &[f64], b: &[f64]| {
            let largest = b.iter().fold(0.0_f64, |most, k| most.max(k.abs()));
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * largest)
        };
        assert!((0..6).all(|e| alike(layered.element_stiffness(e), plain.element_stiffness(e))));
        let load = |plate: &Plate| plate.curvature_load([1.0, 2.0, 3.0]).0;
        assert!(alike(&load(&layered), &load(&plain)));
    }
}

#[test]
fn bad_layers_are_refused_by_name() {
    let refused = |change: fn(&mut Layered)| layered_alike(Kind::Mitc9, change).err().expect("refused");
    let short = refused(|layers| layers.section.truncate(12));
    assert_eq!(short, PlateError::Length { what: "sections", found: 12, expected: 13 });
    let bad: [fn(&mut Layered); 4] = [
        |layers| layers.section[3].bending[0][0] = f64::NAN,
        |layers| layers.section[3].bending[0][1] *= 1.001,
        |layers| layers.section[3].bending[2][2] = 0.0,
        |layers| layers.section[3].shear[1][1] *= -1.0,
    ];
    for change in bad {
        assert_eq!(refused(change), PlateError::Range { what: "sections", index: 3 });
    }
    let outside = refused(|layers| layers.element[0] = 6);
    assert_eq!(outside, PlateError::Range { what: "elements of sections", index: 0 });
}

#[test]
fn bad_materials_and_frames_are_refused() {
    let made = |material: Material, frames: Option<Vec<[f64; 2]>>| {
        let (points, elements) = grid(1, 1, 0.0);
        Plate::new(points, elements, Thickness::Constant(0.1), material, Kind::Q8r, frames).err()
    };
    let factor = 5.0 / 6.0;
    let bad =
        [(0.0, 0.3, factor), (-1.0, 0.3, factor), (f64::NAN, 0.3, factor), (1.0, 1.0, factor), (1.0, -1.0, factor)];
    for (young, poisson, shear_factor) in bad.into_iter().chain([(1.0, 0.3, 0.0)]) {
        let found = made(Material::isotropic(young, poisson, shear_factor), None);
        assert_eq!(found, Some(PlateError::Range { what: "material", index: 0 }));
    }
    let mut frames = vec![[1.0, 0.0]; 8];
    frames[4] = [0.6, 0.7];
    assert_eq!(made(MATERIAL, Some(frames)), Some(PlateError::Range { what: "frames", index: 4 }));
    assert_eq!(
        made(MATERIAL, Some(vec![[1.0, 0.0]; 3])),
        Some(PlateError::Length { what: "frames", found: 3, expected: 8 })
    );
}

#[test]
fn messages_say_what_was_found() {
    let found = PlateError::Length { what: "thickness", found: 7, expected: 8 };
    assert_eq!(found.to_string(), "thickness has length 7; expected 8");
    assert_eq!(PlateError::Inverted { element: 3 }.to_string(), "element 3 is turned over or degenerate");
}

/// Two elements around node 0; in each, a side is collapsed to this node.
fn fan() -> (Vec<[f64; 2]>, Vec<[usize; 8]>) {
    let points = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0], [2.5, 1.0], [1.0, 1.0]];
    let points = [points, vec![[1.0, 2.5], [0.0, 1.0]]].concat();
    (points, vec![[0, 0, 1, 2, 0, 4, 5, 6], [0, 0, 2, 3, 0, 6, 7, 8]])
}

#[test]
fn each_kind_takes_its_own_elements_of_three_corners() {
    let (points, collapsed) = fan();
    let triangles: Vec<[usize; 8]> =
        collapsed.iter().map(|&[c, _, a, b, _, ca, ab, bc]| [a, b, c, c, ab, bc, c, ca]).collect();
    let made = |elements: &[[usize; 8]], kind| {
        let plate = Plate::new(points.clone(), elements.to_vec(), Thickness::Constant(0.1), MATERIAL, kind, None);
        plate.err().map(|error| error.to_string())
    };
    assert_eq!(made(&collapsed, Kind::Q8r), None);
    assert_eq!(made(&triangles, Kind::Mitc9), None);
    assert_eq!(made(&triangles, Kind::Q8r).unwrap(), "element 0 is a triangle, which q8r has not; take mitc9");
    assert!(made(&collapsed, Kind::Mitc9).unwrap().starts_with("element 0 has a collapsed side, which mitc9 has not"));
    assert!(made(&[[0, 0, 1, 2, 8, 4, 5, 6]], Kind::Q8r).unwrap().starts_with("element 0 repeats a node"));
}

proptest! {
    /// A rigid motion with dyadic coordinates, which is exact in doubles, causes no strain at all.
    #[test]
    fn a_rigid_motion_leaves_no_residual(w in -64i32..64, x in -64i32..64, y in -64i32..64, q8r: bool, collapsed: bool) {
        let (points, elements) = if q8r && collapsed { fan() } else { grid(3, 2, 0.0) };
        let kind = if q8r { Kind::Q8r } else { Kind::Mitc9 };
        let plate = Plate::new(points.clone(), elements, Thickness::Constant(0.1), MATERIAL, kind, None).unwrap();
        let (w, x, y) = (f64::from(w), f64::from(x), f64::from(y));
        let mut motion = Displacement::zeros(plate.dof_count());
        for (node, at) in points.iter().enumerate() {
            motion.hi[3 * node] = w + x * at[0] + y * at[1];
            motion.hi[3 * node + 1] = x;
            motion.hi[3 * node + 2] = y;
        }
        let load = vec![0.0; plate.dof_count()];
        let out = residual(&plate, &Springs::default(), &load, &motion);
        prop_assert!(out.iter().all(|&r| r == 0.0));
    }

    /// Rotating the frames rotates the couples of the residual and changes nothing else.
    #[test]
    fn frames_turn_couples(angle in -3.0f64..3.0, seed in 1u64..1000) {
        let plain = plate(Kind::Mitc9, None);
        let turn = [angle.cos(), angle.sin()];
        let length = turn[0].hypot(turn[1]);
        let turn = turn.map(|t| t / length);
        let framed = plate(Kind::Mitc9, Some(vec![turn; plain.node_count()]));
        let mut u = Displacement::zeros(plain.dof_count());
        u.hi.iter_mut().enumerate().for_each(|(i, v)| *v = ((i as u64 * 7919 + seed) as f64).sin());
        let mut v = u.clone();
        let [c, s] = turn;
        for node in 0..plain.node_count() {
            let [x, y] = [u.hi[3 * node + 1], u.hi[3 * node + 2]];
            v.hi[3 * node + 1] = c * x + s * y;
            v.hi[3 * node + 2] = c * y - s * x;
        }
        let load = vec![0.0; plain.dof_count()];
        let here = residual(&plain, &Springs::default(), &load, &u);
        let there = residual(&framed, &Springs::default(), &load, &v);
        let size = here.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        for node in 0..plain.node_count() {
            let [f, x, y] = [0, 1, 2].map(|a| here[3 * node + a]);
            let expected = [f, c * x + s * y, c * y - s * x];
            for a in 0..3 {
                prop_assert!((there[3 * node + a] - expected[a]).abs() <= 1e-13 * size);
            }
        }
    }

    /// Sums and products of integers of up to 100 bits are exact in double-double.
    #[test]
    fn double_doubles_carry_a_hundred_bits(a in -(1i64 << 50)..(1i64 << 50), b in -(1i64 << 50)..(1i64 << 50)) {
        let product = DoubleDouble::from(a as f64).times(b as f64);
        prop_assert_eq!(product.hi as i128 + product.lo as i128, i128::from(a) * i128::from(b));
        let difference = product - DoubleDouble::from(b as f64).times(a as f64);
        prop_assert_eq!(difference.value(), 0.0);
        let mut sum = product;
        sum += b as f64;
        prop_assert_eq!((sum - product).value(), b as f64);
        let mut added = DoubleDouble::from(a as f64);
        added.add_product(a as f64, b as f64);
        let expected = i128::from(a) * i128::from(b) + i128::from(a);
        prop_assert_eq!(added.hi as i128 + added.lo as i128, expected);
    }
}
