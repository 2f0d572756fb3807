"""What an FRF becomes in other packages: python-control, xarray, matplotlib, a notebook."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._core import Frf


def to_control(frf: Frf) -> Any:
    import control  # type: ignore[import-untyped]

    known = np.isfinite(frf.response).all(axis=(1, 2))  # it has no word for a line without an estimate
    return control.FrequencyResponseData(
        np.moveaxis(frf.response[known], 0, -1),
        2 * np.pi * frf.frequency_hz[known],
        inputs=frf.input_names,
        outputs=frf.output_names,
    )


def to_xarray(frf: Frf) -> Any:
    import xarray

    entries = ("frequency", "output", "input")
    arrays: dict[str, tuple[Any, Any]] = {
        "response": (entries, frf.response),
        "noise_variance": (entries, frf.noise_variance),
        "total_variance": (entries, frf.total_variance),
        "condition": (("frequency",), frf.condition),
    }
    return xarray.Dataset(
        {name: array for name, array in arrays.items() if array[1] is not None},
        coords={
            "frequency": ("frequency", frf.frequency_hz, {"units": "Hz"}),
            "output": ("output", frf.output_names, {"units": frf.output_units}),
            "input": ("input", frf.input_names, {"units": frf.input_units}),
        },
        attrs=frf.provenance,
    )


class Plot:
    """Plots of one FRF."""

    def __init__(self, frf: Frf) -> None:
        self._frf = frf

    def bode(self, ax: Any = None, *, phase: bool | None = None, **line: Any) -> Any:
        """Magnitude in dB and phase in degrees over frequency, one column for each input.

        Shaded is the 95 % region of noise and nonlinear distortion, or of the noise where that alone was measured; flagged
        lines have ticks at the upper edge. The range of the magnitudes is that of the responses, shared by the row. The phase has gaps where
        it wraps.

        Parameters
        ----------
        ax : ndarray of matplotlib axes, optional
            Axes of an earlier plot, or your own, to draw into: ``2 * n_outputs * n_inputs`` of them with phase,
            ``n_outputs * n_inputs`` for magnitudes only.
        phase : bool, optional
            Whether each row of magnitudes has its phases below it. By default up to three outputs and inputs.
        **line
            Passed on to matplotlib for the curves, such as ``label`` or ``color``.

        Returns
        -------
        ndarray of matplotlib axes, shape (2 * n_outputs, n_inputs), or (n_outputs, n_inputs) without phase

        Raises
        ------
        ValueError
            If ``ax`` has another number of axes.
        """
        from ._bode import bode

        return bode(self._frf, ax, phase, line)


def repr_html(frf: Frf) -> str:
    if not len(frf.frequency_hz):
        return f"<p>{escape(repr(frf))}</p>"
    measured = {name: getattr(frf, name) is not None for name in ("noise_variance", "total_variance")}
    unknown = int(np.isnan(frf.response).any(axis=(1, 2)).sum())
    rows = {
        "outputs x inputs": f"{frf.n_outputs} x {frf.n_inputs}",
        "frequencies": f"{len(frf.frequency_hz)}, {frf.frequency_hz[0]:.4g} Hz to {frf.frequency_hz[-1]:.4g} Hz",
        **({"lines without an estimate": f"{unknown}"} if unknown else {}),
        **{name.replace("_", " "): "measured" if known else "not measured" for name, known in measured.items()},
        "condition of U": _worst(frf.condition),
    }
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows.items())
    try:
        encoded = b64encode(frf.to_svg().encode()).decode()
        picture = f'<img alt="Bode diagram" src="data:image/svg+xml;base64,{encoded}">'
    except ValueError:  # a logarithmic axis has no room for 0 Hz
        picture = ""
    return f"<table><caption>frfid.Frf</caption>{cells}</table>{picture}"


def _worst(condition: Any) -> str:
    known = () if condition is None else condition[~np.isnan(condition)]
    return f"at most {max(known):.3g}" if len(known) else "-"
