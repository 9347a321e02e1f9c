//! Pairing of triangles into quadrilaterals.

use crate::geometry::Point;
use crate::quality::{Corners, quality};
use crate::triangles::{NONE, Triangles};

/// Smallest quality at which two triangles are paired: smallest sine of the quadrilateral's corner angles (25° to
/// 155°).
const LEAST: f64 = 0.42;
/// Reduction of the quality of pairs that remove a side along a lattice line, so that pairs across diagonals, which are
/// the cells of the lattice, come first. In a lattice with an angle of 40°, pairs across diagonals have a quality of
/// 0.64, but pairs across lattice lines have 0.94.
const KEPT: f64 = 0.35;
/// Largest number of pairs that are exchanged in order to pair two more triangles.
const DEPTH: usize = 10;

/// Pairs triangles into quadrilaterals: the best-shaped pairs first, then by augmenting paths.
///
/// Pairs across a side from a to b for which `kept(a, b)` is true have a lower priority.
pub fn pair(triangles: &Triangles, points: &[Point], kept: impl Fn(Point, Point) -> bool) -> Vec<Corners> {
    let count = triangles.corners.len();
    let mut sides = Vec::new();
    // For each triangle, its possible partner across each of its three sides.
    let mut partners = vec![[NONE; 3]; count];
    for t in 0..count {
        for i in 0..3 {
            let n = triangles.across[t][i];
            if n == NONE || triangles.fixed[t][i] {
                continue;
            }
            let shape = quality(&joined(triangles, t, i), |node| points[node]);
            if shape >= LEAST {
                partners[t][i] = n;
                if t < n {
                    let [a, b] = [1, 2].map(|k| points[triangles.corners[t][(i + k) % 3]]);
                    sides.push((if kept(a, b) { shape - KEPT } else { shape }, t, n));
                }
            }
        }
    }
    // Qualities are rounded, so that pairs of equal quality are ordered by number and regular lattices are paired
    // regularly.
    let rank = |shape: f64| (shape * 1e6).round();
    sides.sort_by(|a, b| rank(b.0).total_cmp(&rank(a.0)).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut mate = vec![NONE; count];
    for (_, t, n) in sides {
        if mate[t] == NONE && mate[n] == NONE {
            (mate[t], mate[n]) = (n, t);
        }
    }
    let mut on_path = vec![false; count];
    for depth in 1..=DEPTH {
        for t in 0..count {
            if mate[t] == NONE {
                augment(t, depth, &partners, &mut mate, &mut on_path);
            }
        }
    }
    let mut elements = Vec::with_capacity(count / 2 + 8);
    for t in 0..count {
        if mate[t] == NONE {
            let [a, b, c] = triangles.corners[t];
            elements.push([a, b, c, NONE]);
        } else if t < mate[t] {
            let i = (0..3).find(|&i| triangles.across[t][i] == mate[t]).expect("paired triangles share a side");
            elements.push(joined(triangles, t, i));
        }
    }
    elements
}

/// The quadrilateral that triangle t and the triangle across its side i form.
fn joined(triangles: &Triangles, t: usize, i: usize) -> Corners {
    let own = triangles.corners[t];
    let n = triangles.across[t][i];
    let (a, b) = (own[(i + 1) % 3], own[(i + 2) % 3]);
    let apex = triangles.corners[n].into_iter().find(|&q| q != a && q != b).expect("triangles differ in a corner");
    [own[i], a, apex, b]
}

/// Finds a partner for triangle t by exchanging at most `depth` other pairs. Returns whether a partner was found.
fn augment(t: usize, depth: usize, partners: &[[usize; 3]], mate: &mut [usize], on_path: &mut [bool]) -> bool {
    on_path[t] = true;
    let mut result = false;
    for n in partners[t].into_iter().filter(|&n| n != NONE) {
        if on_path[n] {
            continue;
        }
        let next = mate[n];
        if next == NONE
            || (depth > 0 && !on_path[next] && {
                on_path[n] = true;
                let freed = augment(next, depth - 1, partners, mate, on_path);
                on_path[n] = false;
                freed
            })
        {
            (mate[t], mate[n]) = (n, t);
            result = true;
            break;
        }
    }
    on_path[t] = false;
    result
}
