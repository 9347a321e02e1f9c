//! Meshes of 8-node quadrilaterals, with 6-node triangles where none fit, of plates with any outline.
//!
//! The outline is checked (`outline`), brought into a form that depends on no unit, place or order (`normal`), and turned
//! into the direction that most of it has; lines to follow are cut where they meet it (`planar`). Nodes are placed along them and on a lattice that is finer where elements must be smaller
//! (`sizes`, `seeding`), joined to Delaunay triangles (`triangles`), these to quadrilaterals (`pairing`), those left over
//! too, as far as they can be led together (`tunnels`), and nodes are moved to better places (`smoothing`). The same
//! input gives the same bits.

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

/// A line or arc for sides of elements to follow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line {
    pub ends: [Point; 2],
    /// A point that it is an arc through; `None`: it is straight.
    pub through: Option<Point>,
    /// Order in which lines are followed; the least first.
    pub rank: usize,
    /// Whether the line may be followed in part: its parts inside the plate that keep half an element from the outline
    /// and from followed lines. Otherwise it is followed as a whole, if it lies within the plate.
    pub in_part: bool,
}

/// How a plate is to be meshed.
#[derive(Clone, Debug)]
pub struct MeshOptions {
    /// Largest side of an element, were they all squares.
    pub size: f64,
    pub refinements: Vec<Refinement>,
    pub lines: Vec<Line>,
    /// Points that become nodes where they keep their distance from others.
    pub points: Vec<Point>,
    /// Elements at most, about; 10⁷ if it is not said.
    pub most: Option<usize>,
    /// The axes along which the plate is meshed, ±x and ±y in either order. Seen along them alike, mirrored and turned
    /// plates have the same mesh, mirrored and turned.
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
    /// Corners counter-clockwise, then the nodes in the middle of the sides, the first between the first two corners.
    /// A triangle repeats its third corner: [a, b, c, c, ab, bc, c, ca].
    pub elements: Vec<[usize; 8]>,
    /// Corner, middle and corner of each side on the outline, the plate on its left, in order around each loop.
    pub sides: Vec<[usize; 3]>,
    /// The loop of each of them, and the side in it.
    pub side_of: Vec<[usize; 2]>,
    /// The smallest angle at a corner of an element, in degrees.
    pub least_angle: f64,
    /// Share of the area in quadrilaterals.
    pub quadrilaterals: f64,
}

/// Default of the largest number of elements.
const MOST: usize = 10_000_000;
/// Times that a mesh with bad elements is made again with smaller ones about them.
const ATTEMPTS: usize = 8;

/// Meshes a plate by the loops around it, the outline first and then its holes.
///
/// # Errors
///
/// If loops cross, touch or all but touch themselves or each other, or a hole is outside; with the side and the place.
///
/// # Panics
///
/// If a loop has no sides, or lists of different lengths.
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
    // Chords along arcs are much shorter than elements: too large a mesh is refused before chords are made.
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

/// Acceptance of the first mesh: area of quadrilaterals relative to the plate, smallest angle in degrees. A mesh of at least
/// `MANY` elements is dominated by its interior lattice and made in one style only.
const ENOUGH: f64 = 0.99;
const SHARP: f64 = 40.0;
const MANY: usize = 20_000;
/// So few elements keep their triangles: longer quadrilaterals in their place would cost more than they bring.
const FEW: usize = 28;
/// Least quality, before smoothing, of elements made by merging triangles; and the same in meshes of many elements,
/// which are not made again without merging where it leaves sharp angles.
const LEAST_MERGED: f64 = 0.05;
const CAUTIOUS: f64 = 0.3;

/// The better of two meshes, of equal ones the first.
fn better(one: Quadratic, other: Quadratic) -> Quadratic {
    let rank = |mesh: &Quadratic| {
        let (share, angle) = mesh.measures();
        // Up to here a degree of the smallest angle counts as much as a fiftieth of the area.
        100.0 * share + 2.0 * angle.min(SHARP)
    };
    if rank(&other) > rank(&one) { other } else { one }
}

/// Nodes and elements before they are shaped.
struct Draft {
    seeds: Seeds,
    pieces: Vec<Piece>,
    elements: Vec<Corners>,
}

struct Task<'a> {
    outline: &'a Outline,
    sizes: &'a Sizes,
    /// And whether they are followed in part.
    lines: &'a [(Curve, bool)],
    points: &'a [Point],
    /// The smallest angle that is good enough.
    sharp: f64,
}

impl Task<'_> {
    /// The first mesh that is good enough, or else the best, of those in several styles.
    ///
    /// # Errors
    ///
    /// The places where elements must be smaller.
    fn best(&self, slant: Option<f64>) -> Result<Quadratic, Vec<Point>> {
        // A lattice at the slant fits such a plate without triangles, or is one style among others.
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

    /// Triangles paired in a style.
    ///
    /// # Errors
    ///
    /// The places where elements must be smaller.
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

    /// Finishes a draft, with triangles merged where possible or with all of them, and smooths it.
    ///
    /// # Errors
    ///
    /// The places where elements must be smaller.
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

    /// Elements with their nodes moved to better places.
    ///
    /// # Errors
    ///
    /// The places where elements must be smaller.
    fn shaped(&self, seeds: &mut Seeds, pieces: &[Piece], elements: &[Corners]) -> Result<Quadratic, Vec<Point>> {
        let mut freedom = vec![Freedom::None; seeds.fixed_points];
        freedom.resize(seeds.points.len(), Freedom::Plane);
        for chord in &seeds.chords {
            for (end, other) in [(0, 1), (1, 0)] {
                let node = chord.ends[end];
                let Some((piece, t)) = seeds.on[node] else {
                    continue;
                };
                // It stays in the middle half of the way to the nodes before and after it.
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
