//! An interpolant as arrays, and back.

use super::distribution::WORDS;
use super::{Distribution, Interpolant, Lobe, Method, Move, mesh_of, plan};
use crate::direction::Disk;
use crate::error::{Error, Result};

/// Arrays of an interpolant.
pub struct Stored {
    /// Word of the method.
    pub method: Method,
    /// Whether all azimuths are alike.
    pub isotropic: bool,
    /// x, y, floor, beam, extent, limit and number of lobes of each distribution.
    pub distributions: Vec<f64>,
    /// x, y, radius² and flux of each lobe.
    pub lobes: Vec<f64>,
    /// What was measured, [`WORDS`] numbers a distribution.
    pub covered: Vec<u32>,
    /// From, to and number of moves of each edge; then from and to of each move.
    pub edges: Vec<u32>,
    /// Flux before and after of each move.
    pub fluxes: Vec<f64>,
}

const COLUMNS: usize = 7;

impl Interpolant {
    /// As arrays.
    pub fn stored(&self) -> Stored {
        let data = &*self.data;
        let mut stored = Stored {
            method: data.method,
            isotropic: data.isotropic,
            distributions: Vec::new(),
            lobes: Vec::new(),
            covered: Vec::new(),
            edges: Vec::new(),
            fluxes: Vec::new(),
        };
        for d in &data.distributions {
            let count = d.lobes.len() as f64;
            let row = [d.incident.x, d.incident.y, d.floor, d.beam, d.extent, d.limit, count];
            stored.distributions.extend(row);
            for l in &d.lobes {
                stored.lobes.extend([l.centre.x, l.centre.y, l.radius2, l.flux]);
            }
            stored.covered.extend(d.covered);
        }
        for (&(a, b), edge) in &data.edges {
            stored.edges.extend([a as u32, b as u32, edge.moves.len() as u32]);
            for m in &edge.moves {
                stored.edges.extend([m.from, m.to]);
                stored.fluxes.extend([m.before, m.after]);
            }
        }
        stored
    }

    /// From arrays.
    pub fn from_stored(stored: &Stored) -> Result<Self> {
        let broken = |what: &str| Error::Argument(format!("an interpolant cannot be put together: {what}"));
        let rows = stored.distributions.as_chunks::<COLUMNS>();
        let lobes = stored.lobes.as_chunks::<4>();
        if !rows.1.is_empty() || !lobes.1.is_empty() || rows.0.is_empty() {
            return Err(broken("its arrays have no whole rows"));
        }
        if stored.covered.len() != rows.0.len() * WORDS {
            return Err(broken("what was measured does not go with its distributions"));
        }
        let numbers = stored.distributions.iter().chain(&stored.lobes).chain(&stored.fluxes);
        if numbers.clone().any(|v| !v.is_finite()) {
            return Err(broken("a number is not finite"));
        }
        let mut left = lobes.0;
        let mut distributions = Vec::with_capacity(rows.0.len());
        for (row, covered) in rows.0.iter().zip(stored.covered.as_chunks::<WORDS>().0) {
            let &[x, y, floor, beam, extent, limit, count] = row;
            if !(count >= 0.0 && count.fract() == 0.0 && count <= left.len() as f64) {
                return Err(broken("there are not as many lobes as it says"));
            }
            if x.hypot(y) > 1.0 + 1e-9 || floor < 0.0 || beam < 0.0 || extent < 0.0 {
                return Err(broken("a distribution is out of range"));
            }
            let (own, rest) = left.split_at(count as usize);
            left = rest;
            if own
                .iter()
                .any(|l| l[0].hypot(l[1]) > 1.0 + 1e-9 || l[2] <= 0.0 || l[3] <= 0.0)
            {
                return Err(broken("a lobe is out of range"));
            }
            distributions.push(Distribution {
                incident: Disk::new(x, y),
                lobes: own
                    .iter()
                    .map(|&[x, y, radius2, flux]| Lobe {
                        centre: Disk::new(x, y),
                        radius2,
                        flux,
                    })
                    .collect(),
                floor,
                beam,
                extent,
                limit,
                covered: *covered,
            });
        }
        if !left.is_empty() {
            return Err(broken("there are more lobes than it says"));
        }
        let mesh = mesh_of(&distributions, stored.isotropic)?;
        let moves = moves(stored, &distributions).ok_or_else(|| broken("its moves do not go with its lobes"))?;
        let known: Vec<(usize, usize)> = moves.iter().map(|m| m.0).collect();
        if stored.method == Method::Transport && known != mesh.edges() {
            return Err(broken("its edges are not those of its incident directions"));
        }
        Self::put_together(distributions, stored.isotropic, stored.method, mesh, moves.into_iter())
    }
}

type Edges = Vec<((usize, usize), Vec<Move>)>;

fn moves(stored: &Stored, distributions: &[Distribution]) -> Option<Edges> {
    let (mut words, mut fluxes) = (&stored.edges[..], &stored.fluxes[..]);
    let mut edges = Vec::new();
    while !words.is_empty() {
        let (&[a, b, count], rest) = words.split_first_chunk::<3>()?;
        let (a, b) = (a as usize, b as usize);
        let (from, to) = (distributions.get(a)?.lobes.len(), distributions.get(b)?.lobes.len());
        words = rest;
        let count = count as usize;
        if words.len() < 2 * count || fluxes.len() < 2 * count {
            return None;
        }
        let (own, rest) = words.split_at(2 * count);
        let (flux, others) = fluxes.split_at(2 * count);
        (words, fluxes) = (rest, others);
        let within = |lobe: u32, lobes: usize| lobe == plan::NONE || (lobe as usize) < lobes;
        let mut moves = Vec::with_capacity(count);
        for (&[f, t], &[before, after]) in own.as_chunks::<2>().0.iter().zip(flux.as_chunks::<2>().0) {
            if !within(f, from) || !within(t, to) || before < 0.0 || after < 0.0 {
                return None;
            }
            moves.push(Move {
                from: f,
                to: t,
                before,
                after,
            });
        }
        edges.push(((a, b), moves));
    }
    fluxes.is_empty().then_some(edges)
}
