"""Resonances of measured records, found again in disjoint pieces of each: apart by what their errors say, or by less where they must.

Other realizations differ by all that an error is made of; other periods of one realization by noise alone, since its distortion repeats;
other lines, every second one, have distortion of their own. The records are read from ``../shared/data``; where they are missing the
tests skip.
"""

import gzip
import pathlib
from dataclasses import dataclass

import numpy as np
import pytest

frfid = pytest.importorskip("frfid")
DATA = pathlib.Path(__file__).parents[3] / "shared" / "data"
QUANTITIES = {"frequency": ("frequency_hz", "frequency_std_hz"), "damping": ("damping", "damping_std"), "level": ("magnitude_db", "magnitude_std_db")}
LEVELS = (1, 3, 7)
# The outputs of the wing move nearly together: two dozen features are as good as ten, whose rms leaves this range at either end once in
# a hundred times.
LEAST, MOST = 0.5, 1.52


@dataclass
class Record:
    """Periods of one machine, each (realization, experiment, period, channel, sample)."""

    u: np.ndarray
    y: np.ndarray
    sample_time_s: float
    lines: np.ndarray
    r: np.ndarray | None = None

    def estimate(self, realizations=slice(None), periods=slice(None), lines=slice(None)):
        cut = lambda signal: None if signal is None else np.ascontiguousarray(signal[realizations, :, periods])
        return frfid.estimate(cut(self.u), cut(self.y), r=cut(self.r), sample_time_s=self.sample_time_s, harmonics=self.lines[lines])

    def halves(self, what):
        """Estimates of the first and the second half of the realizations or periods, or of every second line."""
        if what == "lines":
            return self.estimate(lines=slice(0, None, 2)), self.estimate(lines=slice(1, None, 2))
        middle = self.u.shape[{"realizations": 0, "periods": 2}[what]] // 2
        return self.estimate(**{what: slice(0, middle)}), self.estimate(**{what: slice(middle, None)})


def path(name):
    if not (DATA / name).exists():
        print(f"SKIPPED: {DATA / name} is missing")
        pytest.skip(f"{DATA / name} is missing")
    return DATA / name


def whole_periods(signal, length, first):
    """(channel, sample) from period `first` on, as one realization of one experiment."""
    signal = np.atleast_2d(signal).astype(float)[:, first * length :]
    return signal.reshape(len(signal), -1, length).swapaxes(0, 1)[None, None]


def silverbox():
    data = np.load(path("silverbox/snls80mv.npz"))
    cut = lambda signal: np.stack([signal[40985 + 8692 * p :][:8192] for p in range(10)])[:, None, None, None]
    return Record(cut(data["u"]), cut(data["y"]), 2**14 / 1e7, np.arange(1, 2684, 2))


def wing(level):
    data = np.load(path(f"f16/F16Data_FullMSine_Level{level}.npz"))
    first = 2 if level == 3 else 1  # transient periods, as they are found
    u, y, r = (whole_periods(data[name], 8192, first) for name in ("force", "acceleration", "voltage"))
    return Record(u, y, 1 / 400, np.arange(41, 308), r)


def bench():
    with gzip.open(path("motor_bench/multisine_type_a.csv.gz"), "rt") as file:
        columns = np.loadtxt(file, delimiter=",", skiprows=1).T
    r, u, y = (whole_periods(columns[rows], 2500, 1) for rows in (1, 2, [3, 4]))
    return Record(u, y, 4e-4, np.arange(11, 251), r)


def features(frf):
    """Every resonance and antiresonance that stands out, with its output."""
    return [(entry["output"], change["a"]) for entry in frfid.compare(frf, frf).entries for change in entry["changes"]]


def alike(found, output, one):
    """The feature of the same kind within 2 % of a frequency, or None."""
    apart = lambda other: abs(other["frequency_hz"] / one["frequency_hz"] - 1)
    same = [other for at, other in found if at == output and other["kind"] == one["kind"] and apart(other) < 0.02]
    return min(same, key=apart, default=None)


def together(whole, *pieces):
    """The features of the whole that every piece has: tuples of them."""
    found = [features(piece) for piece in pieces]
    all_of = [(one, *(alike(piece, output, one) for piece in found)) for output, one in features(whole)]
    return [one for one in all_of if None not in one]


def known(triples, quantity):
    """Value and error of a quantity, (feature, piece), the whole first, where all know both."""
    both = [[[one[name] for name in QUANTITIES[quantity]] for one in triple] for triple in triples]
    return np.array([one for one in both if not any(None in pair for pair in one)], float).reshape(-1, len(triples[0]), 2)


def over_whole(triples, quantity):
    """Rms of half the differences of halves over the errors of the whole."""
    values = known(triples, quantity)
    return np.sqrt(np.mean(((values[:, 1, 0] - values[:, 2, 0]) / 2 / values[:, 0, 1]) ** 2))


def over_own(triples, quantity):
    """Rms of the differences of halves over their own errors."""
    values = known(triples, quantity)
    return np.sqrt(np.mean((values[:, 1, 0] - values[:, 2, 0]) ** 2 / (values[:, 1:, 1] ** 2).sum(axis=1)))


def test_silverbox_pairs_scatter_as_they_say():
    record = silverbox()
    pairs = [record.estimate(realizations=slice(p, p + 2)) for p in range(0, 10, 2)]
    whole = record.estimate()
    (found,) = together(whole, *pairs)
    for quantity in ("frequency", "level"):
        values, errors = known([found], quantity)[0, 1:].T
        weight = 1 / errors**2
        misfit = np.sum(weight * (values - np.average(values, weights=weight)) ** 2)
        assert 0.3 < misfit < 13.3, f"{quantity}: {values} with errors {errors}"  # chi-squared of four degrees, 1 % at either end
    first, second = record.halves("realizations")
    assert over_own(together(whole, first, second), "frequency") < 2.6  # one difference, 1 %
    assert frfid.compare(first, second).agrees


@pytest.mark.parametrize("level", LEVELS)
def test_wing_lines_confirm_the_errors_of_the_whole(level):
    record = wing(level)
    whole = record.estimate()
    found = together(whole, *record.halves("lines"))
    assert len(found) >= 0.7 * len(features(whole))
    for quantity in QUANTITIES:
        assert LEAST < over_whole(found, quantity) < MOST, quantity


@pytest.mark.parametrize("level", LEVELS)
def test_wing_periods_differ_by_less_than_errors_with_distortion(level):
    record = wing(level)
    first, second = record.halves("periods")
    whole = record.estimate()
    found = together(whole, first, second)
    assert len(found) >= len(features(whole)) - 1 and frfid.compare(first, second).agrees
    for quantity in QUANTITIES:
        assert over_own(found, quantity) < 0.7, quantity


def test_the_page_has_these_numbers():
    page = (pathlib.Path(__file__).parents[2] / "docs" / "records.md").read_text()
    drift = {}
    for level in LEVELS:
        record = wing(level)
        whole = record.estimate()
        cells = [f"| {level} "]
        for what in ("periods", "lines"):
            found = together(whole, *record.halves(what))
            ratios = ", ".join(f"{over_whole(found, quantity):.1f}" for quantity in QUANTITIES)
            cells.append(f"| {len(found)} of {len(features(whole))}: {ratios} ")
        assert "".join(cells) + "|" in page
        first, second = record.halves("periods")
        noise = first.noise_variance + second.noise_variance
        drift[level] = np.sqrt(np.mean(np.abs(first.response - second.response) ** 2 / noise))
    said = f"moves by {drift[3]:.1f} (level 3) and {drift[7]:.1f} (level 7) standard deviations of its noise, rms over lines, "
    assert said + f"and by {drift[1]:.1f} at level 1" in " ".join(page.split()), said


@pytest.mark.parametrize("level", [pytest.param(level, marks=pytest.mark.xfail(
    level == 3, strict=True, reason="distortion gathers at the resonances, and three lines across one are fitted as they lie",
)) for level in LEVELS])
def test_wing_lines_know_their_own_errors(level):
    record = wing(level)
    found = together(record.estimate(), *record.halves("lines"))
    assert over_own(found, "frequency") < MOST


def test_two_halves_of_one_record_have_no_verdict():
    odd, even = wing(1).halves("lines")
    assert frfid.compare(odd, even).verdict is None


def test_wing_resonances_fall_with_the_level():
    low, middle, high = (wing(level).estimate() for level in LEVELS)
    for weaker, stronger in ((low, middle), (middle, high), (low, high)):
        changes = [change for entry in frfid.compare(weaker, stronger).entries for change in entry["changes"]]
        resonances = [change for change in changes if change["a"]["kind"] == "resonance" and change["b"] is not None]
        errors = np.array([change["shift_percent"] / change["shift_std_percent"] for change in resonances])
        assert np.all(errors < 0) and np.sum(errors < -3) >= 8, errors


def test_bench_frequencies_are_confirmed_by_lines_and_periods():
    record = bench()
    whole = record.estimate()
    for what in ("lines", "periods"):
        found = together(whole, *record.halves(what))
        assert len(found) == 4 and over_whole(found, "frequency") < 2.1  # four features of two modes: one in a hundred
    assert over_whole(together(whole, *record.halves("lines")), "level") < 2.1
    assert frfid.compare(*record.halves("periods")).agrees


def test_repeats_of_a_sweep_are_no_multisine():
    data = np.load(path("slfr_swept/swept_0_10hz.npz"))
    chirp = frfid.Chirp(low_hz=0.01, high_hz=10.0, duration_s=4.0, amplitude=50.0)
    u, y = (data[name].astype(float)[:, None, None] for name in ("v", "theta"))
    frf = frfid.estimate_chirp(u, y, chirp=chirp, sample_time_s=0.002, frequencies_hz=np.arange(0.6, 9.5, 0.05))
    assert features(frf) == []


def gathered(seed):
    """A machine of five modes, one realization: scatter of 1 % from line to line, and of 6 % more around each mode."""
    modes = [(3.4688, 0.0148, 1.0), (3.9735, 0.0213, -1.0), (5.1884, 0.0083, 0.5), (7.3147, 0.0052, 0.6), (9.1754, 0.0076, 0.5)]
    lines, n, periods, random = np.arange(41, 308), 8192, 8, np.random.default_rng(seed)
    complex_normal = lambda *shape: random.normal(size=(*shape, 2)) @ [1, 1j] / np.sqrt(2)

    def response(hz):
        return 0.05 - sum(0.02 * a * (hz / f) ** 2 / (1 - (hz / f) ** 2 + 2j * z * hz / f) for f, z, a in modes)

    hz = lines * 400 / n
    scatter = 0.01 + sum(0.06 * np.exp(-((hz - f) ** 2) / 2 / (3 * z * f) ** 2) for f, z, _ in modes)
    measured = response(hz) * (1 + scatter * complex_normal(len(hz)))
    noise = 4e-3 * np.abs(measured) * complex_normal(periods, len(hz))
    drive = np.exp(2j * np.pi * random.random(len(hz)))

    def signal(spectrum):
        full = np.zeros((periods, n // 2 + 1), complex)
        full[:, lines] = spectrum
        return n * np.fft.irfft(full)[None, None, :, None]

    fine = np.arange(2.1, 14.9, 5e-4)
    level = np.abs(response(fine))
    peaks = fine[1:-1][(level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])]
    return Record(signal(drive), signal((measured + noise) * drive), 1 / 400, lines), peaks


def test_errors_hold_where_distortion_gathers_at_the_resonances():
    ratios = []
    for seed in range(30):
        record, peaks = gathered(seed)
        found = [one for _, one in features(record.estimate()) if one["kind"] == "resonance" and one["frequency_std_hz"]]
        for one in found:
            off = min(peaks - one["frequency_hz"], key=abs)
            ratios.append(off / one["frequency_std_hz"] if abs(off) < 0.02 * one["frequency_hz"] else np.nan)
    rms = np.sqrt(np.nanmean(np.square(ratios)))
    print(f"{rms:.2f} on {np.isfinite(ratios).sum()}")
    assert rms < 1.2  # 100 independent ones, 1 %
