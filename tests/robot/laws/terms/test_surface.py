"""Sliding variables and their slopes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import MEASURED_Q, MEASURED_V, QD, S_E, S_V, VD, WORK_ROWS, S
from slidetune.robot.laws.terms.surface import (
    LinearSurface,
    NftsmSurface,
    linear_surface,
    nftsm_surface,
)

Array = np.ndarray
ERRORS = st.lists(st.floats(-5.0, 5.0), min_size=JOINTS, max_size=JOINTS).map(np.array)
NFTSM = NftsmSurface(
    nu=[0.3, 1, 3, 10, 30, 0.01],
    c=[10, 1, 0.05, 2, 50, 5],
    mu=[0.3, 0, 1, 10, 0.1, 2],
    p=[5, 7, 9, 5, 7, 19],
    k=[3, 5, 7, 3, 5, 11],
)
LINEAR = LinearSurface(lambda_=[5, 1, 0.01, 100, 3, 7])
SURFACES = [(NFTSM, nftsm_surface), (LINEAR, linear_surface)]


def surface(
    gains: NftsmSurface | LinearSurface, kernel: Callable, e: Array, de: Array
) -> tuple[Array, Array, Array]:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[QD], work[VD] = 0.7, -0.4
    work[MEASURED_Q], work[MEASURED_V] = work[QD] - e, work[VD] - de
    kernel(gains.pack_surface(), work)
    return work[S].copy(), work[S_V].copy(), work[S_E].copy()


@given(ERRORS, ERRORS)
def test_terminal_sliding_variable_is_equation_5(e: Array, de: Array) -> None:
    nu, c, mu = (np.array(value) for value in (NFTSM.nu, NFTSM.c, NFTSM.mu))
    power = np.divide(NFTSM.p, NFTSM.k)
    expected = nu * e + c * de + mu * np.sign(de) * np.abs(de) ** power
    found = surface(NFTSM, nftsm_surface, e, de)[0]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@given(ERRORS, ERRORS)
def test_linear_sliding_variable(e: Array, de: Array) -> None:
    expected = np.array(LINEAR.lambda_) * e + de
    found = surface(LINEAR, linear_surface, e, de)[0]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("gains", "kernel"), SURFACES)
@given(e=ERRORS, de=ERRORS)
def test_slopes_are_the_derivatives(
    gains: NftsmSurface | LinearSurface, kernel: Callable, e: Array, de: Array
) -> None:
    de = np.where(np.abs(de) < 0.01, 0.01, de)  # at 0 the second derivative is infinite
    _, over_velocity, over_angle = surface(gains, kernel, e, de)
    for slope, first, second in (
        (over_velocity, (e, de + 1e-6), (e, de - 1e-6)),
        (over_angle, (e + 1e-6, de), (e - 1e-6, de)),
    ):
        ahead, behind = surface(gains, kernel, *first)[0], surface(gains, kernel, *second)[0]
        np.testing.assert_allclose(slope, (ahead - behind) / 2e-6, rtol=1e-3, atol=2e-3)


@pytest.mark.parametrize(("gains", "kernel"), SURFACES)
@given(e=ERRORS, de=ERRORS)
def test_surfaces_are_odd(
    gains: NftsmSurface | LinearSurface, kernel: Callable, e: Array, de: Array
) -> None:
    found, mirrored = surface(gains, kernel, e, de), surface(gains, kernel, -e, -de)
    np.testing.assert_allclose(mirrored[0], -found[0], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(mirrored[1], found[1], rtol=1e-9, atol=1e-9)


@given(ERRORS)
def test_terminal_surface_is_not_singular_at_rest(e: Array) -> None:
    _, over_velocity, _ = surface(NFTSM, nftsm_surface, e, np.zeros(JOINTS))
    np.testing.assert_array_equal(over_velocity, NFTSM.c)


def test_terminal_term_vanishes_with_mu() -> None:
    gains = NftsmSurface(nu=5, c=1, mu=0)
    e, de = np.linspace(-1, 1, JOINTS), np.linspace(3, -3, JOINTS)
    linear = surface(LinearSurface(lambda_=5), linear_surface, e, de)
    for found, expected in zip(surface(gains, nftsm_surface, e, de), linear, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-14)
