from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._frf import Plot

__all__ = [
    "Chirp",
    "Comparison",
    "Experiment",
    "Frf",
    "Multisine",
    "NumericalError",
    "PiController",
    "Plan",
    "Plant",
    "Record",
    "Run",
    "Shaped",
    "__version__",
    "cli",
    "coherence",
    "compare",
    "estimate",
    "estimate_bla",
    "estimate_chirp",
    "estimate_local",
    "estimate_logs",
    "estimate_loop",
    "inspect",
    "load",
    "loop_frf",
    "read",
    "run_closed_loop",
    "run_experiment",
    "shape",
    "simulate",
    "spectra_covariance",
    "spectrogram",
    "subtract_glide",
]

__version__: str

_Profile: TypeAlias = float | list[tuple[float, float]]
_PerChannel: TypeAlias = float | list[float]
_Mimo: TypeAlias = Literal["orthogonal", "sign-flip", "independent", "one-at-a-time", "all-at-once", "zippered"]
_Progress: TypeAlias = Callable[[int, int], object]
_LogMap: TypeAlias = dict[str, Any] | str | PathLike[str]
_Phases: TypeAlias = Literal["random", "low-crest"]

_Challenge: TypeAlias = Literal[
    "gear_load_limit",
    "coulomb_friction",
    "stiffening",
    "position_dependence",
    "torque_ripple",
    "sensing",
    "gravity",
]

class NumericalError(ArithmeticError): ...

class _Testbed(Protocol):
    def run(self, run: Run, /) -> Record: ...

class _TestbedFromRest(Protocol):
    def run(self, reference: NDArray[np.float64]) -> Record: ...

@final
class Multisine:
    def __new__(
        cls,
        *,
        sample_time_s: float,
        n_samples: int,
        harmonics: ArrayLike,
        detection: ArrayLike = ...,
        shape: _Profile | None = None,
        phases: _Phases = "random",
    ) -> Multisine: ...
    @staticmethod
    def design(
        *,
        low_hz: float,
        high_hz: float,
        sample_time_s: float,
        resolution_hz: float,
        n_lines: int | None = None,
        grid: Literal["odd", "full", "odd-random"] = "odd",
        seed: int = 0,
        shape: _Profile | None = None,
        phases: _Phases = "random",
    ) -> Multisine: ...
    def realize(
        self,
        *,
        seed: int,
        n_inputs: int = 1,
        peak: _PerChannel | None = None,
        mimo: _Mimo = "orthogonal",
        realization: int = 0,
    ) -> NDArray[np.float64]: ...
    @property
    def lines_hz(self) -> NDArray[np.float64]: ...
    @property
    def harmonics(self) -> NDArray[np.int64]: ...
    @property
    def detection(self) -> NDArray[np.int64]: ...
    @property
    def shape(self) -> list[tuple[float, float]]: ...
    @property
    def phases(self) -> _Phases: ...
    @property
    def fundamental_hz(self) -> float: ...
    @property
    def period_s(self) -> float: ...
    @property
    def n_samples(self) -> int: ...
    @property
    def sample_time_s(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Chirp:
    def __new__(
        cls,
        *,
        low_hz: float,
        high_hz: float,
        duration_s: float,
        amplitude: _Profile | list[_Profile] | None = None,
        fade_s: float = 0.0,
        tail_s: float = 0.0,
    ) -> Chirp: ...
    def sample(
        self, *, sample_time_s: float, n_inputs: int = 1, mimo: Literal["sign-flip", "orthogonal"] = "sign-flip"
    ) -> NDArray[np.float64]: ...
    def frequency_at(self, time_s: float) -> float: ...
    def instant_of(self, hz: float) -> float: ...
    @property
    def low_hz(self) -> float: ...
    @property
    def high_hz(self) -> float: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def amplitude(self) -> list[list[tuple[float, float]]]: ...
    @property
    def fade_s(self) -> float: ...
    @property
    def tail_s(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class PiController:
    def __new__(
        cls,
        *,
        gain: _PerChannel,
        integral_gain: _PerChannel,
        sample_time_s: float,
        delay_samples: int = 0,
        max_torque_nm: _PerChannel | None = None,
        max_torque_rate_nm_per_s: _PerChannel | None = None,
        position_gain: _PerChannel | None = None,
    ) -> PiController: ...
    @property
    def gain(self) -> list[float]: ...
    @property
    def integral_gain(self) -> list[float]: ...
    @property
    def sample_time_s(self) -> float: ...
    @property
    def delay_samples(self) -> int: ...
    @property
    def max_torque_nm(self) -> list[float] | None: ...
    @property
    def max_torque_rate_nm_per_s(self) -> list[float] | None: ...
    @property
    def position_gain(self) -> list[float] | None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Plant:
    @staticmethod
    def single_joint(
        *,
        motor_inertia_kg_m2: float = 35.0,
        link_inertia_kg_m2: float = 150.0,
        damping_nms_per_rad: float = 400.0,
        stiffness_nm_per_rad: float = 1.5e5,
        stiffness_beyond_nm_per_rad: float | None = None,
        knee_rad: float = 1e-3,
        coulomb_nm: float = 0.0,
        viscous_nms_per_rad: float = 0.0,
        ripple: list[dict[str, float]] | None = None,
        velocity_by_differencing: bool = False,
        position_increment_rad: float | None = None,
        position_noise_rad: float | None = None,
        velocity_noise_rad_s: float | None = None,
        velocity_filter_hz: float | None = None,
        torque_quantum_nm: float | None = None,
        torque_noise_nm: float | None = None,
    ) -> Plant: ...
    @staticmethod
    def load(
        path: str | PathLike[str],
        *,
        pose_rad: Sequence[float] | None = None,
        challenges: dict[_Challenge, bool] | None = None,
    ) -> Plant: ...
    @staticmethod
    def from_toml(text: str) -> Plant: ...
    def to_toml(self) -> str: ...
    @property
    def n_axes(self) -> int: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def pose_rad(self) -> list[float]: ...
    def frf(
        self,
        hz: ArrayLike,
        *,
        hold: Literal["zoh", "linear", "continuous"] = "zoh",
        sample_time_s: float | None = None,
        sensor: bool = False,
    ) -> Frf: ...
    def frf_at(
        self,
        q: ArrayLike,
        hz: ArrayLike,
        *,
        hold: Literal["zoh", "linear", "continuous"] = "zoh",
        sample_time_s: float | None = None,
        sensor: bool = False,
    ) -> NDArray[np.complex128]: ...
    def simulate(
        self,
        u: ArrayLike,
        *,
        sample_time_s: float,
        hold: Literal["zoh", "linear"] = "zoh",
        velocity_rad_s: _PerChannel | None = None,
        integrator: Literal["rk4", "exact"] = "rk4",
        seed: int = 0,
        progress: _Progress | None = None,
    ) -> Record: ...
    def mass_matrix(self, q: ArrayLike) -> NDArray[np.float64]: ...
    def gravity_torque(self, q: ArrayLike) -> NDArray[np.float64]: ...
    def link_acceleration(self, q: ArrayLike, qd: ArrayLike, torque: ArrayLike) -> NDArray[np.float64]: ...
    def modes_hz(self, *, motors_locked: bool = False) -> list[float]: ...
    @property
    def parameters(self) -> dict[str, Any]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Experiment:
    @staticmethod
    def load(path: str | PathLike[str]) -> Experiment: ...
    @staticmethod
    def from_toml(text: str) -> Experiment: ...
    def design(self) -> Plan: ...
    def to_toml(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Plan:
    @staticmethod
    def load(path: str | PathLike[str]) -> Plan: ...
    def __copy__(self) -> Plan: ...
    def __deepcopy__(self, _memo: Any, /) -> Plan: ...
    def save(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def robot_time_s(self) -> float: ...
    def reference(self, index: int) -> NDArray[np.float64]: ...
    def predict(self, *, progress: _Progress | None = None) -> dict[str, Any]: ...
    def run(
        self,
        testbed: _Testbed | _TestbedFromRest | None = None,
        progress: _Progress | None = None,
        *,
        jobs: int = 0,
        folder: str | PathLike[str] | None = None,
        overwrite: bool = False,
    ) -> list[Record]: ...
    def export(
        self,
        path: str | PathLike[str],
        to: Literal["csv", "mat", "joint-trajectory", "float64-array"] = "csv",
        *,
        rate_hz: float | None = None,
        campaign: bool = False,
        separator: Literal["comma", "semicolon", "tab"] = "comma",
        decimal: Literal["point", "comma"] = "point",
        angle: Literal["rad", "deg", "turn", "rpm"] = "rad",
        gear_ratio: Sequence[float] | None = None,
        jobs: int = 0,
        overwrite: bool = False,
        progress: _Progress | None = None,
    ) -> dict[str, Any]: ...
    def import_recordings(
        self,
        recordings: str | PathLike[str] | Sequence[str | PathLike[str]],
        map: _LogMap,
        folder: str | PathLike[str],
        *,
        rate_hz: float | None = None,
        overwrite: bool = False,
        progress: _Progress | None = None,
    ) -> dict[str, Any]: ...
    def estimate(self, records: Sequence[Record | None]) -> Frf: ...
    def __getitem__(self, index: int, /) -> Run: ...
    def __len__(self) -> int: ...

@final
class Run:
    @property
    def name(self) -> str: ...
    @property
    def sample_time_s(self) -> float: ...
    @property
    def reference(self) -> NDArray[np.float64]: ...
    @property
    def reference_unit(self) -> str: ...
    @property
    def velocity_rad_s(self) -> NDArray[np.float64]: ...
    @property
    def start_rad(self) -> NDArray[np.float64]: ...
    @property
    def limits(self) -> dict[str, list[float]]: ...

@final
class Record:
    def __new__(
        cls,
        *,
        sample_time_s: float,
        u: ArrayLike,
        y: ArrayLike,
        r: ArrayLike | None = None,
        position_rad: ArrayLike | None = None,
        input_kind: Literal["commanded", "measured"] = "commanded",
        events: list[Any] | None = None,
    ) -> Record: ...
    @property
    def sample_time_s(self) -> float: ...
    @property
    def u(self) -> NDArray[np.float64]: ...
    @property
    def y(self) -> NDArray[np.float64]: ...
    @property
    def r(self) -> NDArray[np.float64] | None: ...
    @property
    def position_rad(self) -> NDArray[np.float64] | None: ...
    @property
    def input_kind(self) -> Literal["commanded", "measured"]: ...
    @property
    def events(self) -> list[Any]: ...
    @property
    def n_samples(self) -> int: ...
    @staticmethod
    def load(path: str | PathLike[str]) -> Record: ...
    def save(
        self, path: str | PathLike[str], *, joint_names: Sequence[str] | None = None, overwrite: bool = False
    ) -> None: ...

@final
class Frf:
    def __new__(
        cls,
        *,
        frequency_hz: ArrayLike,
        response: ArrayLike,
        noise_covariance: ArrayLike | None = None,
        noise_degrees_of_freedom: float | None = None,
        total_covariance: ArrayLike | None = None,
        total_degrees_of_freedom: float | None = None,
        condition: ArrayLike | None = None,
        relative_resolution: float | None = None,
        torque_rms_nm: Sequence[float] | None = None,
        flagged: Sequence[bool] | None = None,
        distortion: dict[str, Any] | None = None,
        harmonics: dict[str, Any] | None = None,
        input_names: list[str] | None = None,
        output_names: list[str] | None = None,
        input_units: list[str] | None = None,
        output_units: list[str] | None = None,
        verdicts: list[dict[str, Any]] | None = None,
        checks: list[dict[str, Any]] | None = None,
        provenance: dict[str, str] | None = None,
    ) -> Frf: ...
    @property
    def frequency_hz(self) -> NDArray[np.float64]: ...
    @property
    def response(self) -> NDArray[np.complex128]: ...
    @property
    def noise_variance(self) -> NDArray[np.float64] | None: ...
    @property
    def total_variance(self) -> NDArray[np.float64] | None: ...
    @property
    def nonlinear_variance(self) -> NDArray[np.float64] | None: ...
    @property
    def covariance(self) -> NDArray[np.complex128] | None: ...
    @property
    def noise_covariance(self) -> NDArray[np.complex128] | None: ...
    @property
    def total_covariance(self) -> NDArray[np.complex128] | None: ...
    @property
    def noise_degrees_of_freedom(self) -> float | None: ...
    @property
    def total_degrees_of_freedom(self) -> float | None: ...
    @property
    def condition(self) -> NDArray[np.float64] | None: ...
    @property
    def relative_resolution(self) -> float | None: ...
    @property
    def torque_rms_nm(self) -> list[float] | None: ...
    @property
    def flagged(self) -> list[bool] | None: ...
    @property
    def distortion(self) -> dict[str, list[dict[str, list[dict[str, Any]]]]] | None: ...
    @property
    def harmonics(self) -> dict[str, Any] | None: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    def __getitem__(self, key: Any, /) -> Any: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    @property
    def n_outputs(self) -> int: ...
    @property
    def n_inputs(self) -> int: ...
    @property
    def input_names(self) -> list[str]: ...
    @property
    def output_names(self) -> list[str]: ...
    @property
    def input_units(self) -> list[str]: ...
    @property
    def output_units(self) -> list[str]: ...
    @property
    def verdicts(self) -> list[dict[str, Any]]: ...
    @property
    def checks(self) -> list[dict[str, Any]]: ...
    @property
    def provenance(self) -> dict[str, str]: ...
    def save(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    def to_csv(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    def to_npz(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    def to_mat(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    def to_uff(self, path: str | PathLike[str], *, overwrite: bool = False) -> None: ...
    def report(
        self, path: str | PathLike[str], title: str | None = None, note: str | None = None, *, overwrite: bool = False
    ) -> None: ...
    def to_svg(self) -> str: ...
    def to_control(self) -> Any: ...
    def to_xarray(self) -> Any: ...
    @property
    def plot(self) -> Plot: ...
    def _repr_html_(self) -> str: ...

@final
class Comparison:
    @property
    def verdict(self) -> str | None: ...
    @property
    def verdict_entry(self) -> tuple[int, int] | None: ...
    @property
    def agrees(self) -> bool | None: ...
    @property
    def agreement(self) -> dict[str, Any]: ...
    @property
    def band_hz(self) -> tuple[float, float]: ...
    @property
    def unknown_lines(self) -> tuple[int, int]: ...
    @property
    def entries(self) -> list[dict[str, Any]]: ...

@final
class Shaped:
    def __copy__(self) -> Shaped: ...
    def __deepcopy__(self, _memo: Any, /) -> Shaped: ...
    @property
    def reference(self) -> NDArray[np.float64]: ...
    @property
    def records(self) -> list[Record]: ...
    @property
    def number(self) -> int: ...
    @property
    def error(self) -> float | None: ...
    @property
    def errors(self) -> list[float | None]: ...
    @property
    def error_per_frequency(self) -> NDArray[np.float64] | None: ...
    @property
    def r_to_u(self) -> Frf | None: ...
    @property
    def r_to_y(self) -> Frf | None: ...
    @property
    def condition(self) -> NDArray[np.float64] | None: ...
    @property
    def stuck_share(self) -> list[float]: ...
    @property
    def sticking(self) -> list[str]: ...
    @property
    def iterations(self) -> list[dict[str, Any]]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def stop(self) -> str: ...

def shape(
    testbed: _Testbed | _TestbedFromRest | tuple[Plant, PiController],
    *,
    desired: ArrayLike,
    start: ArrayLike,
    sample_time_s: float,
    low_hz: float = 2.0,
    high_hz: float = 60.0,
    target: Literal["torque", "velocity"] = "torque",
    step: Literal["damped", "paper"] = "damped",
    damping: float = 0.9,
    smoothing_bins: int = 30,
    n_iterations: int = 6,
    good_enough: float = 0.05,
    largest_change: float = 3.0,
    max_torque_nm: _PerChannel | None = None,
    max_velocity_rad_s: _PerChannel | None = None,
    max_travel_rad: _PerChannel | None = None,
    max_stuck_share: float = 0.15,
    still_rad_s: float = 0.0,
    coulomb_nm: _PerChannel | None = None,
    seed: int = 0,
    folder: str | PathLike[str] | None = None,
    overwrite: bool = False,
    progress: _Progress | None = None,
) -> Shaped: ...
def compare(
    a: Frf,
    b: Frf,
    *,
    stronger: Literal["a", "b"] | None = None,
    prominence_db: float = 3.0,
    largest_shift: float = 1.5,
) -> Comparison: ...
def load(path: str | PathLike[str]) -> Frf: ...
def read(path: str | PathLike[str], *, map: _LogMap | None = None) -> Record: ...
def run_experiment(plan: str | PathLike[str], index: int, folder: str | PathLike[str]) -> str: ...
def inspect(path: str | PathLike[str]) -> dict[str, Any]: ...
def estimate_logs(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    map: _LogMap | None = None,
    estimate: dict[str, Any] | None = None,
    jobs: int = 0,
    progress: _Progress | None = None,
) -> Frf: ...
def estimate(
    u: ArrayLike,
    y: ArrayLike,
    *,
    sample_time_s: float,
    harmonics: ArrayLike,
    method: Literal[
        "auto", "mean-of-frfs", "mean-of-spectra", "logarithmic-mean", "least-squares", "joint-input-output", "h1", "h2",
        "local-rational", "local-polynomial",
    ]
    | None = None,
    r: ArrayLike | None = None,
    max_condition: float | None = None,
) -> Frf: ...
def estimate_bla(
    u: ArrayLike,
    y: ArrayLike,
    *,
    sample_time_s: float,
    harmonics: ArrayLike,
    r: ArrayLike | None = None,
    average: Literal["frfs", "spectra"] = "spectra",
    max_condition: float | None = None,
) -> Frf: ...
def estimate_loop(
    u: ArrayLike,
    y: ArrayLike,
    r: ArrayLike,
    *,
    sample_time_s: float,
    harmonics: ArrayLike,
    loop: Literal["set-point", "input"] | None = None,
) -> dict[str, Frf]: ...
def coherence(
    u: ArrayLike, y: ArrayLike, *, sample_time_s: float, harmonics: ArrayLike
) -> list[NDArray[np.float64]]: ...
def spectra_covariance(
    u: ArrayLike, y: ArrayLike, *, sample_time_s: float, harmonics: ArrayLike, r: ArrayLike | None = None
) -> dict[str, NDArray[np.complex128] | None]: ...
def estimate_chirp(
    u: ArrayLike,
    y: ArrayLike,
    *,
    chirp: Chirp,
    sample_time_s: float,
    frequencies_hz: ArrayLike,
    method: Literal["excerpt", "local-rational", "local-polynomial"] = "excerpt",
    r: ArrayLike | None = None,
    start_s: float = 0.0,
    max_condition: float | None = None,
) -> Frf: ...
def estimate_local(
    u: ArrayLike,
    y: ArrayLike,
    *,
    sample_time_s: float,
    frequencies_hz: ArrayLike,
    method: Literal["local-rational", "local-polynomial"] = "local-rational",
    r: ArrayLike | None = None,
    half_width: int | None = None,
) -> Frf: ...
def simulate(
    plants: Plant | Sequence[Plant],
    u: ArrayLike,
    *,
    sample_time_s: float,
    hold: Literal["zoh", "linear"] = "zoh",
    velocity_rad_s: _PerChannel | None = None,
    integrator: Literal["rk4", "exact"] = "rk4",
    seed: int = 0,
    progress: _Progress | None = None,
) -> Record: ...
def run_closed_loop(
    plant: Plant | Sequence[Plant],
    controller: PiController,
    r: ArrayLike,
    *,
    velocity_rad_s: _PerChannel | None = None,
    start_rad: _PerChannel | None = None,
    integrator: Literal["rk4", "exact"] = "rk4",
    seed: int = 0,
    progress: _Progress | None = None,
) -> Record: ...
def loop_frf(plant: Plant, controller: PiController, hz: ArrayLike) -> dict[str, Frf]: ...
def spectrogram(
    signal: ArrayLike, *, sample_time_s: float, window_s: float = 1.0, step_s: float = 0.1
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def subtract_glide(
    run: Record, glide: Record, *, by: Literal["time", "position"] = "time", plant: Frf | None = None
) -> Record: ...
def cli(args: Sequence[str]) -> int: ...
