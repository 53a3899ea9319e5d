//! Lobes that belong together: the hills of a distribution.

use super::distribution::{Distribution, chord2};
use super::lobe::{kernel, vector};
use crate::direction::Disk;

/// A hill joins its neighbour where the saddle between them is above this share of the lower summit.
const SADDLE: f64 = 0.4;

/// A hill.
#[derive(Debug, Clone)]
pub struct Cluster {
    /// Numbers of its lobes.
    pub lobes: Vec<usize>,
    /// What they carry.
    pub flux: f64,
    /// Their centre of gravity on the disk.
    pub middle: Disk,
}

/// Hills of a distribution: from the summits down, each lobe joins the hill of its highest neighbour, and hills that meet on a
/// high saddle are one.
pub fn clusters(distribution: &Distribution) -> Vec<Cluster> {
    let lobes = &distribution.lobes;
    let at: Vec<_> = lobes.iter().map(|l| vector(l.centre)).collect();
    let radius: Vec<f64> = lobes.iter().map(|l| l.radius2.sqrt()).collect();
    let amplitude: Vec<f64> = lobes.iter().map(super::lobe::Lobe::amplitude).collect();
    let heights: Vec<f64> = (0..lobes.len())
        .map(|i| {
            (0..lobes.len())
                .map(|j| amplitude[j] * kernel(chord2(at[i], at[j]) / lobes[j].radius2))
                .sum()
        })
        .collect();
    let mut order: Vec<usize> = (0..lobes.len()).collect();
    order.sort_by(|&a, &b| heights[b].total_cmp(&heights[a]));
    // Each hill points to the one that it joined; the summit is its first lobe.
    let mut parent: Vec<usize> = (0..lobes.len()).collect();
    let mut done: Vec<usize> = Vec::with_capacity(lobes.len());
    for &i in &order {
        let mut highest: Option<usize> = None;
        let mut neighbours = Vec::new();
        for &j in &done {
            let reach = 0.4 * (radius[i] + radius[j]);
            if chord2(at[i], at[j]) < reach * reach {
                let summit = top(&mut parent, j);
                neighbours.push(summit);
                if highest.is_none_or(|h| heights[summit] > heights[h]) {
                    highest = Some(summit);
                }
            }
        }
        if let Some(highest) = highest {
            parent[i] = highest;
            for summit in neighbours {
                let summit = top(&mut parent, summit);
                if summit != highest && heights[i] > SADDLE * heights[summit] {
                    parent[summit] = highest;
                }
            }
        }
        done.push(i);
    }
    let mut hills: Vec<(usize, Cluster)> = Vec::new();
    for (i, lobe) in lobes.iter().enumerate() {
        let summit = top(&mut parent, i);
        let place = hills.iter().position(|(s, _)| *s == summit).unwrap_or_else(|| {
            let empty = Cluster {
                lobes: Vec::new(),
                flux: 0.0,
                middle: Disk::NORMAL,
            };
            hills.push((summit, empty));
            hills.len() - 1
        });
        let hill = &mut hills[place].1;
        hill.lobes.push(i);
        hill.flux += lobe.flux;
        hill.middle.x += lobe.flux * lobe.centre.x;
        hill.middle.y += lobe.flux * lobe.centre.y;
    }
    hills
        .into_iter()
        .map(|(_, hill)| Cluster {
            middle: Disk::new(hill.middle.x / hill.flux, hill.middle.y / hill.flux),
            ..hill
        })
        .collect()
}

/// The summit of the hill that a lobe belongs to.
fn top(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}
