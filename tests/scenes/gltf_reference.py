#!/usr/bin/env python3
"""Counts of glTF models for gltf_models_test.cpp, computed without the program under test.

Usage: gltf_reference.py MODEL...
Prints instances, triangles with area, triangles without (per primitive, not per instance), total
area and bounding box in body axes (x, -z, y), in the file's units.

Plain Python and the standard library only; written from the glTF 2.0 specification. Covers what the
models need: TRIANGLES, float positions, no sparse accessors, EXT_mesh_gpu_instancing with floats.
"""
import base64
import json
import math
import os
import struct
import sys

FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def load(path):
    data = open(path, "rb").read()
    binary = None
    if data[:4] == b"glTF":
        length = struct.unpack_from("<I", data, 12)[0]
        text = data[20:20 + length]
        if len(data) > 20 + length:
            size = struct.unpack_from("<I", data, 20 + length)[0]
            binary = data[28 + length:28 + length + size]
    else:
        text = data
    document = json.loads(text)
    buffers = []
    for buffer in document.get("buffers", []):
        uri = buffer.get("uri")
        if uri is None:
            buffers.append(binary)
        elif uri.startswith("data:"):
            buffers.append(base64.b64decode(uri.split(",", 1)[1]))
        else:
            buffers.append(open(os.path.join(os.path.dirname(path), uri), "rb").read())
    return document, buffers


def rows(document, buffers, index):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    pattern = "<%d%s" % (WIDTHS[accessor["type"]], FORMATS[accessor["componentType"]])
    stride = view.get("byteStride", struct.calcsize(pattern))
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    data = buffers[view["buffer"]]
    return [struct.unpack_from(pattern, data, start + i * stride) for i in range(accessor["count"])]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def placed(translation, rotation, scale):
    x, y, z, w = rotation
    n = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / n, y / n, z / n, w / n
    turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    top = [[turn[i][j] * scale[j] for j in range(3)] + [translation[i]] for i in range(3)]
    return top + [[0, 0, 0, 1]]


def local(node):
    if "matrix" in node:
        return [[node["matrix"][4 * j + i] for j in range(4)] for i in range(4)]
    return placed(node.get("translation", (0, 0, 0)), node.get("rotation", (0, 0, 0, 1)),
                  node.get("scale", (1, 1, 1)))


def instances(document, buffers, node):
    extension = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if extension is None:
        return [placed((0, 0, 0), (0, 0, 0, 1), (1, 1, 1))]
    columns = {k: rows(document, buffers, v) for k, v in extension["attributes"].items()}
    count = len(next(iter(columns.values())))
    default = {"TRANSLATION": (0, 0, 0), "ROTATION": (0, 0, 0, 1), "SCALE": (1, 1, 1)}
    return [placed(*(columns[k][i] if k in columns else default[k] for k in default))
            for i in range(count)]


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def area(a, b, c):
    n = cross([b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)])
    return 0.5 * math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])


def primitive_triangles(document, buffers, primitive):
    points = rows(document, buffers, primitive["attributes"]["POSITION"])
    corners = ([row[0] for row in rows(document, buffers, primitive["indices"])]
               if "indices" in primitive else list(range(len(points))))
    every = [[points[k] for k in corners[i:i + 3]] for i in range(0, len(corners), 3)]
    return [t for t in every if area(*t) > 0], sum(1 for t in every if area(*t) == 0)


def measure(path):
    document, buffers = load(path)
    known, total = {}, {"instances": 0, "triangles": 0, "without": 0, "area": 0.0}
    low, high = [math.inf] * 3, [-math.inf] * 3

    def visit(index, above):
        node = document["nodes"][index]
        world = times(above, local(node))
        for child in node.get("children", []):
            visit(child, world)
        if "mesh" not in node:
            return
        for number, primitive in enumerate(document["meshes"][node["mesh"]]["primitives"]):
            key = (node["mesh"], number)
            if key not in known:
                known[key] = primitive_triangles(document, buffers, primitive)
                total["without"] += known[key][1]
            for own in instances(document, buffers, node):
                m = times(world, own)
                total["instances"] += 1
                total["triangles"] += len(known[key][0])
                for triangle in known[key][0]:
                    p = [[sum(m[i][j] * q[j] for j in range(3)) + m[i][3] for i in range(3)]
                         for q in triangle]
                    total["area"] += area(*p)
                    for x, y, z in p:
                        for axis, value in enumerate((x, -z, y)):
                            low[axis] = min(low[axis], value)
                            high[axis] = max(high[axis], value)

    scenes = document.get("scenes", [])
    children = {c for n in document["nodes"] for c in n.get("children", [])}
    roots = (scenes[document.get("scene", 0)]["nodes"] if scenes
             else [i for i in range(len(document["nodes"])) if i not in children])
    for root in roots:
        visit(root, placed((0, 0, 0), (0, 0, 0, 1), (1, 1, 1)))
    return total, low, high


for name in sys.argv[1:]:
    counts, lowest, highest = measure(name)
    print(name)
    print("  {instances}, {triangles}, {without}, {area:.9g},".format(**counts))
    print("  {%s}, {%s}" % (", ".join("%.9g" % v for v in lowest),
                            ", ".join("%.9g" % v for v in highest)))
