//! Paths from eyes and sensors, many at a time.
//!
//! At every surface light is asked for in two ways, weighed against each other by their densities (balance heuristic of Veach
//! and Guibas 1995): a direction to a window or light, and the direction in which the path goes on. The sun is asked for apart:
//! it is too small to be found by chance.

use super::ledger::Ledger;
use super::openings::{area_about, density, pieces};
use super::{Rgb, Role, Room};
use crate::geometry::{Geometry, Hit, Meeting, NO_PIECE, Ray, Vec3};
use crate::material::{Arrival, Draws, Material, Polarisation};
use crate::sequence::r2;

/// Carried shares below this are ended at random.
const ROULETTE: f64 = 0.1;
/// Parts of a window that are asked for a matrix are seen at about this angle (rad) by a path that carries all of its light; they
/// are larger where each takes a ray, and where the path carries less, down to a least share.
const FINENESS: f64 = 1.2;
const COARSER: f64 = 2.5;
const LEAST: f64 = 0.05;
/// Events after which a path is cut off.
const EVENTS: u16 = 500;

/// A path under way.
#[derive(Debug, Clone, Copy)]
struct State {
    weight: Rgb,
    /// Where its light is collected.
    slot: u32,
    draws: Draws,
    /// Density with which its direction was drawn (1/sr); infinite where no window or light was asked instead.
    density: f64,
    /// Into how small parts windows were divided when they were asked there (rad).
    fineness: f64,
    /// The sun was asked for where it comes from.
    sun_asked: bool,
    medium: u16,
    events: u16,
    polarisation: Polarisation<3>,
}

/// Light that a surface asks for.
#[derive(Debug, Clone, Copy)]
struct Claim {
    /// What arrives if nothing is in the way: for an emitter, the factor of its radiance.
    value: Rgb,
    target: Target,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Target {
    Emitter(usize, f64),
    Sun,
}

/// Where paths end that are not followed to their end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Ends {
    /// Paths that met a face from inside of another body, or could not be followed.
    pub lost: u64,
    /// Paths that were cut off.
    pub cut_off: u64,
}

/// Paths of a batch.
pub(super) struct Tracer<'a> {
    room: &'a Room,
    rays: Vec<Ray>,
    states: Vec<State>,
    meetings: Vec<Meeting>,
    shadows: Vec<Ray>,
    claims: Vec<Claim>,
    /// What is being followed of both.
    flying: Vec<Ray>,
    asking: Vec<Claim>,
    found: Vec<Rgb>,
    /// Where light is written down by where it comes from, in place of being told; windows are black then.
    pub(super) ledger: Option<Ledger<'a>>,
    pub(super) ends: Ends,
}

/// Into how small parts a window is divided (rad): coarser if each takes a ray.
fn parted(clear: bool, fineness: f64) -> f64 {
    if clear { fineness } else { COARSER * fineness }
}

impl<'a> Tracer<'a> {
    pub(super) fn new(room: &'a Room) -> Self {
        Self {
            room,
            rays: Vec::new(),
            states: Vec::new(),
            meetings: Vec::new(),
            shadows: Vec::new(),
            claims: Vec::new(),
            flying: Vec::new(),
            asking: Vec::new(),
            found: Vec::new(),
            ledger: None,
            ends: Ends::default(),
        }
    }

    /// Starts a path of an eye; its slot. The sun's disc is not in what it sees, but for mirrors and panes.
    pub(super) fn look(&mut self, origin: Vec3, direction: Vec3, draws: Draws) -> usize {
        let mut state = self.start(draws);
        state.sun_asked = true;
        self.rays.push(Ray {
            origin,
            direction,
            piece: NO_PIECE,
        });
        self.states.push(state);
        self.found.len() - 1
    }

    /// Starts a path of a sensor, which takes in all directions by their cosine to its normal; its slot will hold the mean
    /// radiance by projected solid angle, irradiance over π.
    pub(super) fn sense(&mut self, origin: Vec3, normal: Vec3, draws: Draws) -> usize {
        let mut state = self.start(draws);
        let white = Material::Lambertian {
            reflectance: vec![1.0; 3],
            transmittance: vec![0.0; 3],
        };
        let arrival = Arrival {
            direction: -normal,
            normal,
            here: &self.room.media[0],
            beyond: &self.room.media[0],
        };
        let mut ray = Ray {
            origin,
            direction: -normal,
            piece: NO_PIECE,
        };
        self.ask(&white, &arrival, &ray, &mut state, true);
        if scatter(&white, &arrival, &mut ray, &mut state, true).is_some() {
            self.rays.push(ray);
            self.states.push(state);
        }
        self.found.len() - 1
    }

    fn start(&mut self, draws: Draws) -> State {
        self.found.push([0.0; 3]);
        State {
            weight: [1.0; 3],
            slot: self.found.len() as u32 - 1,
            draws,
            density: f64::INFINITY,
            fineness: f64::INFINITY,
            sun_asked: false,
            medium: 0,
            events: 0,
            polarisation: Polarisation::NONE,
        }
    }

    /// Follows all paths to their ends; the radiance of each slot. The tracer is empty after it.
    pub(super) fn finish(&mut self) -> Vec<Rgb> {
        self.settle();
        while !self.rays.is_empty() {
            self.advance();
            self.settle();
        }
        std::mem::take(&mut self.found)
    }

    fn advance(&mut self) {
        self.meetings.resize(self.rays.len(), Meeting::Lost);
        self.room.mesh.meet_all(&mut self.rays, &mut self.meetings);
        let mut kept = 0;
        for k in 0..self.rays.len() {
            let (mut ray, mut state) = (self.rays[k], self.states[k]);
            let goes_on = match self.meetings[k] {
                Meeting::Hit(hit) => self.arrive(hit, &mut ray, &mut state),
                // A level ray outside of the scene is called lost.
                Meeting::Leaves | Meeting::Lost => {
                    if let Some(ledger) = &mut self.ledger {
                        ledger.sky(ray.direction, state.weight, state.events);
                    } else {
                        let radiance = self.room.outside(ray.direction, !state.sun_asked);
                        self.collect(&state, radiance);
                    }
                    false
                }
            };
            if goes_on {
                (self.rays[kept], self.states[kept]) = (ray, state);
                kept += 1;
            }
        }
        self.rays.truncate(kept);
        self.states.truncate(kept);
    }

    fn collect(&mut self, state: &State, radiance: Rgb) {
        let slot = &mut self.found[state.slot as usize];
        for c in 0..3 {
            slot[c] += state.weight[c] * radiance[c];
        }
    }

    /// Weight of light that was found by going on, against asking for it.
    fn by_chance(&self, emitter: usize, ray: &Ray, distance: f64, density: f64) -> f64 {
        if density == f64::INFINITY {
            return 1.0;
        }
        let room = self.room;
        let asked = room
            .emitters
            .density(&room.windows, &room.lights, emitter, ray.direction, distance);
        density / (density + asked)
    }

    /// A path found a window: its ledger takes it down. Lights are out.
    fn write_down(&mut self, hit: &Hit, ray: &Ray, state: &State) {
        let room = self.room;
        let Role::Window(number) = room.roles[hit.surface as usize] else {
            return;
        };
        if ray.direction.dot(hit.normal) > 0.0 {
            return;
        }
        let window = &room.windows[number as usize];
        let share = if state.density == f64::INFINITY || !self.ledger.as_ref().is_some_and(Ledger::asks_windows) {
            1.0
        } else {
            let (polygon, point) = (window.polygon(), ray.origin);
            let from = point - ray.direction * hit.distance;
            let fineness = parted(room.is_clear(number as usize, from), state.fineness);
            let area = area_about(polygon, from, fineness, point);
            let asked = density(area, polygon.normal(), ray.direction, hit.distance);
            state.density / (state.density + asked)
        };
        let travel = window.disk(-ray.direction);
        if let Some(ledger) = &mut self.ledger {
            // This meeting is counted already, and is none of the room's.
            ledger.window(
                number as usize,
                travel,
                state.weight.map(|w| w * share),
                state.events - 1,
            );
        }
    }

    /// A path meets a surface; whether it goes on.
    fn arrive(&mut self, hit: Hit, ray: &mut Ray, state: &mut State) -> bool {
        let room = self.room;
        state.events += 1;
        let medium = &room.media[usize::from(state.medium)];
        if !medium.is_clear() {
            let mut absorbed = [0.0; 3];
            if let Some(flown) = medium.fly(hit.distance, &mut state.weight, &mut absorbed, &mut state.draws) {
                ray.origin += ray.direction * (flown - hit.distance);
                ray.piece = NO_PIECE;
                ray.direction = medium.scatter(ray.direction, &mut state.weight, &mut state.draws);
                state.density = f64::INFINITY;
                state.sun_asked = false;
                state.polarisation = Polarisation::NONE;
                return self.goes_on(state);
            }
        }
        let face = usize::from(ray.direction.dot(hit.normal) > 0.0);
        let normal = if face == 0 { hit.normal } else { -hit.normal };
        match &room.roles[hit.surface as usize] {
            Role::Light(_) | Role::Window(_) if self.ledger.is_some() => {
                self.write_down(&hit, ray, state);
                false
            }
            Role::Light(number) => {
                let (_, radiance) = &room.lights[*number as usize];
                if face == 0 {
                    let emitter = room.windows.len() + *number as usize;
                    let share = self.by_chance(emitter, ray, hit.distance, state.density);
                    self.collect(state, radiance.map(|r| r * share));
                }
                false
            }
            Role::Window(number) => {
                let window = &room.windows[*number as usize];
                let open = !window.obstructed();
                if face == 0 {
                    let share = self.by_chance(*number as usize, ray, hit.distance, state.density);
                    if open {
                        // What is seen directly or in mirrors is exact; for the rest a table will do.
                        let radiance = if state.density == f64::INFINITY {
                            room.through(*number as usize, ray.direction, !state.sun_asked)
                        } else {
                            window.sent(window.disk(-ray.direction))
                        };
                        self.collect(state, radiance.map(|r| r * share));
                    } else {
                        state.weight = state.weight.map(|w| w * share);
                        state.density = f64::INFINITY;
                    }
                }
                let arrival = Arrival {
                    direction: ray.direction,
                    normal,
                    here: &room.media[0],
                    beyond: &room.media[0],
                };
                let material = window.face(face);
                // What an open window sends in is told at once; only what it returns is followed.
                let both_sides = !(open && face == 0);
                self.ask(material, &arrival, ray, state, both_sides);
                let before = state.sun_asked;
                match scatter(material, &arrival, ray, state, true) {
                    None => false,
                    Some(passes) => {
                        if passes && state.density == f64::INFINITY {
                            // Straight on: who asked for the sun before asked through this window.
                            state.sun_asked = before;
                        }
                        (both_sides || !passes) && self.goes_on(state)
                    }
                }
            }
            Role::Solid(surface) => {
                if surface.media[face] != state.medium {
                    self.ends.lost += 1;
                    return false;
                }
                let arrival = Arrival {
                    direction: ray.direction,
                    normal,
                    here: medium,
                    beyond: &room.media[usize::from(surface.media[1 - face])],
                };
                let material = &room.materials[surface.materials[face] as usize];
                let in_air = state.medium == 0;
                if in_air {
                    self.ask(material, &arrival, ray, state, surface.media[1 - face] == 0);
                }
                match scatter(material, &arrival, ray, state, in_air) {
                    None => false,
                    Some(passes) => {
                        if passes {
                            state.medium = surface.media[1 - face];
                        }
                        self.goes_on(state)
                    }
                }
            }
        }
    }

    /// Asks a window or light, and the sun, for light that a surface scatters back along the path.
    fn ask(&mut self, material: &Material, arrival: &Arrival<'_>, ray: &Ray, state: &mut State, both_sides: bool) {
        if matches!(
            material,
            Material::Black | Material::Mirror { .. } | Material::Interface | Material::Pane(_)
        ) {
            return;
        }
        let room = self.room;
        if let Some(ledger) = &self.ledger {
            if ledger.asks_windows() && !room.windows.is_empty() {
                self.ask_patches(material, arrival, ray, state, both_sides);
            }
            return;
        }
        if !room.emitters.is_empty() {
            let choice = state.draws.next();
            let u = [state.draws.next(), state.draws.next()];
            let asked = room.emitters.sample(&room.windows, &room.lights, ray.origin, choice, u);
            if let Some((emitter, direction)) = asked {
                let by_chance = material.density(arrival, &state.weight, direction);
                let target = Target::Emitter(emitter, by_chance);
                self.claim(material, arrival, ray, state, both_sides, direction, target, [1.0; 3]);
            }
        }
        if let Some(sun) = &room.sun {
            let u = [state.draws.next(), state.draws.next()];
            let solid_angle = sun.solid_angle;
            let factor = sun.radiance.map(|l| l * solid_angle);
            self.claim(
                material,
                arrival,
                ray,
                state,
                both_sides,
                sun.sample(u),
                Target::Sun,
                factor,
            );
        }
    }

    /// Asks the windows for the ledger, at a point of each part of them, and without rays where nothing can be in the way.
    fn ask_patches(
        &mut self,
        material: &Material,
        arrival: &Arrival<'_>,
        ray: &Ray,
        state: &mut State,
        both_sides: bool,
    ) {
        let room = self.room;
        let shift = [state.draws.next(), state.draws.next()];
        let most = state.weight.iter().copied().fold(0.0, f64::max);
        state.fineness = FINENESS / most.max(LEAST).sqrt();
        let mut count = 0;
        for (number, window) in room.windows.iter().enumerate() {
            let (polygon, normal) = (window.polygon(), window.polygon().normal());
            if (polygon.corners()[0] - ray.origin).dot(normal) >= 0.0 {
                continue;
            }
            let clear = room.is_clear(number, ray.origin);
            pieces(polygon, ray.origin, parted(clear, state.fineness), &mut |piece| {
                let way = piece.sample(r2(count, shift)) - ray.origin;
                count += 1;
                let distance = way.length();
                let direction = way * (1.0 / distance);
                let cos = direction.dot(arrival.normal);
                if cos == 0.0 || (cos < 0.0 && !both_sides) {
                    return;
                }
                let by_chance = material.density(arrival, &state.weight, direction);
                let share = 1.0 / (density(piece.area, normal, direction, distance) + by_chance);
                if !clear {
                    let target = Target::Emitter(number, by_chance);
                    self.claim(material, arrival, ray, state, both_sides, direction, target, [share; 3]);
                    return;
                }
                let f = material.evaluate::<3>(arrival, direction);
                let value = std::array::from_fn(|c| state.weight[c] * f[c] * cos.abs() * share);
                if let Some(ledger) = &mut self.ledger {
                    ledger.window(number, window.disk(-direction), value, state.events);
                }
            });
        }
    }

    /// Notes light from a direction, times a factor, that a surface scatters back along the path.
    #[allow(clippy::too_many_arguments)] // What scatters, and what it scatters.
    fn claim(
        &mut self,
        material: &Material,
        arrival: &Arrival<'_>,
        ray: &Ray,
        state: &State,
        both_sides: bool,
        direction: Vec3,
        target: Target,
        factor: Rgb,
    ) {
        let cos = direction.dot(arrival.normal);
        if cos == 0.0 || (cos < 0.0 && !both_sides) {
            return;
        }
        let f = material.evaluate::<3>(arrival, direction);
        let value: Rgb = std::array::from_fn(|c| state.weight[c] * f[c] * cos.abs() * factor[c]);
        if value.iter().any(|v| *v > 0.0) {
            self.shadows.push(Ray { direction, ..*ray });
            self.claims.push(Claim {
                value,
                target,
                state: *state,
            });
        }
    }

    /// Follows all that was asked for.
    fn settle(&mut self) {
        while !self.shadows.is_empty() {
            std::mem::swap(&mut self.shadows, &mut self.flying);
            std::mem::swap(&mut self.claims, &mut self.asking);
            self.meetings.resize(self.flying.len(), Meeting::Lost);
            self.room.mesh.meet_all(&mut self.flying, &mut self.meetings);
            for k in 0..self.flying.len() {
                let (ray, claim) = (self.flying[k], self.asking[k]);
                match claim.target {
                    Target::Sun => self.settle_sun(self.meetings[k], ray, claim),
                    Target::Emitter(emitter, by_chance) => {
                        self.settle_emitter(self.meetings[k], ray, claim, emitter, by_chance);
                    }
                }
            }
            self.flying.clear();
            self.asking.clear();
        }
    }

    fn settle_sun(&mut self, meeting: Meeting, ray: Ray, mut claim: Claim) {
        let hit = match meeting {
            Meeting::Hit(hit) => hit,
            Meeting::Leaves | Meeting::Lost => {
                self.pay(&claim, [1.0; 3]);
                return;
            }
        };
        // Only a window's beam lets it pass; who looks through a pane finds the sun behind it by going on.
        let Role::Window(number) = self.room.roles[hit.surface as usize] else {
            return;
        };
        let window = &self.room.windows[number as usize];
        if ray.direction.dot(hit.normal) > 0.0 {
            return;
        }
        let beam = window.sun_beam();
        if !window.obstructed() {
            self.pay(&claim, beam);
        } else if beam.iter().any(|b| *b > 0.0) {
            for (value, passes) in claim.value.iter_mut().zip(beam) {
                *value *= passes;
            }
            self.shadows.push(ray);
            self.claims.push(claim);
        }
    }

    fn settle_emitter(&mut self, meeting: Meeting, ray: Ray, mut claim: Claim, emitter: usize, by_chance: f64) {
        let Meeting::Hit(hit) = meeting else { return };
        let room = self.room;
        let windows = room.windows.len();
        let met = match room.roles[hit.surface as usize] {
            Role::Window(number) => number as usize,
            Role::Light(number) => windows + number as usize,
            Role::Solid(_) => return,
        };
        if met != emitter || ray.direction.dot(hit.normal) > 0.0 {
            return;
        }
        if let Some(ledger) = &mut self.ledger {
            let travel = room.windows[emitter].disk(-ray.direction);
            ledger.window(emitter, travel, claim.value, claim.state.events);
            return;
        }
        let asked = room
            .emitters
            .density(&room.windows, &room.lights, emitter, ray.direction, hit.distance);
        if asked <= 0.0 {
            return;
        }
        let share = 1.0 / (asked + by_chance);
        if emitter >= windows {
            let (_, radiance) = &room.lights[emitter - windows];
            self.pay(&claim, radiance.map(|r| r * share));
            return;
        }
        if !room.windows[emitter].obstructed() {
            let window = &room.windows[emitter];
            let radiance = window.sent(window.disk(-ray.direction));
            self.pay(&claim, radiance.map(|r| r * share));
            return;
        }
        // Something stands before it: the light is followed from there.
        claim.state.weight = claim.value.map(|v| v * share);
        claim.state.density = f64::INFINITY;
        claim.state.sun_asked = true;
        let (mut ray, mut state) = (ray, claim.state);
        if self.arrive(hit, &mut ray, &mut state) {
            self.rays.push(ray);
            self.states.push(state);
        }
    }

    fn pay(&mut self, claim: &Claim, factor: Rgb) {
        let slot = &mut self.found[claim.state.slot as usize];
        for c in 0..3 {
            slot[c] += claim.value[c] * factor[c];
        }
    }

    /// Roulette, and the greatest number of events.
    fn goes_on(&mut self, state: &mut State) -> bool {
        let most = state.weight.iter().copied().fold(0.0, f64::max);
        if most < ROULETTE {
            let chance = most / ROULETTE;
            if state.draws.next() >= chance {
                return false;
            }
            state.weight = state.weight.map(|w| w / chance);
        }
        if state.events >= EVENTS {
            self.ends.cut_off += 1;
            return false;
        }
        true
    }
}

impl Room {
    /// What an open window sends against a direction that looks at it from the room.
    pub(super) fn through(&self, number: usize, look: Vec3, with_sun: bool) -> Rgb {
        let window = &self.windows[number];
        let travel = window.disk(-look);
        let mut radiance = window.radiance(travel);
        let beam = window.beam(travel);
        if beam.iter().any(|b| *b > 0.0) {
            let behind = self.outside(look, with_sun);
            for c in 0..3 {
                radiance[c] += beam[c] * behind[c];
            }
        }
        radiance
    }
}

/// Where a path goes on, and whether to the other side; None where it ends. `asked` says that windows and the sun were asked
/// for light here.
fn scatter(material: &Material, arrival: &Arrival<'_>, ray: &mut Ray, state: &mut State, asked: bool) -> Option<bool> {
    let before = state.weight;
    let mut absorbed = [0.0; 3];
    let departure = material.scatter(
        arrival,
        &mut state.weight,
        &mut absorbed,
        &mut state.polarisation,
        &mut state.draws,
    )?;
    ray.direction = departure.direction;
    let asked = asked && !departure.specular;
    state.sun_asked = asked;
    state.density = if asked {
        material.density(arrival, &before, departure.direction)
    } else {
        f64::INFINITY
    };
    Some(departure.passes)
}
