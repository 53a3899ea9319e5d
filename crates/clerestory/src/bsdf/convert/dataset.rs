//! Conversion of whole data sets, component by component.

use std::sync::Arc;

use super::{Sampling, to_matrix, to_tree};
use crate::basis::Basis;
use crate::bsdf::tree::Grid;
use crate::bsdf::{Bsdf, Model, Rank};
use crate::direction::{Scatter, Side};
use crate::error::Result;
use crate::progress::Progress;

/// What the conversion of one component did.
#[derive(Debug, Clone)]
pub struct Report {
    /// Name of the band.
    pub band: String,
    /// Side of incidence.
    pub side: Side,
    /// Transmission or reflection.
    pub scatter: Scatter,
    /// Kind of the source's model.
    pub source: &'static str,
    /// Samples a cell; 0 where the result is exact.
    pub samples: u32,
    /// Error of the values, RMS over the mean: for matrices the estimated sampling error, for trees the difference to the
    /// source; none where that has ideal beams.
    pub rms_error: Option<f64>,
    /// Largest difference of direct-hemispherical values to the source.
    pub worst_direct_hemispherical: f64,
}

/// Every component of a data set as a matrix.
pub fn all_to_matrix(
    bsdf: &Bsdf,
    incident: &Arc<Basis>,
    outgoing: &Arc<Basis>,
    sampling: Sampling,
    progress: &Progress,
) -> Result<(Bsdf, Vec<Report>)> {
    let mut reports = Vec::new();
    let result = bsdf.try_map(|band, side, scatter, model| {
        let conversion = to_matrix(model, incident, outgoing, sampling, progress)?;
        reports.push(Report {
            band: band.to_owned(),
            side,
            scatter,
            source: model.kind(),
            samples: conversion.samples,
            rms_error: Some(conversion.rms_error),
            worst_direct_hemispherical: conversion.worst_direct_hemispherical,
        });
        Ok(Model::Matrix(conversion.matrix))
    })?;
    Ok((result, reports))
}

/// Every component of a data set as a tensor tree.
pub fn all_to_tree(
    bsdf: &Bsdf,
    rank: Rank,
    grid: Grid,
    reduction: Option<f64>,
    progress: &Progress,
) -> Result<(Bsdf, Vec<Report>)> {
    let mut reports = Vec::new();
    let result = bsdf.try_map(|band, side, scatter, model| {
        let conversion = to_tree(model, rank, grid, reduction, progress)?;
        reports.push(Report {
            band: band.to_owned(),
            side,
            scatter,
            source: model.kind(),
            samples: grid.samples,
            rms_error: conversion.rms_error,
            worst_direct_hemispherical: conversion.worst_direct_hemispherical,
        });
        Ok(Model::Tree(conversion.tree))
    })?;
    Ok((result, reports))
}
