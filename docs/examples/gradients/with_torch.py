# SPDX-License-Identifier: GPL-3.0-or-later
"""Energies as a function of PyTorch that has derivatives by the heights of a seabed."""

import torch

import heights as seabed


class Energies(torch.autograd.Function):
    @staticmethod
    def forward(context, heights):
        context.save_for_backward(heights)
        return torch.from_numpy(seabed.energies(heights.detach().numpy()))

    @staticmethod
    def backward(context, weights):
        (heights,) = context.saved_tensors
        return torch.from_numpy(seabed.by_heights(heights.detach().numpy(), weights.numpy()))


if __name__ == "__main__":
    heights = torch.zeros((12, 12), dtype=torch.float64)
    heights[5:7, 4:6] = 0.4
    heights.requires_grad_()
    loss = torch.log(Energies.apply(heights).sum())
    loss.backward()
    print("the derivative of the logarithm of the whole energy by the heights in rows 4 to 7:")
    print(heights.grad[4:8])
