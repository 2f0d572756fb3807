//! Blend of rests, moves and ramps with the oscillation of a run: one closed expression for every
//! sample, so that position, velocity, acceleration and jerk belong to each other.

use std::ops::Range;

use ndarray::Array2;

use crate::limit::Limit;
use crate::plan::Plan;
use crate::plan::ramp::{MOST_BENT, MOST_JERKED, Ramp, STEEPEST};
use crate::plan::run::Run;
use crate::playback::oscillation::{LONGEST_RAMP_S, Oscillation};
use crate::playback::{Motion, Player};

/// Shortest ramp in s.
const SHORTEST_RAMP_S: f64 = 0.5;
/// From one ramp that is tried to the next.
const LONGER: f64 = 1.2;
/// Share of a limit that a move takes.
const EASY: f64 = 0.5;
/// Velocity of a move against the largest of the run.
const MOVE_VELOCITY: f64 = 2.0;

/// Where a run is blended in, in samples of the player; times count from the run's first sample.
pub(super) struct Blend<'a> {
    oscillation: &'a Oscillation,
    pose_rad: &'a [f64],
    /// Where the run starts, in rad from the pose.
    start_rad: &'a [f64],
    velocity_rad_s: &'a [f64],
    n_rest: usize,
    n_move: usize,
    n_ramp: usize,
}

impl<'a> Blend<'a> {
    pub(super) fn of(
        plan: &Plan,
        run: &'a Run,
        player: &'a Player,
        oscillation: &'a Oscillation,
    ) -> Self {
        let mut blend = Self {
            oscillation,
            pose_rad: &player.pose_rad,
            start_rad: &run.start_rad,
            velocity_rad_s: &run.velocity_rad_s,
            n_rest: (player.rest_s * player.rate_hz).ceil() as usize,
            n_move: 0,
            n_ramp: 0,
        };
        let mut ramp_s = SHORTEST_RAMP_S;
        loop {
            blend.n_ramp = (ramp_s * player.rate_hz).ceil() as usize;
            if ramp_s >= LONGEST_RAMP_S / LONGER || blend.ramps_keep(plan, player) {
                break;
            }
            ramp_s *= LONGER;
        }
        blend.n_move = (blend.move_s(player) * player.rate_hz).ceil() as usize;
        blend
    }

    pub(super) fn first_sample(&self) -> usize {
        self.n_rest + self.n_move + self.n_ramp
    }

    fn n_samples(&self) -> usize {
        2 * self.first_sample() + self.oscillation.n_run + 1
    }

    /// The whole motion.
    pub(super) fn motion(&self) -> Motion {
        let shape = (self.pose_rad.len(), self.n_samples());
        let mut orders: [Array2<f64>; 4] = std::array::from_fn(|_| Array2::zeros(shape));
        for channel in 0..shape.0 {
            for k in 0..shape.1 {
                let state = self.state(channel, k as isize - self.first_sample() as isize);
                for (order, value) in orders.iter_mut().zip(state) {
                    order[[channel, k]] = value;
                }
            }
        }
        let [
            position_rad,
            velocity_rad_s,
            acceleration_rad_s2,
            jerk_rad_s3,
        ] = orders;
        Motion {
            position_rad,
            velocity_rad_s,
            acceleration_rad_s2,
            jerk_rad_s3,
        }
    }

    /// The whole torque.
    pub(super) fn torque(&self) -> Array2<f64> {
        let shape = (self.pose_rad.len(), self.n_samples());
        Array2::from_shape_fn(shape, |(channel, k)| self.torque_at(channel, k))
    }

    fn torque_at(&self, channel: usize, sample: usize) -> f64 {
        let k = sample as isize - self.first_sample() as isize;
        self.weight(k)[0] * self.oscillating(channel, k)[1]
    }

    /// Position, velocity, acceleration and jerk `k` samples after the run's first.
    fn state(&self, channel: usize, k: isize) -> [f64; 4] {
        let w = self.weight(k);
        let q = self.oscillating(channel, k);
        let v = self.velocity_rad_s[channel];
        let [way, fast, bent, jerked] = self.moved(channel, k);
        [
            self.pose_rad[channel] + way + v * self.weighed_s(k) + w[0] * q[0],
            fast + v * w[0] + w[0] * q[1] + w[1] * q[0],
            bent + v * w[1] + w[0] * q[2] + 2.0 * w[1] * q[1] + w[2] * q[0],
            jerked + v * w[2] + w[0] * q[3] + 3.0 * (w[1] * q[2] + w[2] * q[1]) + w[3] * q[0],
        ]
    }

    /// The weight of the run and its derivatives.
    fn weight(&self, k: isize) -> [f64; 4] {
        let [begin, end] = self.ramps(k).map(|(ramp, time_s)| ramp.at(time_s));
        std::array::from_fn(|order| begin[order] - end[order])
    }

    /// Integral of the weight in s.
    fn weighed_s(&self, k: isize) -> f64 {
        let [begin, end] = self.ramps(k).map(|(ramp, time_s)| ramp.integral(time_s));
        begin - end
    }

    /// The ramps before and after the run, each with the time since it began.
    fn ramps(&self, k: isize) -> [(Ramp, f64); 2] {
        let duration_s = self.time_s(self.n_ramp as isize);
        let begins = [-(self.n_ramp as isize), self.n_run()];
        begins.map(|begin| (Ramp { duration_s }, self.time_s(k - begin)))
    }

    fn n_run(&self) -> isize {
        self.oscillation.n_run as isize
    }

    /// The moves from the pose and back to it.
    fn moved(&self, channel: usize, k: isize) -> [f64; 4] {
        let duration_s = self.time_s(self.n_move as isize);
        let reach = (self.n_ramp + self.n_move) as isize;
        let begins = [-reach, self.n_run() + self.n_ramp as isize];
        let [there, back] = begins.map(|begin| Ramp { duration_s }.at(self.time_s(k - begin)));
        let ways = self.ways_rad(channel);
        std::array::from_fn(|order| ways[0] * there[order] + ways[1] * back[order])
    }

    /// Ways in rad from the pose to where the ramp begins, and from where it ends to the pose.
    fn ways_rad(&self, channel: usize) -> [f64; 2] {
        let velocity = self.velocity_rad_s[channel];
        let ramp_s = self.time_s(self.n_ramp as isize);
        let run_s = self.time_s(self.n_run());
        let there = self.start_rad[channel] - 0.5 * velocity * ramp_s;
        [there, -(there + velocity * (run_s + ramp_s))]
    }

    fn time_s(&self, samples: isize) -> f64 {
        samples as f64 * self.oscillation.step_s
    }

    /// The oscillation, 0 where its weight is.
    fn oscillating(&self, channel: usize, k: isize) -> [f64; 4] {
        let place = k + self.oscillation.n_ramp as isize;
        let at = |order: usize| {
            let values = &self.oscillation.orders[order];
            usize::try_from(place)
                .ok()
                .and_then(|place| values.get([channel, place]))
        };
        std::array::from_fn(|order| at(order).copied().unwrap_or(0.0))
    }

    /// Whether both ramps keep the limits of derivatives.
    fn ramps_keep(&self, plan: &Plan, player: &Player) -> bool {
        let n_run = self.n_run();
        let n_ramp = self.n_ramp as isize;
        let bounds = match plan.injection {
            crate::Injection::Velocity => [Limit::Velocity, Limit::Acceleration, Limit::Jerk],
            crate::Injection::Torque => return true,
        };
        [-n_ramp..0, n_run..n_run + n_ramp]
            .into_iter()
            .all(|samples| {
                (0..self.pose_rad.len()).all(|channel| {
                    let largest = self.largest(channel, samples.clone());
                    let pairs = bounds.iter().zip(&largest[1..]);
                    let mut pairs = pairs.map(|(&limit, &found)| (limit, found));
                    pairs.all(|(limit, found)| {
                        !limit.is_exceeded(found, player.limits.of(limit, channel))
                    })
                })
            })
    }

    /// Largest position, velocity, acceleration and jerk of a part.
    fn largest(&self, channel: usize, samples: Range<isize>) -> [f64; 4] {
        let states = samples.map(|k| self.state(channel, k));
        states.fold([0.0; 4], larger)
    }

    /// Duration of the moves in s: at half the limits, at most twice as fast as the run.
    fn move_s(&self, player: &Player) -> f64 {
        let n_run = self.n_run();
        let durations = (0..self.pose_rad.len()).map(|channel| {
            let way = self
                .ways_rad(channel)
                .map(f64::abs)
                .into_iter()
                .fold(0.0, f64::max);
            let fast = MOVE_VELOCITY * self.largest(channel, 0..n_run)[1];
            let limit = |limit: Limit| EASY * player.limits.of(limit, channel);
            let by_velocity = STEEPEST * way / fast.min(limit(Limit::Velocity));
            let by_acceleration = (MOST_BENT * way / limit(Limit::Acceleration)).sqrt();
            let by_jerk = (MOST_JERKED * way / limit(Limit::Jerk)).cbrt();
            if way > 0.0 {
                by_velocity.max(by_acceleration).max(by_jerk)
            } else {
                0.0
            }
        });
        durations.fold(0.0, f64::max)
    }
}

/// The larger of each size and that of a state.
fn larger(sizes: [f64; 4], state: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|order| f64::max(sizes[order], state[order].abs()))
}
