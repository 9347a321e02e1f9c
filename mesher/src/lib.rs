//! Meshes of 8-node quadrilaterals for plates with any outline, with 6-node triangles where quadrilaterals do not fit.
//!
//! The outline is checked (`outline`), transformed to a form that does not depend on unit, position and order
//! (`normal`), and rotated so that the direction in which its sides are longest is an axis. Lines that element sides
//! follow are cut where they meet the outline (`planar`). Nodes are placed along outline and lines and on a lattice,
//! which is finer where elements must be smaller (`sizes`, `seeding`). Nodes are joined to Delaunay triangles
//! (`triangles`), and triangles to quadrilaterals (`pairing`). Remaining triangles are merged in pairs where possible
//! (`tunnels`), and nodes are moved to improve shapes (`smoothing`). The same input gives the same bits.

#![forbid(unsafe_code)]

mod geometry;
mod normal;
mod outline;
mod pairing;
mod planar;
mod quadratic;
mod quality;
mod seeding;
mod sizes;
mod smoothing;
mod tree;
mod triangles;
mod tunnels;

pub use geometry::Point;
pub use outline::{Loop, MeshError};
pub use sizes::Refinement;

use geometry::Curve;
use normal::Normal;
use outline::{Outline, Side, directions, turned};
use planar::{Piece, Planar};
use quadratic::Quadratic;
use quality::Corners;
use seeding::{Chord, Seeds, Style, seed};
use sizes::Sizes;
use smoothing::{Freedom, smooth};
use triangles::{NONE, Triangles};
use tunnels::Chords;

/// A line or arc that the sides of elements follow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    pub ends: [Point; 2],
    /// A point on the arc between its two ends; `None` for a straight line.
    pub through: Option<Point>,
    /// Priority of the line: sides of elements follow lines of low rank first. A line too near to an earlier one is
    /// left out.
    pub rank: usize,
    /// Whether sides of elements may follow only parts of the line: those inside the plate that are at least about half
    /// an element away from the outline and from earlier lines. If false, they follow all of the line inside the plate,
    /// or none.
    pub in_part: bool,
}

/// Options of the function [`mesh`].
#[derive(Clone, Debug)]
pub struct MeshOptions {
    /// Largest element size, as the side length of a square element.
    pub size: f64,
    pub refinements: Vec<Refinement>,
    pub lines: Vec<Line>,
    /// Points at which nodes are placed if they are far enough from corners of the outline, from other points and from
    /// lines.
    pub points: Vec<Point>,
    /// Largest number of elements, approximately; `None` means 10⁷.
    pub most: Option<usize>,
    /// The two axes along which the plate is meshed: ±x and ±y, in either order. Two plates of equal shape along these
    /// axes have the same mesh, mirrored or turned like the plates.
    pub axes: [Point; 2],
}

impl Default for MeshOptions {
    fn default() -> MeshOptions {
        let axes = [[1.0, 0.0], [0.0, 1.0]];
        MeshOptions { size: 0.0, refinements: Vec::new(), lines: Vec::new(), points: Vec::new(), most: None, axes }
    }
}

#[derive(Clone, Debug)]
pub struct Mesh {
    pub points: Vec<Point>,
    /// Nodes of each element: corners counter-clockwise, then midside nodes, beginning between the first two corners. A
    /// triangle repeats its third corner: [a, b, c, c, ab, bc, c, ca].
    pub elements: Vec<[usize; 8]>,
    /// Corner, midside node and corner of each element side on the outline, in order around each loop. The plate is on
    /// the left of the side.
    pub sides: Vec<[usize; 3]>,
    /// For each of `sides`, the number of its loop, and the number of the outline side in this loop.
    pub side_of: Vec<[usize; 2]>,
    /// The smallest corner angle of all elements, in degrees.
    pub least_angle: f64,
    /// Area of all quadrilaterals divided by the area of the plate.
    pub quadrilaterals: f64,
}

/// Largest number of elements if [`MeshOptions::most`] is `None`.
const MOST: usize = 10_000_000;
/// Largest number of attempts to mesh a plate. After a failed attempt, elements become smaller near badly shaped ones.
const ATTEMPTS: usize = 8;

/// Meshes the plate inside the first loop and outside all other loops, which are holes.
///
/// # Errors
///
/// Returns an error if loops cross, touch or nearly touch themselves or each other, or if a hole is outside the
/// outline. The error has the side and the position.
///
/// # Panics
///
/// Panics if a loop has no sides, or if its lists have different lengths.
///
/// # Examples
///
/// ```
/// use signorini_mesher::{Loop, MeshOptions, mesh};
/// let square = Loop {
///     corners: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]],
///     through: vec![None; 4],
///     names: (1..=4).map(|i| format!("edge {i}")).collect(),
/// };
/// let mesh = mesh(&[square], &MeshOptions { size: 0.5, ..MeshOptions::default() }).unwrap();
/// assert_eq!((mesh.elements.len(), mesh.points.len(), mesh.sides.len()), (16, 65, 16));
/// assert_eq!((mesh.least_angle, mesh.quadrilaterals), (90.0, 1.0));
/// ```
pub fn mesh(loops: &[Loop], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let size = options.size;
    if !(size > 0.0 && options.refinements.iter().all(|r| r.size > 0.0)) {
        return Err(MeshError { message: "An element size must be positive.".to_string(), side: None });
    }
    let most = options.most.unwrap_or(MOST) as f64;
    let too_many = || {
        let message = format!(
            "Elements of size {}, and smaller ones where they are asked for or needed, would be more than the {} that there is \
             room for. Give larger sizes.",
            outline::number(size),
            outline::number(most)
        );
        MeshError { message, side: None }
    };
    let sides = outline::sides(loops)?;
    // Chords along arcs are much shorter than elements. So a mesh with too many elements is refused before chords are
    // made.
    if outline::area(&sides) > most * size * size {
        return Err(too_many());
    }
    Outline::new(sides.clone(), size).require(size)?;
    let normal = Normal::new(loops, options);
    let size = normal.size(size);
    let (sides, given_sides) = normal.sides(loops, &sides);
    let (angle, slant) = directions(&sides);
    let [forth, back] = [-1.0, 1.0].map(|sense: f64| [angle.cos(), sense * angle.sin()]);
    let turn = |p: Point| turned(p, forth);
    let outline =
        Outline::new(sides.into_iter().map(|s| Side { curve: s.curve.mapped(turn, -angle), ..s }).collect(), size);
    let (lines, given_lines) = normal.lines(&options.lines);
    let lines: Vec<(Curve, bool)> = lines.into_iter().map(|(c, in_part)| (c.mapped(turn, -angle), in_part)).collect();
    let points: Vec<Point> = normal.points(&options.points).into_iter().map(turn).collect();
    let mut refinements = normal.refinements(&options.refinements);
    refinements.iter_mut().for_each(|r| (r.from, r.to) = (turn(r.from), turn(r.to)));
    for attempt in 1.. {
        let sizes = Sizes::new(&outline, size, &refinements);
        let count = sizes.count(&outline, most);
        if count > most {
            return Err(too_many());
        }
        let sharp = SHARP.min(0.9 * outline.sharpest());
        let task = Task { outline: &outline, sizes: &sizes, lines: &lines, points: &points, sharp };
        let bad = match task.best(slant.filter(|_| count <= MANY as f64)) {
            Ok(best) => return Ok(best.finish(&given_sides, &given_lines, &normal, back)),
            Err(bad) => bad,
        };
        if attempt == ATTEMPTS {
            let message = format!(
                "No good elements fit near {}: an arc and what is near it leave no room. Give a smaller size, or \
                 simplify the outline there.",
                outline::place(normal.back(turned(bad[0], back)))
            );
            return Err(MeshError { message, side: None });
        }
        refinements.extend(bad.into_iter().map(|p| Refinement { from: p, to: p, size: 0.5 * sizes.at(p) }));
    }
    unreachable!("the last attempt returns")
}

/// A first mesh is accepted if quadrilaterals have at least the fraction `ENOUGH` of the area and the smallest angle is
/// at least `SHARP` degrees. Other styles of node placement are tried only for meshes of at most `MANY` elements, since
/// in larger ones most elements are those of the lattice.
const ENOUGH: f64 = 0.99;
const SHARP: f64 = 40.0;
const MANY: usize = 20_000;
/// Smallest number of elements of a mesh in which remaining triangles are merged in pairs. In a smaller mesh the
/// resulting quadrilaterals would be long and less accurate.
const FEW: usize = 28;
/// Smallest quality (sine of a corner angle), before smoothing, of elements that result from merging triangles.
/// `CAUTIOUS` applies to meshes of more than `MANY` elements, which are not made again without merging if an angle is
/// too sharp.
const LEAST_MERGED: f64 = 0.05;
const CAUTIOUS: f64 = 0.3;

/// The better of two meshes; the first mesh if both are equally good.
fn better(one: Quadratic, other: Quadratic) -> Quadratic {
    let rank = |mesh: &Quadratic| {
        let (share, angle) = mesh.measures();
        // Below `SHARP`, one degree of the smallest angle counts as much as 2 % of the area in quadrilaterals.
        100.0 * share + 2.0 * angle.min(SHARP)
    };
    if rank(&other) > rank(&one) { other } else { one }
}

/// Nodes and elements of a mesh before triangles are merged and nodes are moved.
struct Draft {
    seeds: Seeds,
    pieces: Vec<Piece>,
    elements: Vec<Corners>,
}

struct Task<'a> {
    outline: &'a Outline,
    sizes: &'a Sizes,
    /// Lines that sides of elements follow, and whether they may follow only parts of each line.
    lines: &'a [(Curve, bool)],
    points: &'a [Point],
    /// Smallest acceptable corner angle, in degrees.
    sharp: f64,
}

impl Task<'_> {
    /// The first good mesh of several styles of node placement, or the best mesh if none is good.
    ///
    /// # Errors
    ///
    /// Returns the points at which elements must be smaller, if no mesh can be made.
    fn best(&self, slant: Option<f64>) -> Result<Quadratic, Vec<Point>> {
        // The lattice with the angle `slant` is tried first, since it may fit the plate without triangles. If it does
        // not, its mesh is compared with those of the other styles.
        let mut slanted = slant.and_then(|angle| self.drafted(Style::Skew(angle)).ok());
        let whole = slanted.take_if(|draft| draft.elements.iter().all(|corners| corners[3] != NONE));
        let mut fitting = whole.and_then(|draft| self.made(draft).ok());
        if let Some(mesh) = fitting.take_if(|mesh| self.is_good(mesh)) {
            return Ok(mesh);
        }
        let mut best = self.made(self.drafted(Style::Square)?)?;
        if let Some(mesh) = fitting {
            best = better(best, mesh);
        }
        let mut others =
            [Style::Lined, Style::Loose].into_iter().filter_map(|style| self.drafted(style).ok()).chain(slanted);
        while !self.is_good(&best) && best.len() <= MANY {
            let Some(draft) = others.next() else {
                break;
            };
            if let Ok(other) = self.made(draft) {
                best = better(best, other);
            }
        }
        Ok(best)
    }

    fn is_good(&self, mesh: &Quadratic) -> bool {
        let (share, angle) = mesh.measures();
        share >= ENOUGH && angle >= self.sharp
    }

    /// Places nodes by `style`, triangulates the plate, and pairs triangles into quadrilaterals.
    ///
    /// # Errors
    ///
    /// Returns the points at which elements must be smaller, if no mesh can be made.
    fn drafted(&self, style: Style) -> Result<Draft, Vec<Point>> {
        let Task { outline, sizes, .. } = *self;
        let mut planar = Planar::new(outline, sizes);
        let lines = self.lines.iter().enumerate();
        lines.for_each(|(number, (line, in_part))| planar.follow_curve(number, line, *in_part));
        self.points.iter().for_each(|&p| planar.follow_point(p));
        let (vertices, pieces) = planar.finish();
        let (mut seeds, grid) = seed(outline, sizes, vertices, &pieces, style);
        let triangles = Triangles::new(&mut seeds, sizes, style, |chord: &Chord| pieces[chord.piece].of.is_side())?;
        let elements = pairing::pair(&triangles, &seeds.points, |a, b| grid.is_along(a, b));
        Ok(Draft { seeds, pieces, elements })
    }

    /// Makes a smoothed mesh of a draft, with triangles merged in pairs where possible. If its smallest angle is too
    /// sharp, it is compared with a mesh without merging.
    ///
    /// # Errors
    ///
    /// Returns the points at which elements must be smaller, if no mesh can be made.
    fn made(&self, draft: Draft) -> Result<Quadratic, Vec<Point>> {
        let Draft { mut seeds, pieces, elements: paired } = draft;
        let chords = Chords::new(&seeds.chords, &pieces);
        let before = seeds.points.clone();
        let many = paired.len() > MANY;
        let mut result = Err(Vec::new());
        for led in if paired.len() < FEW { &[false][..] } else { &[true, false] } {
            let mut elements = paired.clone();
            if *led {
                tunnels::join(&mut elements, &before, &chords, self.sizes, if many { CAUTIOUS } else { LEAST_MERGED });
            }
            seeds.points.copy_from_slice(&before);
            result = match (result, self.shaped(&mut seeds, &pieces, &elements)) {
                (Ok(one), Err(_)) => Ok(one),
                (Ok(one), Ok(other)) => Ok(better(one, other)),
                (Err(_), made) => made,
            };
            if result.as_ref().is_ok_and(|mesh| many || mesh.measures().1 >= self.sharp) {
                break;
            }
        }
        result
    }

    /// Smooths the positions of the nodes and makes quadratic elements.
    ///
    /// # Errors
    ///
    /// Returns the points at which elements must be smaller, if elements are inverted or nearly so.
    fn shaped(&self, seeds: &mut Seeds, pieces: &[Piece], elements: &[Corners]) -> Result<Quadratic, Vec<Point>> {
        let mut freedom = vec![Freedom::None; seeds.fixed_points];
        freedom.resize(seeds.points.len(), Freedom::Plane);
        for chord in &seeds.chords {
            for (end, other) in [(0, 1), (1, 0)] {
                let node = chord.ends[end];
                let Some((piece, t)) = seeds.on[node] else {
                    continue;
                };
                // A node moves along its curve at most a quarter of the way to the node before or after it.
                let bound = 0.75 * t + 0.25 * chord.span[other];
                let [low, high] = match freedom[node] {
                    Freedom::Along(_, _, [first, _]) => [first.min(bound), first.max(bound)],
                    _ => [bound; 2],
                };
                freedom[node] = Freedom::Along(pieces[piece].curve, t, [low, high]);
            }
        }
        smooth(&mut seeds.points, elements, &mut freedom);
        let made = Quadratic::new(pieces, seeds, elements, &freedom);
        let folded = made.folded();
        if folded.is_empty() { Ok(made) } else { Err(folded) }
    }
}
