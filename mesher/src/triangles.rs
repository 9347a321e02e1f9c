//! Delaunay triangles inside an outline, refined to the local element sizes.

use crate::geometry::{Point, between, circumcentre, distance, turn};
use crate::seeding::{Chord, Seeds, Style};
use crate::sizes::Sizes;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::HashSet;

/// Index that means "no triangle" or "no node".
pub const NONE: usize = usize::MAX;

/// The triangles of a mesh, with their neighbours.
pub struct Triangles {
    /// The three nodes of each triangle, counter-clockwise.
    pub corners: Vec<[usize; 3]>,
    /// For each corner of each triangle, the triangle across the opposite side; `NONE` if this is outside the plate.
    pub across: Vec<[usize; 3]>,
    /// For each corner of each triangle, whether the opposite side is a chord of the outline or of a line.
    pub fixed: Vec<[bool; 3]>,
}

/// Largest circumradius of a triangle relative to the element size there. Half of a square whose sides are 1.42 times
/// the element size has a circumradius of 1.0.
const LARGE: f64 = 1.1;
/// Largest circumradius relative to the element size for [`Style::Loose`], where refinement adds most nodes. Distances
/// of nodes are then 0.8 to 1.6 element sizes.
const LARGE_LOOSE: f64 = 0.8;
/// Largest circumradius of a triangle relative to its shortest side (smallest angle 20°).
const THIN: f64 = 1.42;
/// Largest number of passes of refinement; few meshes need more than five.
const ROUNDS: usize = 24;

impl Triangles {
    /// Triangulates the initial nodes `seeds`. Adds nodes where triangles are too large or too thin.
    ///
    /// # Errors
    ///
    /// Returns the points at which chords of two arcs cross although the arcs do not.
    pub fn new(
        seeds: &mut Seeds,
        sizes: &Sizes,
        style: Style,
        is_outline: impl Fn(&Chord) -> bool,
    ) -> Result<Triangles, Vec<Point>> {
        for _ in 0..ROUNDS {
            let triangles = triangulate(&seeds.points, &seeds.chords, &is_outline)?;
            let more = triangles.centres(seeds, sizes, if style == Style::Loose { LARGE_LOOSE } else { LARGE });
            if more.is_empty() {
                return Ok(triangles);
            }
            seeds.on.resize(seeds.points.len() + more.len(), None);
            seeds.points.extend(more);
        }
        triangulate(&seeds.points, &seeds.chords, &is_outline)
    }

    /// Circumcentres of triangles that must be refined. No two of these circumcentres are in adjacent triangles.
    fn centres(&self, seeds: &Seeds, sizes: &Sizes, large: f64) -> Vec<Point> {
        let mut poor = Vec::new();
        for (t, corners) in self.corners.iter().enumerate() {
            let [a, b, c] = corners.map(|node| seeds.points[node]);
            let centre = circumcentre(a, b, c);
            let radius = distance(centre, a);
            let shortest = distance(a, b).min(distance(b, c)).min(distance(c, a));
            // If all elements may have the size `largest`, small triangles of good shape are not refined.
            if !(radius > 0.6 * sizes.largest || radius > THIN * shortest || sizes.is_graded()) {
                continue;
            }
            let size = sizes.at(centre);
            if radius > large * size || (radius > THIN * shortest && radius > 0.62 * size) {
                poor.push((radius / size, t, centre, size));
            }
        }
        poor.sort_by(|s, t| t.0.total_cmp(&s.0).then(s.1.cmp(&t.1)));
        let mut taken = vec![false; self.corners.len()];
        let mut centres = Vec::new();
        for (_, t, centre, size) in poor {
            let Some(home) = self.walk(&seeds.points, t, centre) else {
                continue;
            };
            let around = self.across[home].into_iter().filter(|&n| n != NONE);
            if taken[home] || around.clone().any(|n| taken[n]) || !seeds.is_free(centre, size) {
                continue;
            }
            taken[home] = true;
            around.for_each(|n| taken[n] = true);
            centres.push(centre);
        }
        centres
    }

    /// Walks from triangle t to the triangle that contains the point p; `None` if a fixed side is in between.
    fn walk(&self, points: &[Point], mut t: usize, p: Point) -> Option<usize> {
        'step: for _ in 0..1000 {
            let corners = self.corners[t].map(|node| points[node]);
            for i in 0..3 {
                if turn(corners[(i + 1) % 3], corners[(i + 2) % 3], p) < 0.0 {
                    if self.fixed[t][i] {
                        return None;
                    }
                    t = self.across[t][i];
                    continue 'step;
                }
            }
            return Some(t);
        }
        None
    }
}

fn triangulate(
    points: &[Point],
    chords: &[Chord],
    is_outline: impl Fn(&Chord) -> bool,
) -> Result<Triangles, Vec<Point>> {
    // Four points far outside are added, so that the outline is not on the convex hull, where collinear points are
    // degenerate.
    let low = points.iter().fold([f64::INFINITY; 2], |l, p| [l[0].min(p[0]), l[1].min(p[1])]);
    let high = points.iter().fold([f64::NEG_INFINITY; 2], |h, p| [h[0].max(p[0]), h[1].max(p[1])]);
    let margin = 2.0 * (high[0] - low[0]).max(high[1] - low[1]);
    let far = [
        [low[0], low[1], -1.0, -1.0],
        [high[0], low[1], 1.0, -1.0],
        [high[0], high[1], 1.0, 1.0],
        [low[0], high[1], -1.0, 1.0],
    ];
    // The library spade refuses coordinates that are very small but not zero.
    let flush = |x: f64| if x.abs() < 1e-40 { 0.0 } else { x };
    let vertices: Vec<Point2<f64>> = points
        .iter()
        .map(|p| Point2::new(flush(p[0]), flush(p[1])))
        .chain(far.map(|[x, y, u, v]| Point2::new(x + u * margin, y + v * margin)))
        .collect();
    let mut conflicts = Vec::new();
    let edges = chords.iter().map(|chord| chord.ends).collect();
    let made = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(vertices, edges, |edge| {
        conflicts.push(between(points[edge[0]], points[edge[1]], 0.5));
    })
    .map_err(|_| vec![points[0]])?;
    if !conflicts.is_empty() {
        return Err(conflicts);
    }
    // The library spade merges equal points, which would change the numbers of the points after them.
    if made.num_vertices() != points.len() + far.len() {
        return Err(vec![points[0]]);
    }

    // Chords of the outline, each directed so that the plate is on its left.
    let rims: HashSet<[usize; 2]> = chords.iter().filter(|c| is_outline(c)).map(|c| c.ends).collect();
    let faces = made.num_inner_faces();
    let mut corners = Vec::with_capacity(faces);
    let mut across = Vec::with_capacity(faces);
    let mut fixed = Vec::with_capacity(faces);
    let mut inside = vec![false; faces];
    let mut open = Vec::new();
    for (t, face) in made.inner_faces().enumerate() {
        debug_assert_eq!(face.fix().index(), t + 1);
        let edges = face.adjacent_edges();
        corners.push(edges.map(|e| e.from().fix().index()));
        // The side opposite to corner i runs from corner i + 1 to corner i + 2.
        let opposite = [edges[1], edges[2], edges[0]];
        across.push(opposite.map(|e| e.rev().face().as_inner().map_or(NONE, |f| f.fix().index() - 1)));
        fixed.push(opposite.map(|e| e.is_constraint_edge()));
        let on_rim = opposite
            .iter()
            .any(|e| e.is_constraint_edge() && rims.contains(&[e.from().fix().index(), e.to().fix().index()]));
        if on_rim {
            inside[t] = true;
            open.push(t);
        }
    }
    let is_rim = |t: usize, i: usize| {
        let [a, b]: [usize; 2] = [corners[t][(i + 1) % 3], corners[t][(i + 2) % 3]];
        rims.contains(&[a, b]) || rims.contains(&[b, a])
    };
    while let Some(t) = open.pop() {
        for i in 0..3 {
            let n = across[t][i];
            if n != NONE && !inside[n] && !(fixed[t][i] && is_rim(t, i)) {
                inside[n] = true;
                open.push(n);
            }
        }
    }
    let mut new = vec![NONE; faces];
    (0..faces).filter(|&t| inside[t]).enumerate().for_each(|(number, t)| new[t] = number);
    let kept = |t: &usize| inside[*t];
    Ok(Triangles {
        corners: (0..faces).filter(kept).map(|t| corners[t]).collect(),
        across: (0..faces).filter(kept).map(|t| across[t].map(|n| if n == NONE { NONE } else { new[n] })).collect(),
        fixed: (0..faces).filter(kept).map(|t| fixed[t]).collect(),
    })
}
