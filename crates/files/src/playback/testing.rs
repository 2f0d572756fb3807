//! Playbacks for tests.

use std::sync::Arc;

use frfid_signals::{Motion, Playback, Played, RunId};
use ndarray::Array2;

use crate::playback::PlaybackFile;

/// Two joints, the second with a name that needs quotes, at 500 Hz.
pub(crate) fn file(playbacks: Vec<Arc<Playback>>) -> PlaybackFile {
    PlaybackFile {
        name: "p000-m0-q0".into(),
        joint_names: vec!["a".into(), "b,\"2\"".into()],
        plan_id: 0xdead_beef,
        signal_units: vec!["N m".into(); 2],
        pose_rad: vec![0.25, -0.5],
        playbacks,
        form: Default::default(),
    }
}

fn signal(n: usize, scale: f64) -> Array2<f64> {
    Array2::from_shape_fn((2, n), |(row, k)| {
        scale * (0.7 + row as f64 + k as f64).sin() / 3.0
    })
}

fn playback(n: usize, played: Played) -> Arc<Playback> {
    Arc::new(Playback {
        id: RunId::excitation(0, 0, 0),
        sample_time_s: 0.002,
        first_sample: 0,
        run_samples: n,
        played,
    })
}

pub(crate) fn motion(n: usize) -> Arc<Playback> {
    let [
        position_rad,
        velocity_rad_s,
        acceleration_rad_s2,
        jerk_rad_s3,
    ] = [1.0, 1e-3, 10.0, 1e3].map(|scale| signal(n, scale));
    playback(
        n,
        Played::Motion(Motion {
            position_rad,
            velocity_rad_s,
            acceleration_rad_s2,
            jerk_rad_s3,
        }),
    )
}

pub(crate) fn torque(n: usize) -> Arc<Playback> {
    playback(n, Played::Torque(signal(n, 5.0)))
}

/// A motion that stays where it is.
pub(crate) fn resting(n: usize) -> Arc<Playback> {
    let mut resting = Arc::unwrap_or_clone(motion(n));
    let zeros = || Array2::zeros((2, n));
    resting.played = Played::Motion(Motion {
        position_rad: zeros(),
        velocity_rad_s: zeros(),
        acceleration_rad_s2: zeros(),
        jerk_rad_s3: zeros(),
    });
    resting.into()
}
