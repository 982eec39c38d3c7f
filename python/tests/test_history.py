# SPDX-License-Identifier: GPL-3.0-or-later
"""Histories and footprints as arrays: closed forms, the command's files, and whose memory it is."""

import gc

import geopandas
import netCDF4
import numpy as np
import pytest

import tubefoot


def areas(polygon):
    """Of a planar polygon in space."""
    return np.linalg.norm(np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0]).sum(axis=0)) / 2


@pytest.fixture
def flat(keys):
    """A bed that fills all of the camera's sector."""
    keys["objects"] = []
    keys["terrain"].update(width_m=200, length_m=200)
    return tubefoot.Scene.from_dict(keys)


def test_footprints_of_a_flat_bed(flat):
    history = tubefoot.history(flat, "camera", ping=1)
    transmission = history.transmission
    assert transmission.position_m == pytest.approx([0, 0.2, 2]) and transmission.time_s == pytest.approx(0.2)
    assert transmission.apex_m == pytest.approx(transmission.position_m, abs=1e-6)
    # The bed is seen whole: a tube's solid angle is that between its rays.
    a, b, c, d = (transmission.rays[transmission.tubes[:, k]] for k in range(4))

    def solid_angle(x, y, z):
        triple = np.einsum("ij,ij->i", x, np.cross(y, z))
        return 2 * np.arctan2(np.abs(triple), 1 + sum(np.einsum("ij,ij->i", p, q) for p, q in ((x, y), (y, z), (z, x))))
    whole = solid_angle(a, b, c) + solid_angle(a, c, d)
    found = np.bincount(history.tube, history.solid_angle_sr, len(transmission.tubes))
    assert found == pytest.approx(whole, rel=1e-9)
    # Straight down it is 2 m to the bed; lines of sight go down.
    assert history.centroid_m[:, 2] == pytest.approx(-2, abs=1e-5)
    ranges = np.linalg.norm(history.centroid_m, axis=1)
    assert np.sin(history.grazing_rad) == pytest.approx(2 / ranges, rel=1e-5)
    assert (history.range_min_m < ranges).all() and (ranges < history.range_max_m).all()
    assert np.tile([0, 0, 1], (len(history), 1)) == pytest.approx(history.normal)


def test_pieces_are_polygons_of_the_footprints_area(scene):
    history = tubefoot.history(scene, "camera")
    assert len(history) > 8 and history.pieces.sum() == len(history.piece_corners)
    for i in range(len(history)):
        polygons = history.polygons_m(i)
        assert sum(map(areas, polygons)) == pytest.approx(history.area_m2[i], rel=1e-9)
        # They lie on the facet.
        corners = np.concatenate(polygons)
        facet = history.transmission.vertices_m[history.transmission.facets[history.facet[i]]]
        normal = np.cross(facet[1] - facet[0], facet[2] - facet[0])
        assert (corners - facet[0]) @ normal / np.linalg.norm(normal) == pytest.approx(0, abs=1e-9)
    # The tetrahedron hides some of the bed, and nothing hides the tetrahedron's front.
    on_bed = history.transmission.component[history.facet] == 0
    hides = set()
    for i in np.flatnonzero(on_bed & (history.occluders > 0)):
        first = history.first_occluder[i]
        hides.update(history.occluder_facets[first:first + history.occluders[i]])
    assert hides and all(history.transmission.component[f] == 1 for f in hides)


def test_facets_are_those_of_the_scene(scene):
    transmission = tubefoot.transmission(scene, "side", 1)
    assert scene.components == ["terrain", "thing"] and transmission.material_names == ["sand", "steel"]
    assert transmission.facets.shape == (6, 3) and list(transmission.component) == [0, 0, 1, 1, 1, 1]
    assert list(transmission.material) == [0, 0, 1, 1, 1, 1]
    assert transmission.material_mu == pytest.approx([10**-2.7, 0.1])
    assert transmission.vertices_m[transmission.facets[2]] == pytest.approx(np.array([[0, 3, 0], [0, 4, 0], [1, 3, 0]]), abs=1e-6)
    assert transmission.energy_shape == (2, 100) and len(transmission.range_edges_m) == 101
    assert (transmission.range_edges_m[0], transmission.range_edges_m[-1]) == pytest.approx((0.5, 12))
    assert sorted(set(transmission.beam_of_tube)) == [0, 1]
    assert transmission.frequency_khz == 455 and transmission.absorption_db_per_m == pytest.approx(0.4)
    assert transmission.beam_azimuth_rad == pytest.approx([-np.pi / 2, np.pi / 2])


def test_columns_are_the_engines_own_memory(scene):
    history = tubefoot.history(scene, "camera")
    for name in ("tube", "area_m2", "centroid_m", "corners_m", "piece_corners"):
        first, second = getattr(history, name), getattr(history, name)
        assert first.ctypes.data == second.ctypes.data and not first.flags.owndata, name
        with pytest.raises(ValueError):
            first[...] = 0
    # Columns of one record lie side by side.
    assert history.area_m2.strides == history.tube.strides == history.centroid_m.strides[:1]
    facets = history.transmission.facets
    assert facets.ctypes.data == tubefoot.transmission(scene, "camera").facets.ctypes.data


def test_arrays_outlive_everything_else(scene):
    history = tubefoot.history(scene, "camera")
    area, facets, corners = history.area_m2, history.transmission.facets, history.corners_m
    copies = area.copy(), facets.copy(), corners.copy()
    del scene, history
    gc.collect()
    for array, copy in zip((area, facets, corners), copies):
        assert (array == copy).all()


@pytest.mark.parametrize("call, text", [
    (lambda s: tubefoot.history(s, "sonar"), "the scene has no sensor 'sonar'; it has 'camera', 'side'"),
    (lambda s: tubefoot.history(s, "camera", 3), "ping 3: sensor 'camera' has pings 0 to 2"),
    (lambda s: tubefoot.transmission(s, "camera", 0, 1), "transmission 1: a ping of sensor 'camera' has transmissions 0 to 0"),
    (lambda s: tubefoot.transmission(s, "camera", 0.5), "ping: expected a whole number, not 0.5"),
    (lambda s: tubefoot.transmission(s, "camera", -1), "ping -1: expected 0 or more"),
])
def test_transmissions_that_are_not_there(scene, call, text):
    with pytest.raises(tubefoot.UsageError) as error:
        call(scene)
    assert str(error.value) == text


def apart(keys, arm=(1, 0, 0.2)):
    keys["sensors"][0]["receiver_arm_m"] = list(arm)
    return keys


def test_a_receiver_apart_shares_its_footprints(keys, folder):
    alone = tubefoot.history(tubefoot.Scene.from_dict(keys, base=folder), "camera", ping=1)
    assert (alone.receive_tube == alone.tube).all()
    assert (alone.transmission.receiver_apex_m == alone.transmission.apex_m).all()
    scene = tubefoot.Scene.from_dict(apart(keys), base=folder)
    history = tubefoot.history(scene, "camera", ping=1)
    transmission = history.transmission
    assert transmission.receiver_apex_m - transmission.apex_m == pytest.approx([1, 0, 0.2], abs=1e-6)
    # The tubes of both point alike; a pair of them shares what it shares once.
    assert transmission.receive_rays == pytest.approx(transmission.rays, abs=1e-9)
    pairs = set(zip(history.tube, history.receive_tube, history.facet))
    assert len(pairs) == len(history) > 8 and any(t != r for t, r, _ in pairs)
    for i in range(len(history)):
        polygons = history.polygons_m(i)
        assert sum(map(areas, polygons)) == pytest.approx(history.area_m2[i], rel=1e-9)
        corners = np.concatenate(polygons)
        half = sum(np.linalg.norm(corners - apex, axis=1) for apex in (transmission.apex_m, transmission.receiver_apex_m)) / 2
        assert history.range_max_m[i] == pytest.approx(half.max())
        assert history.range_min_m[i] <= half.min() * (1 + 1e-12)
        facet = transmission.vertices_m[transmission.facets[history.facet[i]]]
        assert history.receive_distance_m[i] == pytest.approx(abs((transmission.receiver_apex_m - facet[0]) @ history.normal[i]))
    # The receiver receives less than the transmitter insonifies.
    assert history.area_m2.sum() < alone.area_m2.sum()


def test_an_own_engine_receives_at_a_separate_receiver(keys, folder):
    """Footprints as points between two ends: near to the tube engine's echo of fine beams."""
    @tubefoot.engine("points")
    def points(transmission):
        history = transmission.history()
        centroid = transmission.apex_m + history.centroid_m
        out, home = (np.linalg.norm(centroid - apex, axis=1) for apex in (transmission.apex_m, transmission.receiver_apex_m))
        plane = np.abs(np.einsum("ij,ij->i", history.centroid_m, history.normal))
        mu = transmission.material_mu[transmission.material[history.facet]]
        loss = 10 ** (-transmission.absorption_db_per_m * (out + home) / 10)
        energy = mu * plane / out * history.receive_distance_m / home * history.area_m2 / (out * home) ** 2 * loss
        sample = np.searchsorted(transmission.range_edges_m, (out + home) / 2, side="right") - 1
        heard = (sample >= 0) & (sample < transmission.energy_shape[1])
        total = np.zeros(transmission.energy_shape)
        np.add.at(total, (history.beam[heard], sample[heard]), energy[heard])
        return total
    keys["terrain"].update(cell_m=0.1, kind="fractal", rms_height_m=0.001)
    del keys["sensors"][1]
    scene = tubefoot.Scene.from_dict(apart(keys), base=folder)
    mine, theirs = (tubefoot.run(scene, engine=engine)["camera"].energy for engine in (points, None))
    assert mine.sum(axis=2) == pytest.approx(theirs.sum(axis=2), rel=0.02)


def test_footprints_are_the_commands_file(scene, folder, program):
    program("footprints", folder / "scene.toml", "--sensor", "camera", "--pings", "0:1", "--beams", "2:5", "-o",
            folder / "f.nc")
    table = tubefoot.footprints(scene, "camera", range(0, 2), "2:5")
    with netCDF4.Dataset(folder / "f.nc") as file:
        for name, values in table.items():
            assert (file[name][:].filled() == values).all(), name
            assert file[name].units == table.units[name] and file[name].long_name == table.meanings[name]
    assert table.rows > 8 and set(table["ping"]) == {0, 1} and set(table["beam"]) == {2, 3, 4, 5}
    assert set(table.component) == {"terrain", "thing"} and set(table.material) == {"sand", "steel"}


def test_footprints_sum_to_the_echo(scene):
    result = tubefoot.run(scene)
    table = tubefoot.footprints(scene, "side", ":")
    sums = np.zeros((2, 2))
    np.add.at(sums, (table["ping"], table["beam"]), table["energy_j"])
    assert sums == pytest.approx(result["side"].energy.sum(axis=2), rel=1e-9)


def test_ragged_polygons_have_the_areas(scene):
    table = tubefoot.footprints(scene, "camera")
    assert len(table.first_piece) == table.rows + 1 and table.first_corner[-1] == len(table.corners_m)
    for row in range(table.rows):
        assert sum(map(areas, table.polygons_m(row))) == pytest.approx(table["area_m2"][row], rel=1e-9)
    assert not table["area_m2"].flags.owndata and not table.corners_m.flags.owndata
    assert table.corners_m.ctypes.data == table._native.corners_m.ctypes.data


def test_geopandas_has_the_polygons_of_the_file(scene, folder, program):
    program("footprints", folder / "scene.toml", "--sensor", "camera", "-o", folder / "f.gpkg")
    file = geopandas.read_file(folder / "f.gpkg")
    frame = tubefoot.footprints(scene, "camera").to_geopandas()
    assert len(frame) == len(file)
    assert frame.geometry.area.to_numpy() == pytest.approx(file.geometry.area.to_numpy())
    for column in ("facet", "beam", "area_m2", "energy_j", "material", "component", "pieces"):
        assert (frame[column].to_numpy() == file[column].to_numpy()).all(), column
    assert frame.crs is None


def test_geopandas_has_the_scenes_crs(keys, folder):
    keys["georeference"] = {"crs": "EPSG:32632", "origin_crs": [500000.0, 6000000.0]}
    frame = tubefoot.footprints(tubefoot.Scene.from_dict(keys, base=folder), "camera").to_geopandas()
    assert frame.crs.to_epsg() == 32632
    west, south, east, north = frame.total_bounds
    assert 499990 <= west < east <= 500010 and 5999985 <= south < north <= 6000015


@pytest.mark.parametrize("options, text", [
    (dict(pings="2:9"), "pings '2:9': the sensor has pings 0 to 2"),
    (dict(pings=7), "pings '7': the sensor has pings 0 to 2"),
    (dict(beams=[]), "beams: the selection is empty"),
    (dict(pings=0.5), "pings: expected a whole number, not 0.5"),
    (dict(beams=[1, 8]), "beams '1,8': the sensor has beams 0 to 7"),
])
def test_pings_and_beams_that_are_not_there(scene, options, text):
    with pytest.raises(tubefoot.UsageError) as error:
        tubefoot.footprints(scene, "camera", **options)
    assert str(error.value) == text
