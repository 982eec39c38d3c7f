# SPDX-License-Identifier: GPL-3.0-or-later
"""Energies as a function of JAX that has derivatives by the heights of a seabed."""

import jax
import jax.numpy as jnp
import numpy as np

import heights as seabed

jax.config.update("jax_enable_x64", True)
SHAPE = jax.ShapeDtypeStruct((1, 8, 24), jnp.float64)  # of the energies: pings, beams, range bins


@jax.custom_vjp
def energies(heights):
    return jax.pure_callback(lambda h: seabed.energies(np.asarray(h)), SHAPE, heights)


def _forward(heights):
    return energies(heights), heights


def _backward(heights, weights):
    slope = jax.pure_callback(lambda h, w: seabed.by_heights(np.asarray(h), np.asarray(w)),
                              jax.ShapeDtypeStruct(heights.shape, jnp.float64), heights, weights)
    return (slope,)


energies.defvjp(_forward, _backward)

if __name__ == "__main__":
    bumps = jnp.zeros((12, 12)).at[5:7, 4:6].set(0.4)
    print("the derivative of the logarithm of the whole energy by the heights in rows 4 to 7:")
    print(jax.grad(lambda h: jnp.log(energies(h).sum()))(bumps)[4:8])
