"""The fold of the nonimpacting orbits of Mita's actuator at ω = 0.45, by shooting with SciPy (DOP853 at the
limit of double precision): the reference of `auto.py`, independent of both programs compared there.

At the fold the map over one period T = π/ω has the multiplier 1: the unknowns (q, u, V, β) solve
φ(q, u) = (q, u) and φ'(q, u) v = v with v = (cos β, sin β).
"""

import numpy as np
from scipy.integrate import solve_ivp

OMEGA, DAMPING = 0.45, 0.04
PERIOD = np.pi / OMEGA


def rate(t, state, voltage):
    """The field (q, u) and its variational equation along (state[2], state[3])."""
    q, u, dq, du = state
    force = (voltage * np.sin(OMEGA * t)) ** 2 / (1 - q) ** 2
    stiffness = 1 - 2 * force / (1 - q)
    return [u, force - q - DAMPING * u, du, -stiffness * dq - DAMPING * du]


def residual(unknowns):
    """φ(q, u) − (q, u) and φ'(q, u) v − v."""
    q, u, voltage, angle = unknowns
    start = np.array([q, u, np.cos(angle), np.sin(angle)])
    flow = solve_ivp(rate, (0, PERIOD), start, "DOP853", args=(voltage,), rtol=2.3e-14, atol=1e-17,
                     max_step=PERIOD / 80)
    return flow.y[:, -1] - start


unknowns = np.array([-0.27927944, -0.12112125, 0.23556543, 0.68669638])
for _ in range(5):
    value, step = residual(unknowns), 1e-7
    jacobian = np.array([(residual(unknowns + step * e) - value) / step for e in np.eye(4)]).T
    correction = np.linalg.solve(jacobian, -value)
    unknowns = unknowns + correction
    print(f"V = {unknowns[2]:.16f}   last correction {abs(correction).max():.1e}")
