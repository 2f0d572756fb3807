"""Logs from Python: the same record, result, warnings and refusals as by the command line."""

import json
import pathlib
import shutil
import subprocess
import warnings

import frfid
import numpy as np
import pytest

def table(path, n=4000, header="t [s],u [A],y [rad/s]"):
    """A multisine through a first-order lag, four periods of 1000 samples."""
    time_s = np.arange(n) * 1e-3
    rng = np.random.default_rng(5)
    phases = rng.uniform(0, 2 * np.pi, 30)
    lines = 2 * np.arange(1, 31) - 1
    u, y = np.zeros(n), np.zeros(n)
    for line, phase in zip(lines, phases):
        gain = 1 / (1 + 1j * line / 20)
        u += np.cos(2 * np.pi * line * time_s + phase)
        y += abs(gain) * np.cos(2 * np.pi * line * time_s + phase + np.angle(gain))
    y += 1e-3 * rng.standard_normal(n)
    np.savetxt(path, np.c_[time_s, u, y], delimiter=",", header=header, comments="", fmt="%.17g")
    return u, y


MAP = {
    "u": [{"source": "u [A]", "unit": "A"}],
    "y": [{"source": "y [rad/s]", "unit": "rad/s"}],
    "time": {"source": "t [s]", "unit": "s"},
}


def test_a_recording_is_read_into_the_arrays_that_are_in_it(tmp_path):
    u, y = table(tmp_path / "log.csv")
    record = frfid.read(tmp_path / "log.csv", map=MAP)
    np.testing.assert_allclose(record.u[0], u, rtol=1e-14)
    np.testing.assert_allclose(record.y[0], y, rtol=1e-14)
    assert record.sample_time_s == pytest.approx(1e-3, rel=1e-12)
    assert record.input_kind == "measured"


def test_files_and_dicts_are_one_map_and_the_command_line_says_the_same(tmp_path):
    table(tmp_path / "log.csv")
    (tmp_path / "map.toml").write_text(
        'time = { source = "t [s]", unit = "s" }\nu = [{ source = "u [A]", unit = "A" }]\ny = [{ source = "y [rad/s]", unit = "rad/s" }]\n'
    )
    of_dict = frfid.estimate_logs(tmp_path / "log.csv", map=MAP)
    of_file = frfid.estimate_logs([tmp_path / "log.csv"], map=tmp_path / "map.toml")
    np.testing.assert_array_equal(of_dict.response, of_file.response)
    expected = 1 / (1 + 1j * of_dict.frequency_hz / 20)
    np.testing.assert_allclose(of_dict.response[:, 0, 0], expected, rtol=2e-3)
    assert of_dict.input_names == ["u"] and of_dict.input_units == ["A"]
    command = shutil.which("frfid")
    if command:
        arguments = [command, "estimate", "log.csv", "-o", "frf.json", "--map", "map.toml", "--quiet"]
        done = subprocess.run(arguments, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        of_command = frfid.load(tmp_path / "frf.json")
        np.testing.assert_array_equal(of_command.response, of_dict.response)
        assert of_command.checks == of_dict.checks and of_command.verdicts == of_dict.verdicts


def test_what_the_command_line_warns_of_is_a_warning(tmp_path):
    table(tmp_path / "log.csv")
    other = MAP | {"u": [{"source": "u [A]", "unit": "N m"}]}
    with pytest.warns(UserWarning, match="`A` by its name and in `N m` by the map"):
        frfid.read(tmp_path / "log.csv", map=other)
    with pytest.warns(UserWarning, match="`A` by its name and in `N m` by the map"):
        frfid.estimate_logs(tmp_path / "log.csv", map=other)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"u": []}, "at least one signal for u and for y"),
        ({"u": [{"source": "x", "unit": "A"}]}, "no such column"),
        ({"u": [{"source": "u [A]", "unit": "furlong"}]}, "furlong"),
        ({"u": [{"source": "u [A]", "unit": "%"}]}, "full_scale"),
        ({"u": [{"source": "u [A]", "unit": "counts"}]}, "counts_per_turn"),
        ({"w": []}, "unknown field `w`"),
    ],
)
def test_a_map_that_does_not_fit_is_refused_in_words(change, said, tmp_path):
    table(tmp_path / "log.csv")
    with pytest.raises(ValueError, match=said.replace("(", "\\(")):
        frfid.read(tmp_path / "log.csv", map=MAP | change)
    with pytest.raises(ValueError, match=said.replace("(", "\\(")):
        frfid.estimate_logs(tmp_path / "log.csv", map=MAP | change)


def test_without_a_map_only_our_own_are_read(tmp_path):
    table(tmp_path / "log.csv")
    with pytest.raises(ValueError, match="which signal is which|needed an MCAP"):
        frfid.estimate_logs(tmp_path / "log.csv")
    with pytest.raises(ValueError):
        frfid.read(tmp_path / "log.csv")
    with pytest.raises(OSError):
        frfid.read(tmp_path / "none.csv", map=MAP)


def test_per_cent_and_counts_are_of_what_the_map_says(tmp_path):
    u, y = table(tmp_path / "log.csv", header="t [s],u,y")
    map_ = MAP | {
        "u": [{"source": "u", "unit": "%", "full_scale": "5 N m", "name": "torque"}],
        "y": [{"source": "y", "unit": "counts/s", "counts_per_turn": 4096, "scale": -1.0}],
    }
    record = frfid.read(tmp_path / "log.csv", map=map_)
    np.testing.assert_allclose(record.u[0], u * 0.05, rtol=1e-13)
    np.testing.assert_allclose(record.y[0], -y * 2 * np.pi / 4096, rtol=1e-13)
    frf = frfid.estimate_logs(tmp_path / "log.csv", map=map_)
    assert frf.input_names == ["torque"] and frf.input_units == ["N m"] and frf.output_units == ["rad/s"]


def test_inspect_says_what_is_there_and_guesses_a_map_that_works(tmp_path):
    table(tmp_path / "log.csv", header="Time [s],Current [A],Speed [rad/s]")
    found = frfid.inspect(tmp_path / "log.csv")
    (look,) = found["looks"]
    assert look["n_samples"] == 4000 and look["sample_time_s"] == pytest.approx(1e-3)
    assert [signal["source"] for signal in look["signals"]] == ["Current [A]", "Speed [rad/s]"]
    guessed = {key: value for key, value in found["map"]["map"].items() if value is not None}
    frf = frfid.estimate_logs(tmp_path / "log.csv", map=guessed)
    assert frf.input_names == ["Current"] and frf.frequency_hz.size == 30


def test_a_record_comes_back_from_disk(tmp_path):
    record = frfid.Record(sample_time_s=1e-3, u=[[0.0, 1.0, 2.0]], y=[[3.0, 4.0, 5.0]], r=[[6.0, 7.0, 8.0]])
    record.save(tmp_path / "run.mcap")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        back = frfid.Record.load(tmp_path / "run.mcap")
    for signal in ("u", "y", "r"):
        np.testing.assert_array_equal(getattr(back, signal), getattr(record, signal))
    assert back.input_kind == "commanded" and back.position_rad is None
    with pytest.raises(FileExistsError):
        record.save(tmp_path / "run.mcap")
    record.save(tmp_path / "run.mcap", overwrite=True)
    whole = (tmp_path / "run.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    with pytest.warns(UserWarning, match="the file has no end"):
        frfid.Record.load(tmp_path / "cut.mcap")
    with pytest.raises(ValueError, match="batch"):
        frfid.Record(sample_time_s=1e-3, u=np.zeros((2, 1, 3)), y=np.zeros((2, 1, 3))).save(tmp_path / "batch.mcap")


def test_a_plan_that_was_saved_is_the_plan(tmp_path):
    examples = pathlib.Path(__file__).parents[2] / "examples"
    plan = frfid.Experiment.load(examples / "experiments" / "multisine.toml").design()
    plan.save(tmp_path / "plan.mcap")
    back = frfid.Plan.load(tmp_path / "plan.mcap")
    assert back.names == plan.names
    np.testing.assert_array_equal(back.reference(0), plan.reference(0))
    assert json.dumps(back.predict(), sort_keys=True) == json.dumps(plan.predict(), sort_keys=True)
    whole = (tmp_path / "plan.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError):
        frfid.Plan.load(tmp_path / "cut.mcap")
    with pytest.raises(FileExistsError):
        plan.save(tmp_path / "plan.mcap")
