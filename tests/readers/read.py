"""Reads a folder of results with readers that others wrote, and checks that its files say the same.

Arguments: the folder. Heights, places and directions are believed only as the files themselves state them: the sidecar for
the 16-bit maps, `bbox` and `frame` for rivers, the conventions of PLY's comments and of glTF for the meshes. Ends with one
line of JSON, or with the first disagreement.
"""

import json
import pathlib
import sys

import imageio.v3 as imageio
import numpy as np
import OpenEXR
import trimesh

# Single precision of a metre-sized number on a land of some hundred kilometres, m.
SINGLE = 0.02
# Places of rivers are written to 0.1 m.
WRITTEN = 0.05 + 1e-6
# A pixel's value is the land's at its centre; between centres it is only bent so far, in parts of the relief.
BETWEEN_PIXELS = 0.02


def agree(what, found, expected, tolerance):
    off = float(np.max(np.abs(np.asarray(found, dtype=float) - np.asarray(expected, dtype=float))))
    assert off <= tolerance, f"{what}: off by {off}, at most {tolerance} expected"


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        assert len(file.parts) == 1, f"height.exr: {len(file.parts)} parts"
        found = {name: channel.pixels for name, channel in file.channels().items()}
    for name, pixels in found.items():
        assert pixels.dtype == np.float32, f"height.exr: {name} is {pixels.dtype}"
        assert np.isfinite(pixels).all(), f"height.exr: {name} has numbers that are none"
    return found


def sixteen(folder):
    """The 16-bit maps in metres, as their sidecar says, and the metres of a step."""
    side = json.loads((folder / "height16.json").read_text())
    assert (side["row_origin"], side["pixel"], side["r16"]) == ("north-west", "area", "little-endian"), side
    shape = (side["height"], side["width"])
    png = imageio.imread(folder / "height16.png")
    assert png.dtype == np.uint16 and png.shape == shape, f"height16.png: {png.dtype} {png.shape}"
    raw = np.fromfile(folder / "height16.r16", dtype="<u2")
    assert raw.size == shape[0] * shape[1], f"height16.r16: {raw.size} steps"
    agree("height16.r16 and height16.png", raw.reshape(shape), png, 0)
    assert png.min() == 0 and png.max() == 65535, "height16.png: the range is not used"
    low, high = side["metres_at_0"], side["metres_at_65535"]
    step = (high - low) / 65535
    return side, low + png * step, step


def at(pixels, side, x, y):
    """Values of a map at places in metres from the south-west corner, between the centres of its pixels."""
    width, height = np.array(side["km_per_pixel"]) * 1000
    col = np.clip(x / width - 0.5, 0, pixels.shape[1] - 1)
    row = np.clip(pixels.shape[0] - y / height - 0.5, 0, pixels.shape[0] - 1)
    left, top = np.floor(col).astype(int), np.floor(row).astype(int)
    right, bottom = np.minimum(left + 1, pixels.shape[1] - 1), np.minimum(top + 1, pixels.shape[0] - 1)
    u, v = col - left, row - top
    above = pixels[top, left] * (1 - u) + pixels[top, right] * u
    below = pixels[bottom, left] * (1 - u) + pixels[bottom, right] * u
    return above * (1 - v) + below * v


def same_land(what, pixels, side, x, y, z):
    """The map shows the heights `z` at the places `x`, `y`, and would not if it were turned or mirrored."""
    relief = float(np.ptp(z))
    width, height = np.array(side["km_per_pixel"]) * 1000 * np.array([side["width"], side["height"]])

    def off(x, y):
        return np.abs(at(pixels, side, x, y) - z)

    right = off(x, y)
    typical, most = float(np.median(right)), float(np.percentile(right, 99))
    assert most <= BETWEEN_PIXELS * relief, f"{what}: off by {most} m on a relief of {relief} m"
    turned = {"south up": (x, height - y), "west right": (width - x, y), "upside down": (width - x, height - y)}
    for name, places in turned.items():
        wrong = float(np.median(off(*places)))
        assert wrong > 10 * typical, f"{what}: fits as well {name} ({wrong} m, {typical} m)"
    return typical


def meshes(folder, side, pixels):
    width, height = np.array(side["km_per_pixel"]) * 1000 * np.array([side["width"], side["height"]])
    ply = trimesh.load(folder / "terrain.ply", process=False)
    data = ply.metadata["_ply_raw"]["vertex"]["data"]
    for name in ["area_m2", "uplift", "receiver", "layer", "k"]:
        assert name in data.dtype.names, f"terrain.ply: no {name}"
    x, y, z = ply.vertices.T
    agree("terrain.ply: west and south edge", [x.min(), y.min()], [0, 0], SINGLE)
    agree("terrain.ply: east and north edge, m", [x.max(), y.max()], [width, height], SINGLE)
    assert (ply.face_normals[:, 2] > 0).all(), "terrain.ply: faces look down"
    typical = same_land("terrain.ply on height.exr", pixels, side, x, y, z)
    receiver = data["receiver"]
    outlets = receiver < 0
    assert outlets.any() and receiver.max() < len(x), "terrain.ply: receivers"
    assert (data["area_m2"][receiver[~outlets]] >= data["area_m2"][~outlets]).all(), "terrain.ply: areas shrink downstream"

    scene = trimesh.load(folder / "terrain.glb", process=False)
    (glb,) = scene.geometry.values()
    ((matrix, _),) = (scene.graph[node] for node in scene.graph.nodes_geometry)
    agree("terrain.glb: the node's transform", matrix, np.eye(4), 0)
    agree("terrain.glb: corners of triangles", glb.faces, ply.faces, 0)
    # y up, metres, z to the south.
    agree("terrain.glb: vertices", glb.vertices, np.column_stack([x, z, -y]), SINGLE)
    # Readers of meshes count v from below.
    agree("terrain.glb: texture coordinates", glb.visual.uv, np.column_stack([x / width, y / height]), 1e-5)
    texture = np.asarray(glb.visual.material.baseColorTexture)
    aspect = texture.shape[1] / texture.shape[0]
    agree("terrain.glb: shape of its texture", aspect, width / height, 0.01)
    return len(x), typical


def rivers(folder, side, pixels):
    read = json.loads((folder / "rivers.geojson").read_text())
    assert "kilometres, x east, y north" in read["frame"], read["frame"]
    size = np.array(side["km_per_pixel"]) * np.array([side["width"], side["height"]])
    agree("rivers.geojson: bbox, km", read["bbox"], [0, 0, *size], 1e-6)
    down = up = 0
    for river in read["features"]:
        x, y = np.array(river["geometry"]["coordinates"]).T * 1000
        for places, end in ((x, size[0] * 1000), (y, size[1] * 1000)):
            within = np.clip(places, 0, end)
            agree("rivers.geojson: places on the land, m", places, within, WRITTEN)
        drainage = river["properties"]["drainage_km2"]
        assert len(drainage) == len(x) and (np.diff(drainage) >= 0).all(), "rivers.geojson: a river gets smaller"
        z = at(pixels, side, x, y)
        if z[0] >= z[-1]:
            down += 1
        else:
            up += 1
    assert down > 20 * up, f"rivers.geojson: {up} of {up + down} rivers run uphill on height.exr"
    return down + up


def main():
    folder = pathlib.Path(sys.argv[1])
    exr = channels(folder / "height.exr")
    for name in ["height_m", "uplift_m_per_yr", "drainage_km2", "slope"]:
        assert name in exr, f"height.exr: no {name} among {sorted(exr)}"
    side, metres, step = sixteen(folder)
    heights = exr["height_m"]
    assert heights.shape == metres.shape, f"height.exr: {heights.shape}, height16.png: {metres.shape}"
    agree("height16 and height.exr, m", metres, heights, 0.5 * step + 1e-3)
    picture = imageio.imread(folder / "picture.png")
    assert picture.shape[:2] == heights.shape, f"picture.png: {picture.shape}"
    vertices, typical = meshes(folder, side, heights)
    print(json.dumps({
        "pixels": list(heights.shape),
        "step_m": step,
        "vertices": vertices,
        "mesh_off_m": typical,
        "rivers": rivers(folder, side, heights),
    }))


main()
