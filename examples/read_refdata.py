"""Reads reference data of shadercheck: NPZ with NumPy, Parquet with pyarrow.

    shadercheck refdata generate sphere --profile binary32 --output sphere.npz
    python read_refdata.py sphere.npz

Checks the SHA-256 of the data, computes the outputs of the sphere in binary32, and tells how many are
within their bounds.
"""

import hashlib
import json
import sys

import numpy as np


def read_npz(path):
    with np.load(path) as file:
        document = json.loads(file["provenance"].tobytes())
        return document, {array["name"]: file[array["name"]] for array in document["arrays"]}


def read_parquet(path):
    import pyarrow.parquet as pq

    table = pq.read_table(path)
    document = json.loads(table.schema.metadata[b"shadercheck-refdata"])
    arrays = {}
    for array in document["arrays"]:
        columns = [table[array["name"] + component].to_numpy() for component in array["components"]]
        values = np.stack(columns, axis=-1).astype(array["dtype"])
        if array["per"] == "case":
            values = values[:: document["per_case"]]
        arrays[array["name"]] = values.reshape([len(values)] + array["shape"])
    return document, arrays


def read(path):
    document, arrays = read_parquet(path) if path.endswith(".parquet") else read_npz(path)
    if document["schema"] != "shadercheck-refdata" or not document["schema_version"].startswith("1."):
        sys.exit(f"{path}: not reference data of schema 1")
    return document, arrays


def digest(document, arrays):
    """SHA-256 of the SHA-256 of all blocks."""
    total = hashlib.sha256()
    step, per_case = document["block_rows"], document["per_case"]
    for start in range(0, document["rows"], step):
        end = min(start + step, document["rows"])
        block = hashlib.sha256()
        for array in document["arrays"]:
            rows = slice(start, end)
            if array["per"] == "case":
                rows = slice(start // per_case, -(-end // per_case))
            block.update(np.ascontiguousarray(arrays[array["name"]][rows], dtype=array["dtype"]).tobytes())
        total.update(block.digest())
    return total.hexdigest()


def sphere(arrays, per_case):
    """The points of the sphere in binary32."""
    s, t = arrays["input.parameter"].T
    theta, phi = np.float32(2 * np.pi) * s, np.float32(np.pi) * t
    one = np.ones_like(s)
    points = np.stack([np.sin(phi) * np.cos(theta), np.cos(phi), np.sin(phi) * np.sin(theta), one], axis=-1)
    # Matrices are columns of rows: mc[case, column, row].
    matrices = np.repeat(arrays["case.mc"], per_case, axis=0)[: len(points)]
    return np.einsum("ncr,nc->nr", matrices, points)


def main(path):
    document, arrays = read(path)
    suite, formula = document["suite"], document["expected"]
    print(f"{suite['name']}: {document['rows']} samples, {formula['source']}")
    if digest(document, arrays) != document["sha256"]:
        sys.exit(f"{path}: the data do not have the SHA-256 of their provenance")
    print(f"sha256 {document['sha256']}")
    for flag in document["flags"]:
        count = int(np.count_nonzero(arrays["flags"] & flag["bit"]))
        if count:
            print(f"  {count:8} {flag['name']}: {flag['about']}")
    if suite["name"] == "sphere" and document["profile"]:
        actual = sphere(arrays, document["per_case"]).astype(np.float64)
        bound = arrays["bound.gl_Position"].astype(np.float64)
        within = np.abs(actual - arrays["expected.gl_Position"]) <= bound
        print(f"numpy in binary32: {np.count_nonzero(within)} of {within.size} elements within their bounds")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
