//! Look at the signals of a recording: wraps are unwound, signals that are all held alike are taken at
//! their true rate, the rest is told.

use frfid_estimate::{Consequence, Oddity, look, unwrapped};
use ndarray::{Array2, s};

use crate::estimate::others::recording::{Odd, Recording, Role};

impl Recording {
    /// Looks at every signal and mends what can be.
    pub(in crate::estimate::others) fn look(&mut self) {
        self.odd = self.oddities();
        self.unwrap();
        if let Some((samples, phase)) = self.held_alike() {
            self.take_every(samples, phase);
        }
    }

    /// The signals by role, with their names.
    fn signals(&self) -> [(Role, Option<&Array2<f64>>, &[String]); 4] {
        let log = &self.log;
        let record = &log.record;
        [
            (Role::Input, Some(&record.u), &log.input_names),
            (Role::Output, Some(&record.y), &log.output_names),
            (Role::Reference, record.r.as_ref(), &[]),
            (Role::Position, record.position_rad.as_ref(), &[]),
        ]
    }

    fn oddities(&self) -> Vec<Odd> {
        let mut odd = Vec::new();
        for (role, signal, names) in self.signals() {
            let channels = signal.map(|signal| signal.rows().into_iter());
            for (channel, samples) in channels.into_iter().flatten().enumerate() {
                let name = names.get(channel).cloned();
                let signal = name.unwrap_or_else(|| role.name_of(channel));
                let found = look(samples).into_iter().filter(is_news);
                odd.extend(found.map(|oddity| Odd {
                    signal: signal.clone(),
                    channel,
                    role,
                    oddity,
                    is_cured: false,
                }));
            }
        }
        odd
    }

    /// Unwinds every signal that wraps.
    fn unwrap(&mut self) {
        for odd in &mut self.odd {
            let Oddity::Wrapped { turn, .. } = odd.oddity else {
                continue;
            };
            let record = &mut self.log.record;
            let signal = match odd.role {
                Role::Input => Some(&mut record.u),
                Role::Output => Some(&mut record.y),
                Role::Reference => record.r.as_mut(),
                Role::Position => record.position_rad.as_mut(),
            };
            if let Some(signal) = signal {
                let mut channel = signal.row_mut(odd.channel);
                let straight = unwrapped(channel.view(), turn);
                channel.assign(&straight);
                odd.is_cured = true;
            }
        }
    }

    /// The hold that all inputs and outputs have in common: samples and phase.
    fn held_alike(&self) -> Option<(usize, usize)> {
        let hold = |odd: &Odd| match odd.oddity {
            Oddity::Held {
                samples,
                phase: Some(phase),
            } => Some((odd.role, samples as usize, phase)),
            _ => None,
        };
        let mut holds = self.odd.iter().filter_map(hold);
        let measured = |role: Role| matches!(role, Role::Input | Role::Output);
        let (_, samples, phase) = holds.clone().find(|(role, ..)| measured(*role))?;
        let alike = |hold: &(Role, usize, usize)| (hold.1, hold.2) == (samples, phase);
        let n_held = holds.clone().filter(|hold| measured(hold.0) && alike(hold));
        let n_signals = self.log.record.u.nrows() + self.log.record.y.nrows();
        (n_held.count() == n_signals && holds.all(|hold| !measured(hold.0) || alike(&hold)))
            .then_some((samples, phase))
    }

    /// Takes one of so many samples, from `phase` on: those that say something new.
    fn take_every(&mut self, samples: usize, phase: usize) {
        let every = |signal: &Array2<f64>| signal.slice(s![.., phase..;samples]).to_owned();
        let record = &mut self.log.record;
        record.u = every(&record.u);
        record.y = every(&record.y);
        record.r = record.r.as_ref().map(every);
        record.position_rad = record.position_rad.as_ref().map(every);
        record.sample_time_s *= samples as f64;
        let times_s = self.log.times_s.take();
        self.log.times_s = times_s.map(|times_s| {
            let first_s = times_s.get(phase).copied().unwrap_or(0.0);
            let taken = times_s.iter().skip(phase).step_by(samples);
            taken.map(|time_s| time_s - first_s).collect()
        });
        for odd in &mut self.odd {
            odd.is_cured |= odd.is_held();
        }
    }

    /// The signal that makes the recording useless, and why: an output or the reference of a single
    /// channel that says nothing.
    pub(in crate::estimate::others) fn refusal(&self) -> Option<String> {
        let record = &self.log.record;
        let is_alone = |role: Role| match role {
            Role::Input => record.r.is_none() && record.u.nrows() == 1,
            Role::Reference => record.u.nrows() == 1,
            Role::Output => record.y.nrows() == 1,
            Role::Position => false,
        };
        let refused = |odd: &&Odd| odd.consequence() == Consequence::Refused && is_alone(odd.role);
        self.odd.iter().find(refused).map(Odd::words)
    }
}

/// Whether it is not told by the losses of the recording already.
fn is_news(oddity: &Oddity) -> bool {
    !matches!(oddity, Oddity::Lost { share } if *share < 1.0)
}

impl Odd {
    /// What follows for the estimate: a reference or a position that is odd spoils nothing by itself.
    /// A signal that is taken at its true rate is still one that was sampled too slowly to see what
    /// folds back.
    pub(in crate::estimate::others) fn consequence(&self) -> Consequence {
        match (self.oddity.consequence(), self.role) {
            (Consequence::Flagged, Role::Reference | Role::Position) => Consequence::Told,
            (consequence, _) => consequence,
        }
    }

    /// What it does to the FRF.
    pub(in crate::estimate::others) fn meaning(&self) -> String {
        match self.is_held() && self.is_cured {
            true => {
                "every row a new sample; the new ones alone are taken, and what lies above half of \
                     their rate folds back unseen"
                    .into()
            }
            false => format!("a sound signal: {}", self.oddity.meaning()),
        }
    }

    fn is_held(&self) -> bool {
        matches!(self.oddity, Oddity::Held { .. })
    }

    /// The signal and what is odd about it.
    pub(in crate::estimate::others) fn words(&self) -> String {
        format!("{} {}", self.signal, self.oddity.found())
    }
}

impl Role {
    /// What a channel without a name of its own is called.
    pub(in crate::estimate::others) fn name_of(self, channel: usize) -> String {
        let role = match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Reference => "reference",
            Self::Position => "position",
        };
        format!("{role} {}", channel + 1)
    }
}
