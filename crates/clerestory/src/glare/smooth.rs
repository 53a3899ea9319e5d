//! Smoothing: pixels that a source surrounds belong to it.
//!
//! A pixel joins if more than a fifth of the pixels within a fifth of the search radius belong to sources (found from runs of
//! `evalglare` 3.06).

use rayon::prelude::*;

use super::lens::Lens;

/// Part of the search radius within which neighbours count, and part of them that has to be of a source.
const REACH: f64 = 0.2;
const SHARE: f64 = 0.2;

/// Pixels that join, each with its source; `labels` holds 0 for no source.
pub(super) fn joining(lens: &Lens, labels: &[u32], search_radius: f64) -> Vec<(u32, u32)> {
    let [width, height] = lens.size();
    let limit = (REACH * search_radius).cos();
    let directions: Vec<Option<[f64; 3]>> = (0..width * height)
        .into_par_iter()
        .with_min_len(4096)
        .map(|k| (lens.solid_angles()[k] > 0.0).then(|| lens.direction(k)).flatten())
        .collect();
    let cosine = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    // How far neighbours in a line can lie within reach, by the nearer one of the two next to a pixel.
    let window = |at: usize, d: &[f64; 3], step: usize, before: bool, after: bool| {
        let next = |k: usize| directions[k].as_ref().map(|e| cosine(d, e).min(1.0).acos());
        let sides = [
            before.then(|| next(at - step)).flatten(),
            after.then(|| next(at + step)).flatten(),
        ];
        let pitch = sides.into_iter().flatten().fold(f64::INFINITY, f64::min);
        (1.5 * REACH * search_radius / pitch.max(1e-6)) as usize + 1
    };
    (0..height)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (directions, window) = (&directions, &window);
            (0..width).filter_map(move |column| {
                let at = row * width + column;
                let d = directions[at].as_ref().filter(|_| labels[at] == 0)?;
                let across = window(at, d, 1, column > 0, column + 1 < width);
                let along = window(at, d, width, row > 0, row + 1 < height);
                let (mut all, mut of_sources, mut nearest) = (0_u32, 0_u32, (-1.0, 0));
                for r in row.saturating_sub(along)..(row + along + 1).min(height) {
                    for k in r * width + column.saturating_sub(across)..r * width + (column + across + 1).min(width) {
                        let Some(e) = directions[k].as_ref().filter(|_| k != at) else {
                            continue;
                        };
                        let c = cosine(d, e);
                        if c >= limit {
                            all += 1;
                            if labels[k] > 0 {
                                of_sources += 1;
                                if c > nearest.0 {
                                    nearest = (c, labels[k]);
                                }
                            }
                        }
                    }
                }
                (f64::from(of_sources) > SHARE * f64::from(all)).then_some((at as u32, nearest.1))
            })
        })
        .collect()
}
