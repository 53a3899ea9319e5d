//! Measurements of samples by the virtual goniophotometer.

use std::sync::Mutex;

use clerestory::Error;
use clerestory::bsdf::{Estimate, Rank};
use clerestory::progress::Progress;
use clerestory::trace::{Cones, Goniophotometer, Measured, RaySource, Settings, State, Stop, Tallies, TreeTarget};
use numpy::{PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;

use crate::arrays::{directions, rows, side};
use crate::basis::PyBasis;
use crate::bsdf::PyBsdf;
use crate::errors::{ClerestoryError, raise};
use crate::jobs::{Report, watched_by};
use crate::npz::{GivenArray, TakenArray, given, taken};
use crate::trace::PySample;

/// How to measure.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SettingsSpec {
    sides: Vec<String>,
    error: Option<f64>,
    most: u64,
    replications: u32,
    seed: u64,
    source_cone: f64,
    detector_cone: f64,
    beams: bool,
    reciprocal: bool,
    threads: usize,
}

impl SettingsSpec {
    fn instrument(&self) -> PyResult<Goniophotometer> {
        let most = self.most;
        Ok(Goniophotometer {
            settings: Settings {
                sides: self.sides.iter().map(|s| side(s)).collect::<PyResult<_>>()?,
                stop: self
                    .error
                    .map_or(Stop::Paths(most), |error| Stop::Error { error, most }),
                replications: self.replications,
                seed: self.seed,
                cones: Cones {
                    source: self.source_cone,
                    detector: self.detector_cone,
                },
                beams: self.beams,
                reciprocal: self.reciprocal,
                ..Settings::default()
            },
        })
    }

    /// Runs work on as many threads as are asked for; Ctrl-C stops it.
    fn run<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        work: impl FnOnce(&Progress) -> clerestory::Result<T> + Send,
    ) -> PyResult<T> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()
            .map_err(|e| ClerestoryError::new_err(format!("{} threads cannot be started ({e})", self.threads)))?;
        watched_by(py, progress.map(Report::WithError), |watch| {
            pool.install(|| work(watch))
        })
    }
}

/// What is finished of a measurement.
#[pyclass(name = "TraceState", frozen, module = "clerestory")]
pub struct PyTraceState(Mutex<State>);

impl PyTraceState {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

#[pymethods]
impl PyTraceState {
    /// Nothing is done yet; the fingerprint stands for all that the result depends on.
    #[new]
    fn new(fingerprint: &str) -> Self {
        Self(Mutex::new(State::new(fingerprint)))
    }

    /// From arrays that were kept under the fingerprint `kept`; refused where that is another one.
    #[staticmethod]
    fn from_arrays(fingerprint: &str, kept: &str, arrays: Vec<(String, GivenArray<'_>)>) -> PyResult<Self> {
        State::from_arrays(fingerprint, kept, &given(arrays))
            .map(|state| Self(Mutex::new(state)))
            .map_err(raise)
    }

    fn to_arrays<'py>(&self, py: Python<'py>) -> Vec<(String, TakenArray<'py>)> {
        taken(py, self.lock().to_arrays())
    }

    /// Finished parts, and all parts; (0, 0) before the measurement began.
    fn done(&self) -> (usize, usize) {
        self.lock().done()
    }
}

/// Value and standard error.
type Pair = (f64, f64);

fn pair(estimate: Estimate) -> Pair {
    (estimate.value, estimate.standard_error.unwrap_or(f64::NAN))
}

/// Band, side, scatter, values by incident patch, hemispherical value.
type TotalsRow = (String, &'static str, &'static str, Vec<Pair>, Option<Pair>);

/// Data set, tallies by band, direct-hemispherical values, largest relative error, paths.
type MeasuredParts = (PyBsdf, Vec<Tallies>, Vec<TotalsRow>, f64, u64);

fn parts(measured: Measured) -> MeasuredParts {
    let totals = measured.totals.into_iter().map(|t| {
        let values = t.values.into_iter().map(pair).collect();
        (
            t.band,
            t.side.name(),
            t.scatter.name(),
            values,
            t.hemispherical.map(pair),
        )
    });
    let totals = totals.collect();
    (
        PyBsdf(measured.bsdf),
        measured.balance,
        totals,
        measured.error,
        measured.paths,
    )
}

/// Band, number of the direction, side, scatter, values of the outgoing patches, beam, direct-hemispherical value.
type ScanRow = (String, usize, &'static str, &'static str, Vec<Pair>, Pair, Pair);

#[pymethods]
impl PySample {
    /// Matrices on a pair of bases.
    fn matrices(
        &self,
        py: Python<'_>,
        settings: SettingsSpec,
        incident: &PyBasis,
        outgoing: &PyBasis,
        state: &Bound<'_, PyTraceState>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<MeasuredParts> {
        let instrument = settings.instrument()?;
        let state = state.get();
        let measured = settings.run(py, progress.as_ref(), |watch| {
            instrument.matrices(&self.0, &incident.0, &outgoing.0, &mut state.lock(), watch)
        })?;
        Ok(parts(measured))
    }

    /// Tensor trees of 2^levels cells an axis, of rank 3 for a sample that scatters alike from all azimuths.
    fn trees(
        &self,
        py: Python<'_>,
        settings: SettingsSpec,
        isotropic: bool,
        levels: u32,
        state: &Bound<'_, PyTraceState>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<MeasuredParts> {
        let rank = if isotropic { Rank::Isotropic } else { Rank::Anisotropic };
        let (instrument, target) = (settings.instrument()?, TreeTarget::new(rank, levels));
        let state = state.get();
        let measured = settings.run(py, progress.as_ref(), |watch| {
            instrument.trees(&self.0, &target, &mut state.lock(), watch)
        })?;
        Ok(parts(measured))
    }

    /// Light from listed directions (n, 3), which point to the source. Distributions, tallies by band, warnings.
    fn scan(
        &self,
        py: Python<'_>,
        settings: SettingsSpec,
        incident: PyReadonlyArray2<'_, f64>,
        outgoing: &PyBasis,
        state: &Bound<'_, PyTraceState>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Vec<ScanRow>, Vec<Tallies>, Vec<String>)> {
        let instrument = settings.instrument()?;
        let incident = directions(&incident, "incident")?;
        let state = state.get();
        let scan = settings.run(py, progress.as_ref(), |watch| {
            instrument.scan(&self.0, &incident, &outgoing.0, &mut state.lock(), watch)
        })?;
        let rows = scan.distributions.into_iter().map(|d| {
            let values = d.values.into_iter().map(pair).collect();
            let (side, scatter) = (d.side.name(), d.scatter.name());
            (d.band, d.direction, side, scatter, values, pair(d.beam), pair(d.total))
        });
        Ok((rows.collect(), scan.balance, scan.warnings))
    }

    /// Follows paths from a direction (1, 3), or of diffuse light from a side where none is given, and hands those that
    /// leave to `write`: positions (n, 3) in metres, directions (n, 3), flux (n, bands) as a share of all, reflected (n).
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of the Python API")]
    fn rays(
        &self,
        py: Python<'_>,
        settings: SettingsSpec,
        incident: Option<PyReadonlyArray2<'_, f64>>,
        side_name: &str,
        paths: u32,
        write: Py<PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Vec<Tallies>> {
        let instrument = settings.instrument()?;
        let listed = incident.map(|i| directions(&i, "incident")).transpose()?;
        let source = match listed.as_deref() {
            Some([direction]) => RaySource::Direction(*direction),
            Some(_) => return Err(ClerestoryError::new_err("rays come from one direction (give one)")),
            None => RaySource::Diffuse(side(side_name)?),
        };
        let bands = self.0.bands.len();
        let failed = Mutex::new(None);
        let outcome = settings.run(py, progress.as_ref(), |watch| {
            let mut take = |found: &clerestory::trace::Rays| {
                Python::attach(|py| -> PyResult<()> {
                    let positions = rows(py, found.positions.clone(), 3)?;
                    let ways = rows(py, found.directions.clone(), 3)?;
                    let flux = rows(py, found.flux.clone(), bands)?;
                    write.call1(py, (positions, ways, flux, found.reflected.to_pyarray(py)))?;
                    Ok(())
                })
                .map_err(|error| {
                    let text = error.to_string();
                    *failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(error);
                    Error::Io(text)
                })
            };
            instrument.rays(&self.0, source, paths, &mut take, watch)
        });
        // What Python raised is raised again as it was.
        match failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
            Some(error) => Err(error),
            None => outcome,
        }
    }
}
