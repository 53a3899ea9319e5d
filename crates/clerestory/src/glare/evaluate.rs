//! Glare sources of a picture, and its indices.

use rayon::prelude::*;

use super::cluster::groups;
use super::indices::{Field, Indices, Source, place, summarise};
use super::lens::Lens;
use super::settings::{Settings, Task, Threshold};
use super::smooth::joining;
use crate::error::{Error, Result};

/// What was found in a picture.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// Sources, the most glaring first.
    pub sources: Vec<Source>,
    /// What indices say.
    pub indices: Indices,
    /// Luminance (cd/m²) above which pixels are sources.
    pub threshold: f64,
    /// Mean luminance of the task area (cd/m²), if there is one.
    pub task_luminance: Option<f64>,
    /// Solid angle of the pixels that count (steradians).
    pub solid_angle: f64,
    /// Number of the source of each pixel, from 1 in the order of the sources, row by row from the top; 0 for none.
    pub labels: Vec<u32>,
    /// What makes the result doubtful.
    pub warnings: Vec<String>,
}

/// Sums of a part of the picture.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Solid angle.
    omega: f64,
    /// Luminance times solid angle.
    flux: f64,
    /// That times the cosine.
    illuminance: f64,
}

impl Sums {
    fn add(&mut self, luminance: f64, omega: f64, cosine: f64) {
        self.omega += omega;
        self.flux += luminance * omega;
        self.illuminance += luminance * omega * cosine;
    }
}

/// Finds and rates the sources of a picture of luminances (cd/m²), row by row from the top.
///
/// # Errors
/// The picture does not have the lens's size, has a luminance that is not a number or negative, or is black.
pub fn evaluate(luminance: &[f32], lens: &Lens, settings: &Settings) -> Result<Evaluation> {
    settings.check()?;
    let [width, height] = lens.size();
    if luminance.len() != width * height {
        return Err(Error::Argument(format!(
            "{} luminances are no picture of {width} × {height} (give one a pixel)",
            luminance.len()
        )));
    }
    let total = sums(luminance, lens)?;
    if total.illuminance <= 0.0 {
        return Err(Error::Argument(
            "the picture is black, so there is nothing to rate (check its exposure and its view)".into(),
        ));
    }
    let task_luminance = settings.task.map(|task| in_task(luminance, lens, task)).transpose()?;
    let threshold = match settings.threshold {
        Threshold::Absolute(value) => value,
        Threshold::TimesMean(factor) => factor * total.flux / total.omega,
        Threshold::TimesTask(factor) => factor * task_luminance.unwrap_or_default(),
    };
    let mut warnings = Vec::new();
    // How many pixels the search reaches.
    let reach = 0.5 * settings.search_radius / lens.pitch();
    let coarse = reach < 1.0;
    if coarse && (settings.smoothing || settings.peaks.is_some()) {
        warnings
            .push("the search radius is less than a pixel, so there is no smoothing and no extraction of peaks".into());
    } else if reach < 3.0 {
        warnings.push(format!(
            "the search radius is {reach:.1} pixels only, so sources are told apart coarsely"
        ));
    }
    let mut labels = vec![0_u32; luminance.len()];
    let mut count = detect(luminance, lens, settings, threshold, &mut labels);
    if settings.smoothing && !coarse {
        for (at, label) in joining(lens, &labels, settings.search_radius) {
            labels[at as usize] = label;
        }
    }
    let whole = count;
    if let Some(limit) = settings.peaks.filter(|_| !coarse) {
        count = extract(luminance, lens, settings, limit, count, &mut labels);
    }
    let mut sources = measure(luminance, lens, settings, &mut labels, count, whole);
    let mut order: Vec<usize> = (0..sources.len()).collect();
    order.sort_by(|&a, &b| sources[b].weight().total_cmp(&sources[a].weight()));
    let mut number = vec![0_u32; sources.len() + 1];
    for (k, &old) in order.iter().enumerate() {
        number[old + 1] = k as u32 + 1;
    }
    labels.par_iter_mut().for_each(|label| *label = number[*label as usize]);
    sources = order.iter().map(|&k| sources[k]).collect();

    let (flux, omega) = sources.iter().fold((0.0, 0.0), |(f, o), s| {
        (f + s.luminance * s.solid_angle, o + s.solid_angle)
    });
    let rest = total.omega - omega;
    let field = Field {
        vertical_illuminance: total.illuminance,
        mean_luminance: total.flux / total.omega,
        mean_background: if rest > 1e-12 { (total.flux - flux) / rest } else { 0.0 },
    };
    Ok(Evaluation {
        indices: summarise(&sources, &field, settings)?,
        sources,
        threshold,
        task_luminance,
        solid_angle: total.omega,
        labels,
        warnings,
    })
}

/// Sums over the picture, row after row in a fixed order.
fn sums(luminance: &[f32], lens: &Lens) -> Result<Sums> {
    let [width, _] = lens.size();
    let rows: Vec<Result<Sums>> = luminance
        .par_chunks(width)
        .zip(lens.solid_angles().par_chunks(width))
        .zip(lens.cosines().par_chunks(width))
        .enumerate()
        .map(|(row, ((values, omegas), cosines))| {
            let mut sums = Sums::default();
            for (column, ((&value, &omega), &cosine)) in values.iter().zip(omegas).zip(cosines).enumerate() {
                if !value.is_finite() || value < 0.0 {
                    return Err(Error::Argument(format!(
                        "the luminance of the pixel in column {} and row {} from the top is {value} (correct the picture)",
                        column + 1,
                        row + 1
                    )));
                }
                sums.add(f64::from(value), omega, cosine);
            }
            Ok(sums)
        })
        .collect();
    let mut total = Sums::default();
    for row in rows {
        let row = row?;
        total.omega += row.omega;
        total.flux += row.flux;
        total.illuminance += row.illuminance;
    }
    Ok(total)
}

/// Mean luminance of the task area by solid angle.
fn in_task(luminance: &[f32], lens: &Lens, task: Task) -> Result<f64> {
    let [width, height] = lens.size();
    let outside = || {
        Error::Argument(format!(
            "the task area at {}, {} is outside of the picture of {width} × {height} pixels, or empty (give x from the left, y \
             from the bottom, and an angle in radians)",
            task.x, task.y
        ))
    };
    let inside = |v: f64, size: usize| v >= 0.0 && v < size as f64;
    if !inside(task.x, width) || !inside(task.y, height) {
        return Err(outside());
    }
    let middle = (height - 1 - task.y as usize) * width + task.x as usize;
    let axis = lens.direction(middle).ok_or_else(outside)?;
    let limit = (0.5 * task.angle).cos();
    let mut sums = Sums::default();
    for (k, &omega) in lens
        .solid_angles()
        .iter()
        .enumerate()
        .filter(|(_, omega)| **omega > 0.0)
    {
        if let Some(d) = lens.direction(k)
            && d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] >= limit
        {
            sums.add(f64::from(luminance[k]), omega, 0.0);
        }
    }
    if sums.omega > 0.0 {
        Ok(sums.flux / sums.omega)
    } else {
        Err(outside())
    }
}

/// Pixels of `chosen` with their directions.
fn directed(lens: &Lens, chosen: Vec<u32>) -> (Vec<u32>, Vec<[f64; 3]>) {
    chosen
        .into_par_iter()
        .with_min_len(4096)
        .filter_map(|k| lens.direction(k as usize).map(|d| (k, d)))
        .unzip()
}

/// Labels the pixels above the threshold by source, from 1; gives the number of sources.
fn detect(luminance: &[f32], lens: &Lens, settings: &Settings, threshold: f64, labels: &mut [u32]) -> u32 {
    let omegas = lens.solid_angles();
    let chosen = (0..luminance.len() as u32)
        .filter(|&k| f64::from(luminance[k as usize]) > threshold && omegas[k as usize] > 0.0)
        .collect();
    let (pixels, directions) = directed(lens, chosen);
    let groups = groups(&directions, 0.5 * settings.search_radius);
    for (&pixel, group) in pixels.iter().zip(&groups) {
        labels[pixel as usize] = group + 1;
    }
    groups.iter().max().map_or(0, |g| g + 1)
}

/// Cuts the pixels above a limit out of their sources; gives the number of sources with those of the peaks.
fn extract(luminance: &[f32], lens: &Lens, settings: &Settings, limit: f64, count: u32, labels: &mut [u32]) -> u32 {
    let chosen = (0..luminance.len() as u32)
        .filter(|&k| labels[k as usize] > 0 && f64::from(luminance[k as usize]) > limit)
        .collect();
    let (pixels, directions) = directed(lens, chosen);
    let groups = groups(&directions, 0.5 * settings.search_radius);
    for (&pixel, group) in pixels.iter().zip(&groups) {
        labels[pixel as usize] = count + 1 + group;
    }
    count + groups.iter().max().map_or(0, |g| g + 1)
}

/// Sums of one source.
#[derive(Clone, Copy, Default)]
struct Gathered {
    sums: Sums,
    largest: f64,
    pixels: usize,
    /// Pixel from the left and from the bottom, weighted.
    place: [f64; 2],
    direction: [f64; 3],
}

/// Measures each labelled source; those that nothing is left of vanish, and labels count the others.
fn measure(
    luminance: &[f32],
    lens: &Lens,
    settings: &Settings,
    labels: &mut [u32],
    count: u32,
    whole: u32,
) -> Vec<Source> {
    let [width, height] = lens.size();
    let mut gathered = vec![Gathered::default(); count as usize];
    for (k, &label) in labels.iter().enumerate().filter(|(_, label)| **label > 0) {
        let source = &mut gathered[label as usize - 1];
        let value = f64::from(luminance[k]);
        let omega = lens.solid_angles()[k];
        source.sums.add(value, omega, lens.cosines()[k]);
        source.largest = source.largest.max(value);
        source.pixels += 1;
        source.place[0] += value * omega * (k % width) as f64;
        source.place[1] += value * omega * (height - 1 - k / width) as f64;
    }
    let mut numbers = vec![0_u32; gathered.len() + 1];
    let mut sources = Vec::new();
    for (k, mut source) in gathered.into_iter().enumerate() {
        if source.pixels == 0 || source.sums.flux <= 0.0 {
            continue;
        }
        // The pixel in which the centre of gravity falls; a pixel's own place is not lost to rounding.
        let [x, y] = source.place.map(|sum| (sum / source.sums.flux + 1e-6).floor() as usize);
        let at = (height - 1 - y.min(height - 1)) * width + x.min(width - 1);
        source.direction = lens.direction(at).unwrap_or([0.0, 0.0, 1.0]);
        let (sigma, position_index) = place(lens.camera(), settings, source.direction);
        sources.push(Source {
            direction: lens.camera().world(source.direction),
            luminance: source.sums.flux / source.sums.omega,
            largest: source.largest,
            solid_angle: source.sums.omega,
            illuminance: source.sums.illuminance,
            sigma,
            position_index,
            pixels: source.pixels,
            peak: k >= whole as usize,
        });
        numbers[k + 1] = sources.len() as u32;
    }
    for label in labels {
        *label = numbers[*label as usize];
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::picture::{Camera, View};

    fn lens(size: usize) -> Lens {
        let view = View::fisheye(Vec3::default(), Vec3::new(0.0, 1.0, 0.0));
        Lens::new(Camera::new(view).unwrap(), size, size).unwrap()
    }

    #[test]
    fn a_uniform_field_lights_the_eye_by_pi() {
        let lens = lens(300);
        let found = evaluate(&vec![500.0; 90_000], &lens, &Settings::default()).unwrap();
        assert!((found.indices.vertical_illuminance / (500.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
        assert!((found.solid_angle / std::f64::consts::TAU - 1.0).abs() < 2e-3);
        assert!(found.sources.is_empty() && found.labels.iter().all(|l| *l == 0));
        assert_eq!((found.indices.ugr, found.indices.vcp), (0.0, 100.0));
    }

    #[test]
    fn peaks_leave_their_source_and_labels_follow_the_order() {
        let lens = lens(200);
        let mut picture = vec![100.0_f32; 40_000];
        for row in 60..70 {
            picture[row * 200 + 60..row * 200 + 80].fill(3000.0);
            picture[row * 200 + 140..row * 200 + 150].fill(9000.0);
        }
        picture[65 * 200 + 70] = 1e6;
        let found = evaluate(&picture, &lens, &Settings::default()).unwrap();
        let pixels: Vec<(usize, bool)> = found.sources.iter().map(|s| (s.pixels, s.peak)).collect();
        assert_eq!(pixels, [(1, true), (100, false), (199, false)]);
        for (k, source) in found.sources.iter().enumerate() {
            let labelled = found.labels.iter().filter(|l| **l == k as u32 + 1).count();
            assert_eq!(labelled, source.pixels);
        }
        let off = Settings {
            peaks: None,
            ..Settings::default()
        };
        assert_eq!(evaluate(&picture, &lens, &off).unwrap().sources.len(), 2);
        let factor = Settings {
            threshold: Threshold::TimesMean(5.0),
            ..Settings::default()
        };
        let found = evaluate(&picture, &lens, &factor).unwrap();
        assert!((found.threshold - 5.0 * found.indices.mean_luminance).abs() < 1e-9);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let lens = lens(150);
        let picture: Vec<f32> = (0..22_500_u64)
            .map(|k| (4.0 * crate::sequence::uniform(7, k)).exp() as f32 * 100.0)
            .collect();
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| evaluate(&picture, &lens, &Settings::default()).unwrap())
        };
        let (one, three) = (run(1), run(3));
        assert_eq!(one.indices, three.indices);
        assert_eq!((one.sources, one.labels), (three.sources, three.labels));
    }

    #[test]
    fn what_cannot_be_rated_is_refused() {
        let lens = lens(100);
        for (value, words) in [(f32::NAN, "column 4 and row 2"), (-1.0, "is -1"), (0.0, "black")] {
            let mut picture = vec![0.0; 10_000];
            picture[103] = value;
            let text = evaluate(&picture, &lens, &Settings::default()).unwrap_err().to_string();
            assert!(text.contains(words), "{text}");
        }
        let task = Settings {
            task: Some(Task {
                x: 100.0,
                y: 3.0,
                angle: 0.4,
            }),
            ..Settings::default()
        };
        let text = evaluate(&vec![1.0; 10_000], &lens, &task).unwrap_err().to_string();
        assert!(text.contains("outside of the picture"), "{text}");
    }
}
