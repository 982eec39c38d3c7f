# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples of PyTorch and JAX (docs/examples/gradients). Each needs its package."""

import importlib
import sys

import numpy as np
import pytest

from conftest import SOURCES

STEP = 2.0**-12  # in metres; a multiple of the grid unit


@pytest.fixture(scope="module")
def bumps():
    heights = 2.0**-6 * np.random.default_rng(41).integers(-8, 9, size=(12, 12))
    heights[5:7, 4:6] += 0.375
    return heights


@pytest.fixture(scope="module", autouse=True)
def examples():
    sys.path.insert(0, str(SOURCES / "docs/examples/gradients"))
    yield
    sys.path.pop(0)


def check(slope, energies, bumps):
    """The derivative of the logarithm of the whole energy, against central differences by three heights."""
    largest = np.abs(slope).max()
    for row, column in ((5, 4), (6, 6), (4, 7)):
        moved = np.zeros_like(bumps)
        moved[row, column] = STEP
        difference = (np.log(energies(bumps + moved).sum()) - np.log(energies(bumps - moved).sum())) / (2 * STEP)
        assert abs(difference - slope[row, column]) < 1e-3 * largest


def test_heights_have_derivatives(bumps):
    seabed = importlib.import_module("heights")
    energies = seabed.energies(bumps)
    check(seabed.by_heights(bumps, np.full(energies.shape, 1 / energies.sum())), seabed.energies, bumps)


def test_torch(bumps):
    torch = pytest.importorskip("torch")
    example = importlib.import_module("with_torch")
    heights = torch.tensor(bumps, requires_grad=True)
    torch.log(example.Energies.apply(heights).sum()).backward()
    check(heights.grad.numpy(), importlib.import_module("heights").energies, bumps)


def test_jax(bumps):
    jax = pytest.importorskip("jax")
    example = importlib.import_module("with_jax")
    slope = jax.grad(lambda h: jax.numpy.log(example.energies(h).sum()))(jax.numpy.asarray(bumps))
    check(np.asarray(slope), importlib.import_module("heights").energies, bumps)
