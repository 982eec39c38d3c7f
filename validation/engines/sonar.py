# SPDX-License-Identifier: GPL-3.0-or-later
"""What an engine is told of a scene: triangles, their strength, and the sonar."""
import pathlib
import tomllib

import netCDF4
import numpy as np


class Unsupported(Exception):
    """A scene has what these engines cannot do; the message says what."""


class Scene:
    """Triangles in metres (n, 3, 3), the strength mu of each (Lambert), and which object each belongs to."""

    def __init__(self, path):
        self.path = path = pathlib.Path(path)
        told = tomllib.loads(path.read_text())
        strange = sorted(set(told) & {"terrain", "mirrors", "relief"})
        if strange:
            raise Unsupported(f"{path}: these engines read meshes only, no {', '.join(strange)}")
        self.absorption_db_per_km = told.get("water", {}).get("absorption_db_per_km")
        if self.absorption_db_per_km is None:
            raise Unsupported(f"{path}: [water] must say absorption_db_per_km")
        strength = {}
        for material in told["materials"]:
            if set(material) != {"name", "lambert_db"}:
                raise Unsupported(f"{path}: material '{material['name']}' is no plain Lambert's: only lambert_db is known here")
            strength[material["name"]] = 10 ** (material["lambert_db"] / 10)
        triangles, mu, owner, self.objects = [], [], [], []
        for thing in told["objects"]:
            strange = sorted(set(thing) - {"name", "shape", "material", "file", "position_m"})
            if strange or thing["shape"] != "mesh":
                raise Unsupported(f"{path}: object '{thing['name']}': only meshes with a position_m are known here")
            mesh = read_obj(path.parent / thing["file"]) + np.array(thing.get("position_m", [0, 0, 0]), float)
            triangles.append(mesh)
            mu.append(np.full(len(mesh), strength[thing["material"]]))
            owner.append(np.full(len(mesh), len(self.objects)))
            self.objects.append(thing["name"])
        self.triangles, self.mu, self.owner = np.concatenate(triangles), np.concatenate(mu), np.concatenate(owner)
        normal = np.cross(self.triangles[:, 1] - self.triangles[:, 0], self.triangles[:, 2] - self.triangles[:, 0])
        length = np.linalg.norm(normal, axis=1)
        kept = length > 0
        self.triangles, self.mu, self.owner = self.triangles[kept], self.mu[kept], self.owner[kept]
        self.area = length[kept] / 2
        self.normal = normal[kept] / length[kept, None]

    def has_flat_bed(self):
        """Whether 100 m² or more are horizontal."""
        return bool(self.area[np.abs(self.normal[:, 2]) > 0.999].sum() >= 100)


def read_obj(path):
    """The triangles of an OBJ file of vertices and triangles."""
    vertices, faces = [], []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "v":
            vertices.append([float(w) for w in words[1:4]])
        elif words[0] == "f" and len(words) == 4:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
        else:
            raise Unsupported(f"{path}:{number}: only vertices and triangles are read here, not '{words[0]}'")
    return np.array(vertices)[np.array(faces)]


class Sonar:
    """The sonar of an echo file at one ping. Azimuths grow to starboard, beam 0 is port-most; radians and metres."""

    def __init__(self, path, ping=0):
        self.ping = ping
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            self.shape = file["energy"].shape[1:]
            self.azimuth_deg = file["beam_azimuth"][:]
            width = file["beam_azimuth_width"][:]
            self.slant_range = file["slant_range"][:]
            self.edges = np.append(file["slant_range_bounds"][:, 0], file["slant_range_bounds"][-1, 1])
            self.height = float(np.radians(file["beam_elevation_width"][0]))
            self.apex = file["sensor_position"][ping]
            w, x, y, z = file["sensor_attitude"][ping]
            self.absorption_db_per_km = float(file.absorption_db_per_km)
        self.beams, self.samples = self.shape
        self.azimuth, self.width = np.radians(self.azimuth_deg), float(np.radians(width[0]))
        self.half_fan = float(self.azimuth[-1] + self.width / 2)
        self.step = float(self.edges[1] - self.edges[0])
        if not np.allclose(np.diff(self.azimuth), self.width, atol=1e-9) or not np.allclose(np.diff(self.edges), self.step):
            raise Unsupported(f"{path}: these engines know equiangular beams and equal samples only")
        # Columns: starboard, forward, up, in the scene's axes.
        self.axes = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                              [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                              [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])

    def directions(self, azimuth, elevation):
        """Unit vectors in the scene's axes."""
        azimuth, elevation = np.broadcast_arrays(azimuth, elevation)
        ahead = np.cos(elevation)
        return np.stack([np.sin(azimuth) * ahead, np.cos(azimuth) * ahead, np.sin(elevation)], axis=-1) @ self.axes.T

    def seen_from_here(self, points):
        """Range, azimuth and elevation of points."""
        x, y, z = ((points - self.apex) @ self.axes).T
        return np.sqrt(x * x + y * y + z * z), np.arctan2(x, y), np.arctan2(z, np.hypot(x, y))

    def bin_of(self, ranges):
        """The sample that a range lies in, or -1."""
        index = np.floor((ranges - self.edges[0]) / self.step).astype(int)
        return np.where((index >= 0) & (index < self.samples), index, -1)

    def summed(self, beam, sample, values):
        """Sum and number of values for each beam and sample; those of sample -1 are outside."""
        inside = (sample >= 0) & (sample < self.samples) & (beam >= 0) & (beam < self.beams)
        where = beam[inside] * self.samples + sample[inside]
        bins = self.beams * self.samples
        return (np.bincount(where, values[inside], bins).reshape(self.shape),
                np.bincount(where, minlength=bins).reshape(self.shape))

    def mean(self, beam, sample, values):
        """The mean for each beam and sample, 0 where nothing fell."""
        total, count = self.summed(beam, sample, values)
        return total / np.maximum(count, 1)
