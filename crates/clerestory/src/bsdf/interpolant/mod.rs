//! Measured distributions of a few incident directions, and what lies between them.
//!
//! * [`fit()`]: from scattered points to lobes.
//! * [`Interpolant`]: the model. Light moves from its place in one measured distribution to its place in the next
//!   ([`Method::Transport`]), so that a peak wanders; the other methods are there to be compared with.

mod advect;
mod clusters;
mod distribution;
mod fit;
mod lobe;
mod mesh;
mod plan;
mod state;
mod store;
mod symmetry;
mod trend;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::turned::Turn;
use super::{Estimate, Part, Peak, Sample, Scatterer};
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::progress::Progress;

pub use distribution::Distribution;
pub use fit::{Points, fit};
pub use lobe::Lobe;
pub use plan::Move;
pub use state::{Raster, State};
pub use store::Stored;
pub use symmetry::Symmetry;

use advect::{Corner, Edge, along, blended, within};
use mesh::{Mesh, Place};
use trend::Trend;

/// What lies between measured directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Light moves (after Ward, Kurt and Bonneel 2014).
    Transport,
    /// Distributions fade into each other.
    Linear,
    /// The nearest one.
    Nearest,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Transport, Self::Linear, Self::Nearest];

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Transport => "transport",
            Self::Linear => "linear",
            Self::Nearest => "nearest",
        }
    }
}

/// A model of measured distributions.
#[derive(Clone)]
pub struct Interpolant {
    data: Arc<Data>,
    /// Tells models apart in a thread's store of states.
    id: u64,
}

struct Data {
    method: Method,
    isotropic: bool,
    distributions: Vec<Distribution>,
    mesh: Mesh,
    edges: BTreeMap<(usize, usize), Edge>,
    scattered: Trend,
    beam: Trend,
    /// Largest polar angle of a measured incident direction (radians).
    last: f64,
}

impl std::fmt::Debug for Interpolant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Interpolant")
            .field("method", &self.data.method)
            .field("isotropic", &self.data.isotropic)
            .field("distributions", &self.data.distributions)
            .field("edges", &self.data.edges.values().map(|e| &e.moves).collect::<Vec<_>>())
            .finish_non_exhaustive()
    }
}

/// Share of all lobes' light below which one is left out between measured directions.
const SLIGHT: f64 = 1e-5;
/// Two directions of incidence that are nearer on the disk are the same one.
const SAME: f64 = 0.004;

impl Interpolant {
    /// From distributions that are measured, completed by a symmetry.
    pub fn new(measured: &[Distribution], symmetry: Symmetry, method: Method, progress: &Progress) -> Result<Self> {
        let isotropic = symmetry == Symmetry::Isotropic;
        let (distributions, origins) = symmetry.complete(measured);
        let mesh = mesh_of(&distributions, isotropic)?;
        let edges = mesh.edges();
        let moves = if method == Method::Transport {
            // Edges that are turned into each other have one plan: a turn keeps the numbers of lobes.
            let pair = |&(a, b): &(usize, usize)| origins[a].pair(origins[b]);
            let chosen: BTreeMap<_, _> = edges.iter().map(|edge| (pair(edge), *edge)).collect();
            let chosen: Vec<_> = chosen.into_iter().collect();
            progress.expect(chosen.len());
            let plans = chosen
                .par_iter()
                .map(|&(pair, (a, b))| {
                    let moves = plan::plan(&distributions[a], &distributions[b]);
                    progress.step().map(|()| (pair, moves))
                })
                .collect::<Result<BTreeMap<_, _>>>()?;
            edges.iter().map(|edge| plans[&pair(edge)].clone()).collect()
        } else {
            Vec::new()
        };
        Self::put_together(distributions, isotropic, method, mesh, edges.into_iter().zip(moves))
    }

    fn put_together(
        distributions: Vec<Distribution>,
        isotropic: bool,
        method: Method,
        mesh: Mesh,
        moves: impl Iterator<Item = ((usize, usize), Vec<Move>)>,
    ) -> Result<Self> {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        if let Some(d) = distributions.iter().find(|d| !(d.scattered() + d.beam).is_finite()) {
            return Err(Error::Argument(format!(
                "what was measured at {:.1}° is not finite",
                d.incident.theta().to_degrees()
            )));
        }
        let edges = moves
            .map(|((a, b), moves)| ((a, b), Edge::new(moves, &distributions[a], &distributions[b])))
            .collect();
        let points: Vec<Disk> = distributions.iter().map(|d| d.incident).collect();
        let trend = |values: Vec<f64>| {
            if isotropic {
                Trend::chain(&points, &values)
            } else {
                Trend::plate(&points, &values)
            }
        };
        let data = Data {
            method,
            isotropic,
            scattered: trend(distributions.iter().map(Distribution::scattered).collect()),
            beam: trend(distributions.iter().map(|d| d.beam).collect()),
            last: points.iter().map(|p| p.theta()).fold(0.0, f64::max),
            distributions,
            mesh,
            edges,
        };
        Ok(Self {
            data: Arc::new(data),
            id: NEXT.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// What lies between measured directions.
    pub fn method(&self) -> Method {
        self.data.method
    }

    /// Whether all azimuths are alike.
    pub fn isotropic(&self) -> bool {
        self.data.isotropic
    }

    /// Measured distributions, with those that symmetry gives.
    pub fn distributions(&self) -> &[Distribution] {
        &self.data.distributions
    }

    /// Whether the BSDF of a pair of directions lies beyond what was measured.
    pub fn extrapolated(&self, incident: Disk, outgoing: Disk) -> bool {
        const MARGIN: f64 = 0.03;
        let (point, turn) = self.canonical(incident);
        let place = self.data.mesh.place(point);
        if point.theta() > self.data.last + 1e-6 || place.beyond > MARGIN {
            return true;
        }
        let out = turn.inverse().apply(outgoing);
        (0..place.count).any(|k| place.shares[k] > 1e-6 && !self.data.distributions[place.corners[k]].measured(out))
    }

    /// An incident direction as the mesh knows it, and the turn that takes that to where it is.
    fn canonical(&self, incident: Disk) -> (Disk, Turn) {
        if !self.data.isotropic {
            return (incident, Turn::NONE);
        }
        let radius = incident.sin2_theta().sqrt();
        (Disk::new(radius, 0.0), Turn::new(incident.phi(), false))
    }

    /// Lobes, and share of each corner, without a turn.
    fn lobes(&self, place: &Place) -> Vec<Lobe> {
        let data = &*self.data;
        let corner = |k: usize| Corner {
            measured: &data.distributions[place.corners[k]],
            share: place.shares[k],
            reach: place.reach[k],
        };
        let corners: Vec<Corner<'_>> = (0..place.count).map(corner).collect();
        if data.method != Method::Transport {
            return blended(&corners);
        }
        let edge = |a: usize, b: usize| {
            let (a, b) = (place.corners[a], place.corners[b]);
            (&data.edges[&(a.min(b), a.max(b))], a < b)
        };
        match corners.as_slice() {
            [a, b] => along(*a, *b, edge(0, 1).0),
            [a, b, c] => within([*a, *b, *c], [edge(0, 1), edge(1, 2), edge(0, 2)]),
            _ => blended(&corners),
        }
    }

    /// Measured distributions about a point of the mesh.
    fn place(&self, point: Disk) -> Place {
        let data = &*self.data;
        if data.method == Method::Nearest {
            Place {
                corners: [data.mesh.nearest(point), 0, 0],
                count: 1,
                shares: [1.0, 0.0, 0.0],
                reach: [1.0, 0.0, 0.0],
                beyond: 0.0,
            }
        } else {
            data.mesh.place(point)
        }
    }

    /// Mean over the distributions about a point, by their shares.
    fn mean(&self, place: &Place, of: impl Fn(&Distribution) -> f64) -> f64 {
        (0..place.count)
            .map(|k| place.shares[k] * of(&self.data.distributions[place.corners[k]]))
            .sum()
    }

    /// Scattered light and beam of a point of the mesh.
    fn totals(&self, point: Disk, place: &Place) -> (f64, f64) {
        let data = &*self.data;
        let scattered = self.mean(place, Distribution::scattered);
        if data.method != Method::Transport {
            return (scattered, self.mean(place, |d| d.beam));
        }
        let beam = data.beam.at(point);
        // What is dark all about stays so.
        let wanted = if scattered > 0.0 { data.scattered.at(point) } else { 0.0 };
        (wanted.min(1.0 - beam).max(0.0), beam)
    }

    /// The distribution of one incident direction.
    pub fn state(&self, incident: Disk) -> State {
        let (lobes, floor, peak) = self.parts(incident);
        State::new(&lobes, floor, peak)
    }

    /// Its lobes, floor (1/sr) and beam.
    pub fn parts(&self, incident: Disk) -> (Vec<Lobe>, f64, Option<Peak>) {
        let (point, turn) = self.canonical(incident);
        let place = self.place(point);
        let mut lobes = self.lobes(&place);
        // What is next to nothing is left out; the others are scaled to the total.
        let least = SLIGHT * lobes.iter().map(|l| l.flux).sum::<f64>();
        lobes.retain(|l| l.flux > least);
        let floor = self.mean(&place, |d| d.floor);
        let known: f64 = lobes.iter().map(|l| l.flux).sum::<f64>() + std::f64::consts::PI * floor;
        let (wanted, beam) = self.totals(point, &place);
        let scale = if known > 0.0 { wanted / known } else { 0.0 };
        for lobe in &mut lobes {
            lobe.flux *= scale;
            lobe.centre = turn.apply(lobe.centre);
        }
        let peak = (beam > 0.0).then(|| Peak {
            outgoing: incident,
            value: beam,
            extent: self.mean(&place, |d| d.extent),
        });
        (lobes, scale * floor, peak)
    }

    /// What the others say of each measured direction that lies among them: the number of the measured one, and the model
    /// without it. `every` so many are left out one by one.
    pub fn held_out(
        measured: &[Distribution],
        symmetry: Symmetry,
        method: Method,
        left_out: usize,
    ) -> Result<Option<State>> {
        let rest: Vec<Distribution> = measured
            .iter()
            .enumerate()
            .filter(|(k, _)| *k != left_out)
            .map(|(_, d)| d.clone())
            .collect();
        let incident = measured[left_out].incident;
        let (distributions, _) = symmetry.complete(&rest);
        let isotropic = symmetry == Symmetry::Isotropic;
        let mesh = mesh_of(&distributions, isotropic)?;
        let point = if isotropic {
            Disk::new(incident.sin2_theta().sqrt(), 0.0)
        } else {
            incident
        };
        let place = mesh.place(point);
        if place.beyond > 0.0 {
            return Ok(None);
        }
        let corners = &place.corners[..place.count];
        let edges: Vec<(usize, usize)> = mesh
            .edges()
            .into_iter()
            .filter(|(a, b)| corners.contains(a) && corners.contains(b))
            .collect();
        let moves: Vec<Vec<Move>> = if method == Method::Transport {
            edges
                .iter()
                .map(|&(a, b)| plan::plan(&distributions[a], &distributions[b]))
                .collect()
        } else {
            Vec::new()
        };
        let model = Self::put_together(distributions, isotropic, method, mesh, edges.into_iter().zip(moves))?;
        Ok(Some(model.state(incident)))
    }

    /// Calls `f` with the distribution of an incident direction, which the thread keeps for a while.
    fn with_state<T>(&self, incident: Disk, f: impl FnOnce(&State) -> T) -> T {
        const KEPT: usize = 8;
        type Key = (u64, u64, u64);
        thread_local! {
            static STATES: RefCell<Vec<(Key, Rc<State>)>> = const { RefCell::new(Vec::new()) };
        }
        let key = (self.id, incident.x.to_bits(), incident.y.to_bits());
        let state = STATES.with_borrow_mut(|states| {
            if let Some(place) = states.iter().position(|(k, _)| *k == key) {
                states[..=place].rotate_right(1);
            } else {
                states.truncate(KEPT - 1);
                states.insert(0, (key, Rc::new(self.state(incident))));
            }
            states[0].1.clone()
        });
        f(&state)
    }
}

fn mesh_of(distributions: &[Distribution], isotropic: bool) -> Result<Mesh> {
    let points: Vec<Disk> = distributions.iter().map(|d| d.incident).collect();
    if isotropic {
        Mesh::chain(&points)
    } else {
        Mesh::triangles(&points)
    }
}

impl Scatterer for Interpolant {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.with_state(incident, |s| s.evaluate(outgoing))
    }

    fn evaluate_all(&self, incident: Disk, outgoing: &[Disk], values: &mut [f64]) {
        self.with_state(incident, |s| {
            for (value, &out) in values.iter_mut().zip(outgoing) {
                *value = s.evaluate(out);
            }
        });
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        self.with_state(incident, |s| s.peak.into_iter().collect())
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        self.with_state(incident, |s| s.sample(u))
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.with_state(incident, |s| s.pdf(outgoing))
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        // Without a look at the lobes.
        let (point, _) = self.canonical(incident);
        let (scattered, beam) = self.totals(point, &self.place(point));
        match part {
            Part::All => scattered + beam,
            Part::Scattered => scattered,
            Part::Direct => beam,
        }
        .into()
    }

    fn resolution(&self, incident: Disk) -> f64 {
        self.with_state(incident, State::resolution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::interpolant::distribution::from_square;
    use crate::sequence::r2;

    /// A floor and a peak straight on, as seen from every 10° of polar angle and, unless it is isotropic, 30° of azimuth.
    fn measured(isotropic: bool) -> Vec<Distribution> {
        let azimuths = if isotropic { 1 } else { 12 };
        (0..9)
            .flat_map(|k| (0..if k == 0 { 1 } else { azimuths }).map(move |a| (k, a)))
            .map(|(k, a)| {
                let incident = Disk::from_angles(f64::from(k * 10).to_radians(), f64::from(a * 30).to_radians());
                let even = (0..1500).map(|k| from_square(r2(k, [0.1; 2])));
                let fine = (0..800).map(|k| {
                    let [u, v] = r2(k, [0.6; 2]);
                    lobe::draw(lobe::vector(incident), 0.02, [u * u, v])
                });
                let outgoing: Vec<Disk> = even.chain(fine).filter(|o| o.theta() < 1.4).collect();
                let values: Vec<f64> = outgoing.iter().map(|&o| truth(incident, o)).collect();
                let errors = vec![1e-4; values.len()];
                let points = Points {
                    outgoing: &outgoing,
                    values: &values,
                    errors: &errors,
                };
                fit(incident, &points).unwrap()
            })
            .collect()
    }

    fn truth(incident: Disk, outgoing: Disk) -> f64 {
        let width = 0.03_f64;
        let chord2 = distribution::chord2(lobe::vector(incident), lobe::vector(outgoing));
        let norm = std::f64::consts::TAU * width * width * incident.cos_theta();
        0.05 + 0.4 * (-0.5 * chord2 / (width * width)).exp() / norm
    }

    fn model(isotropic: bool, method: Method) -> Interpolant {
        let symmetry = if isotropic { Symmetry::Isotropic } else { Symmetry::None };
        Interpolant::new(&measured(isotropic), symmetry, method, &Progress::default()).unwrap()
    }

    #[test]
    fn a_peak_wanders_between_measured_directions() {
        for isotropic in [true, false] {
            let transport = model(isotropic, Method::Transport);
            let linear = model(isotropic, Method::Linear);
            for k in 0..20 {
                let incident = Disk::from_angles(0.06 * f64::from(k), 0.4 + f64::from(k));
                let state = transport.state(incident);
                assert!(state.brightest().angle_to(incident) < 0.005, "{isotropic} {k}");
                let expected = 0.05 * std::f64::consts::PI + 0.4;
                assert!(
                    (state.scattered / expected - 1.0).abs() < 0.01,
                    "{isotropic} {k}: {}",
                    state.scattered
                );
            }
            let between = Disk::from_angles(35_f64.to_radians(), 0.25);
            let height = |m: &Interpolant| m.evaluate(between, between);
            assert!(height(&transport) > 0.8 * truth(between, between));
            assert!(height(&linear) < 0.3 * truth(between, between));
        }
    }

    #[test]
    fn edges_of_triangles_agree() {
        let model = model(false, Method::Transport);
        // Along the chain of azimuth 30°, from either side.
        for k in 1..60 {
            let theta = 0.02 * f64::from(k);
            let [a, b] = [-1e-7, 1e-7].map(|d| Disk::from_angles(theta, 30_f64.to_radians() + d));
            for j in 0..20 {
                let outgoing = Disk::uniform(r2(j, [0.2; 2]));
                let (x, y) = (model.evaluate(a, outgoing), model.evaluate(b, outgoing));
                // To a thousandth of the peak's height: its flanks are a few per cent apart.
                let height = truth(a, a);
                assert!((x - y).abs() < 1e-3 * (x + y + height), "{k} {j}: {x} {y}");
            }
        }
    }

    #[test]
    fn what_was_not_measured_is_said() {
        let model = model(true, Method::Transport);
        let inside = Disk::from_angles(0.5, 1.0);
        assert!(!model.extrapolated(inside, inside));
        assert!(model.extrapolated(inside, Disk::from_angles(1.5, 1.0)));
        assert!(model.extrapolated(Disk::from_angles(1.45, 1.0), inside));
        for theta in [1.45, 1.55, 1.57] {
            assert!(model.total(Disk::from_angles(theta, 2.0), Part::All).value <= 1.0);
        }
    }

    #[test]
    fn files_keep_it() {
        let model = model(true, Method::Transport);
        let again = Interpolant::from_stored(&model.stored()).unwrap();
        let (i, o) = (Disk::new(0.3, 0.2), Disk::new(0.31, 0.2));
        assert_eq!(model.evaluate(i, o), again.evaluate(i, o));
        let mut broken = model.stored();
        broken.edges.pop();
        assert!(Interpolant::from_stored(&broken).is_err());
        let mut broken = model.stored();
        broken.lobes[2] = -1.0;
        assert!(Interpolant::from_stored(&broken).is_err());
    }

    #[test]
    fn a_tree_of_it_keeps_its_light() {
        use crate::bsdf::convert::to_tree;
        use crate::bsdf::tree::Grid;
        use crate::bsdf::{Model, Rank};
        let grid = Grid {
            levels: 5,
            samples: 4,
            seed: 0,
        };
        let model = Model::Interpolant(model(true, Method::Transport));
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let done = to_tree(&model, rank, grid, None, &Progress::default()).unwrap();
            for k in 0..12 {
                let incident = Disk::from_angles(0.1 * f64::from(k), 1.3);
                let (a, b) = (
                    done.tree.total(incident, Part::All).value,
                    model.total(incident, Part::All).value,
                );
                assert!((a / b - 1.0).abs() < 0.02, "{rank:?} {k}: {a} {b}");
            }
        }
    }

    #[test]
    fn a_matrix_of_it_holds_the_means_over_pairs_of_patches() {
        use crate::basis::Basis;
        use crate::bsdf::convert::{Sampling, to_matrix};
        use crate::bsdf::{Model, Turn, Turned};
        let basis = Arc::new(Basis::klems_quarter());
        let base = model(true, Method::Transport);
        let turned = Model::Turned(Turned::new(
            Arc::new(Model::Interpolant(base.clone())),
            Turn::new(0.4, false),
        ));
        for model in [Model::Interpolant(base), turned] {
            let done = to_matrix(&model, &basis, &basis, Sampling::of(2048), &Progress::default()).unwrap();
            assert!(
                done.worst_direct_hemispherical < 5e-3,
                "{}",
                done.worst_direct_hemispherical
            );
            let mut peaks = 0;
            for (i, o) in [(0, 0), (0, 3), (12, 12), (20, 20), (20, 30), (35, 8)] {
                let n = 1 << 8;
                let points = |p, shift| (0..n).map(move |k| (p, r2(k, [shift; 2])));
                let mean = |(k, from): (u32, Disk)| {
                    let shift = 0.618 * f64::from(k);
                    let to = points(o, shift).map(|(o, u)| model.evaluate(from, basis.sample_cosine(o, u)));
                    to.sum::<f64>() / f64::from(n)
                };
                let from = points(i, 0.3).map(|(i, u)| basis.sample_cosine(i, u));
                let expected = (0..n).zip(from).map(mean).sum::<f64>() / f64::from(n);
                let found = done.matrix.value(i, o);
                // What little of the peak crosses a border is less well known.
                let near = if (i, o) == (0, 3) { 0.12 } else { 0.02 };
                assert!((found / expected - 1.0).abs() < near, "{i} {o}: {found} {expected}");
                peaks += usize::from(found > 1.0);
            }
            assert!(peaks >= 3);
        }
    }
}
