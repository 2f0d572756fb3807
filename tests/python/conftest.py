"""What several tests need: the paper's joint as scipy knows it, and the measured records."""

import pathlib
import signal

import numpy as np
import pytest
import scipy.linalg
import scipy.signal

# A shell that starts the tests in the background makes them, and all their children, deaf to Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = pathlib.Path(__file__).parents[2]
SHARED_DATA = ROOT.parent / "shared" / "data"


@pytest.fixture
def shared_data():
    """Folder with the measured records; tests that need it skip where it is missing."""
    if not SHARED_DATA.is_dir():
        print(f"SKIPPED: {SHARED_DATA} is missing")
        pytest.skip(f"{SHARED_DATA} is missing")
    return SHARED_DATA


class ScipyJoint:
    """SK15 section 6.1 without friction: states motor position, deflection, motor and link velocity; output motor velocity."""

    def __init__(self, motor=35.0, link=150.0, damping=400.0, stiffness=1.5e5):
        self.a = np.array(
            [
                [0, 0, 1, 0],
                [0, 0, 1, -1],
                [0, -stiffness / motor, -damping / motor, damping / motor],
                [0, stiffness / link, damping / link, -damping / link],
            ]
        )
        self.b = np.array([[0], [0], [1 / motor], [0]])
        self.c = np.array([[0.0, 0, 1, 0]])
        self.d = np.zeros((1, 1))

    def discrete(self, sample_time_s, hold="zoh"):
        method = {"zoh": "zoh", "linear": "foh"}[hold]
        return scipy.signal.cont2discrete((self.a, self.b, self.c, self.d), sample_time_s, method=method)

    def frf(self, hz, sample_time_s, hold="zoh"):
        """Response, (frequency,)."""
        omega = 2 * np.pi * np.asarray(hz)
        if hold == "continuous":
            phi, gamma, c, d, z = self.a, self.b, self.c, self.d, 1j * omega
        else:
            phi, gamma, c, d, _ = self.discrete(sample_time_s, hold)
            z = np.exp(1j * omega * sample_time_s)
        return np.array([(c @ np.linalg.solve(x * np.eye(4) - phi, gamma) + d)[0, 0] for x in z])

    def simulate(self, u, sample_time_s, hold="zoh"):
        """Motor velocity at rest before the first sample; u (sample,)."""
        return scipy.signal.dlsim((*self.discrete(sample_time_s, hold)[:4], sample_time_s), u[:, None])[1][:, 0]


@pytest.fixture
def scipy_joint():
    return ScipyJoint()
