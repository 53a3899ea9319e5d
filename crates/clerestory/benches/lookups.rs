//! Look-ups and samples a second, on one thread. Prints one line a case: name, nanoseconds.
#![allow(clippy::print_stdout, reason = "the output is the result")]
#![allow(missing_docs, reason = "a program")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use clerestory::basis::Basis;
use clerestory::bsdf::tree::Grid;
use clerestory::bsdf::{Lambertian, Matrix, Model, Rank, Scatterer, Tree};
use clerestory::direction::Disk;
use clerestory::progress::Progress;
use clerestory::sequence::{mix, uniform};

const COUNT: usize = 1 << 20;
const REPEATS: usize = 7;

/// A tree of 32 cells an axis that is fine about straight transmission and coarse elsewhere.
fn tree(rank: Rank) -> Tree {
    let lobe = |i: Disk, o: Disk| {
        let d2 = (i.x - o.x).powi(2) + (i.y - o.y).powi(2);
        if d2 < 0.1 {
            0.05 + 2.0 * (-d2 / 0.01).exp()
        } else {
            0.05
        }
    };
    let grid = Grid {
        levels: 5,
        samples: 1,
        seed: 0,
    };
    let tree = Tree::from_fn(rank, grid, &lobe, &Progress::default()).expect("a sound function");
    tree.reduced_by_percent(90.0).expect("a sound tree").tree
}

fn points(seed: u64) -> Vec<Disk> {
    (0..COUNT as u64)
        .map(|k| Disk::uniform([uniform(seed, 2 * k), uniform(seed, 2 * k + 1)]))
        .collect()
}

/// Median nanoseconds of one call.
fn time(name: &str, mut call: impl FnMut(usize) -> f64) {
    let mut runs: Vec<f64> = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            for k in 0..COUNT {
                black_box(call(k));
            }
            start.elapsed().as_secs_f64() * 1e9 / COUNT as f64
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    println!("{name}\t{:.2}", runs[REPEATS / 2]);
}

fn main() {
    let basis = Arc::new(Basis::klems_full());
    let matrix = Matrix::from_fn(basis.clone(), basis, |i, o| uniform(mix(i as u64), o as u64)).expect("sound values");
    let models = [
        ("Lambertian", Model::Lambertian(Lambertian::new(0.5).expect("a value"))),
        ("Klems matrix", Model::Matrix(matrix)),
        ("tensor tree, rank 3", Model::Tree(tree(Rank::Isotropic))),
        ("tensor tree, rank 4", Model::Tree(tree(Rank::Anisotropic))),
    ];
    let (incident, outgoing) = (points(1), points(2));
    for (name, model) in &models {
        time(&format!("{name}: look-up"), |k| {
            model.evaluate(incident[k], outgoing[k])
        });
        time(&format!("{name}: sample"), |k| {
            let u = [uniform(3, k as u64), uniform(4, k as u64)];
            model.sample(incident[k], u).map_or(0.0, |s| s.weight)
        });
    }
}
