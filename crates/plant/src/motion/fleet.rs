//! Fleet: robots in motion side by side, which move as each does alone and in less time.

use crate::error::PlantError;
use crate::motion::{Acting, Motion};

/// Robots in motion, alike but for their numbers.
pub trait Fleet {
    /// Takes in a robot, or gives it back where it is of another kind or there is no room.
    fn join(&mut self, motion: Box<dyn Motion>) -> Option<Box<dyn Motion>>;

    /// How many robots there are.
    fn n_robots(&self) -> usize;

    /// One of the robots, in the order in which they joined.
    fn motion(&self, robot: usize) -> &dyn Motion;

    /// Moves each robot on as [`Motion::advance`] does. One under `None` is left out, for good.
    fn advance(
        &mut self,
        n_steps: usize,
        step_s: f64,
        acting: &[Option<Acting>],
    ) -> Vec<Result<(), PlantError>>;
}

/// Robots in as few fleets as take them in this order; those of one fleet have the same `pace`.
pub(crate) fn fleets<P: PartialEq>(
    motions: impl IntoIterator<Item = (P, Box<dyn Motion>)>,
) -> Vec<(P, Box<dyn Fleet>)> {
    let mut fleets: Vec<(P, Box<dyn Fleet>)> = Vec::new();
    for (pace, motion) in motions {
        let left = match fleets.last_mut() {
            Some((of_fleet, fleet)) if *of_fleet == pace => fleet.join(motion),
            _ => Some(motion),
        };
        fleets.extend(left.map(|motion| (pace, fleet(motion))));
    }
    fleets
}

fn fleet(motion: Box<dyn Motion>) -> Box<dyn Fleet> {
    motion.fleet().unwrap_or_else(|| Box::new(Alone(motion)))
}

/// A robot that nobody joins.
struct Alone(Box<dyn Motion>);

impl Fleet for Alone {
    fn join(&mut self, motion: Box<dyn Motion>) -> Option<Box<dyn Motion>> {
        Some(motion)
    }

    fn n_robots(&self) -> usize {
        1
    }

    fn motion(&self, _robot: usize) -> &dyn Motion {
        &*self.0
    }

    fn advance(
        &mut self,
        n_steps: usize,
        step_s: f64,
        acting: &[Option<Acting>],
    ) -> Vec<Result<(), PlantError>> {
        let acting = acting.first().copied().flatten();
        vec![acting.map_or(Ok(()), |acting| self.0.advance(n_steps, step_s, acting))]
    }
}
