"""Channels of a machine without a model: designed in their own units, played by a testbed, estimated."""

import frfid
import numpy as np
import pytest

DRIVE = """
seed = 1
sample_time_s = 0.0000625
[channels]
names = ["axis"]
input_unit = "%"
[multisine]
low_hz = 10.0
high_hz = 2000.0
resolution_hz = 10.0
n_lines = 40
peak = [5.0]
[averaging]
realizations = 2
periods = 2
[limits]
max_input = [10.0]
"""


class Drive:
    """A motor y[k+1] = 0.999 y[k] + 0.02 u[k] under its own velocity loop, the reference injected behind its controller."""

    def run(self, run):
        (r,) = run.reference
        u, y = np.zeros_like(r), np.zeros_like(r)
        for k in range(len(r)):
            u[k] = r[k] - 2.0 * y[k]
            if k + 1 < len(r):
                y[k + 1] = 0.999 * y[k] + 0.02 * u[k]
        return frfid.Record(sample_time_s=run.sample_time_s, u=u[None], y=y[None], r=r[None])


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "drive.toml").write_text(DRIVE)
    return frfid.Experiment.load(tmp_path / "drive.toml").design()


def test_a_plan_is_in_the_unit_of_its_channels_and_gives_the_plant(plan):
    assert plan[0].limits == {"max_input": [10.0]}
    assert plan[0].reference_unit == "%" and plan[0].sample_time_s == 0.0000625
    assert 4.9 < np.abs(plan[0].reference).max() <= 5.0
    frf = plan.estimate(plan.run(Drive()))
    assert frf.input_units == ["%"] and frf.output_units == ["rad/s"] and frf.torque_rms_nm is None
    z = np.exp(2j * np.pi * frf.frequency_hz * 0.0000625)
    np.testing.assert_allclose(frf.response[:, 0, 0], 0.02 / (z - 0.999), rtol=1e-6)


def test_what_needs_a_model_says_what_to_do(plan):
    for call in (plan.run, plan.predict):
        with pytest.raises(ValueError, match="no robot model: .* play the plan on the machine"):
            call()
