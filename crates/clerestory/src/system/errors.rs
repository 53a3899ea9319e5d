//! Standard errors through layers, to first order: what a small change of one cell of one layer does to the system.
//!
//! Errors of different cells, layers and components are taken as independent of each other.

use std::sync::Arc;

use ndarray::Array2;

use super::flux::Flux;
use super::layers::{Layer, Response};
use super::linear;
use crate::basis::Basis;
use crate::bsdf::Model;
use crate::direction::{Scatter, Side};
use crate::error::Result;

/// Variances of a layer's flux shares, (outgoing, incident), by side of incidence and scatter.
#[derive(Debug, Clone, Default)]
pub struct Variances([[Option<Array2<f64>>; 2]; 2]);

impl Variances {
    /// Takes those of a component, if it has any.
    pub fn set(&mut self, side: Side, scatter: Scatter, model: &Model, basis: &Basis) {
        self.0[side as usize][scatter as usize] = of(model, basis);
    }

    fn get(&self, side: Side, scatter: Scatter) -> Option<&Array2<f64>> {
        self.0[side as usize][scatter as usize].as_ref()
    }

    fn any(&self) -> bool {
        self.0.iter().flatten().any(Option::is_some)
    }
}

fn of(model: &Model, basis: &Basis) -> Option<Array2<f64>> {
    match model {
        Model::Matrix(matrix) => {
            let (n, errors) = (basis.len(), matrix.standard_errors()?);
            let areas = basis.projected_solid_angles();
            (errors.len() == n * n)
                .then(|| Array2::from_shape_fn((n, n), |(o, i)| (errors[i * n + o] * areas[o]).powi(2)))
        }
        Model::Sum(sum) => sum.parts().iter().fold(None, |total, (weight, part)| {
            let part = of(part, basis).map(|v| v * (weight * weight));
            match (total, part) {
                (Some(a), Some(b)) => Some(a + b),
                (a, b) => a.or(b),
            }
        }),
        _ => None,
    }
}

/// Standard errors (1/sr, incident patch by incident patch) of the system's transmission and reflection for light from
/// one side; none where no layer has any.
pub(super) fn standard_errors(
    layers: &[Layer],
    responses: [&Response; 2],
    side: Side,
    basis: &Arc<Basis>,
) -> Result<[Option<Vec<f64>>; 2]> {
    if !layers.iter().any(|layer| layer.variances.any()) {
        return Ok([None, None]);
    }
    let (n, count) = (basis.len(), layers.len());
    let (with, against) = (responses[side as usize], responses[side.opposite() as usize]);
    // Layer k and the gap k before it are counted in the order in which the light meets them.
    let layer = |k: usize| {
        if side == Side::Exterior {
            &layers[k]
        } else {
            &layers[count - 1 - k]
        }
    };
    let reflection_before = |gap: usize| &against.behind[count - gap];
    let reflection_after = |gap: usize| &with.behind[gap];
    // What leaves at the far side of light that falls on layer k, and at the near side of light that falls on it from
    // behind.
    let mut to_far = vec![Flux::identity(n)];
    for k in (0..count).rev() {
        to_far.push(to_far[to_far.len() - 1].after(&with.gains[k]));
    }
    to_far.reverse();
    let mut to_near = vec![Flux::identity(n)];
    for k in 0..count {
        to_near.push(to_near[k].after(&against.gains[count - 1 - k]));
    }
    // By scatter, what leaves of light that starts in a gap, with the light or against it.
    let starting = |gap: usize, forward: bool| -> Result<[Array2<f64>; 2]> {
        let (before, after) = (reflection_before(gap), reflection_after(gap));
        let unit = Flux::identity(n);
        let (with, against) = if forward {
            let with = before.after(after).again_and_again(&unit)?;
            let against = after.after(&with);
            (with, against)
        } else {
            let against = after.after(before).again_and_again(&unit)?;
            (before.after(&against), against)
        };
        Ok([to_far[gap].after(&with).matrix(), to_near[gap].after(&against).matrix()])
    };
    let square = |m: Array2<f64>| m.mapv_into(|v| v * v);
    let mut sums = [Array2::zeros((n, n)), Array2::zeros((n, n))];
    for k in 0..count {
        let variances = &layer(k).variances;
        if !variances.any() {
            continue;
        }
        let next = with.onward.get(k + 1).unwrap_or(&with.transmission);
        let front = square(with.onward[k].matrix());
        let back = square(reflection_after(k + 1).after(next).matrix());
        let opposite = side.opposite();
        for (forward, gap, of_front, of_back) in [
            (
                true,
                k + 1,
                (side, Scatter::Transmission),
                (opposite, Scatter::Reflection),
            ),
            (false, k, (side, Scatter::Reflection), (opposite, Scatter::Transmission)),
        ] {
            let emitted = [(of_front, &front), (of_back, &back)]
                .into_iter()
                .filter_map(|((side, scatter), light)| variances.get(side, scatter).map(|v| linear::product(v, light)))
                .reduce(|a, b| a + b);
            if let Some(emitted) = emitted {
                for (sum, response) in sums.iter_mut().zip(starting(gap, forward)?) {
                    *sum += &linear::product(&square(response), &emitted);
                }
            }
        }
    }
    let areas = basis.projected_solid_angles();
    Ok(sums.map(|variance| {
        Some(
            (0..n * n)
                .map(|k| (k / n, k % n))
                .map(|(i, o)| variance[[o, i]].sqrt() / areas[o])
                .collect(),
        )
    }))
}
