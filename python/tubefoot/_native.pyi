# SPDX-License-Identifier: GPL-3.0-or-later
from collections.abc import Callable
from typing import Any, Optional, Union

import numpy as np

version: str

class Scene:
    title: str
    file: str
    hash: str
    sensors: list[str]
    materials: list[str]
    components: list[str]
    def warnings(self) -> list[tuple[str, bool]]: ...
    def pings(self, sensor: str) -> int: ...
    def transmissions(self, sensor: str) -> int: ...
    def transmission(self, sensor: str, ping: int, transmission: int) -> Transmission: ...

class Transmission:
    sensor: str
    ping: int
    transmission: int
    frequency_khz: float
    sound_speed_m_s: float
    absorption_db_per_m: float
    time_s: float
    receiver_baseline_m: Optional[np.ndarray]
    apex_m: np.ndarray
    receiver_apex_m: np.ndarray
    position_m: np.ndarray
    attitude: np.ndarray
    beams: np.ndarray
    beam_azimuth_rad: np.ndarray
    beam_elevation_rad: np.ndarray
    range_edges_m: np.ndarray
    rays: np.ndarray
    receive_rays: np.ndarray
    tubes: np.ndarray
    beam_of_tube: np.ndarray
    vertices_m: np.ndarray
    facets: np.ndarray
    base_facet: np.ndarray
    material: np.ndarray
    component: np.ndarray
    material_mu: np.ndarray
    material_names: list[str]
    def trace(self) -> History: ...

class History:
    tube: np.ndarray
    receive_tube: np.ndarray
    facet: np.ndarray
    area_m2: np.ndarray
    solid_angle_sr: np.ndarray
    centroid_m: np.ndarray
    normal: np.ndarray
    plane_distance_m: np.ndarray
    receive_distance_m: np.ndarray
    grazing_rad: np.ndarray
    range_min_m: np.ndarray
    range_max_m: np.ndarray
    first_piece: np.ndarray
    pieces: np.ndarray
    first_occluder: np.ndarray
    occluders: np.ndarray
    piece_first_corner: np.ndarray
    piece_corners: np.ndarray
    corners_m: np.ndarray
    occluder_facets: np.ndarray

class Result:
    sensors: list[str]
    statistics: str
    warnings: list[str]
    def arrays(self, sensor: int) -> dict[str, np.ndarray]: ...
    def axes(self, sensor: int) -> dict[str, np.ndarray]: ...
    def received(self, sensor: int, lower: bool) -> Optional[np.ndarray]: ...
    def labels(self, sensor: int) -> Optional[dict[str, Any]]: ...
    def signals(self, sensor: int) -> Optional[Signals]: ...
    def attributes(self, sensor: int) -> dict[str, Any]: ...
    def file_attributes(self) -> dict[str, Any]: ...
    def dimensions(self, sensor: int) -> dict[str, tuple[tuple[str, ...], str, str]]: ...

class Picture:
    title: str
    def pixels(self) -> np.ndarray: ...
    def png(self) -> bytes: ...
    def write(self, file: str) -> None: ...

class Coverage:
    title: str
    pings: list[tuple[str, int]]
    facets_of_scene: int
    by_pings: dict[int, float]
    component_names: list[str]
    material_names: list[str]
    def columns(self) -> dict[str, np.ndarray]: ...
    def depths(self) -> dict[str, np.ndarray]: ...
    def picture(self) -> Picture: ...

class Footprints:
    sensor: str
    first_piece: np.ndarray
    first_corner: np.ndarray
    first_occluder: np.ndarray
    corners_m: np.ndarray
    occluders: np.ndarray
    map_corners: np.ndarray
    crs_wkt: str
    component_names: list[str]
    material_names: list[str]
    def columns(self) -> list[tuple[str, str, str, np.ndarray]]: ...

class Signals:
    def arrays(self) -> dict[str, np.ndarray]: ...
    def numbers(self) -> dict[str, Any]: ...
    def beams(self, pings: list[int], directions: np.ndarray, weights: np.ndarray, reference: list[float],
              near_field: bool, by_phase: bool, band: float, error: float) -> np.ndarray: ...
    def focused(self, first: list[float], column_step: list[float], row_step: list[float], columns: int, rows: int,
                ping_weights: np.ndarray, receiver_weights: np.ndarray, half_beam_rad: Optional[float],
                spreading_undone: bool, band: float, error: float) -> np.ndarray: ...
    def matched_filtered(self, window: str, side_lobe_db: float, nearly_equal: int) -> Signals: ...
    def write(self, file: str) -> None: ...

_Progress = Optional[Callable[[int, int], Any]]

def absolute_path(file: str) -> str: ...
def nearest(word: str, candidates: list[str]) -> str: ...
def read_scene(file: str, confined: bool) -> Scene: ...
def parse_scene(text: str, file: str, facets: list[tuple[bool, int, np.ndarray, np.ndarray]]) -> Scene: ...
def run(scene: Scene, options: dict[str, Any], own_name: Optional[str], own: Optional[Callable[[Transmission], np.ndarray]],
        progress: _Progress, warned: Callable[[str, bool], Any]) -> Result: ...
def open(result: str) -> Result: ...
def picture(result: Result, sensor: int, pings: Optional[list[int]], ping: Optional[int], title: str) -> Picture: ...
def coverage(scene: Scene, sensor: Optional[str], pings: str, output: str) -> Coverage: ...
def advise(scene: Scene, tolerance: str, pings: str, trial_pings: int, threads: Optional[int]) -> str: ...
def footprints(scene: Scene, sensor: str, pings: str, beams: str, progress: _Progress) -> Footprints: ...
def compare(reference: Union[Result, str], candidate: Union[Result, str], sensor: Optional[str], worst: int,
            any_scene: bool) -> str: ...
def chart(asked: dict[str, Any], progress: _Progress) -> list[dict[str, Any]]: ...
def gradient(scene: Scene, weights: list[Optional[np.ndarray]], threads: Optional[int], progress: _Progress) -> dict[str, Any]: ...
def gradient_parameters(scene: Scene) -> list[tuple[str, str, str]]: ...
def read_signals(file: str) -> Signals: ...
def point_signals(targets: np.ndarray, strengths: np.ndarray, transmitter: list[float], receivers: np.ndarray,
                  waveform: list[float], baseband_hz: float, rate_hz: float, first_s: float, samples: int,
                  track_times: np.ndarray, positions: np.ndarray, attitudes: np.ndarray, ping_times: np.ndarray,
                  stop_and_hop: bool, sound_speed: float) -> Signals: ...
def window_weights(window: str, elements: int, side_lobe_db: float, nearly_equal: int) -> np.ndarray: ...
