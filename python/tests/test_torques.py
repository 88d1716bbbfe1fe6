"""Tests torques: the program's numbers, layouts, loads, and what is refused."""

from __future__ import annotations

import json
import pickle
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import contrapposto
from contrapposto import Force, InputError, Model, Weight


def equal(a: contrapposto.Torques, b: contrapposto.Torques) -> bool:
    pairs = ((getattr(a, kind), getattr(b, kind)) for kind in ("external", "passive", "active"))
    return all(x.tobytes() == y.tobytes() for x, y in pairs)


def test_torques_of_10000_postures_equal_those_of_the_program_to_the_last_bit(
    woman: Model, random_postures: np.ndarray, program: str, tmp_path: Path
) -> None:
    ours = woman.torques(random_postures, loads=["hand_r 3kg"])
    assert ours.active.shape == (10_000, 45)
    table, out = tmp_path / "postures.csv", tmp_path / "torques.json"
    with table.open("w") as file:
        file.write(",".join(["time", *woman.coordinate_names]) + "\n")
        for i, row in enumerate(random_postures.tolist()):
            file.write(",".join([repr(float(i)), *map(repr, row)]) + "\n")
    command = [program, "torques", "adult:female,1.65m,60kg", str(table), "--radians", "--load", "hand_r 3kg"]
    subprocess.run([*command, "--out", str(out)], check=True, capture_output=True)
    frames = 0
    with out.open() as file:
        for line in file:
            if not line.startswith("{"):
                continue
            theirs = json.loads(line.rstrip().rstrip(","))["coordinates"]
            for kind in ("external", "passive", "active"):
                given = np.array([theirs[name][kind] for name in ours.names])
                assert given.tobytes() == getattr(ours, kind)[frames].tobytes(), f"{kind} of row {frames}"
            frames += 1
    assert frames == 10_000


def test_torques_add_up_to_zero(woman: Model, random_postures: np.ndarray) -> None:
    torques = woman.torques(random_postures[:100])
    np.testing.assert_allclose(torques.external + torques.passive + torques.active, 0, atol=1e-9)


LAYOUTS = {
    "Fortran order": np.asfortranarray,
    "every second column of a wider array": lambda q: np.repeat(q, 2, axis=1)[:, ::2],
    "every second row of a longer array": lambda q: np.repeat(q, 2, axis=0)[::2],
    "both axes reversed twice": lambda q: np.ascontiguousarray(q[::-1, ::-1])[::-1, ::-1],
    "the transpose of a transposed copy": lambda q: np.ascontiguousarray(q.T).T,
    "the other byte order": lambda q: q.astype(q.dtype.newbyteorder("S")),
    "unaligned memory": lambda q: np.frombuffer(b"\0" + q.tobytes(), np.uint8)[1:].view(np.float64).reshape(q.shape),
    "read-only memory": lambda q: np.frombuffer(q.tobytes()).reshape(q.shape),
    "lists": lambda q: q.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_gives_the_same_bits(woman: Model, random_postures: np.ndarray, layout: str) -> None:
    q = random_postures[:45]  # square: a swap of the axes keeps the shape
    given = LAYOUTS[layout](q)
    assert equal(woman.torques(given), woman.torques(q))


def test_float32_and_whole_numbers_are_taken_by_value(woman: Model, random_postures: np.ndarray) -> None:
    q = random_postures[:5].astype(np.float32)
    assert equal(woman.torques(q), woman.torques(q.astype(np.float64)))
    zeros = np.zeros((2, 45))
    assert equal(woman.torques(zeros.astype(int)), woman.torques(zeros))


def test_a_row_alone_gives_rows_alone(woman: Model, random_postures: np.ndarray) -> None:
    many = woman.torques(random_postures[:3])
    one = woman.torques(random_postures[1])
    assert one.active.shape == (45,)
    assert one.active.tobytes() == many.active[1].tobytes()
    empty = woman.torques(np.zeros((0, 45)))
    assert empty.active.shape == (0, 45)


def test_names_of_a_dictionary_or_table_choose_columns(woman: Model) -> None:
    pandas = pytest.importorskip("pandas")
    angles = np.linspace(0, 1, 4)
    table = np.repeat(woman.default_posture[np.newaxis], 4, axis=0)
    table[:, woman.coordinate_names.index("elbow_flex_r")] = angles
    expected = woman.torques(table)
    assert equal(woman.torques({"elbow_flex_r": angles}), expected)
    assert equal(woman.torques(pandas.DataFrame({"elbow_flex_r": angles})), expected)
    assert woman.torques({"elbow_flex_r": 0.5}).active.shape == (45,)
    with pytest.raises(InputError, match="no coordinate `elbow`") as error:
        woman.torques({"elbow": 0.5})
    assert error.value.coordinate == "elbow"


def test_a_nan_names_row_coordinate_value_unit_and_limit(woman: Model, random_postures: np.ndarray) -> None:
    q = random_postures[:4].copy()
    q[2, woman.coordinate_names.index("pelvis_tx")] = np.nan
    with pytest.raises(InputError, match=r"row 2: coordinate `pelvis_tx` is NaN; it must be finite") as error:
        woman.torques(q)
    assert (error.value.coordinate, error.value.row, error.value.unit) == ("pelvis_tx", 2, "m")
    assert error.value.value is not None and np.isnan(error.value.value)
    assert error.value.limit == "finite and at most 1e9 in size"
    copy = pickle.loads(pickle.dumps(error.value))
    assert (copy.coordinate, str(copy)) == ("pelvis_tx", str(error.value))
    q[2, woman.coordinate_names.index("pelvis_tx")] = np.inf
    with pytest.raises(InputError, match="pelvis_tx"):
        woman.gradient(q)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_of_several_refused_rows_the_first_is_named_for_any_number_of_threads(woman: Model, threads: int) -> None:
    q = np.tile(woman.default_posture, (3000, 1))
    for row, first in ((2999, 2999), (1400, 1400), (300, 300), (127, 127), (1600, 127)):
        q[row, 0] = np.nan
        with pytest.raises(InputError) as error:
            woman.torques(q, threads=threads)
        assert error.value.row == first


@pytest.mark.parametrize(
    ("q", "message"),
    [
        (np.zeros((3, 44)), "postures have 44 values; the model has 45 coordinates"),
        (np.zeros(46), "postures have 46 values; the model has 45 coordinates"),
        (np.zeros((2, 3, 45)), r"shape \(2, 3, 45\)"),
        (np.zeros((2, 45), complex), "complex128; it must hold real numbers"),
        (np.zeros((2, 45), bool), "bool; it must hold real numbers"),
        (np.full((2, 45), "0"), "it must hold real numbers"),
        (np.full((2, 45), None), "object; it must hold real numbers"),
        (None, "object; it must hold real numbers"),
    ],
)
def test_other_shapes_and_types_are_refused(woman: Model, q: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        woman.torques(q)


def test_loads_as_texts_and_as_objects_agree(woman: Model, random_postures: np.ndarray) -> None:
    q = random_postures[:3]
    of = lambda *loads: woman.torques(q, loads=list(loads))  # noqa: E731
    assert equal(of("hand_r 3kg"), of(Weight("hand_r", 3)))
    assert equal(of("hand_r 3kg at 0,-0.08,0"), of(Weight("hand_r", 3, at=(0, -0.08, 0))))
    assert equal(of("hand_r 0,-20,5"), of(Force("hand_r", (0, -20, 5))))
    assert equal(of("hand_r 0,-20,5 at 0,-0.08,0 segment"), of(Force("hand_r", (0, -20, 5), (0, -0.08, 0), "segment")))
    assert equal(woman.torques(q, loads="hand_r 3kg"), of("hand_r 3kg"))


def test_a_load_of_its_own_on_each_posture(woman: Model, random_postures: np.ndarray) -> None:
    q, forces = random_postures[:3], np.array([[0.0, -10, 0], [5, 0, 0], [0, 0, 7]])
    together = woman.torques(q, loads=[Force("hand_r", forces)])
    for i in range(3):
        alone = woman.torques(q[i], loads=[Force("hand_r", forces[i])])
        assert together.active[i].tobytes() == alone.active.tobytes()
    masses = woman.torques(q, loads=[Weight("hand_r", [1, 2, 3])])
    assert masses.active[2].tobytes() == woman.torques(q[2], loads=["hand_r 3kg"]).active.tobytes()


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ("han_r 3kg", "did you mean `hand_r`"),
        ("hand_r", "mass|force"),
        (Weight("hnd_r", 3), "did you mean `hand_r`"),
        (Weight("hand_r", -1), "mass .kg. of a load is -1; it must be between 0 and 1e9"),
        (Weight("hand_r", np.nan), "is NaN"),
        (Weight("hand_r", [1, 2]), "has 2 rows; it must have 1, or 3"),
        (Force("hand_r", (1, 2)), r"shape \(2,\)"),
        (Force("hand_r", (np.inf, 0, 0)), "force .N. of a load is inf"),
        (Force("hand_r", (1, 0, 0), axes="world"), "'ground' or 'segment'"),  # type: ignore[arg-type]
        (3, "is no load"),
    ],
)
def test_odd_loads_are_refused_by_name(woman: Model, load: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        woman.torques(np.zeros((3, 45)), loads=[load])  # type: ignore[list-item]


def test_torques_of_a_device_count_as_external(woman: Model, random_postures: np.ndarray) -> None:
    q = random_postures[:2]
    device = np.zeros(45)
    device[woman.torque_names.index("elbow_flex_r")] = 2.5
    without, with_device = woman.torques(q), woman.torques(q, external=device)
    np.testing.assert_allclose(with_device.external - without.external, np.tile(device, (2, 1)), atol=1e-12)
    np.testing.assert_allclose(with_device.active - without.active, np.tile(-device, (2, 1)), atol=1e-12)
    with pytest.raises(InputError, match="must be"):
        woman.torques(q, external=np.zeros((2, 5)))
    with pytest.raises(InputError, match=f"`{woman.torque_names[1]}` in row 0 is NaN"):
        woman.torques(q, external=np.where(np.arange(45) == 1, np.nan, 0))


def test_the_gradient_agrees_with_central_differences(woman: Model, random_postures: np.ndarray) -> None:
    q, h = random_postures[7], 1e-6
    gradient = woman.gradient(q, loads=["hand_r 3kg"])
    assert gradient.shape == (45, 45)
    steps = np.eye(45) * h
    ahead = woman.torques(q + steps, loads=["hand_r 3kg"]).external
    behind = woman.torques(q - steps, loads=["hand_r 3kg"]).external
    np.testing.assert_allclose(gradient, ((ahead - behind) / (2 * h)).T, atol=1e-5)


def test_threads_do_not_change_a_bit(woman: Model, random_postures: np.ndarray) -> None:
    q = np.tile(random_postures, (3, 1))
    assert equal(woman.torques(q, threads=3), woman.torques(q))
    for wrong in (0, -1, 1.5, True, "2", 10**6):
        with pytest.raises(InputError, match="threads"):
            woman.torques(q, threads=wrong)  # type: ignore[arg-type]


def test_a_python_thread_goes_on_meanwhile(woman: Model, random_postures: np.ndarray) -> None:
    q = np.tile(random_postures, (20, 1))
    turns, ended = 0, threading.Event()

    def count() -> None:
        nonlocal turns
        while not ended.is_set():
            turns += 1

    counter = threading.Thread(target=count)
    counter.start()
    before = turns
    woman.torques(q)
    during = turns - before
    ended.set()
    counter.join()
    assert during > 10_000


def test_an_input_that_changes_meanwhile_changes_nothing(woman: Model, random_postures: np.ndarray) -> None:
    q = np.tile(random_postures, (10, 1))
    expected, ended = woman.torques(q.copy()), threading.Event()
    results: list[contrapposto.Torques] = []
    worker = threading.Thread(target=lambda: (results.append(woman.torques(q)), ended.set()))
    worker.start()
    time.sleep(0.05)  # the copy of 34 MB is made by then; the torques take longer
    if ended.is_set():
        pytest.fail("the torques were ready before the input could change: give more rows")
    q[:] = np.nan
    worker.join()
    assert equal(results[0], expected)


def test_results_are_arrays_in_c_order_that_python_may_keep(woman: Model) -> None:
    active = woman.torques(np.zeros((4, 45))).active
    assert active.flags.c_contiguous and active.flags.writeable and active.dtype == np.float64
    active[:] = 1.0
    assert (active == 1.0).all()


def test_to_pandas_has_a_row_a_posture(woman: Model, random_postures: np.ndarray) -> None:
    pytest.importorskip("pandas")
    torques = woman.torques(random_postures[:3])
    table = torques.to_pandas()
    assert table.shape == (3, 3 * 45)
    np.testing.assert_array_equal(table["elbow_flex_r"]["active"], torques["elbow_flex_r"]["active"])
    with pytest.raises(KeyError, match="lists them"):
        torques["elbow"]
