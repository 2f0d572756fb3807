"""Plants side by side: each moves as it does alone, whatever is beside it, on however many threads."""

import os
import pathlib
import subprocess
import sys

import frfid
import numpy as np
import pytest

ROBOTS = pathlib.Path(__file__).parents[2] / "examples" / "robots"
T = 1e-3
PI = frfid.PiController(gain=600.0, integral_gain=4800.0, sample_time_s=T)


def plants(n=21, ripple=3.0):
    """Joints of other frictions, stiffnesses and springs: most stick now and then, one in three does not."""
    draw = np.random.default_rng(1)
    return [
        frfid.Plant.single_joint(
            coulomb_nm=[0.0, 20.0, 60.0][k % 3],
            stiffness_nm_per_rad=draw.uniform(1e5, 3e5),
            stiffness_beyond_nm_per_rad=3e5 if k % 2 else None,
            link_inertia_kg_m2=draw.uniform(50, 200),
            ripple=[{"cycles_per_turn": 12.0, "amplitude_nm": ripple}] * (k % 3 if ripple else 0),
        )
        for k in range(n)
    ]


def torques(n=21):
    draw = np.random.default_rng(2)
    return 40.0 * np.cumsum(draw.standard_normal((n, 1, 700)), -1) / np.sqrt(np.arange(1, 701))


def assert_alike(batch, alone):
    for name in ("u", "y", "position_rad"):
        assert np.array_equal(getattr(batch, name), np.stack([getattr(one, name) for one in alone])), name


@pytest.mark.parametrize("hold", ["zoh", "linear"])
def test_plants_of_their_own_in_open_loop(hold):
    u = torques()
    batch = frfid.simulate(plants(), u, sample_time_s=T, hold=hold)
    assert_alike(batch, [plant.simulate(each, sample_time_s=T, hold=hold) for plant, each in zip(plants(), u, strict=True)])


def test_one_torque_for_all_plants():
    u = torques(1)[0]
    assert_alike(frfid.simulate(plants(), u, sample_time_s=T), [plant.simulate(u, sample_time_s=T) for plant in plants()])


def test_plants_of_their_own_in_closed_loop():
    r = 1e-3 * torques()
    batch = frfid.run_closed_loop(plants(), PI, r)
    assert_alike(batch, [frfid.run_closed_loop(plant, PI, each) for plant, each in zip(plants(), r, strict=True)])


@pytest.mark.parametrize("hold", ["zoh", "linear"])
def test_exact_steps_alone_side_by_side_and_beside_rk4(hold):
    u, joints, options = torques(), plants(ripple=0), dict(sample_time_s=T, hold=hold)
    batch = frfid.simulate(joints, u, integrator="exact", **options)
    assert_alike(batch, [plant.simulate(each, integrator="exact", **options) for plant, each in zip(joints, u, strict=True)])
    by_rk4 = frfid.simulate(joints, u, **options)
    np.testing.assert_allclose(batch.y, by_rk4.y, rtol=0, atol=1e-7 * np.abs(by_rk4.y).max())
    assert not np.array_equal(batch.y, by_rk4.y)
    assert np.array_equal(by_rk4.y, frfid.simulate(joints, u, integrator="rk4", **options).y)


def test_exact_steps_in_closed_loop():
    r, joints = 1e-3 * torques(), plants(ripple=0)
    batch = frfid.run_closed_loop(joints, PI, r, integrator="exact")
    assert_alike(batch, [frfid.run_closed_loop(plant, PI, each, integrator="exact") for plant, each in zip(joints, r, strict=True)])
    by_rk4 = frfid.run_closed_loop(joints, PI, r)
    np.testing.assert_allclose(batch.y, by_rk4.y, rtol=0, atol=1e-7 * np.abs(by_rk4.y).max())


def test_exact_steps_are_refused_where_nothing_is_piecewise_linear():
    arm = frfid.Plant.load(ROBOTS / "manutec_r3.toml")
    for plant in (arm, plants()[1]):
        with pytest.raises(ValueError, match="single joint without torque ripple.*integrator = \"rk4\""):
            plant.simulate(np.zeros((len(plant.joint_names), 10)), sample_time_s=T, integrator="exact")
    with pytest.raises(ValueError, match="integrator: unknown variant `euler`"):
        plants()[0].simulate(np.zeros((1, 10)), sample_time_s=T, integrator="euler")


def test_an_arm_in_other_poses_and_with_a_joint_of_one_axis_beside_it():
    poses = ([0.0, 0.3, -0.5], [0.2, -0.1, 0.4])
    ideal = {"sensing": False}
    arms = [frfid.Plant.load(ROBOTS / "manutec_r3.toml", pose_rad=pose, challenges=ideal) for pose in poses]
    u = np.zeros((3, 50))
    assert_alike(frfid.simulate(arms, u, sample_time_s=T), [arm.simulate(u, sample_time_s=T) for arm in arms])
    with pytest.raises(ValueError, match=r"plants have \[3, 1\] axes"):
        frfid.simulate([arms[0], frfid.Plant.single_joint()], u, sample_time_s=T)


def test_what_does_not_fit_is_refused():
    for wrong, error, words in [
        ([], ValueError, "one plant at least"),
        ([1, 2], TypeError, "needed a Plant, or a list"),
        (plants(3), ValueError, "u has a batch of 21, needed one for each of 3 plants"),
        (plants(1), ValueError, "u has a batch of 21, needed one for each of 1 plants"),
    ]:
        with pytest.raises(error, match=words):
            frfid.simulate(wrong, torques(), sample_time_s=T)


THREADS = """
import hashlib, sys
sys.path.insert(0, {folder!r})
import frfid, test_plants_side_by_side as bench
print(hashlib.sha256(frfid.simulate(bench.plants(40), bench.torques(40), sample_time_s=1e-3).y.tobytes()).hexdigest())
"""


def test_threads_change_no_digit():
    script = THREADS.format(folder=str(pathlib.Path(__file__).parent))
    said = {
        subprocess.run(
            [sys.executable, "-c", script], env={**os.environ, "RAYON_NUM_THREADS": n}, capture_output=True, text=True, check=True
        ).stdout
        for n in "123"
    }
    assert len(said) == 1
