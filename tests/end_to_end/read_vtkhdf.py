# SPDX-License-Identifier: BSD-3-Clause
"""Opens a snapshot with VTK's own reader, which is ParaView's, and checks that it holds a scene.

read_vtkhdf.py FILE CELL_TYPE [ARRAY...]: CELL_TYPE as VTK numbers them; ARRAYs must exist.
Prints: points cells xmin xmax ymin ymax zmin zmax
"""
import sys

from vtkmodules.vtkIOHDF import vtkHDFReader

file, cell_type, arrays = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
reader = vtkHDFReader()
if not reader.CanReadFile(file):
    sys.exit(f"{file}: VTK cannot read it")
reader.SetFileName(file)
reader.Update()
grid = reader.GetOutput()
if grid.GetNumberOfCells() == 0 or grid.GetNumberOfPoints() == 0:
    sys.exit(f"{file}: VTK finds nothing in it")
for cell in (0, grid.GetNumberOfCells() - 1):
    if grid.GetCellType(cell) != cell_type:
        sys.exit(f"{file}: cell {cell} has type {grid.GetCellType(cell)}")
for name in arrays:
    if grid.GetPointData().GetArray(name) is None:
        sys.exit(f"{file}: no point data '{name}'")
print(grid.GetNumberOfPoints(), grid.GetNumberOfCells(), *(f"{x:.4g}" for x in grid.GetBounds()))
