#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""advised_commands_test.py TUBEFOOT SOURCES: every command that a message or a page advises is run as it stands.

Each case makes a file that the program rejects or warns about, takes the command from the program's own message, fills in
the words in capitals, runs it in a shell, and shows that the program reads the new file as the right seabed, and that the
user's file kept its bytes. At the end, all commands that the sources and the pages name have been run.
"""
import hashlib
import json
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile

try:
    import netCDF4
    import numpy as np
    from osgeo import gdal, ogr, osr
except ImportError as missing:
    print(f"Skipped: {missing}")
    sys.exit(77)
if not shutil.which("gdal_translate") or not shutil.which("gdalmdimtranslate"):
    print("Skipped: the package gdal-bin is not installed")
    sys.exit(77)

gdal.DontUseExceptions()
osr.DontUseExceptions()
ogr.DontUseExceptions()

tubefoot, sources = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
PROGRAMS = r"(?:gdal_translate|gdalwarp|gdal_edit\.py|gdaladdo|gdalbuildvrt|gdalmdimtranslate|gdalinfo|ogr2ogr|nccopy)"
ELSEWHERE = {"gdal_translate -oo", "gdalinfo"}  # the second only reads; the first of BAGs of variable resolution: VariableGrid.AdvisedCommandGivesTheSameSurface
executed = []  # command lines
COLUMNS, ROWS, STEP, WEST, SOUTH = 9, 6, 2.0, 10.0, 100.0  # centres of the south-western cell; odd, and not square
EAST, NORTH = WEST + (COLUMNS - 1) * STEP, SOUTH + (ROWS - 1) * STEP
EDGES = {"WEST": WEST - 1, "NORTH": NORTH + 1, "EAST": EAST + 1, "SOUTH": SOUTH - 1}


def height(x, y):
    """Neither the same in a mirror, nor turned over."""
    return -20 - 0.5 * (y - SOUTH) - 0.125 * (x - WEST)


def grid(scale=1.0, south_first=False):
    x, y = WEST + STEP * np.arange(COLUMNS), SOUTH + STEP * np.arange(ROWS)
    heights = height(x[None, :], y[:, None]) * scale
    return heights if south_first else heights[::-1]


def srs(text):
    reference = osr.SpatialReference()
    assert reference.SetFromUserInput(text) == 0
    return reference


def geotiff(path, heights=None, transform=(WEST - 1, STEP, 0, NORTH + 1, 0, -STEP), crs=None, bands=1, options=(), kind=gdal.GDT_Float64,
            driver="GTiff"):
    heights = grid() if heights is None else heights
    rows, columns = heights.shape
    data = gdal.GetDriverByName(driver).Create(str(path), columns, rows, bands, kind, list(options))
    if transform is not None:
        data.SetGeoTransform(transform)
    if crs:
        data.SetSpatialRef(srs(crs))
    data.GetRasterBand(1).WriteArray(heights)
    return data


def netcdf(path, coordinates=True, north_first=False, names=("y", "x"), units=None, turned=False, more=(), values=None):
    """z(y, x) as many programs write it: coordinate variables without attributes."""
    with netCDF4.Dataset(path, "w") as file:
        y, x = names
        file.createDimension(y, ROWS)
        file.createDimension(x, COLUMNS)
        ys, xs = values if values else (SOUTH + STEP * np.arange(ROWS), WEST + STEP * np.arange(COLUMNS))
        if coordinates:
            for name, coordinate, unit in [(y, ys[::-1] if north_first else ys, 0), (x, xs, 1)]:
                variable = file.createVariable(name, "f8", (name,))
                variable[:] = coordinate
                if units:
                    variable.units = units[unit]
        heights = grid(south_first=not north_first)
        for name in ("z", *more):
            variable = file.createVariable(name, "f8", (x, y) if turned else (y, x))
            variable[:] = (heights.T if turned else heights) if name == "z" else 0


TERRAIN = """
[[materials]]
name = "sand"
lambert_db = -20
{materials}
{georeference}
[[terrain]]
name = "bed"
kind = "raster"
material = "sand"
file = "{file}"
{terrain}
[trajectory]
kind = "fixed"
position_m = [{position}, -5]
[[sensors]]
name = "camera"
kind = "imaging"
frequency_khz = 400
beams = 4
horizontal_deg = 20
vertical_deg = 10
samples = 16
range_min_m = 1
range_max_m = 60
"""


class Case:
    def __init__(self, folder, name):
        self.name = name
        self.folder = folder / name.replace(" ", "-")
        self.folder.mkdir()

    def scene(self, file, **keys):
        keys = {"materials": "", "georeference": "", "terrain": "", "position": "15, 103", **keys}
        path = self.folder / "scene.toml"
        path.write_text(TERRAIN.format(file=file, **keys))
        return path

    def run(self, scene):
        out = self.folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        done = subprocess.run([tubefoot, "export", str(scene), "--to", "obj", "-o", str(out)], capture_output=True, text=True, check=False)
        return done.returncode, done.stderr + done.stdout, out / "scene.obj"

    def advised(self, said, expected, fill, pick=0):
        """Runs the pick-th command of a message; the new file. The user's files keep their bytes."""
        assert expected in said, f"{self.name}: no '{expected}' in: {said}"
        commands = [c for c in re.findall(r"`([^`]+)`", said) if re.match(PROGRAMS, c)]
        assert len(commands) > pick, f"{self.name}: no command in: {said}"
        return self.execute(commands[pick], fill)

    def execute(self, command, fill):
        executed.append(command)
        for word, value in fill.items():
            command = re.sub(rf"(?<![A-Za-z_]){re.escape(word)}(?![A-Za-z_])", str(value).replace("\\", r"\\"), command)
        before = {p: hashlib.sha256(p.read_bytes()).digest() for p in self.folder.rglob("*") if p.is_file()}
        done = subprocess.run(command, shell=True, cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{self.name}: {command}\n{done.stdout}{done.stderr}"
        for path, digest in before.items():
            assert hashlib.sha256(path.read_bytes()).digest() == digest, f"{self.name}: {command} changed {path.name}"
        new = [p for p in self.folder.rglob("*") if p.is_file() and p not in before and not p.name.endswith((".aux.xml", ".gfs"))]
        assert new, f"{self.name}: {command} wrote nothing"
        return max(new, key=lambda p: (len(p.name), p.name))  # the last of several: bed_new2.tif

    def read(self, file, least=None, **keys):
        """Vertices and materials' facets of the seabed that the program makes of a file."""
        status, said, obj = self.run(self.scene(pathlib.Path(file).name, **keys))
        assert status == 0, f"{self.name}: {said}"
        vertices = np.array([[float(w) for w in line.split()[1:4]] for line in obj.read_text().splitlines() if line.startswith("v ")])
        assert len(vertices) >= (COLUMNS * ROWS if least is None else least), f"{self.name}: {len(vertices)} vertices"
        return vertices, said

    def right(self, file, least=None, tolerance=1e-3, place=lambda x, y: (x, y), **keys):
        vertices, said = self.read(file, least, **keys)
        x, y = place(vertices[:, 0], vertices[:, 1])
        error = np.abs(vertices[:, 2] - height(x, y)).max()
        assert error <= tolerance, f"{self.name}: the seabed is up to {error} m wrong"
        print(f"{self.name}: right within {error:.2g} m")
        return said


def cases(folder):
    # netCDF with coordinate variables that have no attributes: read as it is, in either order of rows.
    for north_first in (False, True):
        for names, units in [(("y", "x"), None), (("northing", "easting"), ("m", "m"))]:
            case = Case(folder, f"coordinates {names[0]} {north_first}")
            netcdf(case.folder / "bed.nc", north_first=north_first, names=names, units=units)
            case.right("bed.nc")

    # Without coordinates: nobody knows the order of rows, so there is a command for each.
    for pick, north_first in enumerate([False, True]):
        case = Case(folder, f"bare {north_first}")
        netcdf(case.folder / "bed.nc", coordinates=False, north_first=north_first)
        said = case.run(case.scene("bed.nc"))[1]
        case.right(case.advised(said, "no geotransform", EDGES, pick))

    # A user's own setting of GDAL does not turn a seabed over.
    case = Case(folder, "environment")
    netcdf(case.folder / "bed.nc", units=("m", "m"))
    with netCDF4.Dataset(case.folder / "bed.nc", "a") as file:
        for axis in "xy":
            file[axis].standard_name = f"projection_{axis}_coordinate"
    os.environ["GDAL_NETCDF_BOTTOMUP"] = "NO"
    try:
        case.right("bed.nc")
    finally:
        del os.environ["GDAL_NETCDF_BOTTOMUP"]

    case = Case(folder, "no geotransform")
    geotiff(case.folder / "bed.tif", transform=None)
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "no geotransform", EDGES))

    case = Case(folder, "with spaces")
    geotiff(case.folder / "my bed's.tif", transform=None)
    case.right(case.advised(case.run(case.scene("my bed's.tif"))[1], "no geotransform", EDGES))

    for turned_axis in (False, True):
        case = Case(folder, f"turned over {turned_axis}")
        netcdf(case.folder / "bed.nc", turned=True)
        if turned_axis:
            with netCDF4.Dataset(case.folder / "bed.nc", "a") as file:
                for axis in "xy":
                    file[axis].standard_name, file[axis].units = f"projection_{axis}_coordinate", "m"
        case.right(case.advised(case.run(case.scene("bed.nc"))[1], "rows run along", {}))

    for north_first in (False, True):
        case = Case(folder, f"several variables {north_first}")
        netcdf(case.folder / "bed.nc", more=("quality",), north_first=north_first)
        case.right(case.advised(case.run(case.scene("bed.nc"))[1], "does not hold a single raster, but the variables z, quality", {"VARIABLE": "z"}))

    # Rotated: the corners that gdalwarp adds are holes, not plates at the sea surface.
    case = Case(folder, "rotated")
    c, s = np.cos(0.5), np.sin(0.5)
    rows, columns = 60, 90
    transform = (WEST, 0.3 * c, 0.3 * s, NORTH, 0.3 * s, -0.3 * c)
    i, j = np.arange(columns)[None, :] + 0.5, np.arange(rows)[:, None] + 0.5
    geotiff(case.folder / "bed.tif", height(WEST + 0.3 * (c * i + s * j), NORTH + 0.3 * (s * i - c * j)), transform)
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "is rotated", {}), least=1000, tolerance=0.2)

    case = Case(folder, "south up")
    geotiff(case.folder / "bed.tif", grid(south_first=True), (WEST - 1, STEP, 0, SOUTH - 1, 0, STEP))
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "north-west to south-east", {}))

    case = Case(folder, "fathoms")
    data = geotiff(case.folder / "bed.tif", grid(1 / 1.8288))
    data.GetRasterBand(1).SetUnitType("fathom")
    del data
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "'fathom'", {"METRES": 1.8288}))

    case = Case(folder, "nodata")
    heights = grid().copy()
    heights[0, 0] = -9999
    geotiff(case.folder / "bed.tif", heights)
    said = case.run(case.scene("bed.tif"))[1]
    case.right(case.advised(said, "has cells with the value -9999", {}), least=COLUMNS * ROWS - 1)

    # Longitude and latitude that name no system; and metres that GDAL wrote as such.
    degrees = (60 + 0.00002 * np.arange(ROWS), 9 + 0.00004 * np.arange(COLUMNS))
    frame = '[georeference]\ncrs = "EPSG:32632"\norigin_crs = [500000.0, 6651000.0]\n'
    to_degrees = osr.CoordinateTransformation(srs("EPSG:32632"), srs("OGC:CRS84"))

    def as_metres(x, y):
        points = np.array(to_degrees.TransformPoints([(500000 + a, 6651000 + b) for a, b in zip(x, y)]))
        return WEST + STEP * (points[:, 0] - 9) / 0.00004, SOUTH + STEP * (points[:, 1] - 60) / 0.00002

    for pick, north_first, units in [(0, False, True), (1, True, True), (0, True, False), (1, False, False)]:
        case = Case(folder, f"degrees {pick} {north_first} {units}")
        netcdf(case.folder / "bed.nc", names=("lat", "lon"), units=("degrees_north", "degrees_east") if units else None,
               values=degrees, north_first=north_first)
        said = case.run(case.scene("bed.nc", georeference=frame))[1]
        new = case.advised(said, "coordinates are in degrees", {"EPSG:...": "EPSG:32632"}, pick)
        # GDAL's own rounding of degrees places cells within some centimetres, and bilinear cells end at the border.
        case.right(new, least=20, tolerance=0.3, place=as_metres, georeference=frame)
    case = Case(folder, "metres as degrees")
    netcdf(case.folder / "bed.nc", names=("lat", "lon"), units=("degrees_north", "degrees_east"))
    case.right(case.advised(case.run(case.scene("bed.nc"))[1], "declare this", {}, 2))

    case = Case(folder, "two-dimensional coordinates")
    netcdf(case.folder / "bed.nc", coordinates=False)
    with netCDF4.Dataset(case.folder / "bed.nc", "a") as file:
        file["z"].coordinates = "lon lat"
        for name, values, unit in [("lat", degrees[0][:, None] + 0 * degrees[1], "north"), ("lon", degrees[1] + 0 * degrees[0][:, None], "east")]:
            variable = file.createVariable(name, "f8", ("y", "x"))
            variable[:] = values
            variable.units = f"degrees_{unit}"
    said = case.run(case.scene("bed.nc", georeference=frame))[1]
    if "two-dimensional coordinates" in said:
        case.right(case.advised(said, "two-dimensional", {"EPSG:...": "EPSG:32632"}), least=20, tolerance=1.5, place=as_metres,
                   georeference=frame)

    # A coordinate reference system is added to a copy.
    far = (500000 + WEST - 1, STEP, 0, 6651000 + NORTH + 1, 0, -STEP)
    case = Case(folder, "no CRS")
    geotiff(case.folder / "bed.tif", transform=far)
    said = case.run(case.scene("bed.tif", georeference=frame))[1]
    case.right(case.advised(said, "no coordinate reference system", {"EPSG:...": "EPSG:32632"}), georeference=frame)

    # Of a netCDF whose coordinates GDAL's programs do not find.
    for north_first in (False, True):
        case = Case(folder, f"no CRS netCDF {north_first}")
        netcdf(case.folder / "bed.nc", north_first=north_first,
               values=(6651000 + SOUTH + STEP * np.arange(ROWS), 500000 + WEST + STEP * np.arange(COLUMNS)))
        said = case.run(case.scene("bed.nc", georeference=frame))[1]
        case.right(case.advised(said, "no coordinate reference system", {"EPSG:...": "EPSG:32632"}), georeference=frame)

    case = Case(folder, "one of two without CRS")
    geotiff(case.folder / "bed.tif")
    geotiff(case.folder / "other.tif", transform=far, crs="EPSG:32632")
    second = '[[terrain]]\nname = "other"\nkind = "raster"\nmaterial = "sand"\nfile = "other.tif"\n'
    said = case.run(case.scene("bed.tif", terrain=second))[1]
    geotiff(case.folder / "placed.tif", transform=far)
    case.right(case.advised(said, "a preceding raster has none", {"EPSG:...": "EPSG:32632", "IN": "placed.tif", "OUT": "named.tif"}),
               georeference=frame)

    case = Case(folder, "another CRS than that of files of corrections")
    gdal.GetDriverByName("AAIGrid").CreateCopy(str(case.folder / "bed.asc"), geotiff(case.folder / "from.tif", transform=far))
    (case.folder / "bed.prj").write_text('PROJCS["x",EXTENSION["PROJ4","+proj=utm +zone=32 +nadgrids=other.gsb"]]')
    said = case.run(case.scene("bed.asc", georeference=frame))[1]
    case.right(case.advised(said, "correction files", {"EPSG:...": "EPSG:32632", "IN": "bed.asc", "OUT": "named.tif"}),
               georeference=frame)

    case = Case(folder, "not true to scale")
    mercator = osr.CoordinateTransformation(srs("OGC:CRS84"), srs("EPSG:3857")).TransformPoint(9, 60)
    geotiff(case.folder / "bed.tif", crs="EPSG:3857", transform=(mercator[0], 2, 0, mercator[1], 0, -2))
    said = case.run(case.scene("bed.tif", position="0, 0"))[1]
    new = case.advised(said, "not true to scale", {"EPSG:...": "EPSG:32632", "IN": "bed.tif", "OUT": "utm.tif"})
    vertices, said = case.read(new, least=30, position="0, 0")
    assert "not true to scale" not in said and vertices[:, 2].max() < -19, said

    case = Case(folder, "other resolution")
    geotiff(case.folder / "bed.tif")
    said = case.run(case.scene("bed.tif", terrain="resolution_m = 1"))[1]
    case.right(case.advised(said, "has one resolution", {}), tolerance=1, least=100)

    # Formats, and files that cannot be read as they are.
    case = Case(folder, "another format")
    gdal.GetDriverByName("GSAG").CreateCopy(str(case.folder / "bed.grd"), geotiff(case.folder / "from.tif"))
    case.right(case.advised(case.run(case.scene("bed.grd"))[1], "cannot be read as", {}))

    case = Case(folder, "colours")
    data = geotiff(case.folder / "bed.tif", bands=3, options=["PHOTOMETRIC=RGB"])
    data.GetRasterBand(1).WriteArray(0 * grid())
    data.GetRasterBand(2).WriteArray(grid())
    data.FlushCache()
    del data
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "colour picture", {"BAND": 2}))

    case = Case(folder, "overviews elsewhere")
    data = geotiff(case.folder / "bed.tif")
    data.SetMetadataItem("OVERVIEW_FILE", "elsewhere.tif", "OVERVIEWS")
    del data
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "overviews", {}))

    case = Case(folder, "many pictures")
    for number in range(1001):
        geotiff(case.folder / "bed.tif", options=["APPEND_SUBDATASET=YES"] if number > 0 else [])
    case.right(case.advised(case.run(case.scene("bed.tif"))[1], "chain of more than", {}))

    case = Case(folder, "large blocks")
    rows = columns = 8200
    data = gdal.GetDriverByName("GTiff").Create(str(case.folder / "bed.tif"), columns, rows, 1, gdal.GDT_Float64,
                                               [f"BLOCKYSIZE={rows}", "COMPRESS=DEFLATE", "ZLEVEL=1"])
    data.SetGeoTransform((WEST - 1 - 40 * STEP, STEP, 0, NORTH + 1 + 30 * STEP, 0, -STEP))
    data.GetRasterBand(1).WriteArray(grid(), 40, 30)
    del data
    window = f"window = [40, 30, {COLUMNS}, {ROWS}]"
    new = case.advised(case.run(case.scene("bed.tif", terrain=window))[1], "is stored in blocks of", {})
    case.right(new, terrain=window)
    new.unlink()

    # Virtual rasters.
    case = Case(folder, "virtual raster that is warped")
    geotiff(case.folder / "from.tif", crs="EPSG:32632", transform=far)
    gdal.Warp(str(case.folder / "bed.vrt"), str(case.folder / "from.tif"), format="VRT")
    said = case.run(case.scene("bed.vrt", georeference=frame))[1]
    case.right(case.advised(said, "which tubefoot does not read", {}, pick=1), georeference=frame)
    case.right(case.advised(said, "which tubefoot does not read", {"OUT": "plain.vrt", "IN...": "from.tif"}), georeference=frame)

    case = Case(folder, "virtual raster of a netCDF")
    netcdf(case.folder / "bed.nc", north_first=True)
    subprocess.run(["gdal_translate", "-q", "-of", "VRT", "-a_ullr", *(str(EDGES[e]) for e in ("WEST", "NORTH", "EAST", "SOUTH")), "bed.nc",
                    "bed.vrt"], cwd=case.folder, check=True)
    case.right(case.advised(case.run(case.scene("bed.vrt"))[1], "in the wrong order", {}))

    # Material maps: what lies where is told by the facets of each material.
    more = '[[materials]]\nname = "mud"\nlambert_db = -30\n'

    def materials(case, file, keys, **scene):
        """Where the facets of mud are, of a flat bed."""
        geotiff(case.folder / "flat.tif", 0 * grid() - 20)
        text = f'[terrain.material_map]\nfile = "{file}"\n{keys}'
        status, said, obj = case.run(case.scene("flat.tif", materials=more, terrain=text, **scene))
        if status != 0:
            return None, said
        points, inside, mud = [], False, []
        for line in obj.read_text().splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                points.append([float(w) for w in words[1:3]])
            elif words[:1] == ["usemtl"]:
                inside = words[1] == "mud"
            elif words[:1] == ["f"] and inside:
                mud.append(np.mean([points[int(w.split("/")[0]) - 1] for w in words[1:4]], axis=0))
        return np.array(mud), said

    classes = np.ones((ROWS, COLUMNS))
    classes[1, 1:3] = 2  # one row below the north, and near the west
    raster = 'kind = "raster"\nclasses = { 1 = "sand", 2 = "mud" }\n'

    def right_mud(case, mud, said):
        assert mud is not None, f"{case.name}: {said}"
        assert len(mud) > 0 and (mud[:, 0] > WEST).all() and (mud[:, 0] < WEST + 3 * STEP).all(), f"{case.name}: {mud}"
        assert (mud[:, 1] < NORTH).all() and (mud[:, 1] > NORTH - 2 * STEP).all(), f"{case.name}: {mud}"
        print(f"{case.name}: {len(mud)} facets of mud in their place")

    case = Case(folder, "classes south up")
    geotiff(case.folder / "map.tif", classes[::-1], (WEST - 1, STEP, 0, SOUTH - 1, 0, STEP))
    new = case.advised(materials(case, "map.tif", raster)[1], "is not north-up", {})
    right_mud(case, *materials(case, new.name, raster))

    for pick, north_first in enumerate([True, False]):
        case = Case(folder, f"classes without order {north_first}")
        with netCDF4.Dataset(case.folder / "map.nc", "w") as file:
            file.createDimension("y", ROWS)
            file.createDimension("x", COLUMNS)
            file.createVariable("z", "i2", ("y", "x"))[:] = classes if north_first else classes[::-1]
        keys = raster + f"origin_m = [{WEST - 1}, {SOUTH - 1}]\ncell_m = {STEP}\n"
        new = case.advised(materials(case, "map.nc", keys)[1], "which row is the northernmost", {}, pick)
        right_mud(case, *materials(case, new.name, keys))

    case = Case(folder, "classes in another format")
    gdal.GetDriverByName("GSAG").CreateCopy(str(case.folder / "map.grd"), geotiff(case.folder / "from.tif", classes))
    new = case.advised(materials(case, "map.grd", raster)[1], "cannot be read as", {})
    right_mud(case, *materials(case, new.name, raster))

    def polygon(path, driver, options=()):
        data = ogr.GetDriverByName(driver).CreateDataSource(str(path), options=list(options))
        layer = data.CreateLayer("zones", None, ogr.wkbPolygon)
        layer.CreateField(ogr.FieldDefn("material", ogr.OFTString))
        feature = ogr.Feature(layer.GetLayerDefn())
        feature["material"] = "mud"
        west, east, south, north = WEST + 1, WEST + 3 * STEP - 1, NORTH - 2 * STEP + 1, NORTH - 1
        feature.SetGeometry(ogr.CreateGeometryFromWkt(f"POLYGON(({west} {south},{east} {south},{east} {north},{west} {north},{west} {south}))"))
        layer.CreateFeature(feature)

    polygons = 'kind = "polygons"\nattribute = "material"\ncoordinates = "local"\n'
    case = Case(folder, "polygons in another format")
    polygon(case.folder / "map.gml", "GML")
    new = case.advised(materials(case, "map.gml", polygons)[1], "cannot be read as", {})
    right_mud(case, *materials(case, new.name, polygons))
    # What the message about files of corrections advises for vectors.
    new = case.execute("ogr2ogr -a_srs EPSG:... OUT IN", {"EPSG:...": "EPSG:32632", "OUT": "named.gpkg", "IN": "map.gml"})
    right_mud(case, *materials(case, new.name, polygons))

    case = Case(folder, "polygons of many attributes")
    polygon(case.folder / "map.geojson", "GeoJSON")
    map_of_many = json.loads((case.folder / "map.geojson").read_text())
    for feature in map_of_many["features"]:
        feature["properties"] |= {f"attribute{k}": k for k in range(1001)}
    (case.folder / "map.geojson").write_text(json.dumps(map_of_many))
    new = case.advised(materials(case, "map.geojson", polygons)[1], "more than 1000 attributes", {"NAME": "material"})
    right_mud(case, *materials(case, new.name, polygons))

    for what in ("log", "view"):
        case = Case(folder, f"GeoPackage with a {what}")
        polygon(case.folder / "map.gpkg", "GPKG")
        database = sqlite3.connect(case.folder / "map.gpkg")
        if what == "log":
            database.execute("PRAGMA journal_mode=WAL")
        else:
            database.execute("CREATE VIEW more AS SELECT fid FROM zones")
        database.commit()
        database.close()
        new = case.advised(materials(case, "map.gpkg", polygons)[1], "ogr2ogr", {})
        right_mud(case, *materials(case, new.name, polygons + 'layer = "zones"\n'))

    # Relief and reflectivity: the copies are accepted, and hold what the file holds.
    def accepted(case, file, extra):
        scene = case.scene("flat.tif", materials=extra.format(file=file), georeference=frame)
        geotiff(case.folder / "flat.tif", 0 * grid() - 20, far, "EPSG:32632")
        done = subprocess.run([tubefoot, "check", str(scene)], capture_output=True, text=True, check=False)
        return done.returncode, done.stderr

    relief = '[[materials.relief]]\nkind = "map"\nfile = "{file}"\n'
    reflectivity = '[[materials.reflectivity]]\nkind = "map"\nfile = "{file}"\nvalues = "db"\n'
    for name, extra in [("relief", relief), ("reflectivity", reflectivity)]:
        case = Case(folder, f"{name} without CRS")
        geotiff(case.folder / "map.tif", transform=far)
        status, said = accepted(case, "map.tif", extra)
        assert status != 0
        new = case.advised(said, "no coordinate reference system", {"EPSG:...": "EPSG:32632"})
        assert accepted(case, new.name, extra)[0] == 0, accepted(case, new.name, extra)
        assert (gdal.Open(str(new)).ReadAsArray() == grid()).all()

        case = Case(folder, f"large {name}")
        data = gdal.GetDriverByName("GTiff").Create(str(case.folder / "map.tif"), 10000, 5200, 1, gdal.GDT_Byte,
                                                    ["COMPRESS=DEFLATE", "TILED=YES", "SPARSE_OK=TRUE"])
        data.SetGeoTransform((500000, 0.1, 0, 6651000, 0, -0.1))
        data.SetSpatialRef(srs("EPSG:32632"))
        data.GetRasterBand(1).WriteArray(np.full((400, 400), 8, "u1"), 4000, 400)
        del data
        status, said = accepted(case, "map.tif", extra)
        new = gdal.Open(str(case.advised(said, "exceed the limit of", {})))
        assert (new.RasterXSize, new.RasterYSize) == (2500, 1300) and np.isclose(new.GetGeoTransform(), (500000, 0.4, 0, 6651000, 0, -0.4)).all()
        assert new.ReadAsArray()[150, 1050] == 8 and new.ReadAsArray()[1150, 1050] == 0

    case = Case(folder, "reflectivity without geotransform")
    geotiff(case.folder / "map.tif", transform=None, crs="EPSG:32632")
    status, said = accepted(case, "map.tif", reflectivity)
    edges = {"WEST": far[0], "NORTH": far[3], "EAST": far[0] + COLUMNS * STEP, "SOUTH": far[3] - ROWS * STEP}
    new = case.advised(said, "no geotransform", edges)
    assert accepted(case, new.name, reflectivity)[0] == 0 and gdal.Open(str(new)).GetGeoTransform() == far

    case = Case(folder, "thin cells of relief")
    geotiff(case.folder / "map.tif", 0 * grid() + 0.1, (500000, 1e-5, 0, 6651000, 0, -200), "EPSG:32632")
    status, said = accepted(case, "map.tif", relief)
    assert "resample the raster to square cells" in said, said
    executed.append(re.search(r"`(gdalwarp -tr SIZE[^`]*)`", said)[1])  # of which "other resolution" ran the same with figures

    case = Case(folder, "class raster that is too large")
    data = gdal.GetDriverByName("GTiff").Create(str(case.folder / "map.tif"), 10000, 5200, 1, gdal.GDT_Byte,
                                                ["COMPRESS=DEFLATE", "TILED=YES", "SPARSE_OK=TRUE"])
    data.SetGeoTransform((WEST - 1, STEP, 0, NORTH + 1, 0, -STEP))
    data.GetRasterBand(1).WriteArray(classes.astype("u1"))
    del data
    new = case.advised(materials(case, "map.tif", raster)[1], "exceed the limit of", EDGES)
    right_mud(case, *materials(case, new.name, raster))

    # Commands of pages, which name files of their own.
    case = Case(folder, "pages")
    geotiff(case.folder / "in.tif")
    (case.folder / "tiles").mkdir()
    geotiff(case.folder / "tiles" / "a.tif")
    for command in sorted(page_commands()):
        new = case.execute(command, {"IN": "in.tif", "OUT": "out.tif"})
        if "EPSG:4326" in command:
            assert (gdal.Open(str(new)).ReadAsArray() == grid()).all() and gdal.Open(str(new)).GetSpatialRef().IsGeographic()
        else:
            case.right(new)
        for made in ("out.tif", "bed.vrt"):
            (case.folder / made).unlink(missing_ok=True)


def page_commands():
    return {span for page in [*sources.glob("docs/*.md"), sources / "README.md"]
            for span in re.findall(r"`([^`\n]+)`", page.read_text()) if re.match(PROGRAMS + r"\s", span)}


def key(command):
    """The program and its first option: what the completeness is counted by."""
    words = command.split()
    return " ".join(words[:2] if len(words) > 1 and words[1].startswith("-") else words[:1])


def all_are_run():
    """What the sources advise is what was run, and nothing advises to write into the file of a user."""
    run = {key(part) for command in executed for part in command.split(" && ")}
    run |= {key(re.sub(r" --config \S+ \S+", "", part)) for command in executed for part in command.split(" && ")}
    missing = []
    for path in sorted([*sources.glob("src/**/*.?pp"), *sources.glob("sensors/**/*.?pp"), *sources.glob("python/**/*.py")]):
        text = re.sub(r"//[^\n]*", "", path.read_text())
        text = re.sub(r'"\s*\n\s*"', "", text)  # literals over several lines
        for literal in re.findall(r'"((?:[^"\\\n]|\\.)*)"', text):
            for command in re.findall(rf"{PROGRAMS}(?: -[A-Za-z_]+)?", literal):
                if not any(f"{one} ".startswith(f"{command} ") for one in run | ELSEWHERE):
                    missing.append(f"{path.relative_to(sources)}: {command}")
                if command.startswith("gdal_edit.py") and f"&& {command}" not in literal:
                    missing.append(f"{path.relative_to(sources)}: {command} writes into a file of the user")
                if command.startswith("gdalwarp") and "-dstnodata" not in literal and "warp_" not in text:
                    missing.append(f"{path.relative_to(sources)}: {command} fills what it does not know with 0")
    assert not missing, "advised, and never run:\n" + "\n".join(missing)
    print(f"{len(executed)} commands of messages and pages were run")


with tempfile.TemporaryDirectory() as temporary:
    cases(pathlib.Path(temporary).resolve())
all_are_run()
