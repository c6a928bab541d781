# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: read_dxf.py FILE
#
# What ezdxf reads of a drawing, one line for each entity; exit 1 when it finds a fault, 77 without ezdxf.
import sys

try:
    import ezdxf
    from ezdxf import recover
except ImportError:
    sys.exit(77)

document, auditor = recover.readfile(sys.argv[1])
for fault in list(auditor.errors) + list(auditor.fixes):
    print("fault:", fault.message)
print("version", document.dxfversion)
for entity in document.modelspace():
    kind, layer = entity.dxftype(), entity.dxf.layer
    if kind == "POLYLINE":
        vertices = [(v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices]
        print(kind, layer, *[f"{x:.3f},{y:.3f},{bulge:.6f}" for x, y, bulge in vertices])
    elif kind == "LINE":
        print(kind, layer, f"{entity.dxf.start.x:.3f},{entity.dxf.start.y:.3f}", f"{entity.dxf.end.x:.3f},{entity.dxf.end.y:.3f}")
    else:
        print(kind, layer, entity.dxf.get("text", ""))
sys.exit(1 if auditor.errors or auditor.fixes else 0)
