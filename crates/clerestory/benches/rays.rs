//! Rays and paths a second on one thread: `cargo bench -p clerestory --bench rays`. A line of JSON a case. With the variable
//! CLERESTORY_RAYS set to a folder, the rays are also written there, six 64-bit numbers each, for other programs.
#![allow(clippy::print_stdout, reason = "the output is the result")]
#![allow(missing_docs, reason = "a program")]

use std::f64::consts::TAU;
use std::hint::black_box;
use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clerestory::basis::Basis;
use clerestory::geometry::{Extent, Geometry, Meeting, Mesh, NO_PIECE, Piece, Profile, Ray, Scene, Shape, Vec3};
use clerestory::material::{Material, Medium, Surface};
use clerestory::progress::Progress;
use clerestory::sequence::uniform;
use clerestory::trace::{Goniophotometer, Sample, Settings, State, Stop};

const PATHS: u64 = 1 << 18;
const REPEATS: usize = 7;
const BATCH: usize = 256;

fn arc(from: [f64; 2], to: [f64; 2], turn: f64) -> Piece {
    Piece {
        from,
        to,
        turn,
        surface: 0,
    }
}

/// Sections by name, with their periods.
fn sections() -> Vec<(&'static str, Vec<Piece>, f64)> {
    let film = |count: u32| {
        let at = |k: u32| [1e-5 * uniform(3, u64::from(k % count)), 1e-6 * f64::from(k)];
        let mut pieces: Vec<Piece> = (0..count).map(|k| arc(at(k + 1), at(k), 0.0)).collect();
        pieces.push(arc([-1e-4, 0.0], [-1e-4, 1e-6 * f64::from(count)], 0.0));
        pieces
    };
    let beaded = vec![
        arc([-0.038, 0.0], [0.038, 0.0], -1.0),
        arc([-0.04, 0.002], [-0.04, -0.002], 3.0),
        arc([-0.04, -0.002], [-0.04, 0.002], 3.0),
        arc([0.04, 0.002], [0.04, -0.002], 3.0),
        arc([0.04, -0.002], [0.04, 0.002], 3.0),
    ];
    vec![
        ("flat slats", vec![arc([-0.04, 0.0], [0.04, 0.0], 0.0)], 0.072),
        ("curved slats", vec![arc([-0.04, 0.0], [0.04, 0.0], -1.0)], 0.072),
        ("curved slats with beads", beaded, 0.072),
        ("film of 100 pieces", film(100), 1e-4),
        ("film of 3000 pieces", film(3000), 3e-3),
    ]
}

/// Slats as a mesh, of facets where they turn: as many and as long as told, or one that is repeated.
fn mesh(piece: Piece, period: f64, count: i32, length: f64, repeated: bool) -> Mesh {
    let facets = if piece.turn == 0.0 { 1 } else { 64 };
    let [low, high] = [piece.from[0], piece.to[0]];
    // Its middle rises.
    let point = |k: i32| {
        let at = f64::from(k) / f64::from(facets) - 0.5;
        if piece.turn == 0.0 {
            return [(high - low) * at, 0.0];
        }
        let half = piece.turn.abs() / 2.0;
        let radius = 0.5 * (high - low) / half.sin();
        let angle = 2.0 * half * at;
        [radius * angle.sin(), radius * (angle.cos() - half.cos())]
    };
    let mut scene = Scene::default();
    let (surface, object) = (scene.surface("slat"), scene.object("slat"));
    for slat in 0..count {
        let shift = f64::from(slat - count / 2) * period;
        for k in 0..facets {
            let at = |x: f64, [z, y]: [f64; 2]| Vec3::new(x, y + shift, z);
            let (a, b) = (at(-length, point(k)), at(-length, point(k + 1)));
            let (c, d) = (at(length, point(k)), at(length, point(k + 1)));
            scene.push(Shape::Triangle([a, b, c]), surface, object);
            scene.push(Shape::Triangle([b, d, c]), surface, object);
        }
    }
    let extent = |limits: [f64; 2]| Extent { limits, repeated };
    Mesh::new(scene, [extent([-length, length]), extent([0.0, period])]).expect("a sound scene")
}

/// About a normal, its density in proportion to the cosine.
fn scattered(normal: Vec3, k: u64) -> Vec3 {
    let [t, b] = normal.frame();
    let u = uniform(1, 2 * k);
    let (sin, cos) = (TAU * uniform(1, 2 * k + 1)).sin_cos();
    (t * (u.sqrt() * cos) + b * (u.sqrt() * sin) + normal * (1.0 - u).max(1e-12).sqrt()).unit()
}

/// The rays of paths through a section that scatters evenly: from the exterior, then from where they met it.
fn rays(profile: &Profile) -> Vec<Ray> {
    let [low, high] = profile.depth();
    let period = profile.period()[1];
    let mut flying: Vec<Ray> = (0..PATHS)
        .map(|k| Ray {
            origin: Vec3::new(0.0, period * uniform(2, k), low - 0.01 * (high - low + period)),
            direction: scattered(Vec3::new(0.0, 0.0, 1.0), k),
            piece: NO_PIECE,
        })
        .collect();
    let mut all = Vec::new();
    for bounce in 1..4 {
        all.extend_from_slice(&flying);
        flying.retain_mut(|ray| match profile.meet(ray) {
            Meeting::Hit(hit) => {
                let normal = if ray.direction.dot(hit.normal) > 0.0 {
                    -hit.normal
                } else {
                    hit.normal
                };
                ray.direction = scattered(normal, bounce * PATHS + u64::from(ray.origin.z.to_bits() as u32));
                true
            }
            _ => false,
        });
    }
    all
}

/// Rays a second.
fn meet(geometry: &dyn Geometry, rays: &[Ray]) -> f64 {
    let mut meetings = vec![Meeting::Lost; BATCH];
    let mut buffer = Vec::with_capacity(BATCH);
    let mut best = Duration::MAX;
    for _ in 0..REPEATS {
        let mut time = Duration::ZERO;
        for batch in rays.chunks(BATCH) {
            buffer.clear();
            buffer.extend_from_slice(batch);
            let start = Instant::now();
            geometry.meet_all(&mut buffer, &mut meetings[..batch.len()]);
            time += start.elapsed();
            black_box((&buffer, &meetings));
        }
        best = best.min(time);
    }
    rays.len() as f64 / best.as_secs_f64()
}

/// Paths a second of a whole measurement: Lambertian slats, Klems full both ways.
fn measure(profile: Profile, reflectance: f64) -> f64 {
    let sample = Sample {
        bands: vec!["visible".into()],
        layers: vec![Box::new(profile)],
        surfaces: vec![Surface {
            materials: [0, 0],
            media: [0, 0],
        }],
        materials: vec![Material::Lambertian {
            reflectance: vec![reflectance],
            transmittance: vec![0.0],
        }],
        media: vec![Medium::air(1)],
    };
    let basis = Arc::new(Basis::klems_full());
    let instrument = Goniophotometer {
        settings: Settings {
            stop: Stop::Paths(8192),
            ..Settings::default()
        },
    };
    let mut best = 0.0_f64;
    for _ in 0..3 {
        let start = Instant::now();
        let measured = instrument
            .matrices(&sample, &basis, &basis, &mut State::new(""), &Progress::default())
            .expect("a sound sample");
        best = best.max(measured.paths as f64 / start.elapsed().as_secs_f64());
    }
    best
}

fn write(name: &str, rays: &[Ray]) {
    let Some(folder) = std::env::var_os("CLERESTORY_RAYS") else {
        return;
    };
    let path = std::path::Path::new(&folder).join(format!("{}.rays", name.replace(' ', "-")));
    let bytes: Vec<u8> = rays
        .iter()
        .flat_map(|r| [r.origin, r.direction])
        .flat_map(|v| [v.x, v.y, v.z])
        .flat_map(f64::to_le_bytes)
        .collect();
    std::fs::File::create(path)
        .and_then(|mut file| file.write_all(&bytes))
        .expect("the folder can be written to");
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread can be started");
    pool.install(|| {
        for (name, pieces, period) in sections() {
            let profile = Profile::new(&pieces, period).expect("a sound section");
            let rays = rays(&profile);
            write(name, &rays);
            let speed = meet(&profile, &rays);
            println!(
                r#"{{"case": "{name}", "rays": {}, "rays_per_s": {speed:.0}}}"#,
                rays.len()
            );
            if name.ends_with("slats") {
                // Off the arc that they start on, by more than the facets' distance from it.
                let off = |r: &Ray| Ray {
                    origin: r.origin + r.direction * 2e-5,
                    piece: NO_PIECE,
                    ..*r
                };
                let rays: Vec<Ray> = rays.iter().map(off).collect();
                for (kind, count, length, repeated) in [("mesh", 61, 40.0, false), ("repeated mesh", 1, 0.5, true)] {
                    let speed = meet(&mesh(pieces[0], period, count, length, repeated), &rays);
                    println!(
                        r#"{{"case": "{kind} of {name}", "rays": {}, "rays_per_s": {speed:.0}}}"#,
                        rays.len()
                    );
                }
                let speed = measure(profile, 0.5);
                println!(r#"{{"case": "{name}", "paths_per_s": {speed:.0}}}"#);
            }
        }
    });
}
