"""Reads run.h5 with h5py and snapshots.vtkhdf with VTK, and prints what it finds as JSON.

usage: read_back.py h5py|checksums|vtk FILE
"""

import importlib
import json
import sys


def with_h5py(path):
    import h5py

    with h5py.File(path) as file:
        first = file["snapshots/000000"]
        return {
            "layout": int(file.attrs["sphcut_layout"]),
            "channels": {
                name: {
                    "unit": text(series.attrs["unit"]),
                    "meaning": text(series.attrs["meaning"]),
                    "values": series[:].tolist(),
                    "extendible": series.maxshape == (None,),
                }
                for name, series in file["channels"].items()
            },
            "scenario_text": text(file["provenance/scenario_text"][0]),
            "effects": [[text(cell) for cell in row] for row in file["provenance/effects"]],
            "settings": [[text(cell) for cell in row] for row in file["provenance/settings"]],
            "title": text(file["provenance"].attrs["title"]),
            "steps": int(file["performance"].attrs["steps"]),
            "outcome": text(file["outcome"].attrs["kind"]),
            "material": text(file["facts/materials/000"].attrs["name"]),
            "initial_yield": float(
                file["facts/materials/000/flow_stress"].attrs["initial_yield"]
            ),
            "times": [float(group.attrs["time"]) for group in file["snapshots"].values()],
            "position": first["position"][:].tolist(),
            "temperature": first["temperature"][:].tolist(),
            "id": first["id"][:].tolist(),
            "state": {
                text(array.attrs["name"]): array[:].tolist()
                for array in file["checkpoint"].values()
            },
        }


def checksums(path):
    """Compares the arrays of numbers with the table, as docs/run_h5.md shows it, and names those that differ."""
    import zlib

    import h5py
    import numpy as np

    compared, wrong = 0, []
    with h5py.File(path) as file:
        table = file["sphcut_checksums"][0]
        assert zlib.crc32(table) == file.attrs["sphcut_checksums"]
        for line in table.decode().splitlines():
            kind, _, content, _, name = line.split(" ", 4)
            if kind not in ("reals", "integers"):
                continue
            compared += 1
            try:
                values = np.asarray(file[name], dtype="<f8" if kind == "reals" else "<u8")
            except OSError:
                wrong.append(name)
                continue
            if zlib.crc32(values.tobytes()) != int(content, 16):
                wrong.append(name)
    return {"compared": compared, "wrong": wrong}


def with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(path)
    if not reader.CanReadFile(path):
        raise SystemExit("VTK says it cannot read this file")
    reader.UpdateInformation()
    frames = []
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        data = reader.GetOutput()
        vertices = data.GetVerts()
        arrays = data.GetPointData()
        frames.append(
            {
                "time": reader.GetTimeValue(),
                "points": vtk_to_numpy(data.GetPoints().GetData()).tolist()
                if data.GetNumberOfPoints()
                else [],
                "vertices": vertices.GetNumberOfCells(),
                "connectivity": vtk_to_numpy(vertices.GetConnectivityArray()).tolist()
                if vertices.GetNumberOfCells()
                else [],
                "polygons": vtk_to_numpy(data.GetPolys().GetConnectivityArray()).tolist()
                if data.GetNumberOfPolys()
                else [],
                "arrays": {
                    arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)).tolist()
                    for i in range(arrays.GetNumberOfArrays())
                },
            }
        )
    return {"frames": frames}


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


READERS = {"h5py": ("h5py", with_h5py), "checksums": ("h5py", checksums), "vtk": ("vtkmodules", with_vtk)}

module, read = READERS[sys.argv[1]]
try:
    importlib.import_module(module)
except ImportError:
    print(f"the Python module {module} is not installed", file=sys.stderr)
    raise SystemExit(77) from None
print(json.dumps(read(sys.argv[2])))
