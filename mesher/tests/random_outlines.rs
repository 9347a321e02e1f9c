//! Random outlines with fixed seeds: every valid outline has a conforming mesh that covers it.
//!
//! `OUTLINES=10000 cargo test --release --test random_outlines -- --nocapture` tests more outlines.

use signorini_mesher::{Line, Loop, Mesh, MeshOptions, Point, Refinement, mesh};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::time::{Duration, Instant};

/// Random numbers by splitmix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + self.unit() * (high - low)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    fn point(&mut self, reach: f64) -> Point {
        [self.within(-reach, reach), self.within(-reach, reach)]
    }
}

/// A random closed line around `middle`: a rotated rectangle, a staircase, or a star-shaped or nearly round polygon. Some
/// are rounded to a coarse grid; some sides are arcs.
fn ring(random: &mut Random, name: &str, middle: Point, radius: f64) -> Loop {
    let mut corners: Vec<Point> = match random.below(4) {
        0 => {
            let angle = random.within(0.0, TAU);
            let wide = random.within(0.1, 1.0);
            [[1.0, wide], [-1.0, wide], [-1.0, -wide], [1.0, -wide]]
                .map(|[x, y]| [angle.cos() * x - angle.sin() * y, angle.sin() * x + angle.cos() * y])
                .to_vec()
        }
        1 => {
            // A staircase along the axes.
            let steps = 2 + random.below(3);
            let mut heights: Vec<f64> = (0..steps).map(|_| random.within(0.1, 1.0)).collect();
            heights.sort_by(f64::total_cmp);
            let mut found = vec![[-1.0, -1.0], [1.0, -1.0]];
            for (i, height) in heights.iter().enumerate() {
                let x = |i: usize| 1.0 - 2.0 * i as f64 / steps as f64;
                found.extend([[x(i), *height], [x(i + 1), *height]]);
            }
            found
        }
        kind => {
            let count = 3 + random.below(12);
            let mut angles: Vec<f64> = (0..count).map(|_| random.within(0.0, TAU)).collect();
            angles.sort_by(f64::total_cmp);
            let least = if kind == 2 { 0.3 } else { 0.9 };
            angles
                .iter()
                .map(|a| {
                    let r = random.within(least, 1.0);
                    [r * a.cos(), r * a.sin()]
                })
                .collect()
        }
    };
    if random.chance(0.2) {
        // On a grid, corners may lie on sides and on each other.
        corners.iter_mut().flatten().for_each(|x| *x = (4.0 * *x).round() / 4.0);
    }
    corners.iter_mut().for_each(|p| *p = [middle[0] + radius * p[0], middle[1] + radius * p[1]]);
    let count = corners.len();
    let bent = if random.chance(0.5) { 0.4 } else { 0.0 };
    let through = (0..count)
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % count]);
            let rise = random.within(-0.5, 0.5);
            let at = [0.5 * (a[0] + b[0]) - rise * (b[1] - a[1]), 0.5 * (a[1] + b[1]) + rise * (b[0] - a[0])];
            random.chance(bent).then_some(at)
        })
        .collect();
    Loop { corners, through, names: (1..=count).map(|i| format!("{name} {i}")).collect() }
}

fn plate(seed: u64) -> (Vec<Loop>, MeshOptions) {
    let mut random = Random(seed);
    let mut loops = vec![ring(&mut random, "edge", [0.0, 0.0], 10.0)];
    for hole in 1..=random.below(4) {
        let radius = 10f64.powf(random.within(-1.0, 0.5));
        let middle = random.point(6.0);
        loops.push(ring(&mut random, &format!("hole {hole}, side"), middle, radius));
    }
    let size = 10f64.powf(random.within(-0.6, 1.0));
    let mut options = MeshOptions { size, ..MeshOptions::default() };
    if random.chance(0.5) {
        for (count, round) in [(4, true), (8, false)] {
            for _ in 0..random.below(count) {
                let [from, through, to] = [(); 3].map(|()| random.point(10.0));
                let rank = options.lines.len();
                options.lines.push(Line { ends: [from, to], through: round.then_some(through), rank, in_part: false });
            }
        }
        options.points = (0..random.below(8)).map(|_| random.point(10.0)).collect();
    }
    if random.chance(0.3) {
        let from = random.point(8.0);
        let to = if random.chance(0.5) { from } else { random.point(8.0) };
        options.refinements.push(Refinement { from, to, size: size * random.within(0.05, 1.0) });
    }
    (loops, options)
}

/// Area inside the loops: polygons, and circular segments at their sides.
fn area(loops: &[Loop]) -> f64 {
    let one = |ring: &Loop| {
        let count = ring.corners.len();
        let mut sum = 0.0;
        for i in 0..count {
            let (a, b) = (ring.corners[i], ring.corners[(i + 1) % count]);
            sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
            if let Some(m) = ring.through[i] {
                let (chord, middle) =
                    (f64::hypot(b[0] - a[0], b[1] - a[1]), [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
                let left = ((b[0] - a[0]) * (m[1] - a[1]) - (b[1] - a[1]) * (m[0] - a[0])).signum();
                let rise = f64::hypot(m[0] - middle[0], m[1] - middle[1]);
                let sweep = 4.0 * (2.0 * rise / chord).atan();
                let radius = 0.5 * chord / (0.5 * sweep).sin();
                sum -= left * 0.5 * radius * radius * (sweep - sweep.sin());
            }
        }
        sum.abs()
    };
    2.0 * one(&loops[0]) - loops.iter().map(one).sum::<f64>()
}

/// Descriptions of the defects of a mesh.
fn flaws(mesh: &Mesh, loops: &[Loop]) -> Vec<String> {
    let mut found = Vec::new();
    let mut sides: HashMap<usize, Vec<[usize; 2]>> = HashMap::new();
    let mut covered = 0.0;
    for element in &mesh.elements {
        for i in (0..4).filter(|&i| element[i] != element[(i + 1) % 4]) {
            let (a, m, b) = (element[i], element[4 + i], element[(i + 1) % 4]);
            sides.entry(m).or_default().push([a, b]);
            let [p, q, r] = [a, m, b].map(|node| mesh.points[node]);
            // Simpson's rule is exact for a parabola.
            let cross = |p: Point, q: Point| p[0] * q[1] - p[1] * q[0];
            covered += (cross(p, q) + cross(q, r)) * 2.0 / 3.0 - cross(p, r) / 6.0;
        }
    }
    let single = sides.values().filter(|ends| ends.len() == 1).count();
    if single != mesh.sides.len() || sides.values().any(|e| e.len() > 2 || (e.len() == 2 && e[0] != [e[1][1], e[1][0]]))
    {
        found.push("elements do not meet along sides".to_string());
    }
    for &[a, m, b] in &mesh.sides {
        if sides.get(&m) != Some(&vec![[a, b]]) {
            found.push(format!("the outline's side {a} {m} {b} is none of an element"));
        }
    }
    let wanted = area(loops);
    if (covered - wanted).abs() > 2e-3 * wanted {
        found.push(format!("area {covered} for {wanted}"));
    }
    if !(mesh.least_angle > 0.5) {
        found.push(format!("an angle of {}", mesh.least_angle));
    }
    if mesh.points.iter().flatten().any(|x| !x.is_finite()) {
        found.push("a node is nowhere".to_string());
    }
    found
}

#[test]
fn random_outlines_are_meshed_or_refused_with_a_reason() {
    let count: u64 = std::env::var("OUTLINES").ok().and_then(|text| text.parse().ok()).unwrap_or(300);
    let (mut meshed, mut failed, mut longest) = (0, Vec::new(), (Duration::ZERO, 0));
    let (mut sharp, mut share) = (Vec::new(), 0.0);
    for seed in 0..count {
        let (loops, options) = plate(seed);
        let start = Instant::now();
        let made = mesh(&loops, &options);
        longest = longest.max((start.elapsed(), seed));
        match made {
            Ok(made) => {
                meshed += 1;
                sharp.push(made.least_angle);
                share += made.quadrilaterals;
                failed.extend(flaws(&made, &loops).into_iter().map(|flaw| (seed, flaw)));
            }
            // The error for an invalid outline refers to one of its sides.
            Err(fault) if fault.side.is_some() => {}
            Err(fault) => failed.push((seed, fault.message)),
        }
    }
    sharp.sort_by(f64::total_cmp);
    println!(
        "{meshed} of {count} meshed, the others refused; least angles {:.1?}; {:.1}% in quadrilaterals; longest {:?} (seed {})",
        [0.01, 0.05, 0.1, 0.5].map(|part| sharp[(part * sharp.len() as f64) as usize]),
        100.0 * share / f64::from(meshed),
        longest.0,
        longest.1
    );
    assert!(failed.is_empty(), "{} failed: {:#?}", failed.len(), &failed[..failed.len().min(20)]);
    assert!(f64::from(meshed) > 0.3 * count as f64);
}

/// The same plate in other axes, with another origin and another unit of length.
fn seen(loops: &[Loop], options: &MeshOptions, axes: [Point; 2], shift: Point, unit: f64) -> (Vec<Loop>, MeshOptions) {
    let at = |p: Point| [0, 1].map(|i| unit * (axes[i][0] * p[0] + axes[i][1] * p[1] + shift[i]));
    let ring = |ring: &Loop| Loop {
        corners: ring.corners.iter().map(|&p| at(p)).collect(),
        through: ring.through.iter().map(|p| p.map(at)).collect(),
        names: ring.names.clone(),
    };
    let line = |line: &Line| Line { ends: line.ends.map(at), through: line.through.map(at), ..*line };
    let finer = |r: &Refinement| Refinement { from: at(r.from), to: at(r.to), size: unit * r.size };
    let options = MeshOptions {
        size: unit * options.size,
        refinements: options.refinements.iter().map(finer).collect(),
        lines: options.lines.iter().map(line).collect(),
        points: options.points.iter().map(|&p| at(p)).collect(),
        most: options.most,
        axes: [[axes[0][0], axes[1][0]], [axes[0][1], axes[1][1]]],
    };
    (loops.iter().map(ring).collect(), options)
}

#[test]
fn a_plate_has_the_same_mesh_in_other_units_elsewhere_mirrored_and_turned() {
    let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
    let (left, down) = ([-1.0, 0.0], [0.0, -1.0]);
    let views = [
        ([x, y], [0.0, 0.0], 0.3048),
        ([x, y], [31.7, -2.9], 1.0),
        ([left, y], [0.0, 0.0], 1.0),
        ([down, x], [0.0, 0.0], 1e3),
        ([down, left], [0.3, 0.1], 1e-3),
    ];
    let mut others = Vec::new();
    for seed in 0..40 {
        let (loops, options) = plate(seed);
        let Ok(first) = mesh(&loops, &options) else {
            continue;
        };
        for (axes, shift, unit) in views {
            let (loops, options) = seen(&loops, &options, axes, shift, unit);
            let other = mesh(&loops, &options).unwrap_or_else(|fault| panic!("{seed}: {fault}"));
            let at = |p: Point| [0, 1].map(|i| unit * (axes[i][0] * p[0] + axes[i][1] * p[1] + shift[i]));
            let far = |(&p, &q): (&Point, &Point)| f64::hypot(at(p)[0] - q[0], at(p)[1] - q[1]) > 1e-10 * unit;
            let nodes = |mesh: &Mesh| -> Vec<Vec<usize>> {
                let sorted = |element: &[usize; 8]| {
                    let mut nodes = element.to_vec();
                    nodes.sort_unstable();
                    nodes.dedup();
                    nodes
                };
                mesh.elements.iter().map(sorted).collect()
            };
            if first.points.iter().zip(&other.points).any(far) || nodes(&first) != nodes(&other) {
                others.push((seed, unit));
            }
        }
    }
    assert!(others.is_empty(), "{others:?}");
}
