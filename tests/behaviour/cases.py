"""Descriptions whose behaviour is recorded: a template, what is replaced in it, and the commands that are tried on it.

Each case is run through the binary alone. `SHORT` shortens the period, so that all of them together take minutes.
"""

from dataclasses import dataclass, field

SHORT = ("resolution_hz = 0.1", "resolution_hz = 1.0")


@dataclass
class Case:
    """A description, made from a template by replacements of texts that must be there."""

    name: str
    template: str
    replacements: list[tuple[str, str]] = field(default_factory=list)
    seed: int = 1
    shape: bool = False
    small: bool = False
    estimates: list[list[str]] = field(default_factory=list)


OTHER_WAYS = [["--average", "spectra"], ["--indirect"]]

CASES = [
    Case("multisine", "multisine", [("realizations = 30", "realizations = 4")], estimates=OTHER_WAYS),
    Case(
        "noisy_multisine",
        "multisine",
        [
            SHORT,
            ("realizations = 30", "realizations = 3"),
            ("periods = 1 ", "periods = 3 "),
            ('grid = "odd"', 'grid = "odd-random"'),
            (
                "\n[multisine]",
                "\n[robot.sensor]\nvelocity_noise_rad_s = 1e-4\ntorque_noise_nm = 1.0\n\n[multisine]",
            ),
            ("max_effort = [150.0]", "max_effort = [160.0]"),
        ],
        seed=7,
        small=True,
        estimates=OTHER_WAYS,
    ),
    Case("chirp", "chirp", estimates=[["--n-frequencies", "50"]]),
    Case(
        "faded_chirp",
        "chirp",
        [
            ("duration_s = 20.0", "duration_s = 4.0\nfade_s = 0.1\ntail_s = 0.5"),
            ("low_hz = 1.0", "low_hz = 2.0"),
            ("[limits]", "[averaging]\nrepetitions = 2\nlead_in_s = 0.25\n\n[limits]"),
        ],
        seed=3,
        small=True,
    ),
    Case("constant_velocity", "constant-velocity", [("realizations = 10", "realizations = 3")]),
    Case(
        "ripple_by_position",
        "r3-multisine",
        [
            SHORT,
            ("realizations = 10", "realizations = 2"),
            ("repetitions = 5", "repetitions = 2"),
            ("glides = 5 ", "glides = 2 "),
        ],
        small=True,
    ),
    Case(
        "r3_multisine",
        "r3-multisine",
        [
            ("realizations = 10", "realizations = 2"),
            ("repetitions = 5", "repetitions = 2"),
            ("glides = 5 ", "glides = 2 "),
        ],
        estimates=OTHER_WAYS,
    ),
    Case(
        "stopped",
        "r3-multisine",
        [
            SHORT,
            ("realizations = 10", "realizations = 2"),
            ("repetitions = 5", "repetitions = 1"),
            ("glides = 5 ", "glides = 1 "),
            ("max_travel = [0.0698, 0.0698, 0.0698]", "max_travel = [0.0698, 0.0698, 0.0698]\nmax_velocity = [3.0, 0.02725, 3.0]"),
            ('glide_subtraction = "position"', 'glide_subtraction = "time"'),
        ],
        seed=3,
        small=True,
    ),
    Case("r3_chirp", "r3-chirp", [("n_iterations = 6", "n_iterations = 3")], shape=True),
    Case(
        "paper_step",
        "r3-chirp",
        [
            ('step = "damped" ', 'step = "paper" '),
            ("n_iterations = 6", "n_iterations = 2"),
            ("duration_s = 20.0", "duration_s = 6.0"),
            ("\n[chirp]", "position_gain_per_s = [8.0, 8.0, 8.0]\nmax_torque_nm = [900.0, 1500.0, 500.0]\n\n[chirp]"),
        ],
        seed=11,
        shape=True,
        small=True,
    ),
    Case(
        "six_axis_multisine",
        "six-axis-multisine",
        [
            ("resolution_hz = 0.2", "resolution_hz = 1.0"),
            ("realizations = 10", "realizations = 2"),
            ("repetitions = 5", "repetitions = 1"),
            ("glides = 5 ", "glides = 1 "),
        ],
    ),
    Case("six_axis_chirp", "six-axis-chirp", [("n_iterations = 10", "n_iterations = 1")], shape=True),
]

# What is wrong in each of these is told with its place; the template is `multisine` unless another is named.
REFUSED = {
    "unknown_key": ("multisine", "n_lines = 80", "n_linse = 80"),
    "wrong_type": ("multisine", "seed = 1", 'seed = "one"'),
    "negative_stiffness": ("multisine", "stiffness_nm_per_rad = 1.5e5", "stiffness_nm_per_rad = -1.5e5"),
    "negative_link": ("multisine", "link_inertia_kg_m2 = 150.0", "link_inertia_kg_m2 = nan"),
    "bad_ripple": ("multisine", "\n[multisine]", "ripple = [{ cycles_per_turn = -1, amplitude_nm = 2 }]\n\n[multisine]"),
    "bad_sensor": ("multisine", "\n[multisine]", "\n[robot.sensor]\ntorque_noise_nm = -1.0\n\n[multisine]"),
    "above_nyquist": ("multisine", "high_hz = 60.0", "high_hz = 600.0"),
    "empty_band": ("multisine", "high_hz = 60.0", "high_hz = 1.01"),
    "no_lines": ("multisine", "n_lines = 80", "n_lines = 0"),
    "peak_of_two": ("multisine", "peak_nm = [150.0]", "peak_nm = [150.0, 150.0]"),
    "peak_of_velocity_loop": ("multisine", "peak_nm", "peak_rad_s"),
    "peak_negative": ("multisine", "peak_nm = [150.0]", "peak_nm = [-150.0]"),
    "realizations_zero": ("multisine", "realizations = 30", "realizations = 0"),
    "realizations_too_many": ("multisine", "realizations = 30", "realizations = 3000000"),
    "lead_in_negative": ("multisine", "periods = 1 ", "lead_in_s = -1.0 "),
    "limit_too_low": ("multisine", "max_effort = [150.0]", "max_effort = [100.0]"),
    "limit_of_two": ("multisine", "max_effort = [150.0]", "max_effort = [100.0, 2.0]"),
    "limit_unknown": ("multisine", "max_effort", "max_effrot"),
    "two_excitations": ("multisine", "[limits]", "[chirp]\nlow_hz = 1\nhigh_hz = 2\nduration_s = 3\n\n[limits]"),
    "chirp_periods": ("chirp", "[limits]", "[averaging]\nperiods = 2\n\n[limits]"),
    "chirp_fade": ("chirp", "duration_s = 20.0", "duration_s = 20.0\nfade_s = 11.0"),
    "chirp_independent": ("chirp", "duration_s = 20.0", 'duration_s = 20.0\nmimo = "independent"'),
    "too_few_frequencies": ("chirp", "n_frequencies = 200", "n_frequencies = 1"),
    "no_amplitude_left": ("constant-velocity", "max_effort = [200.0]", "max_effort = [40.0]"),
    "velocity_of_two": ("constant-velocity", "[0.25]", "[0.25, 0.1]"),
    "gain_negative": ("r3-multisine", "gain_nms_per_rad = [1500.0", "gain_nms_per_rad = [-1500.0"),
    "gain_of_two": ("r3-multisine", "[12000.0, 12000.0, 3200.0]", "[12000.0, 3200.0]"),
    "share_of_nothing": ("r3-multisine", "peak_of_velocity = 0.4", "peak_of_velocity = 0.0"),
    "inertia": ("r3-multisine", "iyy = 0.64", "iyy = 9.64"),
    "gear_ratio": ("r3-multisine", "gear_ratio = 210.0", "gear_ratio = 0.0"),
    "joint_limit": ("r3-multisine", "max_effort = 2195.0", "max_effort = 0.0"),
    "joint_damping": ("r3-multisine", "damping_nms_per_rad = 441.0", "damping_nms_per_rad = -441.0"),
    "pose": ("r3-multisine", "pose_rad = [-1.0471975511965976, 0", "pose_rad = [0"),
    "shape_limit": ("r3-chirp", "[[36.0, 400.0], [44.0, 200.0]]", "[[36.0, 4000.0], [44.0, 200.0]]"),
    "shape_damping": ("r3-chirp", "n_iterations = 6", "n_iterations = 6\ndamping = 1.5"),
}

REFUSED_SMALL = ["negative_stiffness", "limit_too_low", "limit_unknown", "gain_negative", "inertia", "shape_limit"]
