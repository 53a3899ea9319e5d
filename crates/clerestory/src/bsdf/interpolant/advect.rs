//! Lobes between measured directions.

use super::distribution::Distribution;
use super::lobe::Lobe;
use super::plan::{Move, NONE};
use crate::direction::Disk;

/// Moves between two neighbours, sorted for a look from either.
#[derive(Debug, Clone)]
pub struct Edge {
    /// As they are kept in files.
    pub moves: Vec<Move>,
    forth: Side,
    back: Side,
}

/// Moves by the lobe of one end.
#[derive(Debug, Clone)]
struct Side {
    /// First entry of each lobe in `entries`, and the end.
    first: Vec<u32>,
    entries: Vec<Entry>,
    /// Those without a lobe at this end.
    fresh: Vec<Entry>,
}

/// A lobe at the other end, what it takes here and what it is there.
#[derive(Debug, Clone, Copy)]
struct Entry {
    other: u32,
    here: f64,
    there: f64,
}

impl Edge {
    /// Of the moves from `a` to `b`.
    pub fn new(moves: Vec<Move>, a: &Distribution, b: &Distribution) -> Self {
        let forth = Side::new(
            moves.iter().map(|m| {
                (
                    m.from,
                    Entry {
                        other: m.to,
                        here: m.before,
                        there: m.after,
                    },
                )
            }),
            a.lobes.len(),
            &b.lobes,
        );
        let back = Side::new(
            moves.iter().map(|m| {
                (
                    m.to,
                    Entry {
                        other: m.from,
                        here: m.after,
                        there: m.before,
                    },
                )
            }),
            b.lobes.len(),
            &a.lobes,
        );
        Self { moves, forth, back }
    }
}

impl Side {
    fn new(moves: impl Iterator<Item = (u32, Entry)>, lobes: usize, others: &[Lobe]) -> Self {
        let (fresh, mut known): (Vec<_>, Vec<_>) = moves.partition(|(own, _)| *own == NONE);
        // In one order of place, so that what splits on two edges splits alike.
        let place = |e: &Entry| {
            let centre = others.get(e.other as usize).map_or(Disk::NORMAL, |l| l.centre);
            centre.x + 0.618 * centre.y
        };
        known.sort_by(|a, b| a.0.cmp(&b.0).then(place(&a.1).total_cmp(&place(&b.1))));
        let mut first = vec![0; lobes + 1];
        for (own, _) in &known {
            first[*own as usize + 1] += 1;
        }
        for k in 0..lobes {
            first[k + 1] += first[k];
        }
        Self {
            first,
            entries: known.into_iter().map(|(_, e)| e).collect(),
            fresh: fresh.into_iter().map(|(_, e)| e).collect(),
        }
    }

    fn of(&self, lobe: usize) -> &[Entry] {
        &self.entries[self.first[lobe] as usize..self.first[lobe + 1] as usize]
    }
}

/// A corner's lobes and its shares of flux and of position.
#[derive(Clone, Copy)]
pub struct Corner<'a> {
    /// What was measured there.
    pub measured: &'a Distribution,
    /// Share of what it carries.
    pub share: f64,
    /// Share of its position.
    pub reach: f64,
}

/// All corners' lobes in their places, by their shares: what fades in one place and grows in another.
pub fn blended(corners: &[Corner<'_>]) -> Vec<Lobe> {
    let mut lobes = Vec::new();
    for corner in corners.iter().filter(|c| c.share > 0.0) {
        lobes.extend(corner.measured.lobes.iter().map(|l| Lobe {
            flux: l.flux * corner.share,
            ..*l
        }));
    }
    lobes
}

/// A lobe of corners' lobes, each with the flux that it gives; None where that is nothing.
fn moved(parts: &[(Corner<'_>, u32, f64)], factor: f64) -> Option<Lobe> {
    let there = |part: &&(Corner<'_>, u32, f64)| part.1 != NONE;
    let whole = parts.iter().all(|p| p.1 != NONE);
    let flux: f64 = factor * parts.iter().map(|(c, _, flux)| c.share * flux).sum::<f64>();
    if flux <= 0.0 {
        return None;
    }
    // What is not everywhere stays where it is.
    let reach = |c: &Corner<'_>| if whole { c.reach } else { c.share };
    let reaches: f64 = parts.iter().filter(there).map(|(c, ..)| reach(c)).sum();
    let shares: f64 = parts.iter().filter(there).map(|(c, ..)| c.share).sum();
    let (mut x, mut y, mut radius2) = (0.0, 0.0, 0.0);
    for (corner, lobe, _) in parts.iter().filter(there) {
        let lobe = &corner.measured.lobes[*lobe as usize];
        x += reach(corner) / reaches * lobe.centre.x;
        y += reach(corner) / reaches * lobe.centre.y;
        radius2 += corner.share / shares * lobe.radius2;
    }
    Some(Lobe {
        centre: Disk::new(x, y),
        radius2,
        flux,
    })
}

/// Between two neighbours.
pub fn along(a: Corner<'_>, b: Corner<'_>, edge: &Edge) -> Vec<Lobe> {
    edge.moves
        .iter()
        .filter_map(|m| moved(&[(a, m.from, m.before), (b, m.to, m.after)], 1.0))
        .collect()
}

/// Within a triangle. Seen from each corner, its lobes split as both edges say; the three views are mixed by the corners'
/// shares, so that on an edge only the views of its ends are left, which agree with the edge's plan.
pub fn within(corners: [Corner<'_>; 3], edges: [(&Edge, bool); 3]) -> Vec<Lobe> {
    /// Least part of a lobe that is followed.
    const SLIVER: f64 = 1e-3;
    let mut lobes = Vec::new();
    // Edges 01, 12, 02; true where the edge was made from its first corner to its second.
    let side = |edge: usize, from_first: bool| {
        let (edge, straight) = edges[edge];
        if straight == from_first {
            &edge.forth
        } else {
            &edge.back
        }
    };
    let views = [
        (0, 1, 2, side(0, true), side(2, true)),
        (1, 0, 2, side(0, false), side(1, true)),
        (2, 0, 1, side(2, false), side(1, false)),
    ];
    for (own, left, right, to_left, to_right) in views {
        let view = corners[own].share;
        if view <= 0.0 {
            continue;
        }
        for (i, lobe) in corners[own].measured.lobes.iter().enumerate() {
            let (first, second) = (to_left.of(i), to_right.of(i));
            let share = |e: &Entry| e.here / lobe.flux;
            let (mut a, mut b) = (0, 0);
            let (mut left_of_a, mut left_of_b) = (first.first().map_or(0.0, share), second.first().map_or(0.0, share));
            while a < first.len() && b < second.len() {
                let part = left_of_a.min(left_of_b);
                if part > SLIVER * share(&first[a]).min(share(&second[b])) && part > 0.0 {
                    let of = |e: &Entry| e.there * part / share(e);
                    lobes.extend(moved(
                        &[
                            (corners[own], i as u32, lobe.flux * part),
                            (corners[left], first[a].other, of(&first[a])),
                            (corners[right], second[b].other, of(&second[b])),
                        ],
                        view,
                    ));
                }
                left_of_a -= part;
                left_of_b -= part;
                if left_of_a <= left_of_b {
                    a += 1;
                    left_of_a = first.get(a).map_or(0.0, share);
                } else {
                    b += 1;
                    left_of_b = second.get(b).map_or(0.0, share);
                }
            }
        }
        for (corner, side) in [(corners[left], to_left), (corners[right], to_right)] {
            lobes.extend(
                side.fresh
                    .iter()
                    .filter_map(|e| moved(&[(corner, e.other, e.there)], view)),
            );
        }
    }
    lobes
}
