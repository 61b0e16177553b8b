"""Heights or fields on a uniform grid as files of other programs: GSF of Gwyddion, X3P (ISO 25178-72), VTK.

Rows are written in the order of increasing y. XDMF describes a result in the plane for ParaView and VTK:
RESULT.xdmf beside RESULT.h5.
"""

from __future__ import annotations

import base64
import io
import zipfile
from collections.abc import Callable
from hashlib import md5
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape, quoteattr

import h5py
import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.hdf5_file import open_for_reading
from ehlpetsc.results.output_guard import atomic_write


class GridField(NamedTuple):
    """Values on a uniform grid.

    `values`: shape (ny, nx), in `unit`.
    `dx`, `dy`: distances of the columns and of the rows [m].
    `name`, `unit`: of the values.
    `origin`: x and y of the first value [m].
    """

    values: np.ndarray
    dx: float
    dy: float
    name: str = "height"
    unit: str = "m"
    origin: tuple[float, float] = (0.0, 0.0)


def gsf(field: GridField) -> bytes:
    """Gwyddion Simple Field 1.0: header of text, padded with NUL to a multiple of four bytes, float32."""
    ny, nx = field.values.shape
    entries = {
        "XRes": nx,
        "YRes": ny,
        "XReal": repr(float(nx * field.dx)),  # of cells, one around each point
        "YReal": repr(float(ny * field.dy)),
        "XOffset": repr(float(field.origin[0] - 0.5 * field.dx)),
        "YOffset": repr(float(field.origin[1] - 0.5 * field.dy)),
        "Title": field.name,
        "XYUnits": "m",
        "ZUnits": "" if field.unit == "1" else field.unit,
    }
    header = "Gwyddion Simple Field 1.0\n" + "".join(f"{key} = {value}\n" for key, value in entries.items())
    encoded = header.encode()
    return encoded + b"\0" * (4 - len(encoded) % 4) + field.values.astype("<f4").tobytes()


X3P = """<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">
<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>{kind}</FeatureType><Axes>
<CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{dx!r}</Increment><Offset>{x!r}</Offset></CX>
<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{dy!r}</Increment><Offset>{y!r}</Offset></CY>
<CZ><AxisType>A</AxisType><DataType>D</DataType><Increment>1</Increment><Offset>0</Offset></CZ>
</Axes></Record1>
<Record3><MatrixDimension><SizeX>{nx}</SizeX><SizeY>{ny}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
<DataLink><PointDataLink>bindata/data.bin</PointDataLink>
<MD5ChecksumPointData>{digest}</MD5ChecksumPointData></DataLink></Record3>
<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4>
</p:ISO5436_2>
"""


def x3p(field: GridField) -> bytes:
    """X3P of ISO 25178-72 (ISO 5436-2): an archive of a description and of float64 heights."""
    if field.unit != "m":
        raise OutputError(f"{field.name}: in {field.unit}; X3P holds heights in m, .gsf and .vti any field")
    (ny, nx), data = field.values.shape, field.values.astype("<f8").tobytes()
    x, y = map(float, field.origin)
    steps, kind = {"dx": float(field.dx), "dy": float(field.dy), "x": x, "y": y}, "PRF" if ny == 1 else "SUR"
    digest = md5(data, usedforsecurity=False).hexdigest()
    main = X3P.format(nx=nx, ny=ny, kind=kind, digest=digest.upper(), **steps).encode()
    checksum = f"{md5(main, usedforsecurity=False).hexdigest()} *main.xml\n"
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in (("main.xml", main), ("bindata/data.bin", data), ("md5checksum.hex", checksum)):
            archive.writestr(name, content)
    return file.getvalue()


def vti(field: GridField) -> bytes:
    """Image data of VTK as XML, with float64 point data in base64; lengths in m."""
    (ny, nx), data = field.values.shape, field.values.astype("<f8").tobytes()
    extent, (x, y) = f"0 {nx - 1} 0 {ny - 1} 0 0", map(float, field.origin)
    name = quoteattr(f"{field.name} [{field.unit}]")
    content = base64.b64encode(np.uint64(len(data)).tobytes() + data).decode()
    return (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<ImageData WholeExtent="{extent}" Origin="{x!r} {y!r} 0"'
        f' Spacing="{float(field.dx)!r} {float(field.dy)!r} 1">\n'
        f'<Piece Extent="{extent}"><PointData Scalars={name}>\n'
        f'<DataArray type="Float64" Name={name} format="binary">{content}</DataArray>\n'
        "</PointData></Piece></ImageData></VTKFile>\n"
    ).encode()


WRITERS: dict[str, Callable[[GridField], bytes]] = {".gsf": gsf, ".x3p": x3p, ".vti": vti}
"""Content of a file by its ending."""

XDMF_HEAD = '<?xml version="1.0"?>\n<Xdmf Version="2.0">\n<Domain>\n'
COLLECTION = '<Grid Name="frames" GridType="Collection" CollectionType="Temporal">\n'
FOOT = "</Grid>\n</Domain>\n</Xdmf>\n"


def write_xdmf(path: Path) -> Path:
    """Write the description of the frames of a result in the plane, XDMF 2, beside it; returns its path."""
    with open_for_reading(path) as file:
        frames = "".join(_frame(file, Path(path).name, k) for k in range(len(file["time"])))
    target = Path(path).with_suffix(".xdmf")
    atomic_write(target, (XDMF_HEAD + COLLECTION + frames + FOOT).encode())
    return target


def _frame(file: h5py.File, name: str, index: int) -> str:
    (x, dx), (y, dy) = ((axis[0], axis[1] - axis[0]) for axis in (file["x"][:], file["y"][:]))
    shape = "1 {} {}".format(
        *map(len, (file["y"], file["x"]))
    )  # z, y, x: VTK would lay two dimensions into y and z
    item = '<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">'
    step, time = file["step"][index], file["time"][index]
    lines = [
        f'<Grid Name="frame {step}"><Time Value="{time:.9g}"/>',
        f'<Topology TopologyType="3DCoRectMesh" Dimensions="{shape}"/>',
        f'<Geometry GeometryType="ORIGIN_DXDYDZ">{item}0 {y:.12g} {x:.12g}</DataItem>',
        f"{item}1 {dy:.12g} {dx:.12g}</DataItem></Geometry>",
        *(_field(data, name, index, shape) for data in file.values() if getattr(data, "ndim", 0) == 3),
        "</Grid>\n",
    ]
    return "\n".join(lines)


def _field(data: h5py.Dataset, file: str, index: int, shape: str) -> str:
    """Frame of a field: a hyperslab (start, stride, count) of its dataset."""
    kind = "UChar" if data.dtype.kind == "u" else "Float"
    all_frames = " ".join(map(str, data.shape))
    return (
        f'<Attribute Name={quoteattr(data.name[1:])} Center="Node">'
        f'<DataItem ItemType="HyperSlab" Dimensions="{shape}">'
        f'<DataItem Dimensions="3 3" Format="XML">{index} 0 0 1 1 1 {shape}</DataItem>'
        f'<DataItem Dimensions="{all_frames}" NumberType="{kind}" Precision="{data.dtype.itemsize}" '
        f'Format="HDF">{escape(f"{file}:{data.name}")}</DataItem></DataItem></Attribute>'
    )
