#!/usr/bin/env python3
"""Points and force plates of C3D files by ezc3d, and by Python's c3d where ezc3d does not read a file (MIPS), for a test that compares them with ours.

    python3 -m venv venv && venv/bin/pip install ezc3d==1.7.2 c3d==0.6.0 numpy
    venv/bin/python scripts/c3d_peer.py FOLDER
    CONTRAPPOSTO_C3D=FOLDER cargo test -p contrapposto-formats c3d -- --ignored --nocapture

FOLDER holds files that are not a part of this project, such as Input/C3DSamples of the repository Biomechanical-ToolKit/BTKData. Beside each one
comes NAME.points: the unit and the reader, the labels, and a row for each frame: time in s, and x, y, z of each point in the file's unit, NaN for gaps.
NAME.forces, of files with force plates that ezc3d reads: a row for each analog sample with the force (N) and the moment about the middle of the surface (N m) of
each plate in the axes of the laboratory. ezc3d takes POINT:UNITS for the length in moments. Its moments of type 1 are left out: they are those of the centre of
pressure and the couple, from which they are computed here.

    CONTRAPPOSTO_C3D=FOLDER cargo test -p contrapposto-formats force_plates -- --ignored --nocapture
"""

import pathlib
import sys

import ezc3d
import numpy

import c3d


def by_ezc3d(path):
    read = ezc3d.c3d(str(path))
    point = read["parameters"]["POINT"]
    labels = list(point["LABELS"]["value"])
    number = 2
    while f"LABELS{number}" in point:
        labels += point[f"LABELS{number}"]["value"]
        number += 1
    units = point["UNITS"]["value"]
    if read["header"]["analogs"]["size"] == 0 and int.from_bytes(path.read_bytes()[4:6], "little") > 0:
        raise ValueError("takes the analog samples that the header counts, and ANALOG:USED does not, for points")
    first = read["header"]["points"]["first_frame"]
    points = read["data"]["points"][:3].transpose(2, 1, 0)
    return units[0] if units else "", labels, float(point["RATE"]["value"][0]), first, points


def by_c3d(path):
    with open(path, "rb") as file:
        reader = c3d.Reader(file)
        frames = [points.copy() for _, points, _ in reader.read_frames(copy=True)]
        points = numpy.array(frames, dtype=float)
        points[points[:, :, 3] < 0] = numpy.nan
        unit = reader.get("POINT:UNITS").string_value.strip()
        labels = [label.strip() for label in reader.point_labels]
        return unit, labels, float(reader.point_rate), reader.first_frame - 1, points[:, :, :3]


METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


def forces(path):
    read = ezc3d.c3d(str(path), extract_forceplat_data=True)
    parameters, rows = read["parameters"], []
    metres = METRES[parameters["POINT"]["UNITS"]["value"][0].strip()]
    for plate, kind in zip(read["data"]["platform"], parameters["FORCE_PLATFORM"]["TYPE"]["value"]):
        force, moment = plate["force"], metres * plate["moment"]
        if kind == 1:
            arm = plate["center_of_pressure"] - plate["corners"].mean(axis=1, keepdims=True)
            moment = metres * (numpy.cross(arm.T, force.T).T + plate["Tz"])
        rows.append(numpy.vstack([force, moment]))
    return numpy.vstack(rows).T


def main(folder):
    for path in sorted(p for p in pathlib.Path(folder).iterdir() if p.suffix.lower() == ".c3d"):
        target = path.with_suffix(".forces")
        target.unlink(missing_ok=True)
        try:
            rows = forces(path)
            target.write_text("\n".join("\t".join(repr(float(x)) for x in row) for row in rows) + "\n")
            print(f"{path.name}: {rows.shape[1] // 6} force plates, {len(rows)} samples")
        except Exception as error:
            print(f"{path.name}: forces: {str(error)[:90]}")
        target = path.with_suffix(".points")
        target.unlink(missing_ok=True)
        for reader in (by_ezc3d, by_c3d):
            try:
                unit, labels, rate, first, points = reader(path)
            except Exception as error:
                print(f"{path.name}: {reader.__name__}: {str(error)[:90]}")
                continue
            if not len(points) or not points.shape[1]:
                print(f"{path.name}: {reader.__name__}: no points")
                continue
            unit = unit.strip() if unit.strip() in ("mm", "cm", "m") else "mm"
            rows = ["\t".join(repr(float(x)) for x in [(first + i) / rate, *frame.ravel()]) for i, frame in enumerate(points)]
            target.write_text("\n".join([f"{unit}\t{reader.__name__}", "\t".join(label.strip() for label in labels), *rows]) + "\n")
            print(f"{path.name}: {reader.__name__}: {points.shape[1]} points, {len(points)} frames")
            break


if __name__ == "__main__":
    main(sys.argv[1])
