//! Look at the signals of a recording: wraps are unwound, signals that are all held alike are taken at
//! their true rate, the rest is told.

use frfid_estimate::{Consequence, Oddity, look, unwrapped};
use frfid_signals::Record;
use ndarray::{Array2, s};

use crate::estimate::others::recording::{Odd, Recording, Role};

/// A signal with its role and the names of its channels.
type Named<'a> = (Role, Option<&'a Array2<f64>>, &'a [String]);

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
    fn signals(&self) -> [Named<'_>; 4] {
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
            if let Some(signal) = signal_of(&mut self.log.record, odd.role) {
                let mut channel = signal.row_mut(odd.channel);
                let straight = unwrapped(channel.view(), turn);
                channel.assign(&straight);
                odd.is_cured = true;
            }
        }
    }

    /// The hold that all inputs and outputs have in common: samples and phase.
    fn held_alike(&self) -> Option<(usize, usize)> {
        let measured = self.odd.iter().filter(|odd| odd.role.is_measured());
        let holds: Vec<(usize, usize)> = measured.filter_map(Odd::hold).collect();
        let first = holds.first()?;
        let n_signals = self.log.record.u.nrows() + self.log.record.y.nrows();
        let are_all = holds.len() == n_signals && holds.iter().all(|hold| hold == first);
        are_all.then_some(*first)
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
        self.log.times_s = times_s.map(|times_s| every_time(&times_s, samples, phase));
        for odd in &mut self.odd {
            odd.is_cured |= odd.is_held();
        }
    }

    /// What may spoil the FRF.
    pub(in crate::estimate::others) fn flagged(&self) -> impl Iterator<Item = &Odd> {
        let odd = self.odd.iter();
        odd.filter(|odd| odd.consequence() == Consequence::Flagged)
    }

    /// The signal that makes the recording useless, and why: the only output, or the only reference
    /// or input, says nothing.
    pub(in crate::estimate::others) fn refusal(&self) -> Option<String> {
        let mut useless = self.odd.iter().filter(|odd| odd.is_useless());
        useless.find(|odd| self.is_alone(odd.role)).map(Odd::words)
    }

    /// Whether there is but one signal of that role, and nothing can be had without it.
    fn is_alone(&self, role: Role) -> bool {
        let record = &self.log.record;
        match role {
            Role::Input => record.r.is_none() && record.u.nrows() == 1,
            Role::Reference => record.u.nrows() == 1,
            Role::Output => record.y.nrows() == 1,
            Role::Position => false,
        }
    }

    /// Whether the same signal says nothing here, too.
    pub(in crate::estimate::others) fn has_as_useless(&self, odd: &Odd) -> bool {
        let same = |other: &&Odd| (other.role, other.channel) == (odd.role, odd.channel);
        self.odd.iter().filter(same).any(Odd::is_useless)
    }
}

/// One of so many times, from `phase` on, which is the new start.
fn every_time(times_s: &[f64], samples: usize, phase: usize) -> Vec<f64> {
    let first_s = times_s.get(phase).copied().unwrap_or(0.0);
    let taken = times_s.iter().skip(phase).step_by(samples);
    taken.map(|time_s| time_s - first_s).collect()
}

/// The signal of a role.
fn signal_of(record: &mut Record, role: Role) -> Option<&mut Array2<f64>> {
    match role {
        Role::Input => Some(&mut record.u),
        Role::Output => Some(&mut record.y),
        Role::Reference => record.r.as_mut(),
        Role::Position => record.position_rad.as_mut(),
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

    /// Whether nothing can be had from it.
    pub(in crate::estimate::others) fn is_useless(&self) -> bool {
        self.consequence() == Consequence::Refused
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

    /// Samples and phase of a hold.
    fn hold(&self) -> Option<(usize, usize)> {
        match self.oddity {
            Oddity::Held {
                samples,
                phase: Some(phase),
            } => Some((samples as usize, phase)),
            _ => None,
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
    /// Whether the FRF is made of it.
    fn is_measured(self) -> bool {
        matches!(self, Self::Input | Self::Output)
    }

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
