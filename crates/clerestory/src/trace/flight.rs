//! Paths through a sample, many at a time.

use super::balance::{Balance, add};
use super::scene::Scene;
use crate::direction::{Disk, Scatter, Side};
use crate::error::Result;
use crate::geometry::{Area, Meeting, NO_PIECE, Ray, Vec3};
use crate::material::{Arrival, Draws, Polarisation};
use crate::progress::Progress;

/// When a path ends that neither leaves nor is absorbed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// A path that carries less than this share of what it began with is ended at random, by roulette.
    pub roulette: f64,
    /// Events after which it is cut off.
    pub events: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            roulette: 0.05,
            events: 1000,
        }
    }
}

/// A path that leaves the sample.
pub struct Leaving<'a, const N: usize> {
    /// Transmitted or reflected.
    pub scatter: Scatter,
    /// Direction of travel that it came with.
    pub incident: Disk,
    /// Direction of travel that it leaves with.
    pub outgoing: Disk,
    /// It is a beam still, straight on or mirrored in the sample's plane.
    pub beam: bool,
    /// What it carries, one a band.
    pub weight: &'a [f64; N],
    /// Where it was last and where it flies.
    pub ray: &'a Ray,
    /// Random numbers that are left.
    pub draws: Draws,
}

/// What takes in the light that leaves the sample.
pub trait Collector<const N: usize> {
    /// One path.
    fn collect(&mut self, path: &Leaving<'_, N>);
}

/// A path under way.
struct Path<const N: usize> {
    weight: [f64; N],
    polarisation: Polarisation<N>,
    incident: Disk,
    draws: Draws,
    events: u32,
    medium: u16,
    layer: u16,
    /// Whole periods that its layer has taken off along x and y (metres): another layer has others.
    taken_off: [f64; 2],
    specular: bool,
}

/// How many paths fly together: enough for batches, few enough for the first level of cache.
const BATCH: usize = 256;
/// Rays start at least so far before the sample (metres).
const CLEAR: f64 = 1e-9;
/// A beam may stray this far on the disk by rounding.
const STRAIGHT: f64 = 1e-9;

/// Room for paths, used again and again.
pub struct Flight<'a, const N: usize> {
    scene: &'a Scene<'a>,
    area: Area,
    limits: Limits,
    paths: Vec<Path<N>>,
    rays: Vec<Ray>,
    meetings: Vec<Meeting>,
    /// Rays of one layer, where there are several.
    together: Vec<Ray>,
    met: Vec<Meeting>,
}

impl<'a, const N: usize> Flight<'a, N> {
    /// Over an area of a sample.
    pub fn new(scene: &'a Scene<'a>, area: Area, limits: Limits) -> Self {
        Self {
            scene,
            area,
            limits,
            paths: Vec::with_capacity(BATCH),
            rays: Vec::with_capacity(BATCH),
            meetings: vec![Meeting::Lost; BATCH],
            together: Vec::new(),
            met: vec![Meeting::Lost; if scene.sample.layers.len() > 1 { BATCH } else { 0 }],
        }
    }

    /// Sends the paths of a range of indices from one side, in directions that `incident` draws, and collects them.
    #[allow(clippy::too_many_arguments)] // What is sent, and all that takes it in.
    pub fn run(
        &mut self,
        side: Side,
        key: u64,
        indices: std::ops::Range<u32>,
        incident: impl Fn([f64; 2]) -> Disk,
        collector: &mut impl Collector<N>,
        balance: &mut Balance<N>,
        progress: &Progress,
    ) -> Result<()> {
        let full = self.scene.weights::<N>();
        let mut next = indices.start;
        while next < indices.end {
            progress.check()?;
            let last = indices.end.min(next + BATCH as u32);
            for index in next..last {
                self.start(side, Draws::new(key, index), &incident);
            }
            add(&mut balance.traced, &full.map(|w| w * f64::from(last - next)));
            next = last;
            while !self.rays.is_empty() {
                self.advance(side, collector, balance);
            }
        }
        Ok(())
    }

    fn start(&mut self, side: Side, mut draws: Draws, incident: &impl Fn([f64; 2]) -> Disk) {
        let Area { x, y } = self.area;
        let depth = self.scene.depth;
        let disk = incident([draws.next(), draws.next()]);
        let at = |[low, high]: [f64; 2], u: f64| low + (high - low) * u;
        // A little before the sample, so that what lies in its first plane is met.
        let margin = 1e-3 * (depth[1] - depth[0]) + CLEAR;
        let y = at(y, draws.next());
        let x = at(x, draws.next());
        let (z, layer) = match side {
            Side::Exterior => (depth[0] - margin, 0),
            Side::Interior => (depth[1] + margin, self.scene.sample.layers.len() - 1),
        };
        self.rays.push(Ray {
            origin: Vec3::new(x, y, z),
            direction: Vec3::new(disk.x, disk.y, -side.sign() * disk.cos_theta()),
            piece: NO_PIECE,
        });
        self.paths.push(Path {
            weight: self.scene.weights(),
            polarisation: Polarisation::NONE,
            incident: disk,
            draws,
            events: 0,
            medium: 0,
            layer: layer as u16,
            taken_off: [0.0; 2],
            specular: true,
        });
    }

    /// Meets each path's own layer, all paths of a layer together.
    fn meet_layers(&mut self) {
        for (number, layer) in self.scene.sample.layers.iter().enumerate() {
            let of_layer = |paths: &[Path<N>], k: usize| usize::from(paths[k].layer) == number;
            self.together.clear();
            for (k, ray) in self.rays.iter().enumerate() {
                if of_layer(&self.paths, k) {
                    self.together.push(*ray);
                }
            }
            let met = &mut self.met[..self.together.len()];
            layer.meet_all(&mut self.together, met);
            let mut found = self.together.iter().zip(met);
            for k in 0..self.rays.len() {
                if !of_layer(&self.paths, k) {
                    continue;
                }
                let (Some((ray, meeting)), start) = (found.next(), self.rays[k]) else {
                    break;
                };
                if let Meeting::Hit(hit) = meeting {
                    let off = start.origin + start.direction * hit.distance - ray.origin;
                    let taken = &mut self.paths[k].taken_off;
                    *taken = [taken[0] + off.x, taken[1] + off.y];
                }
                (self.rays[k], self.meetings[k]) = (*ray, *meeting);
            }
        }
    }

    /// Moves all paths to their next event.
    fn advance(&mut self, side: Side, collector: &mut impl Collector<N>, balance: &mut Balance<N>) {
        let n = self.rays.len();
        if let [layer] = &self.scene.sample.layers[..] {
            layer.meet_all(&mut self.rays, &mut self.meetings[..n]);
        } else {
            self.meet_layers();
        }
        let mut kept = 0;
        for k in 0..n {
            let (ray, path) = (&mut self.rays[k], &mut self.paths[k]);
            if step(
                self.scene,
                self.limits,
                side,
                self.meetings[k],
                ray,
                path,
                collector,
                balance,
            ) {
                if kept < k {
                    self.rays.swap(kept, k);
                    self.paths.swap(kept, k);
                }
                kept += 1;
            }
        }
        self.rays.truncate(kept);
        self.paths.truncate(kept);
    }
}

/// What happens to a path at its next event; whether it goes on.
#[allow(clippy::too_many_arguments)] // One place that is called, in the innermost loop.
fn step<const N: usize>(
    scene: &Scene<'_>,
    limits: Limits,
    side: Side,
    meeting: Meeting,
    ray: &mut Ray,
    path: &mut Path<N>,
    collector: &mut impl Collector<N>,
    balance: &mut Balance<N>,
) -> bool {
    let hit = match meeting {
        Meeting::Hit(hit) => hit,
        Meeting::Lost => {
            add(&mut balance.lost, &path.weight);
            return false;
        }
        Meeting::Leaves => {
            let beyond = i32::from(path.layer) + if ray.direction.z > 0.0 { 1 } else { -1 };
            if (0..scene.sample.layers.len() as i32).contains(&beyond) {
                path.layer = beyond as u16;
                let [x, y] = std::mem::take(&mut path.taken_off);
                ray.origin += Vec3::new(x, y, 0.0);
                ray.piece = NO_PIECE;
                return true;
            }
            leave(side, ray, path, collector, balance);
            return false;
        }
    };
    let medium = &scene.media[usize::from(path.medium)];
    if !medium.is_clear() {
        let before = path.weight;
        let mut absorbed = [0.0; N];
        let scattered = medium.fly(hit.distance, &mut path.weight, &mut absorbed, &mut path.draws);
        add(&mut balance.absorbed, &absorbed);
        if let Some(flown) = scattered {
            ray.origin += ray.direction * (flown - hit.distance);
            ray.piece = NO_PIECE;
            ray.direction = medium.scatter(ray.direction, &mut path.weight, &mut path.draws);
            path.specular = false;
            path.polarisation = Polarisation::NONE;
            return goes_on(limits, path, &before, &absorbed, balance);
        }
        for b in 0..N {
            balance.roulette[b] += before[b] - absorbed[b] - path.weight[b];
        }
    }
    let surface = &scene.sample.surfaces[hit.surface as usize];
    let face = usize::from(ray.direction.dot(hit.normal) > 0.0);
    if surface.media[face] != path.medium {
        // The geometry does not agree on what is inside: a hole, or two bodies that overlap.
        add(&mut balance.lost, &path.weight);
        return false;
    }
    let arrival = Arrival {
        direction: ray.direction,
        normal: if face == 0 { hit.normal } else { -hit.normal },
        here: medium,
        beyond: &scene.media[usize::from(surface.media[1 - face])],
    };
    let before = path.weight;
    let mut absorbed = [0.0; N];
    let material = &scene.materials[surface.materials[face] as usize];
    let departure = material.scatter(
        &arrival,
        &mut path.weight,
        &mut absorbed,
        &mut path.polarisation,
        &mut path.draws,
    );
    add(&mut balance.absorbed, &absorbed);
    let Some(departure) = departure else {
        for b in 0..N {
            balance.roulette[b] += before[b] - absorbed[b];
        }
        return false;
    };
    path.specular &= departure.specular;
    ray.direction = departure.direction;
    if departure.passes {
        path.medium = surface.media[1 - face];
    }
    goes_on(limits, path, &before, &absorbed, balance)
}

/// Ends an event: roulette, its tally, and the greatest number of events.
fn goes_on<const N: usize>(
    limits: Limits,
    path: &mut Path<N>,
    before: &[f64; N],
    absorbed: &[f64; N],
    balance: &mut Balance<N>,
) -> bool {
    path.events += 1;
    let goes_on = survives(limits, path);
    for b in 0..N {
        balance.roulette[b] += before[b] - absorbed[b] - path.weight[b];
    }
    if goes_on && path.events >= limits.events {
        add(&mut balance.cut_off, &path.weight);
        return false;
    }
    goes_on
}

/// Roulette for a path that carries little.
fn survives<const N: usize>(limits: Limits, path: &mut Path<N>) -> bool {
    let most = path.weight.iter().copied().fold(0.0, f64::max);
    if most >= limits.roulette {
        return true;
    }
    let chance = most / limits.roulette;
    if path.draws.next() < chance {
        for w in &mut path.weight {
            *w /= chance;
        }
        true
    } else {
        path.weight = [0.0; N];
        false
    }
}

fn leave<const N: usize>(
    side: Side,
    ray: &Ray,
    path: &Path<N>,
    collector: &mut impl Collector<N>,
    balance: &mut Balance<N>,
) {
    let leaves_to = if ray.direction.z > 0.0 {
        Side::Interior
    } else {
        Side::Exterior
    };
    let scatter = if leaves_to == side {
        Scatter::Reflection
    } else {
        Scatter::Transmission
    };
    let outgoing = Disk::new(ray.direction.x, ray.direction.y);
    let stray = (outgoing.x - path.incident.x)
        .abs()
        .max((outgoing.y - path.incident.y).abs());
    let beam = path.specular && stray < STRAIGHT;
    match scatter {
        Scatter::Transmission => add(&mut balance.transmitted, &path.weight),
        Scatter::Reflection => add(&mut balance.reflected, &path.weight),
    }
    collector.collect(&Leaving {
        scatter,
        incident: path.incident,
        outgoing,
        beam,
        weight: &path.weight,
        ray,
        draws: path.draws,
    });
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::testing::stretches;
    use super::super::{Goniophotometer, Sample, Settings, State, Stop};
    use super::*;
    use crate::basis::Basis;
    use crate::material::Material;

    /// Paths that pass, by incident patch.
    fn passed(sample: &Sample) -> Vec<f64> {
        let basis = Arc::new(Basis::klems_quarter());
        let instrument = Goniophotometer {
            settings: Settings {
                sides: vec![Side::Exterior],
                stop: Stop::Paths(4096),
                ..Settings::default()
            },
        };
        let measured = instrument
            .matrices(sample, &basis, &basis, &mut State::new(""), &Progress::default())
            .expect("a sound sample");
        measured.places.iter().map(|p| p.balance[0][1]).collect()
    }

    #[test]
    fn layers_of_different_periods_keep_their_places() {
        let mirror = || Material::Mirror { reflectance: vec![1.0] };
        let slat = |k: f64| [[0.0, k + 0.5], [3.0, k + 0.5]];
        let post = |k: f64| [[4.0, 0.7 * k], [4.0, 0.7 * k + 0.35]];
        let counted = |n: u8, piece: fn(f64) -> [[f64; 2]; 2]| (0..n).map(move |k| piece(f64::from(k)));
        let mut layered = stretches(&[slat(0.0)], 1.0, mirror(), 1);
        layered
            .layers
            .append(&mut stretches(&[post(0.0)], 0.7, mirror(), 1).layers);
        // The same in one layer of seven and ten periods.
        let all: Vec<_> = counted(7, slat).chain(counted(10, post)).collect();
        let whole = stretches(&all, 7.0, mirror(), 1);
        let (layered, whole) = (passed(&layered), passed(&whole));
        assert!(
            whole.iter().any(|n| *n < 3000.0) && whole.iter().all(|n| *n > 1000.0),
            "{whole:?}"
        );
        for (a, b) in layered.iter().zip(&whole) {
            assert!((a - b).abs() <= 2.0, "{layered:?} {whole:?}");
        }
    }
}
