"""A look at every signal: what is odd is cured and said, fails a check, or is refused."""

import numpy as np
import pytest
from joint import MAP, POSITION, SAMPLE_TIME_S, Multisine, estimate, instants, joint, noise, position, steady, write_csv


def write(path, t, torque, speed):
    write_csv(path, t=t, torque=torque, speed=speed)


@pytest.mark.parametrize("slope", [0.02, 0.5, -8.0])
def test_a_position_that_drifts(tmp_path, slope):
    t, torque, angle = steady(1, 5, frf=position)
    write_csv(tmp_path / "a.csv", t=t, torque=torque, angle=angle + slope * t)
    outcome = estimate(tmp_path, ["a.csv"], *POSITION)
    assert outcome.error(position).max() < 2e-2 and outcome.inside(position) > 0.85
    assert outcome.said("drift") or slope < 0.1


@pytest.mark.parametrize(("turn", "unit"), [(2 * np.pi, "rad"), (1.0, "turn"), (360.0, "deg")])
def test_an_encoder_that_wraps(tmp_path, turn, unit):
    t, torque, angle = steady(2, 5, frf=position)
    turns = (angle + 2.5 * t) / (2 * np.pi)
    write_csv(tmp_path / "a.csv", t=t, torque=torque, angle=turn * np.mod(turns, 1.0))
    outcome = estimate(tmp_path, ["a.csv"], "--u", "torque=N m", "--y", f"angle={unit}", "--time", "t=s")
    assert outcome.error(position).max() < 5e-2 and outcome.said("wrap")


def test_a_creeping_offset_that_dies_out(tmp_path):
    t, torque, speed = steady(3, 8)
    write(tmp_path / "a.csv", t, torque, speed + 2 * speed.std() * np.exp(-t / 6.0))
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.error().max() < 2e-2 and outcome.inside() > 0.85


def test_the_same_ramp_in_every_period(tmp_path):
    # a sawtooth of the period itself cannot be told from a response; on the excited lines it is one
    t, torque, speed = steady(3, 6, level=2e-3)
    ramp = 0.3 * speed.std() * t / 2.4
    write(tmp_path / "a.csv", t, torque, speed + ramp)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.inside() > 0.85 and outcome.said("drift")


def test_a_speed_that_never_changes_is_refused(tmp_path):
    t, torque, speed = steady(1, 5)
    for value in (0.0, 0.31, -1e6):
        write(tmp_path / "a.csv", t, torque, np.full(len(t), value))
        outcome = estimate(tmp_path, ["a.csv"], *MAP)
        assert outcome.result is None and outcome.said("speed", "does not change")
    write(tmp_path / "a.csv", t, 0 * t, speed)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.result is None and outcome.said("torque", "does not change")


@pytest.mark.parametrize(("step", "coarse"), [(3.0, True), (1.5, True), (1e-2, False), (1e-4, False)])
def test_an_encoder_s_steps(tmp_path, step, coarse):
    t, torque, speed = steady(1, 5)
    step *= speed.std()
    write(tmp_path / "a.csv", t, torque, step * np.round(speed / step))
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    if coarse:
        assert outcome.code in (1, 3) and outcome.said("speed", "step")
    else:
        assert outcome.code == 0 and np.median(outcome.error()) < 1e-2


@pytest.mark.parametrize("share", [1.2, 1.6])
def test_a_torque_that_saturates(tmp_path, share):
    t = instants(5)
    torque = Multisine.draw(1)
    wanted = torque.at(t)
    limit = share * wanted.std()
    delivered = np.clip(wanted, -limit, limit)
    spectrum = np.fft.rfft(delivered)
    hz = np.fft.rfftfreq(len(t), SAMPLE_TIME_S)
    spectrum[1:] *= joint(hz[1:])
    speed = np.fft.irfft(spectrum, len(t)) + noise(1, len(t), 1e-3)
    write_csv(tmp_path / "a.csv", t=t, torque=delivered, wanted=wanted, speed=speed)
    measured = estimate(tmp_path, ["a.csv"], *MAP, "--r", "wanted=N m")
    assert np.median(measured.error()) < 5e-3 and measured.code == 3 and measured.said("torque", "saturat")


@pytest.mark.parametrize("hold", [2, 4])
def test_a_speed_that_is_held(tmp_path, hold):
    t, torque, speed = steady(1, 5)
    held = np.repeat(speed[::hold], hold)[: len(speed)]
    write(tmp_path / "a.csv", t, torque, held)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.code == 3 and outcome.said("speed", "held", str(hold))
    # where all are held alike, the rows that say something new are the recording
    write(tmp_path / "b.csv", t, np.repeat(torque[::hold], hold)[: len(t)], held)
    outcome = estimate(tmp_path, ["b.csv"], *MAP)
    assert outcome.result is None or np.median(outcome.error()) < 5e-3


def test_spikes(tmp_path):
    t, torque, speed = steady(1, 6)
    spiky = speed.copy()
    spiky[[1234, 4321, 5678]] += 40 * speed.std()
    write(tmp_path / "a.csv", t, torque, spiky)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.said("speed", "3") and (outcome.code == 3 or np.median(outcome.error()) < 1e-2)


def test_growth_from_period_to_period(tmp_path):
    t, torque, speed = steady(1, 6)
    growing = speed + 1e-3 * speed.std() * np.exp(t / 2.0) * np.sin(2 * np.pi * 17.3 * t)
    write(tmp_path / "a.csv", t, torque, growing)
    outcome = estimate(tmp_path, ["a.csv"], *MAP)
    assert outcome.code in (1, 3) and (outcome.said("grow") or outcome.said("settled"))


def test_sound_recordings_raise_nothing(tmp_path):
    for seed in range(12):
        generator = np.random.default_rng(seed)
        level = 10.0 ** generator.uniform(-4, -1)
        t, torque, speed = steady(seed, int(generator.integers(3, 9)), level=level)
        decimals = int(generator.integers(4, 10))
        write_csv(tmp_path / "a.csv", digits=decimals + 2, t=t, torque=torque, speed=speed + generator.uniform(-3, 3))
        outcome = estimate(tmp_path, ["a.csv"], *MAP)
        assert outcome.code == 0 and not outcome.said("warning"), (seed, outcome.text)
