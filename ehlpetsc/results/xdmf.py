"""Description of a result in the plane for ParaView and VTK: RESULT.xdmf beside RESULT.h5, XDMF 2."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from ehlpetsc.results.output_guard import atomic_write
from ehlpetsc.results.reader import Result, read_result

XDMF_HEAD = '<?xml version="1.0"?>\n<Xdmf Version="2.0">\n<Domain>\n'
COLLECTION = '<Grid Name="frames" GridType="Collection" CollectionType="Temporal">\n'
FOOT = "</Grid>\n</Domain>\n</Xdmf>\n"


def write_xdmf(path: Path) -> Path:
    """Write the description of the frames of a result file beside it; returns its path."""
    with read_result(path) as result:
        frames = "".join(_frame(result, k) for k in range(len(result.time)))
    target = Path(path).with_suffix(".xdmf")
    atomic_write(target, (XDMF_HEAD + COLLECTION + frames + FOOT).encode())
    return target


def _frame(result: Result, index: int) -> str:
    (x, dx), (y, dy) = ((axis[0], axis[1] - axis[0]) for axis in (result.x, result.y))
    shape = f"1 {len(result.y)} {len(result.x)}"  # z, y, x: VTK would lay two dimensions into y and z
    item = '<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">'
    lines = [
        f'<Grid Name="frame {result.step[index]}"><Time Value="{result.time[index]:.9g}"/>',
        f'<Topology TopologyType="3DCoRectMesh" Dimensions="{shape}"/>',
        f'<Geometry GeometryType="ORIGIN_DXDYDZ">{item}0 {y:.12g} {x:.12g}</DataItem>',
        f"{item}1 {dy:.12g} {dx:.12g}</DataItem></Geometry>",
        *(_field(result, name, index, shape) for name in result.fields),
        "</Grid>\n",
    ]
    return "\n".join(lines)


def _field(result: Result, name: str, index: int, shape: str) -> str:
    """Frame of a field: a hyperslab (start, stride, count) of its dataset."""
    data = result[name]
    kind = "UChar" if data.dtype.kind == "u" else "Float"
    all_frames = " ".join(map(str, data.shape))
    return (
        f'<Attribute Name={quoteattr(name)} Center="Node">'
        f'<DataItem ItemType="HyperSlab" Dimensions="{shape}">'
        f'<DataItem Dimensions="3 3" Format="XML">{index} 0 0 1 1 1 {shape}</DataItem>'
        f'<DataItem Dimensions="{all_frames}" NumberType="{kind}" Precision="{data.dtype.itemsize}" '
        f'Format="HDF">{escape(f"{result.path.name}:/{name}")}</DataItem></DataItem></Attribute>'
    )
