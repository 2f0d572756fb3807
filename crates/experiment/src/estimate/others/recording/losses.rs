//! Losses of a recording in words: one by one where they are few, summed up where they are many.

use frfid_files::Loss;
use frfid_signals::format::{count, significant};

use crate::estimate::others::recording::Recording;

/// So many losses of one signal are named one by one.
const NAMED: usize = 4;

impl Recording {
    /// What of it is lost.
    pub(in crate::estimate::others) fn lost(&self) -> Vec<String> {
        let mut words = Vec::new();
        for of_topic in self.log.losses.chunk_by(|a, b| a.topic == b.topic) {
            let n_gaps = of_topic
                .iter()
                .filter(|loss| loss.to_s > loss.from_s)
                .count();
            if n_gaps <= NAMED {
                words.extend(of_topic.iter().map(Loss::to_string));
            } else {
                let is_of_file = |loss: &&Loss| loss.to_s == loss.from_s;
                words.extend(of_topic.iter().filter(is_of_file).map(Loss::to_string));
                words.push(self.summed_up(of_topic, n_gaps));
            }
        }
        let named = words
            .into_iter()
            .map(|loss| format!("{}: {loss}", self.name));
        named.collect()
    }

    /// Many gaps of one signal as one.
    fn summed_up(&self, losses: &[Loss], n_gaps: usize) -> String {
        let record = &self.log.record;
        let samples = |loss: &Loss| ((loss.to_s - loss.from_s) / record.sample_time_s).round();
        let lost: f64 = losses.iter().map(samples).sum();
        let longest = losses
            .iter()
            .max_by(|a, b| samples(a).total_cmp(&samples(b)));
        let longest = longest.map_or(0.0, samples);
        format!(
            "{}: {lost} of {} samples ({} %) are missing in {}, the longest of {longest}: least squares go without them",
            losses[0].topic,
            record.n_samples(),
            significant(100.0 * lost / record.n_samples() as f64, 2),
            count(n_gaps, "gap"),
        )
    }
}
