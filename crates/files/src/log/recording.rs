//! Recording as a reader of one format delivers it: series of samples with their stamps, not yet on
//! one clock.

/// The samples of the signals of one topic (or of a whole CSV) as they were recorded, with their
/// stamps.
#[derive(Debug, Default)]
pub(crate) struct Series {
    pub(crate) topic: String,
    pub(crate) stamps_ns: Vec<i64>,
    /// Which signals, by their place among all signals of the map.
    pub(crate) signals: Vec<usize>,
    /// One row of values per stamp, in the order of `signals`; NaN where a message does not have
    /// the joint.
    pub(crate) rows: Vec<Vec<f64>>,
}

/// What a reader of one format delivers.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    pub(crate) series: Vec<Series>,
    /// Damage to the file, at times in ns where these are known.
    pub(crate) damages: Vec<(Option<i64>, String)>,
    pub(crate) warnings: Vec<String>,
    /// The sample time in s where the user gave it.
    pub(crate) sample_time_s: Option<f64>,
}
