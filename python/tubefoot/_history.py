# SPDX-License-Identifier: GPL-3.0-or-later
"""Transmissions and their footprints as arrays, for inspection and for custom engines and sensors."""

from __future__ import annotations

from typing import Optional, Union

import numpy as np

from . import _native
from ._errors import UsageError, whole
from ._scene import PathLike, Scene, a_scene
from ._words import former, with_named_arguments


class Transmission:
    """One transmission of a sensor: the facets of the scene, the sensor's tubes, its pose and its reception.

    Arrays are read-only, and large arrays share the scene's memory. ``V`` is the number of vertices, ``F`` of facets, ``R``
    of rays and ``T`` of tubes. ``B`` is the number of beams that receive the transmission, and ``K`` the number of range
    samples.
    """

    def __init__(self, native: _native.Transmission) -> None:
        self._native = native

    @property
    def sensor(self) -> str:
        """Name of the sensor."""
        return self._native.sensor

    @property
    def ping(self) -> int:
        """Number of the ping, counted from 0."""
        return self._native.ping

    @property
    def transmission(self) -> int:
        """Number of the transmission within its ping, counted from 0."""
        return self._native.transmission

    @property
    def energy_shape(self) -> tuple[int, ...]:
        """(B, K): shape of the energies that an engine returns. With two receivers the shape is (4, B, K).

        The first two channels are the energies of the upper and of the lower receiver. The other two are the real and the
        imaginary part of a mean product: the upper receiver's signal times the conjugate of the lower receiver's signal.
        """
        cells = len(self._native.beams), len(self._native.range_edges_m) - 1
        return cells if self.receiver_baseline_m is None else (4, *cells)

    @property
    def shot(self) -> int:
        """The former name of :attr:`transmission`, with a DeprecationWarning."""
        former("shot", "transmission")
        return self.transmission

    @property
    def staff_m(self) -> Optional[np.ndarray]:
        """(B, 3) float64: the former name of :attr:`receiver_baseline_m`, with a DeprecationWarning."""
        former("staff_m", "receiver_baseline_m")
        return self.receiver_baseline_m

    @property
    def receiver_baseline_m(self) -> Optional[np.ndarray]:
        """(B, 3) float64: vector from the lower to the upper receiver of each beam in m, east, north, up.

        The transmitter is at the midpoint of this vector. The property is None with one receiver.
        """
        return self._native.receiver_baseline_m

    @property
    def vertices_m(self) -> np.ndarray:
        """(V, 3) float64: east, north, up of the vertices in m, on the scene's grid."""
        return self._native.vertices_m

    @property
    def facets(self) -> np.ndarray:
        """(F, 3) uint32: vertices of each facet.

        With relief or refraction, the facets are those of the transmission's own surface mesh. For terrain in tiles, the
        facets are those of the tiles that the ping needs.
        """
        return self._native.facets

    @property
    def material(self) -> np.ndarray:
        """(F,) uint16: material of each facet."""
        return self._native.material

    @property
    def component(self) -> np.ndarray:
        """(F,) uint16: terrain or object of each facet."""
        return self._native.component

    @property
    def base_facet(self) -> np.ndarray:
        """(F,) uint32, a copy: the identical or enclosing facet of the loaded scene, for each facet."""
        return self._native.base_facet

    @property
    def material_mu(self) -> np.ndarray:
        """(materials,) float64: Lambert parameter mu (linear) of each material."""
        return self._native.material_mu

    @property
    def material_names(self) -> list[str]:
        """Name of each material."""
        return self._native.material_names

    @property
    def apex_m(self) -> np.ndarray:
        """(3,) float64: origin of all rays in m, east, north, up. It is the sensor's position on the scene's grid."""
        return self._native.apex_m

    @property
    def receiver_apex_m(self) -> np.ndarray:
        """(3,) float64: origin of the receiver's rays in m. It equals :attr:`apex_m` unless the sonar is bistatic."""
        return self._native.receiver_apex_m

    @property
    def position_m(self) -> np.ndarray:
        """(3,) float64: position of the sensor in m, east, north, up."""
        return self._native.position_m

    @property
    def attitude(self) -> np.ndarray:
        """(4,) float64: unit quaternion w, x, y, z that rotates the sensor's axes (starboard, forward, up) into the local
        frame."""
        return self._native.attitude

    @property
    def rays(self) -> np.ndarray:
        """(R, 3) float64: unit directions of the tubes' corner rays, east, north, up."""
        return self._native.rays

    @property
    def receive_rays(self) -> np.ndarray:
        """(R, 3) float64: unit directions of the corner rays of the receiver's tubes. The indices in :attr:`tubes` apply."""
        return self._native.receive_rays

    @property
    def tubes(self) -> np.ndarray:
        """(T, 4) uint32: rays of each tube, counter-clockwise for a viewer who looks back at the apex."""
        return self._native.tubes

    @property
    def beam_of_tube(self) -> np.ndarray:
        """(T,) uint32: beam of each tube, numbered within the transmission (a row of the energies)."""
        return self._native.beam_of_tube

    @property
    def beams(self) -> np.ndarray:
        """(B,) uint32: the sensor's number of each beam of the transmission."""
        return self._native.beams

    @property
    def beam_azimuth_rad(self) -> np.ndarray:
        """(B,) float64: azimuth of each beam's axis in the sensor's frame in rad, clockwise from forward."""
        return self._native.beam_azimuth_rad

    @property
    def beam_elevation_rad(self) -> np.ndarray:
        """(B,) float64: elevation of each beam's axis in rad, upwards."""
        return self._native.beam_elevation_rad

    @property
    def range_edges_m(self) -> np.ndarray:
        """(K + 1,) float64: slant ranges in m that separate the range samples."""
        return self._native.range_edges_m

    @property
    def frequency_khz(self) -> float:
        """Acoustic frequency in kHz."""
        return self._native.frequency_khz

    @property
    def sound_speed_m_s(self) -> float:
        """Sound speed at the sensor in m/s."""
        return self._native.sound_speed_m_s

    @property
    def absorption_db_per_m(self) -> float:
        """One-way absorption in dB per m."""
        return self._native.absorption_db_per_m

    @property
    def time_s(self) -> float:
        """Time of the transmission in s on the scene's clock."""
        return self._native.time_s

    def history(self) -> History:
        """Computes the footprints with the exact engine.

        Each call repeats the computation. Other Python threads continue during a call.
        """
        return History(self._native.trace(), self)

    def __repr__(self) -> str:
        return f"<tubefoot.Transmission {self.transmission} of ping {self.ping} of {self.sensor!r}>"


class History:
    """Visible footprints of a transmission, in order of tubes, then of facets.

    A footprint is the part of a facet that a tube meets first. In a bistatic history, one tube of the transmitter and one
    tube of the receiver both meet this part first. The rows of a bistatic history are in order of tubes, receive tubes, then
    facets. Its ranges are half of the path length, and its other measures refer to the transmitter.

    Arrays are read-only and share the engine's memory. ``N`` is the number of footprints, ``P`` the number of their convex
    pieces, and ``C`` the number of corners of these pieces. Positions are relative to the apex.
    """

    def __init__(self, native: _native.History, transmission: Transmission) -> None:
        self._native = native
        self._transmission = transmission

    @property
    def transmission(self) -> Transmission:
        """The transmission of this history."""
        return self._transmission

    @property
    def shot(self) -> Transmission:
        """The former name of :attr:`transmission`, with a DeprecationWarning."""
        former("shot", "transmission")
        return self._transmission

    @property
    def apex_m(self) -> np.ndarray:
        """(3,) float64: position of the apex in m, east, north, up."""
        return self._transmission.apex_m

    @property
    def tube(self) -> np.ndarray:
        """(N,) uint32: tube of each footprint."""
        return self._native.tube

    @property
    def receive_tube(self) -> np.ndarray:
        """(N,) uint32: tube that receives each footprint. It equals :attr:`tube` unless the sonar is bistatic."""
        return self._native.receive_tube

    @property
    def beam(self) -> np.ndarray:
        """(N,) uint32, a copy: beam that receives each footprint, numbered within the transmission (a row of the
        energies)."""
        return self._transmission.beam_of_tube[self.receive_tube]

    @property
    def facet(self) -> np.ndarray:
        """(N,) uint32: facet of each footprint."""
        return self._native.facet

    @property
    def area_m2(self) -> np.ndarray:
        """(N,) float64: area in m²."""
        return self._native.area_m2

    @property
    def solid_angle_sr(self) -> np.ndarray:
        """(N,) float64: solid angle at the apex in sr."""
        return self._native.solid_angle_sr

    @property
    def centroid_m(self) -> np.ndarray:
        """(N, 3) float64: centroid of the area, relative to the apex in m."""
        return self._native.centroid_m

    @property
    def normal(self) -> np.ndarray:
        """(N, 3) float64: unit normal of the facet on the side of the apex."""
        return self._native.normal

    @property
    def grazing_rad(self) -> np.ndarray:
        """(N,) float64: angle between the line of sight and the facet at the centroid in rad."""
        return self._native.grazing_rad

    @property
    def range_min_m(self) -> np.ndarray:
        """(N,) float64: slant range of the nearest point in m. For a bistatic sonar it is half of the shortest path."""
        return self._native.range_min_m

    @property
    def range_max_m(self) -> np.ndarray:
        """(N,) float64: slant range of the farthest point in m. For a bistatic sonar it is half of the longest path."""
        return self._native.range_max_m

    @property
    def receive_distance_m(self) -> np.ndarray:
        """(N,) float64: distance of the receiver from the facet's plane in m."""
        return self._native.receive_distance_m

    @property
    def first_piece(self) -> np.ndarray:
        """(N,) uint32: first piece of each footprint."""
        return self._native.first_piece

    @property
    def pieces(self) -> np.ndarray:
        """(N,) uint32: number of pieces of each footprint. The interiors of the pieces are disjoint."""
        return self._native.pieces

    @property
    def piece_first_corner(self) -> np.ndarray:
        """(P,) uint32: first corner of each piece."""
        return self._native.piece_first_corner

    @property
    def piece_corners(self) -> np.ndarray:
        """(P,) uint32: number of corners of each piece, at least 3."""
        return self._native.piece_corners

    @property
    def corners_m(self) -> np.ndarray:
        """(C, 3) float64: corners of all pieces in m, relative to the apex; counter-clockwise as seen from the apex."""
        return self._native.corners_m

    @property
    def occluders(self) -> np.ndarray:
        """(N,) uint32: number of facets that hide a part of each footprint's facet.

        Bistatic histories do not report occluders.
        """
        return self._native.occluders

    @property
    def first_occluder(self) -> np.ndarray:
        """(N,) uint32: index of each footprint's first occluder in :attr:`occluder_facets`."""
        return self._native.first_occluder

    @property
    def occluder_facets(self) -> np.ndarray:
        """(any,) uint32: facets that hide a part of a footprint's facet, in order of footprints."""
        return self._native.occluder_facets

    def polygons_m(self, footprint: int) -> list[np.ndarray]:
        """Returns the pieces of a footprint: arrays (corners, 3) float64, east, north, up in m in the scene's frame."""
        first = int(self.first_piece[footprint])
        pieces = range(first, first + int(self.pieces[footprint]))
        starts, counts = self.piece_first_corner, self.piece_corners
        return [self.apex_m + self.corners_m[starts[p]:starts[p] + counts[p]] for p in pieces]

    def __len__(self) -> int:
        return len(self.tube)

    def __repr__(self) -> str:
        return f"<tubefoot.History of {self._transmission!r}: {len(self)} footprints>"


@with_named_arguments
def transmission(scene: Union[Scene, PathLike], sensor: str, ping: int = 0, transmission: int = 0) -> Transmission:
    """Returns one transmission of a ping of a sensor.

    Pings and transmissions are counted from 0. The scene may be the name of its file.

    Raises:
        InputError: the scene is invalid.
        UsageError: the sensor, ping or transmission does not exist.
    """
    known = a_scene(scene)
    with known._explained():
        return Transmission(known._native.transmission(sensor, _counted("ping", ping), _counted("transmission", transmission)))


@with_named_arguments
def history(scene: Union[Scene, PathLike], sensor: str, ping: int = 0, transmission: int = 0) -> History:
    """Computes the footprints of one transmission with the exact engine.

    Arguments and errors are those of :func:`transmission`.
    """
    known = a_scene(scene)
    with known._explained():
        return Transmission(known._native.transmission(sensor, _counted("ping", ping), _counted("transmission", transmission))).history()


def _counted(name: str, number: int) -> int:
    if whole(name, number) < 0:
        raise UsageError(f"{name} {number}: expected 0 or more")
    return whole(name, number)
