# SPDX-License-Identifier: GPL-3.0-or-later
"""One image of simple_sonar_simulator: simple_sonar_images.py RUN.yaml, with its sources in PYTHONPATH.

The simulator reads all files and computes the image. Its own program needs two poses and computes an image for each; this one
computes the image of the first pose only, because an image takes minutes.
"""
import sys

from sonar_sim.data_classes import RunConfig, SonarConfig
from sonar_sim.scene_loader import load_scene
from sonar_sim.sonar_simulator import SonarSimulator
from sonar_sim.trajectory_loader import load_trajectory

run = RunConfig.from_yaml(sys.argv[1])
poses, _ = load_trajectory(run.trajectory_file)
simulator = SonarSimulator(SonarConfig.from_yaml(run.sonar_config_file), load_scene(run.scene_file))
simulator.run_simulation(poses[:1], run.output_folder, run.name, run.normalize, run.smoothing_sigma)
