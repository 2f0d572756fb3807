//! Fleet: robots in motion side by side, which move as each does alone and in less time.

use crate::error::PlantError;
use crate::motion::{Acting, Motion};

/// A robot of a fleet that cannot move on, and why.
pub(crate) type Failed = (usize, PlantError);

/// Robots in motion, alike but for their numbers: as many as there are lanes for their kind at most.
pub trait Fleet {
    /// Takes in a robot, or gives it back where it is of another kind or there is no room.
    fn join(&mut self, motion: Box<dyn Motion>) -> Option<Box<dyn Motion>>;

    /// How many robots there are.
    fn n_robots(&self) -> usize;

    /// One of the robots, in the order in which they joined.
    fn motion(&self, robot: usize) -> &dyn Motion;

    /// Moves each robot on as [`Motion::advance`] does; returns those that cannot, and why. One under
    /// `None` is left out, for good.
    fn advance(&mut self, n_steps: usize, step_s: f64, acting: &[Option<Acting>]) -> Vec<Failed>;
}

/// A fleet of robots of the same pace.
pub(crate) struct Squad<P> {
    pub(crate) pace: P,
    pub(crate) fleet: Box<dyn Fleet>,
    /// The places of its robots among all.
    pub(crate) places: Vec<usize>,
}

/// Robots in as few fleets as take them in their order.
pub(crate) fn squads<P: PartialEq>(
    motions: impl IntoIterator<Item = (P, Box<dyn Motion>)>,
) -> Vec<Squad<P>> {
    let mut squads: Vec<Squad<P>> = Vec::new();
    for (place, (pace, motion)) in motions.into_iter().enumerate() {
        let last = squads.iter_mut().rfind(|squad| squad.pace == pace);
        let left = match last {
            Some(squad) => squad.join(place, motion),
            None => Some(motion),
        };
        squads.extend(left.map(|motion| Squad {
            pace,
            fleet: fleet(motion),
            places: vec![place],
        }));
    }
    squads
}

impl<P> Squad<P> {
    fn join(&mut self, place: usize, motion: Box<dyn Motion>) -> Option<Box<dyn Motion>> {
        let left = self.fleet.join(motion);
        if left.is_none() {
            self.places.push(place);
        }
        left
    }
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

    fn advance(&mut self, n_steps: usize, step_s: f64, acting: &[Option<Acting>]) -> Vec<Failed> {
        let acting = acting.first().copied().flatten();
        let moved = acting.map_or(Ok(()), |acting| self.0.advance(n_steps, step_s, acting));
        moved.err().map(|error| (0, error)).into_iter().collect()
    }
}
