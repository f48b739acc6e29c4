"""Opens every .pvd and .vtu of a run with VTK's own reader and checks what is inside.

    python check_vtk.py DIRECTORY

Fields have to be there and finite. Where DIRECTORY/expected.json says so (written by the validation binary, mode
`verify files`), the number of cells and the sum of their areas have to agree as well.
"""

import json
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.vtkCommonDataModel import VTK_LINE
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

AREA_TOLERANCE = 1e-9  # relative

# Point and cell fields of each series.
FIELDS = {
    "fluid": (["velocity", "pressure"], ["vorticity", "part", "cut"]),
    "solid": (["displacement", "velocity"], ["cauchy_stress", "von_mises", "pressure", "body"]),
    "interface": ([], ["traction", "velocity_jump", "normal", "body"]),
}


def read_grid(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if reader.GetErrorCode() or grid.GetNumberOfCells() == 0:
        raise ValueError("VTK cannot read it, or it is empty")
    return grid


def area(grid):
    """Sum of the signed areas of all polygons in the plane."""
    total = []
    for k in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(k)
        if cell.GetCellType() == VTK_LINE:
            continue
        ids = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
        corners = [grid.GetPoint(i) for i in ids]
        x0, y0, _ = corners[0]
        rel = [(x - x0, y - y0) for x, y, _ in corners]
        total.append(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(rel, rel[1:])) / 2)
    if any(a <= 0 for a in total):
        raise ValueError("a cell is turned over or has no area")
    return math.fsum(total)


def check_fields(grid, series):
    for data, names in zip((grid.GetPointData(), grid.GetCellData()), FIELDS[series]):
        for name in names:
            array = data.GetArray(name)
            if array is None:
                raise ValueError(f"no field {name}")
            for component in range(array.GetNumberOfComponents()):
                low, high = array.GetRange(component)
                if not (math.isfinite(low) and math.isfinite(high)):
                    raise ValueError(f"{name} is not finite")


def check_file(path, series, expected):
    grid = read_grid(path)
    check_fields(grid, series)
    summary = f"{grid.GetNumberOfCells()} cells"
    if expected is not None and grid.GetNumberOfCells() != expected["cells"]:
        raise ValueError(f"{grid.GetNumberOfCells()} cells, not {expected['cells']}")
    if series != "interface":
        found = area(grid)
        summary += f", area {found:.12g}"
        asked = (expected or {}).get("area")
        if asked is not None:
            deviation = abs(found - asked) / asked
            summary += f" (deviation {deviation:.1e})"
            if deviation > AREA_TOLERANCE:
                raise ValueError(f"area {found!r}, not {asked!r}")
    return summary


def main(directory):
    expected_path = directory / "expected.json"
    expected = json.loads(expected_path.read_text()) if expected_path.is_file() else {}
    seen, errors = set(), 0
    for series in FIELDS:
        index = directory / f"{series}.pvd"
        entries = ElementTree.parse(index).getroot().iter("DataSet")
        times = []
        for entry in entries:
            file = entry.get("file")
            times.append(float(entry.get("timestep")))
            seen.add(file)
            try:
                print(f"  {file}: {check_file(directory / file, series, expected.get(file))}")
            except ValueError as error:
                errors += 1
                print(f"  FAIL {file}: {error}")
        if not times or times != sorted(set(times)):
            errors += 1
            print(f"  FAIL {index}: times do not increase")
    for file in sorted(set(expected) - seen):
        errors += 1
        print(f"  FAIL {file}: no index names it")
    print(f"  {len(seen)} files read by VTK, {errors} errors")
    return errors == 0 and bool(seen)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(0 if main(Path(sys.argv[1])) else 1)
