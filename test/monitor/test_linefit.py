"""Line fit where rounding leaves its matrix indefinite."""

import numpy as np
import pytest

from nw_gear_monitor.signals.linefit import RIDGES, _factor


@pytest.mark.parametrize("smallest", [1.0, 1e-6, 0.0, -1e-8, -0.33])
def test_a_matrix_is_factored_however_rounding_has_left_it(smallest):
    rng = np.random.default_rng(1)
    vectors, _ = np.linalg.qr(rng.standard_normal((30, 30)))
    values = np.append(np.linspace(0.5, 4.0, 29), smallest)
    factor, lower = _factor((vectors * values) @ vectors.T)
    assert not lower
    upper = np.triu(factor)
    found = np.linalg.eigvalsh(upper.T @ upper)
    assert found[0] > 0.0
    assert found[1:] == pytest.approx(np.sort(values)[1:], abs=2.0 * RIDGES[-1])
