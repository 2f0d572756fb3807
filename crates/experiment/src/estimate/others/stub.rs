use frfid_estimate::EstimateError;
use frfid_signals::Frf;
use ndarray::Array2;
use num_complex::Complex64;
pub(super) struct Ratio { pub period_samples: f64 }
pub(super) fn find_clock_ratio(_: &[Option<Array2<Complex64>>], _: &[usize], _: f64) -> Result<Option<Ratio>, EstimateError> { Ok(None) }
pub(super) struct Roughness { pub over_noise: f64, pub relative: f64 }
pub(super) fn roughness(_: &Frf) -> Option<Roughness> { None }
