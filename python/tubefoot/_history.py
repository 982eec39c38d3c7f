# SPDX-License-Identifier: GPL-3.0-or-later
"""What a transmission meets, as arrays: for looking at, and for engines and sensors of one's own."""

from __future__ import annotations

from typing import Optional, Union

import numpy as np

from . import _native
from ._errors import UsageError, whole
from ._scene import PathLike, Scene, a_scene
from ._words import former, with_named_arguments


class Transmission:
    """One transmission of one sensor: the scene's facets, the tubes that it looks through and how it listens.

    Arrays are read-only; large ones share the scene's memory. ``V`` vertices, ``F`` facets, ``R`` rays, ``T`` tubes,
    ``B`` beams that listen to the transmission and ``K`` range samples.
    """

    def __init__(self, native: _native.Transmission) -> None:
        self._native = native

    @property
    def sensor(self) -> str:
        """The sensor's name."""
        return self._native.sensor

    @property
    def ping(self) -> int:
        """The ping, from 0."""
        return self._native.ping

    @property
    def transmission(self) -> int:
        """The transmission of the ping, from 0."""
        return self._native.transmission

    @property
    def energy_shape(self) -> tuple[int, ...]:
        """(B, K): shape of the energies that an engine returns. With two receivers (4, B, K): energies of the upper
        and of the lower one, and real and imaginary part of the mean product of the upper one's signal with the
        conjugate of the lower one's."""
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
        """(B, 3) float64: way from the lower to the upper receiver of each beam in m, east, north, up; the
        transmitter is in its middle. None with one receiver."""
        return self._native.receiver_baseline_m

    @property
    def vertices_m(self) -> np.ndarray:
        """(V, 3) float64: east, north, up of the vertices in m, on the scene's grid."""
        return self._native.vertices_m

    @property
    def facets(self) -> np.ndarray:
        """(F, 3) uint32: vertices of each facet. With relief, or through refracting water, of this transmission's ground; of
        terrain that is read by tiles, those in the tiles that its ping needs."""
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
        """(F,) uint32, a copy: the facet of the scene as loaded, whole, that each facet is, or is a part of."""
        return self._native.base_facet

    @property
    def material_mu(self) -> np.ndarray:
        """(materials,) float64: Lambert parameter mu (linear) by material."""
        return self._native.material_mu

    @property
    def material_names(self) -> list[str]:
        """Names by material."""
        return self._native.material_names

    @property
    def apex_m(self) -> np.ndarray:
        """(3,) float64: where all rays start, east, north, up in m: the sensor's position on the scene's grid."""
        return self._native.apex_m

    @property
    def receiver_apex_m(self) -> np.ndarray:
        """(3,) float64: where the receiver's rays start: :attr:`apex_m`, unless it is apart."""
        return self._native.receiver_apex_m

    @property
    def position_m(self) -> np.ndarray:
        """(3,) float64: the sensor's position, east, north, up in m."""
        return self._native.position_m

    @property
    def attitude(self) -> np.ndarray:
        """(4,) float64: unit quaternion w, x, y, z that turns the sensor's axes (starboard, forward, up) into the
        local frame."""
        return self._native.attitude

    @property
    def rays(self) -> np.ndarray:
        """(R, 3) float64: unit directions of the tubes' corner rays, east, north, up."""
        return self._native.rays

    @property
    def receive_rays(self) -> np.ndarray:
        """(R, 3) float64: the same of the tubes that the receiver hears in, whose rays :attr:`tubes` numbers alike."""
        return self._native.receive_rays

    @property
    def tubes(self) -> np.ndarray:
        """(T, 4) uint32: rays of each tube, counter-clockwise for someone who looks back at the apex."""
        return self._native.tubes

    @property
    def beam_of_tube(self) -> np.ndarray:
        """(T,) uint32: beam of each tube, as the transmission numbers them (a row of the energies)."""
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
        """(K + 1,) float64: slant ranges in m between which the samples lie."""
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
        """When the transmission is fired, s on the scene's clock."""
        return self._native.time_s

    def history(self) -> History:
        """The footprints that the exact engine finds. Computed at each call; other threads run meanwhile."""
        return History(self._native.trace(), self)

    def __repr__(self) -> str:
        return f"<tubefoot.Transmission {self.transmission} of ping {self.ping} of {self.sensor!r}>"


class History:
    """Which part of which facet each tube of a transmission touches first, in order of tubes, then of facets.

    With the receiver apart: which part one tube of the transmitter and one of the receiver both touch first, in order of
    tubes, receive tubes, then facets. Ranges are then half paths; the other measures are as the transmitter sees it.

    Arrays are read-only and share the engine's memory. ``N`` footprints, ``P`` convex pieces that they consist of and
    ``C`` corners of those. Positions are relative to the apex.
    """

    def __init__(self, native: _native.History, transmission: Transmission) -> None:
        self._native = native
        self._transmission = transmission

    @property
    def transmission(self) -> Transmission:
        """The transmission."""
        return self._transmission

    @property
    def shot(self) -> Transmission:
        """The former name of :attr:`transmission`, with a DeprecationWarning."""
        former("shot", "transmission")
        return self._transmission

    @property
    def apex_m(self) -> np.ndarray:
        """(3,) float64: the apex, east, north, up in m."""
        return self._transmission.apex_m

    @property
    def tube(self) -> np.ndarray:
        """(N,) uint32: tube of each footprint."""
        return self._native.tube

    @property
    def receive_tube(self) -> np.ndarray:
        """(N,) uint32: tube that each footprint is heard in: :attr:`tube`, unless the receiver is apart."""
        return self._native.receive_tube

    @property
    def beam(self) -> np.ndarray:
        """(N,) uint32, a copy: beam that hears each footprint, as the transmission numbers them (a row of the energies)."""
        return self._transmission.beam_of_tube[self.receive_tube]

    @property
    def facet(self) -> np.ndarray:
        """(N,) uint32: facet of each footprint."""
        return self._native.facet

    @property
    def area_m2(self) -> np.ndarray:
        """(N,) float64: area in m2."""
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
        """(N, 3) float64: unit normal of the facet, to the apex's side."""
        return self._native.normal

    @property
    def grazing_rad(self) -> np.ndarray:
        """(N,) float64: angle between line of sight and facet at the centroid in rad."""
        return self._native.grazing_rad

    @property
    def range_min_m(self) -> np.ndarray:
        """(N,) float64: slant range of the nearest point in m; half of the shortest path, if the receiver is apart."""
        return self._native.range_min_m

    @property
    def range_max_m(self) -> np.ndarray:
        """(N,) float64: slant range of the farthest point in m; half of the longest path."""
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
        """(N,) uint32: number of pieces of each footprint; their interiors are disjoint."""
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
        """(C, 3) float64: corners of all pieces, counter-clockwise for the apex, relative to it in m."""
        return self._native.corners_m

    @property
    def occluders(self) -> np.ndarray:
        """(N,) uint32: number of facets that hide something of each footprint's facet; not told if the receiver is
        apart."""
        return self._native.occluders

    @property
    def first_occluder(self) -> np.ndarray:
        """(N,) uint32: first of them in :attr:`occluder_facets`."""
        return self._native.first_occluder

    @property
    def occluder_facets(self) -> np.ndarray:
        """(any,) uint32: the facets that hide something, footprint by footprint."""
        return self._native.occluder_facets

    def polygons_m(self, footprint: int) -> list[np.ndarray]:
        """The pieces of a footprint: arrays (corners, 3) float64, east, north, up in m in the scene's frame."""
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
    """One transmission of a ping of a sensor, both counted from 0. The scene may be the name of its file.

    Raises:
        InputError: the scene is wrong.
        UsageError: there is no such sensor, ping or transmission.
    """
    known = a_scene(scene)
    with known._explained():
        return Transmission(known._native.transmission(sensor, _counted("ping", ping), _counted("transmission", transmission)))


@with_named_arguments
def history(scene: Union[Scene, PathLike], sensor: str, ping: int = 0, transmission: int = 0) -> History:
    """The footprints of one transmission, found by the exact engine; as :func:`transmission`."""
    known = a_scene(scene)
    with known._explained():
        return Transmission(known._native.transmission(sensor, _counted("ping", ping), _counted("transmission", transmission))).history()


def _counted(name: str, number: int) -> int:
    if whole(name, number) < 0:
        raise UsageError(f"{name} {number}: counted from 0")
    return whole(name, number)
