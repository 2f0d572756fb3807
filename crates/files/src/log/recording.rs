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

impl Series {
    /// Series without samples yet.
    pub(crate) fn of(topic: &str, signals: Vec<usize>) -> Self {
        Self {
            topic: topic.into(),
            signals,
            ..Default::default()
        }
    }

    /// Takes in a sample.
    pub(crate) fn push(&mut self, stamp_ns: i64, row: Vec<f64>) {
        self.stamps_ns.push(stamp_ns);
        self.rows.push(row);
    }

    /// Whether the sample before this one has the same stamp.
    pub(crate) fn is_twin(&self, sample: usize) -> bool {
        sample > 0 && self.stamps_ns[sample] == self.stamps_ns[sample - 1]
    }
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
