//! An isotropic tree with its paths travelled backwards: exact totals, and samples of constant weight.
//!
//! Backwards, the incident direction is the outgoing one of the tree, and only its distance from the normal counts: turned
//! about the normal by all azimuths it is a circle in the disk. The concentric map makes of this circle the outline of a
//! square, and of equal azimuths equal lengths, so the tree's cells cut the outline at their edges. A cell that the circle
//! crosses thus stands for outgoing directions between two radii and between two azimuths: all is sums over such
//! *pieces*, without any error.
//!
//! Half of the square's side, counted in the finest cells, is *R*. Its whole number is the *ring* of cells that the
//! outline lies in. Within a ring the same cells are crossed, each along its whole edge, but for the four at the corners;
//! so a piece begins and ends at a R + b along the outline with whole a and b, and every sum is linear in R. What a ring
//! needs is found when it is first asked for.

use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::OnceLock;

use super::{Entry, Tree, decode};
use crate::direction::Disk;

/// Incident directions this near to the normal are the normal; nearer still, rounding decides on the cell.
const NORMAL: f64 = 1e-12;

/// No number, where a child is missing.
const NONE: u32 = u32::MAX;

/// a R + b.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Linear {
    slope: f64,
    offset: f64,
}

impl Linear {
    fn new(slope: f64, offset: f64) -> Self {
        Self { slope, offset }
    }

    fn at(self, half: f64) -> f64 {
        self.slope * half + self.offset
    }

    fn plus(self, other: Self, factor: f64) -> Self {
        Self::new(self.slope + factor * other.slope, self.offset + factor * other.offset)
    }
}

/// A leaf that the outline crosses.
#[derive(Debug)]
struct Piece {
    /// Number of the cell along the outline, among those of the leaf's size.
    cell: u32,
    /// Flux times R of it and the ones before it.
    flux: Linear,
}

/// Leaves that the outline crosses, between two outgoing radii.
#[derive(Debug)]
struct Node {
    /// Leaves as long as this interval of radii.
    pieces: std::ops::Range<u32>,
    /// The outer and the inner half of the interval, for smaller leaves.
    halves: [u32; 2],
    /// Flux times R of all.
    flux: Linear,
}

/// All that one ring of cells holds.
#[derive(Debug, Default)]
struct Ring {
    nodes: Vec<Node>,
    pieces: Vec<Piece>,
}

/// The reverse of an isotropic tree, which is not stored here.
#[derive(Debug)]
pub(in crate::bsdf) struct Backwards {
    depth: u32,
    normal: OnceLock<Ring>,
    rings: Box<[OnceLock<Ring>]>,
}

/// Where an incident direction lies: its ring, none for the normal, and R.
#[derive(Debug, Clone, Copy)]
struct Place {
    ring: Option<u32>,
    half: f64,
}

impl Place {
    fn new(depth: u32, incident: Disk) -> Self {
        let r = incident.sin2_theta().sqrt();
        if r < NORMAL {
            return Self { ring: None, half: 1.0 };
        }
        // A hair less, as in the map.
        let half = r * (1.0 - 1e-13) * 2_f64.powi(depth as i32 - 1);
        let last = (1_u32 << depth) / 2;
        Self {
            ring: Some((half as u32).min(last.saturating_sub(1))),
            half,
        }
    }

    /// Ring among the cells of a level.
    fn at_level(self, depth: u32, level: u32) -> Option<u32> {
        self.ring.map(|ring| ring >> (depth - level))
    }
}

/// Between which two lengths along the outline a cell lies; `ring` and `cell` count cells that are `width` wide.
fn limits(level: u32, ring: Option<u32>, cell: u32, width: f64) -> [Linear; 2] {
    let Some(ring) = ring.filter(|_| level > 0) else {
        // At the normal one quadrant stands for all azimuths.
        return [Linear::new(0.0, 0.0), Linear::new(8.0, 0.0)];
    };
    let (quadrant, along) = (cell / (2 * ring + 1), cell % (2 * ring + 1));
    let begin = 2.0 * f64::from(quadrant);
    // Up one side, about the corner, and along the next side.
    let before = |cells: u32| Linear::new(begin, width * f64::from(cells));
    let after = |cells: u32| Linear::new(begin + 2.0, -width * f64::from(cells));
    let first = if along <= ring {
        before(along)
    } else {
        after(2 * ring + 1 - along)
    };
    let last = if along < ring {
        before(along + 1)
    } else {
        after(2 * ring - along)
    };
    [first, last]
}

/// The cells of half the width that the outline crosses in one cell, in order: their number along the outline and their
/// place in the block (axes 1 and 2).
fn below(level: u32, ring: Option<u32>, cell: u32, finer: Option<u32>) -> impl Iterator<Item = (u32, usize)> {
    let (quadrants, alongs) = match (ring, finer) {
        (Some(ring), Some(finer)) => {
            let (quadrant, along) = (cell / (2 * ring + 1), cell % (2 * ring + 1));
            let alongs = match along {
                _ if along < ring => 2 * along..2 * along + 2,
                // The corner: its inner quarter alone, or the three others.
                _ if along == ring && finer == 2 * ring => finer..finer + 1,
                _ if along == ring => finer - 1..finer + 2,
                _ => {
                    let last = 2 * finer - 2 * (2 * ring - along);
                    last - 1..last + 1
                }
            };
            let quadrants = if level == 0 { 0..4 } else { quadrant..quadrant + 1 };
            (quadrants, alongs)
        }
        _ => (0..1, 0..1),
    };
    let ring = finer.unwrap_or(0);
    quadrants.flat_map(move |quadrant| {
        alongs.clone().map(move |along| {
            let (mut x, mut y) = if along <= ring {
                (i64::from(ring), i64::from(along))
            } else {
                (i64::from(2 * ring - along), i64::from(ring))
            };
            for _ in 0..quadrant {
                (x, y) = (-1 - y, x);
            }
            let middle = 1_i64 << level;
            let bit = |place: i64| (place + middle) as usize & 1;
            (quadrant * (2 * ring + 1) + along, bit(x) << 1 | bit(y) << 2)
        })
    })
}

/// Least and largest outgoing radius of an interval of axis 0.
fn radii(level: u32, index: u32) -> [f64; 2] {
    let width = 2.0 * 0.5_f64.powi(level as i32);
    let outer = 1.0 - width * f64::from(index);
    [(outer - width).max(0.0), outer]
}

/// Makes a ring.
struct Builder<'a> {
    tree: &'a Tree,
    place: Place,
    ring: Ring,
}

impl Builder<'_> {
    /// Adds the node of an interval of axis 0, for the entries that the outline crosses. Its number; [`NONE`] if dark.
    fn node(&mut self, level: u32, index: u32, crossed: &[(u32, u32)]) -> u32 {
        let depth = self.tree.depth;
        let ring = self.place.at_level(depth, level);
        let width = f64::from(1_u32 << (depth - level));
        let [inner, outer] = radii(level, index);
        let share = 0.5 * (outer * outer - inner * inner) * FRAC_PI_4;
        let first = self.ring.pieces.len() as u32;
        let mut flux = Linear::default();
        for &(entry, cell) in crossed {
            if let Entry::Value(value) = decode(entry)
                && value > 0.0
            {
                let [from, to] = limits(level, ring, cell, width);
                flux = flux.plus(to.plus(from, -1.0), share * f64::from(value));
                self.ring.pieces.push(Piece { cell, flux });
            }
        }
        let pieces = first..self.ring.pieces.len() as u32;
        let mut halves = [NONE; 2];
        // The upper half of the whole axis is unused.
        for half in 0..if level == 0 { 1 } else { 2 } {
            let mut smaller = Vec::new();
            for &(entry, cell) in crossed {
                if let Entry::Block(block) = decode(entry) {
                    let block = self.tree.block(block);
                    let finer = self.place.at_level(depth, level + 1);
                    smaller.extend(below(level, ring, cell, finer).map(|(cell, child)| (block[child | half], cell)));
                }
            }
            if !smaller.is_empty() {
                let node = self.node(level + 1, index << 1 | half as u32, &smaller);
                halves[half] = node;
                if node != NONE {
                    flux = flux.plus(self.ring.nodes[node as usize].flux, 1.0);
                }
            }
        }
        if flux == Linear::default() {
            return NONE;
        }
        self.ring.nodes.push(Node { pieces, halves, flux });
        self.ring.nodes.len() as u32 - 1
    }
}

impl Backwards {
    /// Of a tree of rank 3; each method is to be given the same tree.
    pub fn new(tree: &Tree) -> Self {
        let rings = (1_usize << tree.depth).div_ceil(2);
        Self {
            depth: tree.depth,
            normal: OnceLock::new(),
            rings: (0..rings).map(|_| OnceLock::new()).collect(),
        }
    }

    fn ring(&self, tree: &Tree, place: Place) -> &Ring {
        let slot = place.ring.map_or(&self.normal, |ring| &self.rings[ring as usize]);
        slot.get_or_init(|| {
            let mut builder = Builder {
                tree,
                place,
                ring: Ring::default(),
            };
            builder.node(0, 0, &[(tree.root, 0)]);
            builder.ring
        })
    }

    /// Direct-hemispherical value.
    pub fn total(&self, tree: &Tree, incident: Disk) -> f64 {
        let place = Place::new(self.depth, incident);
        let root = self.ring(tree, place).nodes.last();
        root.map_or(0.0, |root| root.flux.at(place.half) / place.half)
    }

    /// A direction with a density in proportion to the value; none where nothing leaves.
    pub fn sample(&self, tree: &Tree, incident: Disk, u: [f64; 2]) -> Option<Disk> {
        // Rounding must not move a point at a cell's edge into the neighbour.
        const MARGIN: f64 = 1e-9;
        let place = Place::new(self.depth, incident);
        let ring = self.ring(tree, place);
        let half = place.half;
        let (mut level, mut index) = (0, 0);
        let mut node = ring.nodes.last().filter(|root| root.flux.at(half) > 0.0)?;
        let [u_azimuth, mut u_radius] = u;
        let pieces = loop {
            let pieces = &ring.pieces[node.pieces.start as usize..node.pieces.end as usize];
            let own = pieces.last().map_or(0.0, |p| p.flux.at(half));
            let below = node.halves.map(|h| ring.nodes.get(h as usize));
            let [outer, inner] = below.map(|h| h.map_or(0.0, |h| h.flux.at(half)));
            let target = u_radius * (own + outer + inner);
            if target < own || outer + inner <= 0.0 {
                u_radius = target / own;
                break pieces;
            }
            let (child, part, whole) = if target < own + outer || inner <= 0.0 {
                (0, target - own, outer)
            } else {
                (1, target - own - outer, inner)
            };
            u_radius = (part / whole).min(1.0 - f64::EPSILON);
            node = below[child]?;
            level += 1;
            index = index << 1 | child as u32;
        };
        // Less than all, so that it ends in a piece of some length.
        let target = u_azimuth.min(1.0 - 1e-12) * pieces.last()?.flux.at(half);
        let at = pieces
            .partition_point(|p| p.flux.at(half) <= target)
            .min(pieces.len() - 1);
        let before = at.checked_sub(1).map_or(0.0, |p| pieces[p].flux.at(half));
        let within = (target - before) / (pieces[at].flux.at(half) - before);
        let inside = |u: f64| u.clamp(MARGIN, 1.0 - MARGIN);
        let width = f64::from(1_u32 << (self.depth - level));
        let [from, to] =
            limits(level, place.at_level(self.depth, level), pieces[at].cell, width).map(|limit| limit.at(half));
        let azimuth = FRAC_PI_4 * (from + (to - from) * inside(within)) / half;
        let [inner, outer] = radii(level, index).map(|r| r * r);
        let radius = (outer + (inner - outer) * inside(u_radius)).sqrt();
        // The circle runs the other way round: the larger its azimuth, the farther back the outgoing direction.
        let (sin, cos) = azimuth.sin_cos();
        let along = if place.ring.is_some() {
            incident.turned(-sin, cos)
        } else {
            Disk::new(cos, -sin)
        };
        let length = along.sin2_theta().sqrt();
        Some(Disk::new(along.x * radius / length, along.y * radius / length))
    }

    /// Projected solid angle (sr) of the outgoing directions that share the cell of a pair; the cell is a leaf `level`
    /// levels below the root.
    pub fn area(&self, incident: Disk, outgoing: Disk, level: u32) -> f64 {
        let place = Place::new(self.depth, incident);
        let cells = f64::from(1_u32 << level);
        let r = outgoing.sin2_theta().sqrt();
        let axis = (0.5 - 0.5 * r).clamp(0.0, 0.5 - 5e-7);
        let [inner, outer] = radii(level, (axis * cells) as u32);
        let annulus = 0.5 * (outer * outer - inner * inner);
        let Some(ring) = place.at_level(self.depth, level).filter(|_| level > 0) else {
            return 2.0 * PI * annulus;
        };
        let on_outline = super::Rank::Isotropic.into_frame(outgoing.reversed(), incident.reversed());
        // Distance from the middle, of the cell's side that is nearer, in cells of this level.
        let [x, y] = on_outline.to_square().map(|s| {
            let place = (s * cells).floor() - 0.5 * cells;
            if place < 0.0 { -1.0 - place } else { place }
        });
        let half = place.half / f64::from(1_u32 << (self.depth - level));
        let corner = x.min(y) >= f64::from(ring);
        let length = if corner { 2.0 * (half - f64::from(ring)) } else { 1.0 };
        annulus * FRAC_PI_4 * length / half
    }

    /// Upper limit of the distance between an outgoing direction and others of its cell, which is one of the finest.
    pub fn extent(&self, incident: Disk, outgoing: Disk) -> f64 {
        let place = Place::new(self.depth, incident);
        let width = 2.0 * 0.5_f64.powi(self.depth as i32);
        // The longest pieces of the outline go about a corner: two cells.
        let azimuth = place.ring.map_or(2.0 * PI, |_| FRAC_PI_4 * 2.0 / place.half);
        let outer = (outgoing.sin2_theta().sqrt() + width).min(1.0);
        (width + outer * azimuth).min(2.0)
    }

    /// The normal, for directions that are as good as it.
    pub fn settled(incident: Disk) -> Disk {
        if incident.sin2_theta().sqrt() < NORMAL {
            Disk::NORMAL
        } else {
            incident
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Rank;
    use super::super::testing::{Stream, random};
    use super::*;
    use crate::bsdf::Scatterer;

    /// Incident directions: ordinary ones, on the borders of cells, in corners, at the normal and at the horizon.
    fn incident(stream: &mut Stream) -> Vec<Disk> {
        let fixed = [0.0, 1e-13, 1e-9, 0.125, 0.25, 0.5, 0.75, 1.0 - 1e-9, 1.0];
        let turned = |(k, r): (usize, f64)| Disk::new(r * (1.0 + k as f64).cos(), r * (1.0 + k as f64).sin());
        let fixed = fixed.into_iter().enumerate().map(turned);
        fixed.chain((0..40).map(|_| stream.disk())).collect()
    }

    fn value(tree: &Tree, incident: Disk, outgoing: Disk) -> f64 {
        tree.evaluate(outgoing.reversed(), Backwards::settled(incident).reversed())
    }

    /// ∫ f over outgoing projected solid angles, by one point in each part of the disk in which f is constant.
    fn quadrature(tree: &Tree, incident: Disk, area: impl Fn(Disk, f64) -> f64) -> f64 {
        let cells = 1_u32 << tree.depth();
        let half = incident.sin2_theta().sqrt() * f64::from(cells) / 2.0;
        // Where the outline is cut, in units of its length, from the azimuth of the incident direction on.
        let mut cuts = vec![0.0, 1.0];
        for side in 0..8 {
            let along = |k: u32| (f64::from(side) * half + f64::from(k)) / (8.0 * half);
            cuts.extend((0..=half as u32).filter(|_| side % 2 == 0).map(along));
            let along = |k: u32| (f64::from(side + 1) * half - f64::from(k)) / (8.0 * half);
            cuts.extend((0..=half as u32).filter(|_| side % 2 == 1).map(along));
        }
        cuts.retain(|cut| (0.0..=1.0).contains(cut));
        cuts.sort_unstable_by(f64::total_cmp);
        let rings = (cells / 2).max(1);
        let mut sum = 0.0;
        for ring in 0..rings {
            let [r0, r1] = [ring, ring + 1].map(|k| f64::from(k) / f64::from(rings));
            for pair in cuts.windows(2).filter(|p| p[1] - p[0] > 1e-12) {
                let azimuth = incident.phi() - PI * (pair[0] + pair[1]);
                let r = 0.5 * (r0 + r1);
                let outgoing = Disk::new(r * azimuth.cos(), r * azimuth.sin());
                let part = PI * (r1 * r1 - r0 * r0) * (pair[1] - pair[0]);
                sum += value(tree, incident, outgoing) * area(outgoing, part);
            }
        }
        sum
    }

    #[test]
    fn totals_are_sums_over_all_pieces() {
        for (depth, seed) in [(0, 1), (1, 2), (2, 3), (4, 4), (5, 5)] {
            let tree = random(Rank::Isotropic, depth, seed);
            let backwards = Backwards::new(&tree);
            for incident in incident(&mut Stream::new(seed)) {
                let exact = quadrature(&tree, incident, |_, part| part);
                let total = backwards.total(&tree, incident);
                assert!(
                    (total - exact).abs() < 1e-8 * exact.max(1e-3),
                    "{depth} {incident:?}: {total} {exact}"
                );
            }
        }
    }

    #[test]
    fn areas_are_those_of_the_directions_that_share_a_cell() {
        let tree = random(Rank::Isotropic, 4, 6);
        let backwards = Backwards::new(&tree);
        let mut stream = Stream::new(7);
        let incident: Vec<Disk> = (0..10).map(|_| stream.disk()).chain([Disk::NORMAL]).collect();
        for incident in incident {
            let cell = |outgoing: Disk| tree.walk::<3>(Rank::Isotropic.code(outgoing.reversed(), incident.reversed()));
            for _ in 0..10 {
                let (_, place, level) = cell(stream.disk());
                let one = |outgoing: Disk| cell(outgoing).1 == place;
                let (mut found, mut count, n) = (None, 0, 50_000);
                for k in 0..n {
                    let outgoing = Disk::uniform(crate::sequence::r2(k, [0.0; 2]));
                    if one(outgoing) {
                        count += 1;
                        found = Some(backwards.area(incident, outgoing, level));
                    }
                }
                let share = f64::from(count) / f64::from(n);
                let area = found.unwrap_or(0.0) / PI;
                assert!(
                    (area - share).abs() < 1e-3 * share.sqrt() + 1e-4,
                    "{incident:?} {area} {share}"
                );
            }
        }
    }

    #[test]
    fn samples_are_distributed_as_the_values() {
        const DRAWS: u32 = 100_000;
        const BINS: usize = 12;
        for seed in [1, 4] {
            let tree = random(Rank::Isotropic, 4, seed);
            let backwards = Backwards::new(&tree);
            let mut stream = Stream::new(seed);
            for incident in [stream.disk(), stream.disk(), Disk::NORMAL, Disk::new(0.02, -0.03)] {
                let total = backwards.total(&tree, incident);
                let bin = |point: Disk| {
                    let [a, b] = point.to_square().map(|c| (c * BINS as f64) as usize);
                    b * BINS + a
                };
                let (mut expected, mut counts) = ([0.0; BINS * BINS], [0.0; BINS * BINS]);
                let fine = 720_u32;
                for k in 0..fine * fine {
                    let outgoing =
                        Disk::from_square([k % fine, k / fine].map(|c| (f64::from(c) + 0.5) / f64::from(fine)));
                    expected[bin(outgoing)] += value(&tree, incident, outgoing) * PI / f64::from(fine).powi(2);
                }
                for k in 0..DRAWS {
                    let u = [1, 2].map(|s| crate::sequence::uniform(s, k.into()));
                    let outgoing = backwards.sample(&tree, incident, u).unwrap();
                    assert!(value(&tree, incident, outgoing) > 0.0);
                    counts[bin(outgoing)] += 1.0;
                }
                let (mut sum, mut freedom) = (0.0, -1.0);
                for (count, flux) in counts.iter().zip(expected) {
                    let expected = flux / total * f64::from(DRAWS);
                    if expected > 5.0 {
                        sum += (count - expected).powi(2) / expected;
                        freedom += 1.0;
                    }
                }
                let spread: f64 = 2.0 / (9.0 * freedom);
                let z = ((sum / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
                assert!(z.abs() < 3.5, "{seed} {incident:?}: {z}");
            }
        }
    }

    #[test]
    fn extreme_numbers_give_directions_of_light() {
        let tree = random(Rank::Isotropic, 5, 9);
        let backwards = Backwards::new(&tree);
        let mut stream = Stream::new(10);
        for incident in incident(&mut Stream::new(11)) {
            for k in 0..300 {
                let edge = |u: f64| match k % 3 {
                    0 => 0.0,
                    1 => 1.0 - f64::EPSILON / 2.0,
                    _ => u,
                };
                let u = [edge(stream.next()), edge(stream.next())];
                match backwards.sample(&tree, incident, u) {
                    Some(outgoing) => assert!(value(&tree, incident, outgoing) > 0.0, "{incident:?} {u:?}"),
                    None => assert_eq!(backwards.total(&tree, incident), 0.0),
                }
            }
        }
    }

    #[test]
    fn a_dark_tree_has_no_samples() {
        for tree in [
            Tree::constant(Rank::Isotropic, 0.0).unwrap(),
            Tree::from_grid(Rank::Isotropic, 2, &[0.0; 64]).unwrap(),
        ] {
            let backwards = Backwards::new(&tree);
            for incident in [Disk::NORMAL, Disk::new(0.4, 0.4)] {
                assert_eq!(backwards.total(&tree, incident), 0.0);
                assert!(backwards.sample(&tree, incident, [0.5; 2]).is_none());
            }
        }
    }
}
